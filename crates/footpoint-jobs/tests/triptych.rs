//! The triptych shows three pictures of one scan from one camera, and refuses what is no scan.

use footpoint_jobs::{Context, JobError, triptych};

#[test]
fn a_scan_gives_three_pictures_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    let (cloud, output) = (folder.path().join("ball.csv"), folder.path().join("figure-3.png"));
    let rows: Vec<String> = footpoint::samples::sphere(1.0, 1500, 7)
        .points
        .iter()
        .map(|p| format!("{},{},{}\n", p[0], p[1], p[2]))
        .collect();
    std::fs::write(&cloud, format!("x,y,z\n{}", rows.concat())).unwrap();
    let report = triptych(Some(&cloud), &output, 150, &Context::default()).unwrap();
    let render = report.render.unwrap();
    assert_eq!((render.width, render.shading, render.rays), (150, "triptych", 3 * 50 * 50 * 4));
    let [low, high] = render.range.unwrap();
    assert!(low < high && high == 1.0);
    assert_eq!(&std::fs::read(&output).unwrap()[1..4], b"PNG");
    let error = triptych(Some(&cloud), &output, 150, &Context::default()).unwrap_err();
    assert!(error.is_existing_output(), "{error}");

    let curve = folder.path().join("curve.csv");
    std::fs::write(&curve, "x,y\n0,0\n1,0\n2,1\n").unwrap();
    let error = triptych(Some(&curve), &folder.path().join("b.png"), 150, &Context::default()).unwrap_err();
    assert!(matches!(error, JobError::OnlyPlane(_)), "{error}");
}
