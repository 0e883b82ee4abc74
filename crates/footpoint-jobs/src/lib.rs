//! footpoint-jobs.
