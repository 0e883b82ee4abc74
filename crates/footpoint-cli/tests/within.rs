//! `--within` reads a part of a file, and a report replays it.

mod common;

use common::{Folder, numbers_of, shared, sphere_csv};

#[test]
fn only_the_points_inside_are_read() {
    let folder = Folder::new();
    folder.write("cloud.csv", sphere_csv(2000));
    let all = folder.csv("cloud.csv").points::<3>();
    let inside = all.iter().filter(|p| (0..3).all(|k| p[k] >= 0.0 && p[k] <= 1.0)).count();
    assert!(inside > 100 && inside < 1000);
    let report = folder.report("normals cloud.csv -o n.csv --within 0,0,0,1,1,1");
    assert_eq!(report["points"], inside);
    assert_eq!(folder.csv("n.csv").len(), inside);
    folder.write("report.json", report.to_string());
    let again = folder.report("normals cloud.csv -o again.csv --definition report.json");
    assert_eq!(again["points"], inside);
    let wider = folder.report("normals cloud.csv -o w.csv --definition report.json --within=-2,-2,-2,2,2,2");
    assert_eq!(wider["points"], 2000);
    for wrong in ["1,1,1,0,0,0", "0,0,1,1", "0,0,0,1,1,nan", "a"] {
        assert_eq!(folder.run(&format!("info cloud.csv --within {wrong}")).code, 2, "{wrong}");
    }
}

#[test]
fn a_part_of_a_survey_in_copc() {
    let Some(data) = shared("data/copc") else { return };
    let folder = Folder::new();
    let name = folder.copy(&data.join("lone-star.copc.laz"));
    let part = folder.report(&format!("info {name} --within 515380,4918350,2300,515385,4918355,2400"));
    let table = folder.table(&name);
    let (low, high) = ([515_380.0, 4_918_350.0, 2300.0], [515_385.0, 4_918_355.0, 2400.0]);
    let axes = ["x", "y", "z"].map(|name| numbers_of(&table, name));
    let is_inside = |i: &usize| (0..3).all(|k| (low[k]..=high[k]).contains(&axes[k][*i]));
    let inside = (0..table.rows()).filter(is_inside).count();
    assert!(inside > 100, "{inside}");
    assert_eq!(part["inputs"][0]["points"], inside);
    assert_eq!(part["inputs"][0]["missing_points"], 0, "what is outside is not missing");
}

#[test]
fn points_without_coordinates_can_be_left_out() {
    let folder = Folder::new();
    let whole = sphere_csv(300);
    folder.write("cloud.csv", &whole);
    folder.write("holes.csv", format!("{}\n", whole.trim_end()) + "nan,0,0,0,0,1\n0,inf,0,0,0,1\n");
    let refused = folder.run("normals holes.csv -o n.laz");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("leave the point out (--within finite does)"), "{refused:?}");
    let left = folder.report("normals holes.csv -o n.laz --within finite");
    assert_eq!((left["points"].as_u64(), left["inputs"][0]["not_finite"].as_u64()), (Some(300), Some(0)));
    folder.done("normals cloud.csv -o whole.laz");
    assert_eq!(folder.table("n.laz").columns, folder.table("whole.laz").columns);
}
