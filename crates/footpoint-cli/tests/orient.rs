//! `orient` writes normals whose signs agree, under the names that later commands take for given normals.

mod common;

use common::{Folder, csv_of, numbers_of};
use footpoint::samples::{Samples, moebius, torus};

fn folder() -> (Folder, Samples<3>) {
    let folder = Folder::new();
    let shape = torus(1.0, 0.4, 4000, 1);
    let row = |i: usize| {
        let (p, n) = (shape.points[i], shape.normals[i]);
        // A sensor outside, at a time that tells where it was: it goes once around the tube of each sample.
        let sensor: [f64; 3] = std::array::from_fn(|k| p[k] + 0.2 * n[k]);
        let turned = if i.is_multiple_of(3) { n.map(|c| -c) } else { n };
        [&p[..], &turned, &sensor, &[i as f64]].concat()
    };
    let rows: Vec<_> = (0..shape.points.len()).map(row).collect();
    let track = rows.iter().map(|row| [&row[6..9], &row[9..]].concat());
    folder.write("track.csv", csv_of("x,y,z,clock", track));
    folder.write("cloud.csv", csv_of("x,y,z,nx,ny,nz,sx,sy,sz,clock", rows.into_iter()));
    folder.write("bare.csv", csv_of("x,y,z", shape.points.iter().map(|p| p.to_vec())));
    (folder, shape)
}

fn wrong(folder: &Folder, file: &str, truth: &[[f64; 3]]) -> usize {
    let table = folder.table(file);
    let n = ["nx", "ny", "nz"].map(|name| numbers_of(&table, name));
    let outward = |i: usize| (0..3).map(|k| n[k][i] * truth[i][k]).sum::<f64>() > 0.0;
    (0..truth.len()).filter(|&i| !outward(i)).count()
}

#[test]
fn every_rule_finds_the_outside() {
    let (folder, shape) = folder();
    for rule in
        ["", "--normal given", "--sensor-columns sx,sy,sz", "--trajectory track.csv --time-column clock"]
    {
        for output in ["o.csv", "o.ply"] {
            let report = folder.report(&format!("orient cloud.csv -o {output} --force {rule}"));
            assert_eq!(wrong(&folder, output, &shape.normals), 0, "{rule}");
            let found = &report["orientation"];
            assert_eq!((&report["job"], &found["oriented"]), (&"orient".into(), &4000.into()), "{rule}");
            assert!(found["reversed"].as_u64().unwrap() > 0 && found["non_orientable"] == 0, "{rule}");
            let propagated = !rule.contains("columns") && !rule.contains("trajectory");
            assert_eq!(found["components"], u64::from(propagated), "{rule}");
            assert_eq!(report["inputs"].as_array().unwrap().len(), 1 + usize::from(rule.contains("track")));
        }
    }
    // The given normals are kept under another name, and the rest is as it was.
    let names: Vec<String> = folder.table("o.csv").columns.into_iter().map(|c| c.name).collect();
    assert_eq!(names.join(" "), "x y z given_nx given_ny given_nz sx sy sz clock nx ny nz status");
    for (rule, side) in [("--towards 0,0,-9", -1.0), ("--along 0,0,2", 1.0), ("--along -0,-0,-1", -1.0)] {
        folder.done(&format!("orient bare.csv -o side.csv --force {rule}"));
        let z = numbers_of(&folder.table("side.csv"), "nz");
        let up = z.iter().filter(|&&z| z * side > 0.0).count();
        assert!(if rule.contains("along") { up == 4000 } else { up > 3700 }, "{rule}: {up}");
    }
}

#[test]
fn oriented_samples_give_averaged_normals_and_signed_distances() {
    let (folder, _) = folder();
    folder.write("queries.csv", "x,y,z\n1.45,0,0\n1.35,0,0\n0,1.45,0\n0,-1.35,0\n");
    for output in ["o.csv", "o.ply"] {
        folder.done(&format!("orient bare.csv -o {output}"));
        for field in ["averaged", "centred"] {
            let report = folder
                .report(&format!("project queries.csv --onto {output} -o feet.csv --field {field} --force"));
            assert_eq!(report["surface"]["sign"], "given");
            let distance = numbers_of(&folder.table("feet.csv"), "distance");
            for (found, expected) in distance.iter().zip([0.05, -0.05, 0.05, -0.05]) {
                assert!((found - expected).abs() < 0.02, "{output} {field}: {distance:?}");
            }
        }
    }
    // A second time nothing is left to reverse, whatever the format.
    let report = folder.report("orient o.csv -o again.csv --normal given");
    assert_eq!(report["orientation"]["reversed"], 0);
    // Given normals are rescaled to unit length on the way, which may change their last bits.
    let normal = |file: &str| numbers_of(&folder.table(file), "ny");
    for (again, first) in normal("again.csv").into_iter().zip(normal("o.csv")) {
        assert!((again - first).abs() < 1e-15, "{again} {first}");
    }
}

#[test]
fn a_moebius_strip_is_left_alone_unless_forced() {
    let folder = Folder::new();
    let strip = moebius(1.0, 0.35, 8000, 1);
    folder.write("strip.csv", csv_of("x,y,z", strip.points.iter().map(|p| p.to_vec())));
    let left = folder.report("orient strip.csv -o left.csv");
    assert_eq!(
        (&left["orientation"]["oriented"], &left["orientation"]["non_orientable"]),
        (&0.into(), &1.into())
    );
    assert_eq!(left["orientation"]["largest"][0]["verdict"], "non_orientable");
    assert!(numbers_of(&folder.table("left.csv"), "nx").iter().all(|c| c.is_nan()));
    let said = folder.done("orient strip.csv -o said.csv").stderr;
    assert!(said.contains("1 not orientable") && said.contains("--force-orientation"), "{said}");
    assert!(!said.contains("poorly determined"), "the frames are not to blame: {said}");
    let forced = folder.report("orient strip.csv -o forced.csv --force-orientation");
    assert_eq!(forced["orientation"]["oriented"], 8000);
    assert!(numbers_of(&folder.table("forced.csv"), "nx").iter().all(|c| !c.is_nan()));
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let (folder, _) = folder();
    for (words, expected) in [
        ("cloud.csv --towards 1,2", "the viewpoint: 2 given, but the points have 3 coordinates"),
        ("cloud.csv --along 0,0,0", "the axis must be finite, and an axis not zero"),
        ("cloud.csv --sensor-columns sx,sy", "the sensor's columns: 2 given"),
        ("cloud.csv --sensor-columns sx,sy,sw", "no column of numbers named `sw`"),
        ("cloud.csv --trajectory track.csv", "no column of numbers named `time`"),
        ("bare.csv --normal given", "the cloud has no normals to orient"),
        ("cloud.csv --towards 1,2,3 --along 0,0,1", "cannot be used with"),
        ("cloud.csv --towards 1,2,3 --force-orientation", "cannot be used with"),
    ] {
        let ran = folder.run(&format!("orient {words} -o o.csv"));
        assert!(ran.code == 2 && ran.stderr.contains(expected), "{words}: {ran:?}");
    }
    assert!(!folder.path("o.csv").exists());
}
