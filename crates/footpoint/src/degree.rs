//! The degree that suits a cloud: that of the least error, as the samples tell it.

use crate::algebra::{dot, length, scale, sub};
use crate::definition::{DefinitionError, Kind};
use crate::evaluate::{Evaluations, Want};
use crate::project::Project;
use crate::run::{Cancelled, Run};
use crate::surface::{Running, Surface};

/// Which error to make least. They do not agree: noise turns the normals of higher degrees more than it moves their surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum DegreeAim {
    /// Of positions on the surface.
    #[default]
    Position,
    /// Of surface normals.
    Normal,
}

/// What the samples tell about one degree.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DegreeEvidence {
    /// The degree.
    pub degree: u8,
    /// Share of the probes that project onto its surface with status *ok*.
    pub ok: f64,
    /// Expected error of positions, root mean square, a length.
    pub position: f64,
    /// Expected error of surface normals, root mean square, in radians while it is small.
    pub normal: f64,
}

/// The degree of least error, and why.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DegreeChoice {
    /// The degree.
    pub degree: u8,
    /// Which error is least.
    pub aim: DegreeAim,
    /// Points that were looked at.
    pub probes: usize,
    /// Every degree that was tried, ascending; empty for fields and kinds that have no other.
    pub evidence: Vec<DegreeEvidence>,
}

/// Samples that are looked at, at most.
const PROBES: usize = 2000;
/// Parts that the samples are dealt into, to leave out one after the other.
const PARTS: usize = 5;
/// The largest of the squares are left out of every mean, this share: single failures do not decide.
const LEFT_OUT: f64 = 0.01;
/// A degree is out of the question if it finds the surface at so many fewer of the probes than the best.
const FEWER: f64 = 0.01;

/// f/|∇f|, the distance to first order, and the surface normal at every probe.
struct Answers<const D: usize> {
    distance: Vec<f64>,
    normal: Vec<[f64; D]>,
}

impl<const D: usize> Surface<D> {
    /// The same surface of another degree: no new index. Fails as [`Surface::new`] does for that degree.
    pub fn with_degree(mut self, degree: u8) -> Result<Self, DefinitionError> {
        let definition = self.definition.with_degree(degree);
        definition.check()?;
        self.definition = definition;
        Ok(self)
    }

    /// [`Running::choose_degree`] on all cores.
    pub fn choose_degree(&self, aim: DegreeAim) -> DegreeChoice {
        let run = Run::new();
        let nothing = DegreeChoice { degree: 0, aim, probes: 0, evidence: Vec::new() };
        // A run without a flag is never cancelled.
        self.with(&run).choose_degree(aim).unwrap_or(nothing)
    }
}

impl<const D: usize> Running<'_, D> {
    /// Finds the degree whose error is least at this support, from 2000 of the samples.
    ///
    /// The error from noise and from uneven sampling is that of the jackknife: how much the answers differ when a fifth
    /// of the samples is left out, in turn. The bias is the difference to the highest degree, less what chance makes
    /// of that difference, by the same jackknife. It costs six indexes; the choice does not depend on the
    /// order of the samples, nor on the degree that the definition has now.
    pub fn choose_degree(&self, aim: DegreeAim) -> Result<DegreeChoice, Cancelled> {
        let surface = self.surface;
        let silent = self.run.silent();
        let run = &silent;
        let definition = surface.definition.with_degree_fallback(false);
        // About a(x) degree 1 is degree 0: the frame's plane is the best already.
        let degrees: Vec<u8> = (0..=3)
            .filter(|&degree| degree != 1 || definition.field().needs_normals())
            .filter(|&degree| definition.with_degree(degree).check().is_ok())
            .collect();
        let mut choice = DegreeChoice { degree: 0, aim, probes: 0, evidence: Vec::new() };
        if degrees.len() < 2 || surface.definition.kind() == Kind::Levin {
            return Ok(choice);
        }
        let at = |degree: u8| definition.with_degree(degree);
        let starts = surface.some_samples(PROBES);
        let whole = surface.part(at(2).with_degree_fallback(true), &|_| true, run)?;
        let Some(mut whole) = whole else { return Ok(choice) };
        let feet = whole.with(run).project(&starts, &Project::new())?;
        let probes: Vec<[f64; D]> =
            (0..starts.len()).filter(|&i| feet.status[i].is_ok()).map(|i| feet.point[i]).collect();
        choice.probes = probes.len();
        if probes.is_empty() {
            return Ok(choice);
        }
        let mut ok = Vec::new();
        let mut all = Vec::new();
        for &degree in &degrees {
            whole.definition = at(degree);
            let p = whole.with(run).project(&starts, &Project::new())?;
            ok.push(p.status.iter().filter(|s| s.is_ok()).count() as f64 / starts.len() as f64);
            all.push(answers(&whole, &probes, run)?);
        }
        drop(whole);
        let like = all[1].normal.clone();
        all.iter_mut().for_each(|answers| answers.face(&like));
        let mut without: Vec<Vec<Answers<D>>> = Vec::new();
        for part in 0..PARTS {
            let kept = |place: usize| scattered(place) % PARTS as u64 != part as u64;
            let Some(mut rest) = surface.part(at(0), &kept, run)? else { return Ok(choice) };
            let mut found = Vec::new();
            for &degree in &degrees {
                rest.definition = at(degree);
                let mut answers = answers(&rest, &probes, run)?;
                answers.face(&like);
                found.push(answers);
            }
            without.push(found);
        }
        let enough = ok.iter().fold(0.0_f64, |most, &share| most.max(share)) - FEWER;
        let reference = (0..degrees.len()).rev().find(|&m| ok[m] >= enough).unwrap_or(0);
        choice.evidence = (0..degrees.len())
            .map(|m| {
                let error = |of: &Of<'_, D>| {
                    let noise = jackknife(&probes, &without, &|found, i| of(&found[m], i));
                    let apart =
                        |found: &[Answers<D>], i: usize| sub(of(&found[m], i), of(&found[reference], i));
                    let squares = (0..probes.len()).map(|i| {
                        let apart = apart(&all, i);
                        dot(apart, apart)
                    });
                    let chance = jackknife(&probes, &without, &apart);
                    let bias =
                        if m < reference { (trimmed(squares.collect()) - chance).max(0.0) } else { 0.0 };
                    (noise + bias).sqrt()
                };
                DegreeEvidence {
                    degree: degrees[m],
                    ok: ok[m],
                    position: error(&|answers, i| {
                        std::array::from_fn(|k| if k == 0 { answers.distance[i] } else { 0.0 })
                    }),
                    normal: error(&|answers, i| answers.normal[i]),
                }
            })
            .collect();
        let error = |evidence: &DegreeEvidence| match aim {
            DegreeAim::Position => evidence.position,
            DegreeAim::Normal => evidence.normal,
        };
        let possible = choice.evidence.iter().filter(|evidence| evidence.ok >= enough);
        let best = possible.filter(|e| error(e).is_finite()).min_by(|a, b| error(a).total_cmp(&error(b)));
        choice.degree = best.map_or(0, |evidence| evidence.degree);
        Ok(choice)
    }
}

/// A quantity of one probe.
type Of<'f, const D: usize> = dyn Fn(&Answers<D>, usize) -> [f64; D] + 'f;

fn answers<const D: usize>(
    surface: &Surface<D>,
    probes: &[[f64; D]],
    run: &Run<'_>,
) -> Result<Answers<D>, Cancelled> {
    let want = Want::VALUE | Want::GRADIENT | Want::SURFACE_NORMAL;
    let Evaluations { value, gradient, surface_normal, .. } = surface.with(run).evaluate(probes, want)?;
    let distance = value.iter().zip(gradient).map(|(value, gradient)| value / length(gradient)).collect();
    Ok(Answers { distance, normal: surface_normal })
}

impl<const D: usize> Answers<D> {
    /// Gives each the sign with which its normal faces like these.
    fn face(&mut self, like: &[[f64; D]]) {
        for (i, &like) in like.iter().enumerate() {
            if dot(self.normal[i], like) < 0.0 {
                self.distance[i] = -self.distance[i];
                self.normal[i] = scale(self.normal[i], -1.0);
            }
        }
    }
}

/// The mean over the probes of the variance that leaving out parts tells of.
fn jackknife<const D: usize>(
    probes: &[[f64; D]],
    without: &[Vec<Answers<D>>],
    of: &dyn Fn(&[Answers<D>], usize) -> [f64; D],
) -> f64 {
    let parts = without.len() as f64;
    let variance = |i: usize| {
        let found: Vec<[f64; D]> = without.iter().map(|answers| of(answers, i)).collect();
        (0..D)
            .map(|k| {
                let mean = found.iter().map(|v| v[k]).sum::<f64>() / parts;
                let squares: f64 = found.iter().map(|v| (v[k] - mean) * (v[k] - mean)).sum();
                squares * (parts - 1.0) / parts
            })
            .sum()
    };
    trimmed((0..probes.len()).map(variance).collect())
}

/// The mean of what exists, without the largest; NaN if nothing does.
fn trimmed(mut squares: Vec<f64>) -> f64 {
    squares.retain(|square| square.is_finite());
    squares.sort_unstable_by(f64::total_cmp);
    let kept = squares.len() - (squares.len() as f64 * LEFT_OUT) as usize;
    squares[..kept].iter().sum::<f64>() / kept as f64
}

/// A number without a pattern for each place.
fn scattered(place: usize) -> u64 {
    let mixed = (place as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((mixed ^ (mixed >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9)) >> 33
}
