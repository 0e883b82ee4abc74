//! footpoint computes with the smooth surface that a point cloud describes: the *point set surface* of Alexa and
//! Adamson, "On Normals and Projection Operators for Surfaces Defined by Point Sets" (2004).
//!
//! The surface is where f(x) = n(x)·(x − a(x)) vanishes: a is the weighted average of the samples around x, n the
//! normal of a frame fitted to them. The normal of that surface is not n but ∇f, which is computed exactly.
//!
//! ```
//! use footpoint::{Cloud, Definition, Project, Queries, Surface, Want, samples};
//!
//! let cloud = Cloud::new(samples::sphere(1.0, 5000, 1).points);
//! let surface = Surface::new(cloud, Definition::default())?;
//! println!("support radius {:.3}", surface.support().median);
//!
//! let normals = surface.evaluate(Queries::Samples, Want::SURFACE_NORMAL).surface_normal;
//! assert_eq!(normals.len(), 5000);
//! let feet = surface.project(&[[0.0, 0.0, 1.1]], &Project::default());
//! assert!(feet.status[0].is_ok() && (feet.distance[0] - 0.1).abs() < 0.02);
//! # Ok::<(), footpoint::Error>(())
//! ```
//!
//! A tour: [`Cloud`] holds the samples with optional normals, supports and factors; [`Definition`] says which surface
//! they define ([`Weight`], [`Support`], [`NormalField`], [`Acceptance`]); [`Surface`] answers questions:
//! [`Surface::evaluate`] gives f, ∇f and what belongs to them, [`Surface::project`] takes points to the surface,
//! [`Surface::orient`] gives normals signs that agree, [`Surface::contour`] gives a curve of the plane as polylines. Every answer has a [`Status`]. [`Run`] says how to run: threads, progress, cancelling.

// No panic on data and nothing on standard output by accident; tests may.
#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]

mod algebra;
mod average;
mod choose;
mod cloud;
mod columns;
mod compare;
mod contour;
mod curvature;
mod definition;
mod degree;
mod domain;
mod dual;
mod eigen;
mod engine;
mod evaluate;
mod evaluator;
mod field;
mod frame;
mod grid;
mod heights;
mod lane;
mod least_squares;
mod neighbours;
mod noise;
mod orient;
mod polynomial;
mod project;
mod queries;
mod ray;
mod regression;
mod run;
pub mod samples;
mod status;
mod support;
mod surface;
mod uncertainty;
mod variance;
mod weight;
#[cfg(feature = "serde")]
mod written;

pub use choose::{Aim, Choice};
pub use cloud::{Cloud, CloudError};
pub use compare::{CompareError, Compared, Comparison, Differences, Pair};
pub use contour::{Contour, Contours, Polyline};
pub use definition::{Acceptance, Definition, DefinitionError, Error, Kind};
pub use degree::{DegreeAim, DegreeChoice, DegreeEvidence};
pub use evaluate::{Curvatures, Evaluations, Want};
pub use field::NormalField;
pub use lane::Precision;
pub use noise::{Noise, NoiseError};
pub use orient::{Component, NonOrientable, NormalSource, Orient, OrientError, Orientation, Verdict};
pub use project::{Operator, Project, Projections, Trace};
pub use queries::Queries;
pub use ray::{AllHits, Cast, Hits, Ray, Sought};
pub use run::{Cancelled, Instructions, Progress, Run};
pub use status::Status;
pub use support::{Support, SupportChoice, SupportError, SupportSummary, spacing};
pub use surface::{Running, Sign, Surface};
pub use uncertainty::{NoiseEstimate, Uncertainties, Uncertainty, UncertaintyError};
pub use weight::Weight;

/// The README's example is tested like every other.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// So are those of the mathematics.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../../../docs/definitions.md")]
    struct Definitions;
    #[doc = include_str!("../../../docs/degrees.md")]
    struct Degrees;
    #[doc = include_str!("../../../docs/rays.md")]
    struct Rays;
    #[doc = include_str!("../../../docs/sensitivity.md")]
    struct Sensitivity;
}
