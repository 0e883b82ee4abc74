//! Cases as data: what is measured, on which points, with the answers expected and the targets set.

use footpoint::{Instructions, NormalField, Precision, Weight};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The file of cases.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Cases {
    pub(crate) data: BTreeMap<String, Torus>,
    pub(crate) groups: Vec<Group>,
    pub(crate) targets: Vec<Target>,
    pub(crate) peers: Vec<PeerGroup>,
}

/// Uniform samples of a torus in random order, with normally distributed noise along every axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Torus {
    pub(crate) major: f64,
    pub(crate) minor: f64,
    pub(crate) samples: usize,
    pub(crate) seed: u64,
    /// Standard deviation of the noise in units of √(area/samples).
    pub(crate) noise_in_spacings: f64,
}

/// Cases whose repeats are interleaved, so that their ratios belong to the same minutes.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Group {
    pub(crate) name: String,
    pub(crate) repeats: usize,
    pub(crate) cases: Vec<Case>,
}

/// One contestant on one cloud.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) data: String,
    pub(crate) neighbours: Neighbours,
    #[serde(default)]
    pub(crate) engine: Engine,
    #[serde(default)]
    pub(crate) field: NormalField,
    #[serde(default)]
    pub(crate) degree: u8,
    #[serde(default)]
    pub(crate) weight: Weight,
    #[serde(default)]
    pub(crate) precision: Precision,
    #[serde(default)]
    pub(crate) support: Radii,
    #[serde(default = "one")]
    pub(crate) threads: usize,
    #[serde(default)]
    pub(crate) instructions: Level,
    pub(crate) measure: Vec<Stage>,
    /// Answers by name; one that does not hold makes the run fail.
    #[serde(default)]
    pub(crate) expected: BTreeMap<String, Expected>,
    /// The case of the same group whose f, n and ∇f must be the same.
    pub(crate) agreement: Option<Agreement>,
    /// A rival slower than this is not written well enough for a ratio to it to count.
    pub(crate) counts_up_to_ns_per_pair: Option<f64>,
}

fn one() -> usize {
    1
}

/// The number of samples in the support, on average over the samples.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Neighbours {
    pub(crate) mean: f64,
    pub(crate) tolerance: f64,
}

/// Who computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Engine {
    #[default]
    Footpoint,
    Baseline,
}

/// The radii of the supports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Radii {
    #[default]
    Uniform,
    /// One a sample: uniform between 1 − spread and 1 + spread times a common one.
    PerSample { spread: f64, seed: u64 },
}

/// The instructions allowed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Level {
    #[default]
    Best,
    Avx2,
    Baseline,
}

impl From<Level> for Instructions {
    fn from(level: Level) -> Self {
        match level {
            Level::Best => Self::Best,
            Level::Avx2 => Self::Avx2,
            Level::Baseline => Self::Baseline,
        }
    }
}

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Stage {
    /// Building the index.
    Index,
    /// f, n and the exact ∇f at the samples, into columns that are there already.
    Evaluate,
    /// Surface normals at the samples, index included.
    Normals,
    /// Orthogonal projection of the samples to 1e-6 h, index included.
    Project,
}

impl Stage {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Index => "index",
            Self::Evaluate => "evaluate",
            Self::Normals => "normals",
            Self::Project => "project",
        }
    }
}

/// An answer and how far off it may be.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Expected {
    pub(crate) value: f64,
    pub(crate) tolerance: f64,
}

/// The largest difference allowed to another case: of f in units of h, of n, and of ∇f relative to its length,
/// wherever the gap exceeds `gap`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Agreement {
    pub(crate) with: String,
    pub(crate) at_most: f64,
    pub(crate) gap: f64,
}

/// A target: missing it is recorded, not a failure.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Target {
    pub(crate) name: String,
    pub(crate) measure: Measure,
    /// `group/case/stage`.
    pub(crate) of: String,
    /// What `of` is divided by.
    pub(crate) to: Option<String>,
    pub(crate) at_most: Option<f64>,
    pub(crate) at_least: Option<f64>,
    pub(crate) stretch: Option<f64>,
}

/// The quantity that a target is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Measure {
    /// Median CPU time.
    Cpu,
    /// Median CPU time per sample, in nanoseconds.
    NsPerSample,
    /// Median CPU time per sample in the support, in nanoseconds.
    NsPerPair,
    /// Shortest wall time.
    BestWall,
}

/// Jobs of several programs on the same points.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PeerGroup {
    pub(crate) name: String,
    pub(crate) data: String,
    pub(crate) repeats: usize,
    /// The mean count that the radius gives.
    pub(crate) neighbours: Neighbours,
    /// The job of this library that the others are compared with.
    pub(crate) own: Stage,
    /// The degree of its surface.
    #[serde(default)]
    pub(crate) degree: u8,
    pub(crate) jobs: Vec<PeerJob>,
}

/// What a peer is asked to do.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PeerJob {
    pub(crate) peer: String,
    pub(crate) job: String,
    /// Neighbours of a search by count; a search by radius takes the group's.
    pub(crate) count: Option<usize>,
    /// In what the comparison is equal.
    pub(crate) equal: String,
    /// Answers by name, as for a case.
    #[serde(default)]
    pub(crate) expected: BTreeMap<String, Expected>,
}

impl Case {
    /// The default definition on some data, with this mean count; nothing is measured.
    pub(crate) fn with(data: &str, neighbours: Neighbours) -> Self {
        Self {
            name: String::new(),
            data: data.to_owned(),
            neighbours,
            engine: Engine::default(),
            field: NormalField::default(),
            degree: 0,
            weight: Weight::default(),
            precision: Precision::default(),
            support: Radii::default(),
            threads: 1,
            instructions: Level::default(),
            measure: Vec::new(),
            expected: BTreeMap::new(),
            agreement: None,
            counts_up_to_ns_per_pair: None,
        }
    }
}

impl Cases {
    /// The cases that come with the benchmark.
    pub(crate) fn read() -> Result<Self, serde_json::Error> {
        serde_json::from_str(include_str!("../cases.json"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_cases_parse_and_what_they_name_exists() {
        let cases = Cases::read().unwrap();
        let mut stages = BTreeSet::new();
        for group in &cases.groups {
            for case in &group.cases {
                assert!(cases.data.contains_key(&case.data), "{}", case.data);
                stages.extend(
                    case.measure.iter().map(|s| format!("{}/{}/{}", group.name, case.name, s.name())),
                );
                let partner = |with: &str| group.cases.iter().any(|other| other.name == with);
                assert!(case.agreement.as_ref().is_none_or(|a| partner(&a.with)), "{}", case.name);
            }
        }
        for target in &cases.targets {
            assert!(stages.contains(&target.of), "{}", target.of);
            assert!(target.to.as_ref().is_none_or(|to| stages.contains(to)), "{:?}", target.to);
            assert!(target.at_most.is_some() || target.at_least.is_some(), "{}", target.name);
        }
        assert!(cases.peers.iter().all(|group| cases.data.contains_key(&group.data)));
    }
}
