//! The demo's scan comes out nearer to the truth than it went in, and the demo says by how much.

mod common;

use common::{found, names, numbers, run_demo, table};
use footpoint_jobs::scan::{ScanPlan, Vessel};
use footpoint_jobs::{Context, DemoPlan, JobError, Overwrite, Support, demo};

/// The support that the command takes for the demo.
const DEMO_SUPPORT: Support = Support::AutoPerSample { effective_neighbours: 24.0 };

const FILES: [&str; 5] = ["scan.ply", "normals.ply", "projected.ply", "picture.png", "triptych.png"];

#[test]
fn at_full_size() {
    let folder = tempfile::tempdir().unwrap();
    let report = run_demo(folder.path(), ScanPlan::default(), DEMO_SUPPORT);
    let demo = found(&report);
    println!("{} points: {demo:?}", report.points);
    assert!(report.points >= 200_000, "{}", report.points);
    assert!(demo.rms_ratio <= 0.45, "{demo:?}");
    assert!((demo.rms_after_metres / demo.rms_before_metres - demo.rms_ratio).abs() < 1e-12);
    // The noise goes along the rays: across the surface it is a little less.
    assert!((0.6..1.0).contains(&(demo.rms_before_metres / demo.noise_metres)), "{demo:?}");
    assert!(demo.median_surface_normal_error_degrees <= 2.0, "{demo:?}");
    assert!(demo.median_normal_error_at_samples_degrees <= 2.0, "{demo:?}");
    assert!(demo.ok_share >= 0.99, "{demo:?}");
}

#[test]
fn files_hold_what_the_report_says() {
    let folder = tempfile::tempdir().unwrap();
    // The folder is made, and those above it.
    let inside = folder.path().join("some/demo");
    let scan = ScanPlan { rays: 10_000, ..ScanPlan::default() };
    let report = run_demo(&inside, scan.clone(), DEMO_SUPPORT);
    let demo = found(&report);
    let paths = FILES.map(|name| inside.join(name).display().to_string());
    assert_eq!(report.outputs, paths);
    let [cloud, normals, projected] = [0, 1, 2].map(|i| table(&inside, FILES[i]));
    assert_eq!([cloud.rows(), normals.rows(), projected.rows()], [report.points; 3]);
    assert_eq!(names(&cloud), "x y z station");
    assert_eq!(names(&normals), "x y z station nx ny nz frame_nx frame_ny frame_nz status");
    assert_eq!(
        names(&projected),
        "x y z station nx ny nz distance residual evaluations status error_before error_after"
    );
    let made = footpoint_jobs::scan::scan(&Vessel::new(), &scan);
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let measured: Vec<f64> = made.points.iter().map(|p| p[axis]).collect();
        assert_eq!(numbers(&cloud, name), measured);
        assert_eq!(numbers(&normals, name), measured);
    }
    // The errors stand in the file, and are those of the points in it.
    let vessel = Vessel::new();
    let status = numbers(&projected, "status");
    let [x, y, z, error] = ["x", "y", "z", "error_after"].map(|name| numbers(&projected, name));
    let mut squares = (0.0_f64, 0.0_f64);
    for i in 0..report.points {
        let (distance, _, _) = vessel.distance([x[i], y[i], z[i]]);
        if status[i] == 0.0 {
            assert!((distance - error[i]).abs() < 1e-15, "{i}");
            squares = (squares.0 + distance * distance, squares.1 + 1.0);
        } else {
            assert!(error[i].is_nan(), "{i}");
        }
    }
    let rms = (squares.0 / squares.1).sqrt();
    assert!((rms / demo.rms_after_metres - 1.0).abs() < 1e-12, "{rms}");
    assert!((squares.1 / report.points as f64 - demo.ok_share).abs() < 1e-12);
}

#[test]
fn two_runs_write_the_same_bytes() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let scan = ScanPlan { rays: 4_900, ..ScanPlan::default() };
    run_demo(one.path(), scan.clone(), DEMO_SUPPORT);
    run_demo(two.path(), scan, DEMO_SUPPORT);
    for name in FILES {
        let [a, b] = [&one, &two].map(|folder| std::fs::read(folder.path().join(name)).unwrap());
        assert!(a == b, "{name} differs");
    }
}

#[test]
fn less_noise_gives_less_error() {
    let folder = tempfile::tempdir().unwrap();
    let at = |noise: f64| {
        let scan = ScanPlan { rays: 40_000, noise, ..ScanPlan::default() };
        let demo = found(&run_demo(&folder.path().join(noise.to_string()), scan, DEMO_SUPPORT));
        assert_eq!(demo.noise_metres, noise);
        demo
    };
    let (still, noisy) = (at(0.0), at(8e-4));
    assert!(still.rms_before_metres < 1e-12, "{still:?}");
    // At this density most of the position error comes from the width of the support.
    assert!(still.rms_after_metres < 0.9 * noisy.rms_after_metres, "{still:?} {noisy:?}");
    let errors = [&still, &noisy].map(|demo| demo.median_surface_normal_error_degrees);
    assert!(errors[0] < 0.4 * errors[1], "{errors:?}");
}

#[test]
fn existing_files_and_senseless_plans_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let plan = |rays: u32, noise: f64| DemoPlan {
        folder: folder.path().join("new"),
        scan: ScanPlan { rays, noise, ..ScanPlan::default() },
        picture_width: 16,
    };
    let refused = |plan: &DemoPlan| demo(plan, &Context::default()).unwrap_err();
    for (rays, noise) in [(0, 1e-4), (400, -1e-4), (400, f64::NAN), (400, f64::INFINITY)] {
        assert!(matches!(refused(&plan(rays, noise)), JobError::Plan(_)), "{rays} {noise}");
    }
    assert!(!folder.path().join("new").exists(), "a folder is left behind");

    demo(&plan(400, 0.0), &Context::default()).unwrap();
    let error = refused(&plan(400, 1e-4));
    assert!(error.is_existing_output(), "{error}");
    let before = std::fs::read(folder.path().join("new/scan.ply")).unwrap();
    let replace = Context { overwrite: Overwrite::Replace, ..Context::default() };
    demo(&plan(400, 1e-4), &replace).unwrap();
    assert_ne!(before, std::fs::read(folder.path().join("new/scan.ply")).unwrap());
}
