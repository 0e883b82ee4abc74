//! Without noise the demo's position error falls with the square of the support.

mod common;

use common::{found, run_demo};
use footpoint_jobs::Support;
use footpoint_jobs::scan::ScanPlan;

/// Slope of the least-squares line through points (log h, log error).
fn order(measured: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = measured.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    let count = logs.len() as f64;
    let (mean_h, mean_e) = logs.iter().fold((0.0, 0.0), |(h, e), l| (h + l.0 / count, e + l.1 / count));
    let above: f64 = logs.iter().map(|(h, e)| (h - mean_h) * (e - mean_e)).sum();
    above / logs.iter().map(|(h, _)| (h - mean_h).powi(2)).sum::<f64>()
}

#[test]
fn position_error() {
    let folder = tempfile::tempdir().unwrap();
    let mut measured = Vec::new();
    // From h on the finest detail is resolved; below the last one the unevenness of the samples would show.
    for step in 0..3 {
        let h = 0.012 * 0.5_f64.powf(0.5 * f64::from(step));
        let scan = ScanPlan { noise: 0.0, rays: 90_000, ..ScanPlan::default() };
        let inside = folder.path().join(step.to_string());
        let demo = found(&run_demo(&inside, scan, Support::Uniform(h)));
        println!("h {h:.5}: {demo:?}");
        measured.push((h, demo.rms_after_metres));
    }
    let order = order(&measured);
    println!("order {order:.2}");
    assert!((1.7..2.4).contains(&order), "{order} from {measured:?}");
}
