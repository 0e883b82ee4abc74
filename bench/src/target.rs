//! Targets, judged by the measurements: met, missed, or without a rival that counts.

use crate::case::{Measure, Target};
use crate::clock::rounded;
use crate::speed::{Measurement, Measurements};
use serde_json::{Value, json};

/// The record of every target whose measurements exist.
pub(crate) fn judged(targets: &[Target], measurements: &Measurements) -> Vec<Value> {
    targets.iter().filter_map(|target| target.judge(measurements)).collect()
}

impl Target {
    fn judge(&self, measurements: &Measurements) -> Option<Value> {
        let of = measurements.get(&self.of)?;
        let to = match &self.to {
            Some(to) => Some(measurements.get(to)?),
            None => None,
        };
        let reached = self.measure.of(of) / to.map_or(1.0, |to| self.measure.of(to));
        let counts = of.counts && to.is_none_or(|to| to.counts);
        let verdict = match (counts, self.holds(reached)) {
            (false, _) => "does not count: the rival is slower than its bound",
            (true, true) => "met",
            (true, false) => "missed",
        };
        let stretch = self.stretch.map(|limit| match self.at_least {
            Some(_) => reached >= limit,
            None => reached <= limit,
        });
        let mut record = json!({ "target": self.name, "reached": rounded(reached), "verdict": verdict });
        let bounds = [("at_most", self.at_most), ("at_least", self.at_least), ("stretch", self.stretch)];
        for (name, bound) in bounds {
            if let Some(bound) = bound {
                record[name] = json!(bound);
            }
        }
        if let Some(stretch) = stretch {
            record["stretch_met"] = json!(counts && stretch);
        }
        Some(record)
    }

    fn holds(&self, reached: f64) -> bool {
        self.at_most.is_none_or(|most| reached <= most) && self.at_least.is_none_or(|least| reached >= least)
    }
}

impl Measure {
    fn of(self, measurement: &Measurement) -> f64 {
        match self {
            Self::Cpu => measurement.cpu,
            Self::NsPerSample => 1e9 * measurement.cpu / measurement.samples,
            Self::NsPerPair => 1e9 * measurement.cpu / measurement.pairs,
            Self::BestWall => measurement.best_wall,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(at_least: f64, counts: bool) -> String {
        let one = |cpu| Measurement { cpu, best_wall: cpu, samples: 10.0, pairs: 100.0, counts };
        let measurements = Measurements::from([("a".to_owned(), one(3.0)), ("b".to_owned(), one(1.0))]);
        let target = Target {
            name: "a against b".to_owned(),
            measure: Measure::Cpu,
            of: "a".to_owned(),
            to: Some("b".to_owned()),
            at_most: None,
            at_least: Some(at_least),
            stretch: None,
        };
        judged(&[target], &measurements)[0]["verdict"].as_str().unwrap().to_owned()
    }

    #[test]
    fn a_target_is_met_missed_or_without_a_rival() {
        assert_eq!(verdict(2.9, true), "met");
        assert_eq!(verdict(3.1, true), "missed");
        assert!(verdict(2.9, false).starts_with("does not count"));
    }
}
