//! Orientation: signs for normals that have none, from where the samples were seen or from neighbour to neighbour.

mod components;
mod edge;
mod forest;
mod seen;
mod signs;
mod verdict;

use crate::evaluate::Want;
use crate::neighbours::Neighbours;
use crate::queries::Queries;
use crate::run::{Cancelled, Run};
use crate::status::Status;
use crate::surface::{Running, Surface};
use components::Components;

/// Which normals are given signs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum NormalSource {
    /// ∇f/|∇f| at the samples.
    #[default]
    Surface,
    /// The cloud's own normals, whose signs count for nothing.
    Given,
}

/// What decides the signs. Positions are in the unit of the samples.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Orient<'a, const D: usize> {
    /// Normals face this point.
    Towards([f64; D]),
    /// Normals have a positive component along this axis, of any length.
    Along([f64; D]),
    /// Each normal faces the position of the sensor that measured its sample: one a sample.
    Sensors(&'a [[f64; D]]),
    /// The same with a sensor that moves: it is where linear interpolation in `path` finds it.
    Trajectory {
        /// When each sample was measured.
        times: &'a [f64],
        /// Times, ascending, and positions of the sensor then.
        path: &'a [(f64, [f64; D])],
    },
    /// Along the minimum spanning forest of the graph of neighbours, which needs a connected and orientable surface; each
    /// component then faces outward.
    Propagated(NonOrientable),
}

/// What becomes of a component in which signs cannot agree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum NonOrientable {
    /// It gets no oriented normals.
    #[default]
    Leave,
    /// It is oriented along the forest; a seam remains, along which neighbours face opposite sides.
    Force,
}

/// Whether the signs of a component can agree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Verdict {
    /// They can, up to contradictions that noise explains.
    #[default]
    Orientable,
    /// They cannot, as on a Möbius strip: a path of reliable edges (those that are not doubtful) comes back with the other
    /// sign, and none that stays within four supports of the contradiction does.
    NonOrientable,
}

/// A connected component of the graph of neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Component {
    /// Its samples.
    pub samples: usize,
    /// How many of their normals were reversed.
    pub reversed: usize,
    /// Doubtful edges of its tree: between normals 60 degrees or more apart, or samples of which one lies more than half a
    /// support above the other's tangent plane.
    pub doubtful_edges: usize,
    /// Reliable edges that contradict the signs found.
    pub odd_edges: usize,
    /// Whether its signs can agree.
    pub verdict: Verdict,
}

/// `component` of a sample that belongs to none.
const NO_COMPONENT: u32 = u32::MAX;

/// Oriented normals, one a sample in the order of the cloud, and how they came about.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Orientation<const D: usize> {
    /// Unit normals; NaN where the status is not *ok*.
    pub normal: Vec<[f64; D]>,
    /// *ok*; that of the sample's surface normal where it has none; *outside* where its time is not in the trajectory;
    /// *degenerate* where no sign can be had (a given normal or sensor position that is absent, a component that is not
    /// orientable); *invalid* where the sample takes no part.
    pub status: Vec<Status>,
    /// Number of the sample's component in `components`, `u32::MAX` if it has no normal; empty unless propagated.
    pub component: Vec<u32>,
    /// The components, largest first; empty unless propagated.
    pub components: Vec<Component>,
    /// Normals that have a sign now.
    pub oriented: usize,
    /// How many of them were reversed.
    pub reversed: usize,
    /// Signs that hang on little: doubtful edges of the forest, or normals within 6 degrees of a right angle to the direction
    /// that decides.
    pub doubtful: usize,
}

/// Why nothing is oriented.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OrientError {
    /// A column has another length than the cloud.
    #[error("{column}: {found} values for {expected} samples")]
    Length {
        /// Which column.
        column: &'static str,
        /// Number of samples.
        expected: usize,
        /// Number of values given.
        found: usize,
    },
    /// A viewpoint that is not finite, or an axis that has no direction.
    #[error("the {0} must be finite, and an axis not zero")]
    NotFinite(&'static str),
    /// A trajectory without a position.
    #[error("the trajectory is empty")]
    NoPath,
    /// A time or position of the trajectory is not finite, or the time is before the last one.
    #[error("entry {0} of the trajectory (from 0): times and positions must be finite, and times ascend")]
    Path(usize),
    /// The cloud has no normals to give signs to.
    #[error("the cloud has no normals to orient: orient the surface's")]
    NoNormals,
    /// The computation was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Neighbours are samples within their supports of each other; of a Gaussian, whose support is wider than it counts, within
/// this many of its scales.
const WIDEST_REACH: f64 = 2.0;

impl<const D: usize> Surface<D> {
    /// Gives the normals at the samples signs that agree.
    ///
    /// Propagation takes time near-linear in the samples, and some 30 bytes a sample beside the result (D = 3); of what it
    /// finds the bits are the same for any number of threads and any order of the samples. A strip whose whole loop lies
    /// within four supports is too small for a verdict. Fails where columns do not fit or a direction makes no sense.
    pub fn orient(&self, normals: NormalSource, how: &Orient<'_, D>) -> Result<Orientation<D>, OrientError> {
        self.with(&Run::new()).orient(normals, how)
    }

    /// The normals as they are, with the statuses of those that are absent.
    fn given_normals(&self) -> Result<Orientation<D>, OrientError> {
        let given = self.cloud.normals().ok_or(OrientError::NoNormals)?;
        let mut normal = vec![[f64::NAN; D]; given.len()];
        let mut status = vec![Status::Invalid; given.len()];
        for &row in self.grid.original() {
            let row = row as usize;
            normal[row] = given[row];
            status[row] = if given[row][0].is_nan() { Status::Degenerate } else { Status::Ok };
        }
        Ok(Orientation { normal, status, ..Orientation::default() })
    }
}

impl<const D: usize> Running<'_, D> {
    /// [`Surface::orient`].
    pub fn orient(&self, normals: NormalSource, how: &Orient<'_, D>) -> Result<Orientation<D>, OrientError> {
        let surface = self.surface;
        seen::check(how, surface.cloud.len())?;
        let mut found = match normals {
            NormalSource::Given => surface.given_normals()?,
            NormalSource::Surface => {
                let evaluated = self.evaluate(Queries::Samples, Want::SURFACE_NORMAL)?;
                let (normal, status) = (evaluated.surface_normal, evaluated.status);
                Orientation { normal, status, ..Orientation::default() }
            }
        };
        match how {
            Orient::Propagated(non_orientable) => self.propagate(*non_orientable, &mut found)?,
            seen => seen::face(seen, surface.cloud.points(), &mut found),
        }
        Ok(found)
    }

    /// Carries signs from neighbour to neighbour.
    fn propagate(&self, non_orientable: NonOrientable, found: &mut Orientation<D>) -> Result<(), Cancelled> {
        let Surface { grid, cloud, definition, .. } = self.surface;
        let run = self.run.silent();
        let original = grid.original();
        let normal = &found.normal;
        let normals: Vec<[f32; D]> =
            run.collect(original.len(), |place| normal[original[place] as usize].map(|c| c as f32));
        let near = Neighbours::new(cloud, grid, definition.weight().reach().min(WIDEST_REACH));
        let forest = forest::grow(&near, &normals, &run)?;
        let mut components = Components::of(&forest, &normals);
        components.judge(&near, &normals, &forest, &run)?;
        drop(normals);
        let reversed = components.reversed(self.surface, &found.normal, &forest);

        found.component = vec![NO_COMPONENT; cloud.len()];
        for (place, &row) in original.iter().enumerate() {
            let (number, row) = (components.number[place], row as usize);
            let Some(component) = components.all.get_mut(number as usize) else { continue };
            found.component[row] = number;
            if component.verdict == Verdict::NonOrientable && non_orientable == NonOrientable::Leave {
                found.normal[row] = [f64::NAN; D];
                found.status[row] = Status::Degenerate;
                continue;
            }
            found.oriented += 1;
            if forest.sets.is_opposed(place) ^ reversed[number as usize] {
                found.normal[row] = found.normal[row].map(|c| -c);
                component.reversed += 1;
            }
        }
        found.reversed = components.all.iter().map(|component| component.reversed).sum();
        found.doubtful = components.all.iter().map(|component| component.doubtful_edges).sum();
        found.components = components.all;
        Ok(())
    }
}
