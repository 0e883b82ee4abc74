//! Speed: the groups of cases, their repeats interleaved, their answers checked, the targets judged.

use crate::answers::{Summary, difference, failures, summary};
use crate::case::{Case, Cases, Expected, Group, Stage};
use crate::clock::{Seconds, median, rounded};
use crate::cloud::{Sampled, Supports};
use crate::contest::{Contestant, contestant};
use crate::machine::circumstances;
use crate::target::judged;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::rc::Rc;

/// A case under way.
pub(crate) struct Entry {
    case: Case,
    /// `group/case`.
    name: String,
    sampled: Rc<Sampled>,
    supports: Supports,
    contestant: Box<dyn Contestant>,
    seconds: BTreeMap<Stage, Vec<Seconds>>,
}

/// One stage of one case, measured.
pub(crate) struct Measurement {
    pub(crate) cpu: f64,
    pub(crate) best_wall: f64,
    pub(crate) samples: f64,
    pub(crate) pairs: f64,
    /// Whether a ratio to it counts.
    pub(crate) counts: bool,
}

/// Measurements by `group/case/stage`.
pub(crate) type Measurements = BTreeMap<String, Measurement>;

/// Runs the groups (all, if none is named) and gives the record with what failed.
pub(crate) fn speed(cases: &Cases, only: &[String], repeats: Option<usize>) -> Result<Value, String> {
    let mut measurements = Measurements::new();
    let (mut groups, mut failed) = (Vec::new(), Vec::new());
    let start = circumstances();
    for group in cases.groups.iter().filter(|group| only.is_empty() || only.contains(&group.name)) {
        let repeats = repeats.unwrap_or(group.repeats);
        let entries = measure(cases, group, repeats)?;
        let records: Vec<Value> =
            entries.iter().map(|entry| entry.finish(&entries, &mut measurements, &mut failed)).collect();
        groups.push(json!({ "group": group.name, "repeats": repeats, "cases": records }));
    }
    Ok(json!({
        "bench": "speed",
        "circumstances": start,
        "data": "torus, uniform, random order, noise along every axis; answers in the order of the input",
        "time": "user and system seconds of the process, median of the repeats; wall: the shortest",
        "targets": judged(&cases.targets, &measurements),
        "groups": groups,
        "failures": failed,
    }))
}

/// Makes every case of a group ready and repeats their stages in turn.
fn measure(cases: &Cases, group: &Group, repeats: usize) -> Result<Vec<Entry>, String> {
    let mut clouds: BTreeMap<&str, Rc<Sampled>> = BTreeMap::new();
    let mut entries: Vec<Entry> = Vec::new();
    for case in &group.cases {
        let name = format!("{}/{}", group.name, case.name);
        eprintln!("{name}: making ready");
        let data = cases.data.get(&case.data).ok_or_else(|| format!("{name}: no data {}", case.data))?;
        let sampled = clouds.entry(&case.data).or_insert_with(|| Rc::new(Sampled::new(data)));
        let sampled = Rc::clone(sampled);
        let like = |entry: &&Entry| {
            entry.case.data == case.data
                && entry.case.support == case.support
                && entry.case.neighbours.mean == case.neighbours.mean
        };
        let supports = match entries.iter().find(like) {
            Some(entry) => entry.supports.clone(),
            None => sampled.supports(case.neighbours, case.support)?,
        };
        let contestant = contestant(case, &sampled, &supports).map_err(|e| format!("{name}: {e}"))?;
        let seconds = BTreeMap::new();
        entries.push(Entry { case: case.clone(), name, sampled, supports, contestant, seconds });
    }
    for repeat in 1..=repeats {
        eprintln!("{}: repeat {repeat} of {repeats}", group.name);
        for entry in &mut entries {
            for &stage in &entry.case.measure {
                let seconds = entry.contestant.time(stage).map_err(|e| format!("{}: {e}", entry.name))?;
                entry.seconds.entry(stage).or_default().push(seconds);
            }
        }
    }
    Ok(entries)
}

impl Entry {
    /// Checks the answers, keeps the measurements and gives the record.
    fn finish(&self, entries: &[Self], measurements: &mut Measurements, failed: &mut Vec<String>) -> Value {
        let Self { case, name, sampled, supports, .. } = self;
        let summary = summary(&*self.contestant, sampled, supports.radius);
        let neighbours = Expected { value: case.neighbours.mean, tolerance: case.neighbours.tolerance };
        let mut expected = case.expected.clone();
        expected.insert("mean_neighbours".to_owned(), neighbours);
        failed.extend(failures(name, &summary, &expected));
        let mut record = Map::new();
        if let Some(agreement) = &case.agreement {
            let other = entries.iter().find(|entry| entry.case.name == agreement.with);
            let found = other.map_or(f64::NAN, |other| {
                difference(&*self.contestant, &*other.contestant, agreement, supports.radius)
            });
            // NaN is no agreement.
            if found.is_nan() || found > agreement.at_most {
                failed.push(format!("{name}: differs from {} by {found:e}", agreement.with));
            }
            record.insert("largest_difference".to_owned(), json!({ "to": agreement.with, "is": found }));
        }
        let stages: Map<String, Value> = (self.seconds.iter())
            .map(|(&stage, seconds)| {
                let measurement = self.measurement(&summary, seconds);
                let value = measurement.record(stage, seconds);
                measurements.insert(format!("{name}/{}", stage.name()), measurement);
                (stage.name().to_owned(), value)
            })
            .collect();
        record.insert("case".to_owned(), json!(case.name));
        record.insert("samples".to_owned(), json!(sampled.points.len()));
        record.insert("radius".to_owned(), json!(supports.radius));
        record.insert("threads".to_owned(), json!(case.threads));
        record.insert("answers".to_owned(), json!(summary));
        record.insert("stages".to_owned(), Value::Object(stages));
        Value::Object(record)
    }

    fn measurement(&self, summary: &Summary, seconds: &[Seconds]) -> Measurement {
        let samples = self.sampled.points.len() as f64;
        let pairs = samples * summary.get("mean_neighbours").copied().unwrap_or(f64::NAN);
        let mut measurement = Measurement {
            cpu: median(seconds.iter().map(|s| s.cpu)),
            best_wall: seconds.iter().map(|s| s.wall).fold(f64::INFINITY, f64::min),
            samples,
            pairs,
            counts: true,
        };
        // The bound is for an evaluation; the other stages of the contestant stand and fall with it.
        let evaluation = self.seconds.get(&Stage::Evaluate).map(|all| median(all.iter().map(|s| s.cpu)));
        if let (Some(bound), Some(cpu)) = (self.case.counts_up_to_ns_per_pair, evaluation) {
            measurement.counts = 1e9 * cpu / pairs <= bound;
        }
        measurement
    }
}

impl Measurement {
    fn record(&self, stage: Stage, seconds: &[Seconds]) -> Value {
        let mut record = json!({
            "cpu_seconds": rounded(self.cpu),
            "best_wall_seconds": rounded(self.best_wall),
            "ns_per_sample": rounded(1e9 * self.cpu / self.samples),
            "cpu_seconds_of_repeats": seconds.iter().map(|s| rounded(s.cpu)).collect::<Vec<_>>(),
        });
        if stage == Stage::Evaluate {
            record["ns_per_pair"] = json!(rounded(1e9 * self.cpu / self.pairs));
            record["counts"] = json!(self.counts);
        }
        record
    }
}
