//! The surface: samples, index and definition.

use crate::cloud::{Cloud, CloudError};
use crate::definition::{Definition, DefinitionError, Error};
use crate::domain::Domain;
use crate::field::NormalField;
use crate::grid::{Grid, cell_side};
use crate::lane::Precision;
use crate::noise::{Noise, NoiseError};
use crate::run::{Cancelled, Run};
use crate::support::{Support, SupportChoice, SupportError, SupportSummary, choose};
use std::sync::OnceLock;

/// The surface that a cloud defines: the zero set of f(x) = n(x)·(x − a(x)) (eqs. 2 and 3).
///
/// Immutable, and shared freely between threads. Plain calls use all cores and cannot fail: every point gets a
/// [`Status`](crate::Status). [`Surface::with`] gives the same calls with threads, progress and cancelling. Results have the
/// same bits for any number of threads, any batch and any order of the samples.
#[derive(Debug)]
pub struct Surface<const D: usize> {
    pub(crate) cloud: Cloud<D>,
    pub(crate) definition: Definition,
    pub(crate) grid: Grid<D>,
    /// Made when the first ray asks.
    domain: OnceLock<Domain<D>>,
    support: SupportSummary,
    support_choice: Option<SupportChoice>,
    sign: Sign,
}

/// How the sign of f and of the normals is decided (SPEC § 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Sign {
    /// By the samples' normals: distances are signed.
    Given,
    /// By a rule that only makes it unique at each point: distances are not signed.
    Arbitrary,
}

/// A surface together with how to run: the same calls, which end early when cancelled.
#[derive(Clone, Copy, Debug)]
pub struct Running<'r, const D: usize> {
    pub(crate) surface: &'r Surface<D>,
    pub(crate) run: &'r Run<'r>,
}

impl<const D: usize> Surface<D> {
    /// Chooses the support and indexes the samples.
    ///
    /// Fails where the definition makes no sense or needs normals that are absent, and where no sample is usable.
    pub fn new(cloud: Cloud<D>, definition: Definition) -> Result<Self, Error> {
        Self::build(cloud, definition, &Run::new())
    }

    /// [`Surface::new`] with threads and cancelling.
    pub fn build(cloud: Cloud<D>, definition: Definition, run: &Run<'_>) -> Result<Self, Error> {
        const { assert!(D == 2 || D == 3, "clouds have 2 or 3 dimensions") };
        definition.check()?;
        if u32::try_from(cloud.len()).is_err() {
            return Err(CloudError::TooMany(cloud.len()).into());
        }
        let field = definition.field();
        let has_normals = cloud.absent_normals() < cloud.len();
        if field.needs_normals() && !has_normals && !cloud.is_empty() {
            return Err(DefinitionError::NormalsAbsent(field).into());
        }
        // The main axis of normals is for those whose signs mean nothing.
        let signed = has_normals && field != NormalField::AveragedAxes;
        let sign = if signed { Sign::Given } else { Sign::Arbitrary };
        let (radii, support_choice) = choose(&cloud, definition.support(), definition.weight(), run)?;
        let support = radii.summary(&cloud)?;
        let SupportSummary { smallest, largest, .. } = support;
        if definition.precision() == Precision::Single && smallest < 1e-3 * largest {
            return Err(DefinitionError::SingleRange { smallest, largest }.into());
        }
        run.check()?;
        let reach = definition.weight().reach();
        let grid = Grid::new(&cloud, &radii, support.largest, reach, definition.precision(), run);
        run.check()?;
        if grid.len() == 0 {
            return Err(SupportError::NoSample(cloud.len()).into());
        }
        Ok(Self { cloud, definition, grid, domain: OnceLock::new(), support, support_choice, sign })
    }

    /// The same calls with threads, progress and cancelling.
    pub fn with<'r>(&'r self, run: &'r Run<'r>) -> Running<'r, D> {
        Running { surface: self, run }
    }

    /// Gives all samples one figure of noise, in place of what the cloud said: no new index.
    pub fn with_uniform_noise(mut self, sigma: f64) -> Result<Self, NoiseError> {
        self.cloud = self.cloud.with_noise(Noise::Uniform(sigma))?;
        self.grid.noise.clear();
        Ok(self)
    }

    /// The surface of those samples whose place in the canonical order is kept, each with the radius that it has here. None
    /// where there is none.
    pub(crate) fn part(
        &self,
        definition: Definition,
        kept: &dyn Fn(usize) -> bool,
        run: &Run<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        let grid = &self.grid;
        let places: Vec<usize> = (0..grid.len()).filter(|&place| kept(place)).collect();
        let rows: Vec<usize> = places.iter().map(|&place| grid.original()[place] as usize).collect();
        let mut cloud = self.cloud.select(&rows);
        let mut support = Support::Uniform(self.support.median);
        if !grid.scales.is_empty() {
            let radii: Vec<f64> = places.iter().map(|&place| grid.scales[place] * grid.unit).collect();
            match cloud.with_supports(radii) {
                Ok(with) => cloud = with,
                Err(_) => return Ok(None),
            }
            support = Support::FromSamples;
        }
        match Self::build(cloud, definition.with_support(support), run) {
            Ok(surface) => Ok(Some(surface)),
            Err(Error::Cancelled(cancelled)) => Err(cancelled),
            Err(_) => Ok(None),
        }
    }

    /// Where rays may come near samples.
    pub(crate) fn domain(&self, run: &Run<'_>) -> &Domain<D> {
        // Not made inside the lock: a thread that waits for the pool may be given work that asks for it too.
        match self.domain.get() {
            Some(domain) => domain,
            None => {
                let made = Domain::new(&self.grid, self.definition.domain_ratio(), run);
                self.domain.get_or_init(|| made)
            }
        }
    }

    /// So many samples or fewer, evenly from the canonical order.
    pub(crate) fn some_samples(&self, most: usize) -> Vec<[f64; D]> {
        let order = self.grid.original();
        let stride = order.len().div_ceil(most).max(1);
        order.iter().step_by(stride).map(|&row| self.cloud.points()[row as usize]).collect()
    }

    /// The samples that take part, each with its support radius.
    pub(crate) fn samples_with_supports(&self) -> Vec<([f64; D], f64)> {
        let grid = &self.grid;
        let radius = |place: usize| grid.scales.get(place).map_or(self.support.median, |s| s * grid.unit);
        let sample = |(place, &row): (usize, &u32)| (self.cloud.points()[row as usize], radius(place));
        grid.original().iter().enumerate().map(sample).collect()
    }

    /// The definition.
    pub fn definition(&self) -> &Definition {
        &self.definition
    }

    /// The cloud.
    pub fn cloud(&self) -> &Cloud<D> {
        &self.cloud
    }

    /// The radii that the definition's rule gave.
    pub fn support(&self) -> SupportSummary {
        self.support
    }

    /// Why the radii are what they are, where the rule was one of least error.
    pub fn support_choice(&self) -> Option<SupportChoice> {
        self.support_choice
    }

    /// Whether distances and normals have a sign that means something.
    pub fn sign(&self) -> Sign {
        self.sign
    }

    /// Samples that take part: those with finite coordinates, and a positive support and factor.
    pub fn samples_used(&self) -> usize {
        self.grid.len()
    }

    /// Side of the index's cells: a cloud moved by whole multiples of it along the axes keeps every bit of its
    /// answers (if the moved coordinates are exact). It belongs to the largest support.
    pub fn cell_side(&self) -> f64 {
        cell_side(self.support.largest * self.definition.weight().reach())
    }
}
