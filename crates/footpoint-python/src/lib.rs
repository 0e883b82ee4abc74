//! The private extension module `footpoint._footpoint`: surfaces, files and pictures for the Python package, which checks
//! shapes and types, and gives results their names.

// No panic on data and nothing on standard output by accident.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod answers;
mod arrays;
mod errors;
mod files;
mod options;
mod picture;
mod surface;
mod work;

use pyo3::prelude::*;
use std::{panic, thread};

/// Damaged LAZ makes its decoder panic, which the reader turns into an error: nobody is to read of it twice.
fn silence_unpacking() {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if thread::current().name() != Some(footpoint_jobs::UNPACKING) {
            usual(info);
        }
    }));
}

#[pymodule]
mod _footpoint {
    use super::{PyResult, silence_unpacking};
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::files::{Origin, read, write};
    #[pymodule_export]
    use crate::surface::AnySurface;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        silence_unpacking();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
