//! The footpoint command.
fn main() {}
