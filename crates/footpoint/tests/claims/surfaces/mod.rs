//! What the surface is and how sure of it one may be: one claim a file.

mod boundary;
mod comparison;
mod curvature;
mod hostile;
mod medial_axis;
mod no_global_sign;
mod uncertainty;
