//! `render` draws a picture with no option but its input, every option matters, and what cannot be drawn is refused.

mod common;

use common::{Folder, csv_of, sphere_csv};
use serde_json::Value;

/// A sphere in colours, and a larger one.
fn folder() -> Folder {
    let folder = Folder::new();
    let sphere = footpoint::samples::sphere(1.0, 1500, 7);
    let rows = sphere.points.iter().map(|p| [&p[..], &p.map(|c| 127.0 + 127.0 * c)].concat());
    folder.write("ball.csv", csv_of("x,y,z,red,green,blue", rows));
    let rows = sphere.points.iter().map(|p| p.map(|c| 1.1 * c).to_vec());
    folder.write("large.csv", csv_of("x,y,z", rows));
    folder
}

fn drawn(folder: &Folder, options: &str) -> (Vec<u8>, Value) {
    let report = folder.report(&format!("render ball.csv -o out.png --force --size 48x36 {options}"));
    (folder.bytes("out.png"), report)
}

/// Width, height, bits, and kind of colour of a PNG.
fn header(bytes: &[u8]) -> (u32, u32, u8, u8) {
    let number = |i: usize| u32::from_be_bytes(bytes[i..i + 4].try_into().unwrap());
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    (number(16), number(20), bytes[24], bytes[25])
}

#[test]
fn the_input_is_enough() {
    let folder = Folder::new();
    folder.write("my.scan.csv", sphere_csv(800));
    let ran = folder.done("render my.scan.csv --size 48");
    assert!(ran.stderr.contains("wrote my.scan.png") && ran.stderr.contains("--look-from"), "{}", ran.stderr);
    assert_eq!(header(&folder.bytes("my.scan.png")), (48, 36, 8, 6));
    let again = folder.run("render my.scan.csv --size 48");
    assert!(again.code == 2 && again.stderr.contains("--force"), "{again:?}");
}

#[test]
fn every_option_matters() {
    let folder = folder();
    let (plain, _) = drawn(&folder, "");
    let mut seen = vec![plain];
    for options in [
        "--shading frame",
        "--shading difference",
        "--shading difference --flat",
        "--shading curvature",
        "--shading normal",
        "--shading depth",
        "--shading depth --range 3,5",
        "--shading colour",
        "--to large.csv",
        "--attribute x",
        "--samples 1",
        "--samples 9",
        "--background black",
        "--background #123456",
        "--background transparent",
        "--view front",
        "--view back",
        "--view left",
        "--view right",
        "--view top",
        "--view bottom",
        "--look-from 3,1,1",
        "--look-from 3,1,1 --look-at 0,0,0.5",
        "--look-up 1,0.2,0",
        "--up x",
        "--up -y",
        "--camera orthographic",
        "--camera orthographic --view-height 4",
        "--fov 60",
        "--auto 60",
    ] {
        let (bytes, report) = drawn(&folder, options);
        assert!(!seen.contains(&bytes), "{options}: the same picture as before");
        assert!(report["render"]["hits"].as_u64().unwrap() > 300, "{options}");
        seen.push(bytes);
    }
    assert_eq!(drawn(&folder, "--view auto --shading surface --samples 4 --background white").0, seen[0]);
    let (_, report) = drawn(&folder, "--to large.csv");
    let range = &report["render"]["range"];
    assert!((range[1].as_f64().unwrap() - 0.1).abs() < 0.03, "{range}");
}

#[test]
fn occlusion_darkens_what_is_hollow() {
    let folder = Folder::new();
    let ring = footpoint::samples::torus(1.0, 0.4, 2000, 7);
    folder.write("ring.csv", csv_of("x,y,z", ring.points.iter().map(|p| p.to_vec())));
    let drawn = |options: &str| {
        folder.report(&format!("render ring.csv -o out.png --force --size 48x36 {options}"));
        folder.bytes("out.png")
    };
    let [none, default, few, sixteen] = ["", "--occlusion", "--occlusion 4", "--occlusion 16"].map(drawn);
    assert!(none != default && default != few && default == sixteen);
}

#[test]
fn the_camera_of_a_report_draws_the_same_picture() {
    let folder = folder();
    let (bytes, report) = drawn(&folder, "--look-up 0,1,0");
    let camera = &report["render"]["camera"];
    let vector = |name: &str| {
        let numbers: Vec<String> = camera[name].as_array().unwrap().iter().map(Value::to_string).collect();
        numbers.join(",")
    };
    let fov = &camera["projection"]["perspective"]["fov_degrees"];
    let (from, at, up) = (vector("from"), vector("at"), vector("up"));
    let again = format!("--look-from {from} --look-at {at} --look-up {up} --fov {fov}");
    assert_eq!(drawn(&folder, &again).0, bytes);
}

#[test]
fn a_report_says_what_is_up_and_an_option_says_otherwise() {
    let folder = Folder::new();
    let hollow = (0..900).map(|i| (f64::from(i % 30) / 15.0 - 1.0, f64::from(i / 30) / 15.0 - 1.0));
    folder.write("land.csv", csv_of("x,y,z", hollow.map(|(x, y)| vec![x, y, 0.2 * (x * x + y * y)])));
    let drawn = |options: &str| {
        let words = format!("render land.csv -o out.png --force --samples 1 {options}");
        let said = folder.done(&words).stderr;
        let report = folder.report(&words);
        let camera = &report["render"]["camera"];
        let back: Vec<f64> =
            (0..3).map(|k| camera["from"][k].as_f64().unwrap() - camera["at"][k].as_f64().unwrap()).collect();
        (said, report["render"].clone(), back)
    };
    let (said, report, back) = drawn("--size 64x48");
    assert!(said.contains("up: z, the cloud is flat"), "{said}");
    assert_eq!(report["up"]["why"], "flat");
    assert!(back[2] > 0.0 && back[1] < 0.0 && back[0].abs() < 1e-9 * back[2], "{back:?}");
    let (same, numbers) = (&report["camera"], &drawn("--size 64x48 --flat --attribute z").1);
    // The strip of the scale bar takes rows, nothing else of the view.
    assert_eq!((&numbers["up"], &numbers["camera"]["up"]), (&report["up"], &same["up"]));
    let (said, report, _) = drawn("--size 64x48 --view front --up y");
    assert!(said.contains("up: y, as asked for"), "{said}");
    assert_eq!(report["up"]["axis"], serde_json::json!([0.0, 1.0, 0.0]));
    assert!(drawn("--size 64x48 --view front").2[1] < 0.0);
    // Without a size: wider than high from the front, and as many pixels as ever.
    let report = drawn("--view front").1;
    let [width, height] = ["width", "height"].map(|side| report[side].as_f64().unwrap());
    assert!((width / height - 2.5).abs() < 0.01 && (width * height / 1.92e6 - 1.0).abs() < 0.01);
}

#[test]
fn depth_normals_and_mask_are_pictures_too() {
    let folder = folder();
    let (_, report) = drawn(&folder, "--depth depth.png --normals normals.png --mask mask.png");
    assert_eq!(report["outputs"].as_array().unwrap().len(), 4);
    for (name, kind) in
        [("depth.png", (48, 36, 16, 0)), ("normals.png", (48, 36, 16, 2)), ("mask.png", (48, 36, 8, 0))]
    {
        assert_eq!(header(&folder.bytes(name)), kind, "{name}");
    }
    let depths = report["render"]["depth_range"].as_array().unwrap();
    assert!(depths[0].as_f64().unwrap() < depths[1].as_f64().unwrap());
}

#[test]
fn what_cannot_be_drawn_is_refused_and_nothing_is_written() {
    let folder = folder();
    folder.write("curve.csv", "x,y\n0,0\n1,0\n2,1\n");
    let before = folder.listing();
    for (words, expected) in [
        ("render curve.csv -o a.png", "footpoint figure"),
        ("render ball.csv -o a.jpg", ".png"),
        ("render ball.csv -o a.png --size 16 --look-from 9,9,9 --look-at 20,20,20", "no ray met the surface"),
        ("render ball.csv -o a.png --size 16 --look-from 1,1,1 --look-at 1,1,1", "looks from"),
        ("render ball.csv -o a.png --fov 180", "degrees"),
        ("render ball.csv -o a.png --size 0x3", "pixels"),
        ("render ball.csv -o a.png --samples 5", "square"),
        ("render ball.csv -o a.png --background reddish", "transparent"),
        ("render ball.csv -o a.png --attribute heat", "heat"),
        ("render large.csv -o a.png --shading colour", "red"),
        ("render ball.csv -o a.png --shading distance", "--to"),
        ("render ball.csv -o a.png --shading attribute", "--attribute"),
        ("render ball.csv -o a.png --shading surface --to large.csv", "--to belongs"),
        ("render ball.csv -o a.png --up w", "x, y or z"),
        ("render ball.csv -o a.png --view-height 3", "orthographic"),
        ("render ball.csv -o a.png --shading depth --range 3,1", "below"),
        ("render ball.csv -o a.png --depth nowhere/d.png", "nowhere"),
        ("render ball.csv -o a.png --depth a.png", "two pictures"),
    ] {
        let ran = folder.run(words);
        assert!(ran.code == 2 && ran.stderr.contains(expected), "{words}: {ran:?}");
        assert_eq!(folder.listing(), before, "{words}");
    }
}
