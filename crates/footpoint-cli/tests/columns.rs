//! Columns have the names that suit the format, the input's own columns stay, and a result is again an input.

mod common;

use common::{Folder, bits, csv_of, numbers_of};
use footpoint::samples::sphere;
use footpoint_io::Data;

/// A sphere with normals that are not the surface's, a colour and a lonely sample of unknown label.
fn folder() -> Folder {
    let folder = Folder::new();
    let s = sphere(1.0, 400, 2);
    let row = |i: usize| {
        let n = s.normals[i];
        [&s.points[i][..], &[n[1], n[2], n[0]], &[(i % 256) as f64]].concat()
    };
    let lonely = vec![9.0, 0.0, 0.0, 0.0, 0.0, 1.0, 7.0];
    folder.write("cloud.csv", csv_of("x,y,z,nx,ny,nz,red", (0..400).map(row).chain([lonely])));
    // The same as PLY with small types, by way of the command itself.
    let mut table = folder.table("cloud.csv");
    for column in &mut table.columns {
        let values = column.data.to_f64().unwrap();
        column.data = match column.name.as_str() {
            "red" => Data::U8(values.iter().map(|v| *v as u8).collect()),
            _ => Data::F32(values.iter().map(|v| *v as f32).collect()),
        };
    }
    footpoint_io::write(&folder.path("cloud.ply"), &table, &footpoint_io::WriteOptions::default()).unwrap();
    folder
}

fn names(folder: &Folder, file: &str) -> String {
    let table = folder.table(file);
    table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(" ")
}

#[test]
fn ply_has_the_names_that_viewers_know() {
    let folder = folder();
    folder.done("normals cloud.ply -o n.ply --normal both");
    assert_eq!(
        names(&folder, "n.ply"),
        "x y z given_nx given_ny given_nz red nx ny nz frame_nx frame_ny frame_nz status"
    );
    let (before, after) = (folder.table("cloud.ply"), folder.table("n.ply"));
    for (from, to) in [("x", "x"), ("nx", "given_nx"), ("nz", "given_nz"), ("red", "red")] {
        let (old, new) = (before.column(from).unwrap(), after.column(to).unwrap());
        assert_eq!(old.data, new.data, "{from}: same type, same values");
    }
    let Data::U8(status) = &after.column("status").unwrap().data else { panic!("status is no byte") };
    assert_eq!((status.len(), status[0], status[400]), (401, 0, 2));
    assert!(numbers_of(&after, "nx")[400].is_nan(), "no normal is nan");

    folder.done("project cloud.ply -o p.ply");
    assert_eq!(
        names(&folder, "p.ply"),
        "x y z given_nx given_ny given_nz red nx ny nz distance residual evaluations status"
    );
    let moved = folder.table("p.ply");
    assert!(matches!(moved.column("x").unwrap().data, Data::F64(_)), "projected points are doubles");
    assert_eq!(numbers_of(&moved, "x")[400], 9.0, "a point without an answer stays");
    folder.done("normals cloud.ply -o f.ply --normal frame");
    assert_eq!(names(&folder, "f.ply"), "x y z nx ny nz red frame_nx frame_ny frame_nz status");
}

#[test]
fn text_has_names_that_explain_themselves() {
    let folder = folder();
    folder.done("normals cloud.csv -o n.csv --normal both");
    let csv = folder.csv("n.csv");
    assert_eq!(
        csv.names.join(" "),
        "x y z nx ny nz red surface_normal_x surface_normal_y surface_normal_z \
         frame_normal_x frame_normal_y frame_normal_z status"
    );
    assert_eq!((csv.words("status")[0], csv.words("status")[400]), ("ok", "degenerate"));
    assert_eq!(csv.words("surface_normal_x")[400], "nan");
    let input = folder.csv("cloud.csv");
    for name in &input.names {
        assert_eq!(input.words(name), csv.words(name), "{name}");
    }
    folder.done("evaluate cloud.csv --at cloud.csv -o e.csv");
    assert_eq!(
        folder.csv("e.csv").names.join(" "),
        "x y z value average_x average_y average_z frame_normal_x frame_normal_y frame_normal_z \
         gradient_x gradient_y gradient_z surface_normal_x surface_normal_y surface_normal_z \
         gap neighbours effective_neighbours status nx ny nz red"
    );
    // The header is kept by every kind of text that has one.
    for kind in ["txt", "xyz", "pwn"] {
        folder.done(&format!("normals cloud.csv -o n.{kind}"));
        let header = "x y z nx ny nz red surface_normal_x surface_normal_y surface_normal_z status";
        assert_eq!(names(&folder, &format!("n.{kind}")), header, "{kind}");
    }
}

#[test]
fn a_result_can_go_through_again() {
    let folder = folder();
    for kind in ["ply", "csv"] {
        let (once, twice) = (format!("once.{kind}"), format!("twice.{kind}"));
        folder.done(&format!("normals cloud.{kind} -o {once} --field covariance"));
        folder.done(&format!("normals {once} -o {twice} --field covariance"));
        // What an earlier job computed is kept once, however often a result goes through again.
        let expected = if kind == "ply" {
            "x y z given_nx given_ny given_nz red nx ny nz given_status status"
        } else {
            "x y z nx ny nz red given_surface_normal_x given_surface_normal_y given_surface_normal_z \
             surface_normal_x surface_normal_y surface_normal_z status"
        };
        assert_eq!(names(&folder, &twice), expected);
        folder.done(&format!("normals {twice} -o thrice.{kind} --field covariance"));
        assert_eq!(names(&folder, &format!("thrice.{kind}")), expected);
        let (first, second) = (folder.table(&once), folder.table(&twice));
        let given = if kind == "ply" { "given_nx" } else { "nx" };
        assert_eq!(numbers_of(&first, given), numbers_of(&second, given), "the first normals are kept");
        let normal = if kind == "ply" { "nx" } else { "surface_normal_x" };
        let sizes = |values: Vec<f64>| bits(&values.iter().map(|v| v.abs()).collect::<Vec<_>>());
        let same = sizes(numbers_of(&first, normal)) == sizes(numbers_of(&second, normal));
        assert!(same, "{kind}: the sign aside, the field does not depend on normals");
        folder.done(&format!("project {twice} -o feet.{kind}"));
        folder.done(&format!("normals feet.{kind} -o again.{kind}"));
        let again = folder.table(&format!("again.{kind}"));
        assert_eq!(again.rows(), 401);
        assert!(again.column("distance").is_some(), "columns of earlier jobs are kept");
    }
}

#[test]
fn the_formats_can_be_mixed() {
    let folder = folder();
    folder.done("normals cloud.ply -o from_ply.csv");
    folder.done("normals from_ply.csv -o back.ply --radius 0.5");
    let (direct, back) = (folder.table("cloud.ply"), folder.table("back.ply"));
    for name in ["x", "y", "z", "red"] {
        assert_eq!(bits(&numbers_of(&direct, name)), bits(&numbers_of(&back, name)), "{name}");
    }
}

#[test]
fn columns_of_the_input_with_the_names_of_results_are_kept() {
    let folder = folder();
    let rows = (0..200).map(|i| {
        let angle = f64::from(i) * 0.0314;
        format!("{} {} {i} {} 7\n", angle.cos(), angle.sin(), 1000 + i)
    });
    let text = format!("x y status distance residual\n{}", rows.collect::<String>());
    std::fs::write(folder.path("own.txt"), text).unwrap();
    for (verb, output) in [("project", "own.ply"), ("project", "own.csv"), ("normals", "normals.csv")] {
        folder.done(&format!("{verb} own.txt -o {output}"));
        let table = folder.table(output);
        let statuses: Vec<f64> = (0..200).map(f64::from).collect();
        assert_eq!(numbers_of(&table, "given_status"), statuses, "{output}");
        let distance = if verb == "project" { "given_distance" } else { "distance" };
        assert_eq!(numbers_of(&table, distance)[3], 1003.0, "{output}");
    }
}

#[test]
fn dropped_columns_are_as_if_they_had_not_been_there() {
    let folder = Folder::new();
    let sphere = sphere(1.0, 500, 1);
    let mut text = String::from("x y z nx ny nz weight\n");
    for ([x, y, z], [a, b, c]) in sphere.points.iter().zip(&sphere.normals) {
        text += &format!("{x} {y} {z} {a} {b} {c} 2\n");
    }
    folder.write("sphere.xyz", &text);
    let kept = folder.report("normals sphere.xyz -o kept.xyz");
    assert!(kept["inputs"][0]["normals"] == true && kept.get("drop").is_none());
    let report = folder.report("normals sphere.xyz --drop normals,weight,none -o dropped.xyz");
    assert_eq!(report["inputs"][0]["normals"], false);
    assert_eq!(report["drop"], serde_json::json!(["normals", "weight", "none"]));
    let notes = report["inputs"][0]["notes"].to_string();
    assert!(notes.contains("nothing named `none` to drop") && !notes.contains("`weight`"), "{notes}");
    let header = |name: &str| folder.text(name).lines().next().unwrap().to_owned();
    assert!(header("kept.xyz").contains("weight") && header("kept.xyz").contains("nx"));
    assert!(!header("dropped.xyz").contains("weight") && !header("dropped.xyz").contains("nx"));
    let refused = folder.run("normals sphere.xyz --drop z,y -o none.xyz");
    assert_eq!(refused.code, 2, "no points are left");
}
