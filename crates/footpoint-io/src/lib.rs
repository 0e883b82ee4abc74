//! footpoint-io.
