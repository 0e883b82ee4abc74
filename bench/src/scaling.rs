//! Cost against size: CPU time of index, evaluation and projection from 10⁴ to 10⁶ samples at fixed neighbours, in
//! random order, on one thread. Each case states what it expects, and the run fails where that is not met.

use crate::clock::{median, rounded, timed};
use crate::machine;
use footpoint::samples::torus;
use footpoint::{Cloud, Definition, Project, Queries, Run, Support, Surface, Want};
use serde_json::{Map, Value, json};
use std::f64::consts::PI;

const MAJOR: f64 = 1.0;
const MINOR: f64 = 0.4;
const SEED: u64 = 20_040_602;
const REPEATS: usize = 5;
const SIZES: [usize; 5] = [10_000, 31_623, 100_000, 316_228, 1_000_000];
/// Samples in the support, on average, and how far the measured mean may be off: the smallest torus bends within a
/// support of a hundred samples, which brings one more into it.
const NEIGHBOURS: [(f64, f64); 2] = [(30.0, 0.5), (100.0, 1.5)];
/// Share of points that must be projected.
const LEAST_OK: f64 = 0.99;
/// Largest slope of log CPU over log N.
const LARGEST_SLOPE: f64 = 1.08;

/// Medians over the repeats at one size.
struct Row {
    samples: usize,
    neighbours: f64,
    ok_share: f64,
    index: f64,
    evaluate: f64,
    project: f64,
}

type Stage = (&'static str, fn(&Row) -> f64);
const STAGES: [Stage; 4] = [
    ("index", |row| row.index),
    ("evaluate", |row| row.evaluate),
    ("project", |row| row.project),
    ("all", |row| row.index + row.evaluate + row.project),
];

/// Measures, and gives the record.
pub(crate) fn scaling() -> Value {
    let mut failures = Vec::new();
    let mut cases = Vec::new();
    for (wanted, tolerance) in NEIGHBOURS {
        let rows: Vec<Row> = SIZES.iter().filter_map(|&samples| measure(samples, wanted)).collect();
        let mut slopes = Map::new();
        for (name, seconds) in STAGES {
            let slope = slope(&rows, seconds);
            slopes.insert(name.to_owned(), json!(rounded(slope)));
            if slope > LARGEST_SLOPE {
                failures.push(format!("{wanted} neighbours: {name} grows with N^{slope:.3}"));
            }
        }
        for row in &rows {
            if (row.neighbours - wanted).abs() > tolerance || row.ok_share < LEAST_OK {
                let (n, ok) = (row.neighbours, row.ok_share);
                failures.push(format!("{} samples: {n:.2} neighbours, {ok:.4} projected", row.samples));
            }
        }
        if rows.len() != SIZES.len() {
            failures.push(format!("{wanted} neighbours: a surface could not be made"));
        }
        cases.push(json!({
            "neighbours": wanted,
            "slopes_of_log_cpu_over_log_n": slopes,
            "rows": rows.iter().map(Row::record).collect::<Vec<_>>(),
        }));
    }
    json!({
        "bench": "cost against size",
        "data": format!("torus {MAJOR} / {MINOR}, uniform, noise half a spacing, random order, seed {SEED}"),
        "what": "centred covariance, poly3, double; f, n and exact gradient; orthogonal projection to 1e-6 h",
        "version": env!("CARGO_PKG_VERSION"),
        "machine": machine::name(),
        "threads": 1,
        "repeats": REPEATS,
        "largest_slope": LARGEST_SLOPE,
        "failures": failures,
        "cases": cases,
    })
}

/// Index, evaluation at the samples and self-projection, each the median of the repeats.
fn measure(samples: usize, neighbours: f64) -> Option<Row> {
    let area = 4.0 * PI * PI * MAJOR * MINOR;
    let per_sample = area / samples as f64;
    let noise = 0.5 * per_sample.sqrt();
    // A sample is its own neighbour, the others fill a disc. Across the surface two samples differ by twice the
    // variance of the noise: the ball must be that much wider than the disc.
    let disc = (neighbours - 1.0) * per_sample / PI;
    let radius = (disc + 2.0 * noise * noise).sqrt();
    let points = torus(MAJOR, MINOR, samples, SEED).with_noise(noise, SEED + 1).points;
    let definition = Definition::new().with_support(Support::Uniform(radius));
    let run = Run::new().threads(1);
    let want = Want::VALUE | Want::FRAME_NORMAL | Want::GRADIENT;
    let how = Project::new();

    let (mut index, mut evaluate, mut project) = (Vec::new(), Vec::new(), Vec::new());
    let mut row = None;
    for _ in 0..REPEATS {
        let cloud = Cloud::new(points.clone());
        let (surface, seconds) = timed(|| Surface::build(cloud, definition, &run));
        let surface = surface.ok()?;
        index.push(seconds.cpu);
        let (evaluated, seconds) = timed(|| surface.with(&run).evaluate(Queries::Samples, want));
        std::hint::black_box(evaluated.ok()?);
        evaluate.push(seconds.cpu);
        let (projected, seconds) = timed(|| surface.with(&run).project(Queries::Samples, &how));
        project.push(seconds.cpu);
        let ok = projected.ok()?.status.iter().filter(|status| status.is_ok()).count();
        row.get_or_insert_with(|| {
            let counts = surface.evaluate(Queries::Samples, Want::NEIGHBOURS).neighbours;
            let mean = counts.iter().map(|&c| f64::from(c)).sum::<f64>() / samples as f64;
            (mean, ok as f64 / samples as f64)
        });
    }
    let (neighbours, ok_share) = row?;
    let (index, evaluate, project) = (median(index), median(evaluate), median(project));
    Some(Row { samples, neighbours, ok_share, index, evaluate, project })
}

impl Row {
    fn record(&self) -> Value {
        let per_sample = |seconds: f64| rounded(1e9 * seconds / self.samples as f64);
        json!({
            "samples": self.samples,
            "mean_neighbours": rounded(self.neighbours),
            "ok_share": rounded(self.ok_share),
            "index_ns_per_sample": per_sample(self.index),
            "evaluate_ns_per_sample": per_sample(self.evaluate),
            "evaluate_ns_per_pair": rounded(1e9 * self.evaluate / self.samples as f64 / self.neighbours),
            "project_ns_per_sample": per_sample(self.project),
        })
    }
}

/// Slope of the least-squares line through log seconds over log samples.
fn slope(rows: &[Row], seconds: fn(&Row) -> f64) -> f64 {
    let points: Vec<(f64, f64)> =
        rows.iter().map(|row| ((row.samples as f64).ln(), seconds(row).ln())).collect();
    let count = points.len() as f64;
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / count;
    let covariance: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    covariance / points.iter().map(|p| (p.0 - mean_x).powi(2)).sum::<f64>()
}
