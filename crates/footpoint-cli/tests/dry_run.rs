//! `--dry-run` reads, checks and tells, and neither computes nor writes.

mod common;

use common::{Folder, sphere_csv};

#[test]
fn nothing_is_written_and_the_plan_is_told() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(200));
    let before = folder.listing();
    for (words, writes) in [
        ("info cloud.csv", &[][..]),
        ("normals cloud.csv -o n.ply --weight poly4", &["n.ply"]),
        ("orient cloud.csv -o o.ply", &["o.ply"]),
        ("project cloud.csv -o p.ply --onto cloud.csv", &["p.ply"]),
        ("distance cloud.csv --to cloud.csv -o d.ply", &["d.ply"]),
        ("evaluate cloud.csv --at cloud.csv -o e.ply", &["e.ply"]),
        ("render cloud.csv --mask m.png", &["cloud.png", "m.png"]),
        ("figure 3 cloud.csv -o figures", &["figures/figure-3.png"]),
        ("figure 1 -o figures", &["figures/figure-1.svg"]),
        ("demo -o shown --picture-width 0", &["shown/scan.ply", "shown/normals.ply", "shown/projected.ply"]),
    ] {
        let report = folder.report(&format!("{words} --dry-run"));
        assert_eq!(report["dry_run"], true, "{words}");
        let outputs: Vec<&str> =
            report["outputs"].as_array().unwrap().iter().map(|o| o.as_str().unwrap()).collect();
        assert_eq!(outputs, writes, "{words}");
        assert!(report["surface"].is_null() && report["statuses"].as_array().unwrap().is_empty(), "{words}");
        let ran = folder.run(&format!("{words} --dry-run"));
        assert!(ran.stdout.contains("dry run: nothing was computed or written"), "{ran:?}");
    }
    assert_eq!(folder.listing(), before);
    assert!(
        folder.run("normals cloud.csv -o n.ply --weight poly4 --dry-run").stdout.contains("weight poly4")
    );
    assert!(folder.report("info cloud.csv").get("dry_run").is_none(), "only where it is one");
}

#[test]
fn problems_show_as_they_would() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(50));
    folder.write("plane.csv", "x,y\n0,0\n1,0\n0,1\n1,1\n");
    folder.write("named.csv", "x,y,z,name\n0,0,0,a\n1,0,0,b\n");
    for words in [
        "normals missing.csv -o n.ply",
        "normals cloud.csv -o cloud.csv",
        "normals cloud.csv -o nowhere/deep/n.docx",
        "normals cloud.csv -o n.ply --support-column r",
        "project cloud.csv --onto missing.csv -o p.ply",
        "project cloud.csv --onto plane.csv -o p.ply",
        "project cloud.csv -o p.obj",
        "project named.csv -o p.ply",
        "project cloud.csv --onto cloud.csv -o p.ply --noise 0.1 --query-noise nowhere",
        "distance cloud.csv --to cloud.csv -o p.obj",
        "distance cloud.csv --to cloud.csv -o p.ply --compare points --registration 1",
        "distance cloud.csv --to cloud.csv -o p.ply --noise 1",
        "evaluate cloud.csv --at cloud.csv -o e.obj",
        "evaluate cloud.csv --at cloud.csv -o e.ply --with sigma",
        "orient cloud.csv -o o.ply --towards 1,2",
        "orient cloud.csv -o o.ply --sensor-columns a,b,c",
        "render cloud.csv -o cloud.jpeg",
        "render cloud.csv -o cloud.png --mask cloud.png",
        "render plane.csv",
        "render cloud.csv --attribute nothing",
        "figure 3 plane.csv -o figures",
        "figure 1 cloud.csv -o figures",
    ] {
        let (dry, real) = (folder.run(&format!("{words} --dry-run")), folder.run(words));
        assert_eq!(dry.code, 2, "{words}: {dry:?}");
        assert_eq!(dry.stderr, real.stderr, "{words}");
        assert!(!dry.stderr.contains("--help"), "a mistyped case: {dry:?}");
    }
}
