//! footpoint.
