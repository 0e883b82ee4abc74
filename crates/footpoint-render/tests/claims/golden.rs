//! Pictures stay what they are: at most 1 % of the pixels differ by more than 12 levels, and all by 1 level in the mean.
//!
//! `FOOTPOINT_WRITE_GOLDEN=1` writes them anew.

use crate::shapes::{plan, viewed};
use footpoint::samples::torus;
use footpoint::{Cloud, Definition, Run, Surface};
use footpoint_render::{Image, Occlusion, Plan, Shading, View, Wish, render, triptych, write_image};
use png::Decoder;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::PathBuf;

fn ring() -> Surface<3> {
    let samples = torus(1.0, 0.4, 4_000, 3);
    let cloud = Cloud::new(samples.points).with_normals(samples.normals).unwrap();
    Surface::new(cloud, Definition::default()).unwrap()
}

fn read(path: &PathBuf) -> Vec<u8> {
    let file = File::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut reader = Decoder::new(BufReader::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    bytes
}

#[track_caller]
fn compare(name: &str, image: &Image) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"));
    if std::env::var_os("FOOTPOINT_WRITE_GOLDEN").is_some() {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        write_image(image, File::create(&path).unwrap()).unwrap();
    }
    let golden = read(&path);
    let pixels = image.pixels();
    assert_eq!(golden.len(), 4 * pixels.len(), "{name}: another size");
    let off = |i: usize| (0..4).map(|k| u32::from(golden[4 * i + k].abs_diff(pixels[i][k]))).max().unwrap();
    let (mut sum, mut far) = (0, 0);
    for i in 0..pixels.len() {
        sum += off(i);
        far += usize::from(off(i) > 12);
    }
    let mean = f64::from(sum) / pixels.len() as f64;
    assert!(
        mean <= 1.0 && far * 100 <= pixels.len(),
        "{name}: {mean:.3} levels in the mean, {far} pixels off"
    );
}

#[test]
fn every_shading() {
    let surface = ring();
    let heights: Vec<f64> = surface.cloud().points().iter().map(|p| p[2]).collect();
    let colours: Vec<[f64; 3]> = surface.cloud().points().iter().map(|p| p.map(|c| 0.5 + 0.3 * c)).collect();
    let other = {
        let moved: Vec<[f64; 3]> = surface.cloud().points().iter().map(|p| p.map(|c| 1.02 * c)).collect();
        Surface::new(Cloud::new(moved), Definition::default()).unwrap()
    };
    for (name, shading) in [
        ("surface", Shading::Surface),
        ("frame", Shading::Frame),
        ("difference", Shading::Difference),
        ("curvature", Shading::Curvature),
        ("distance", Shading::Distance(&other)),
        ("attribute", Shading::Attribute(&heights)),
        ("colour", Shading::Colour(&colours)),
        ("normal", Shading::Normal),
        ("depth", Shading::Depth),
    ] {
        let plan = Plan {
            size: [96, 72],
            across: 2,
            camera: viewed(&surface, View::Iso),
            title: name.into(),
            ..plan(shading)
        };
        compare(name, &render(&surface, &plan, &Run::new()).unwrap().image);
    }
}

#[test]
fn occlusion_and_triptych() {
    let surface = ring();
    let plan = Plan {
        size: [96, 72],
        across: 2,
        camera: viewed(&surface, View::Iso),
        occlusion: Some(Occlusion { rays: 16, reach: 0.8 }),
        ..plan(Shading::Surface)
    };
    compare("occlusion", &render(&surface, &plan, &Run::new()).unwrap().image);
    let three = triptych(&surface, &Wish::default(), ([64, 64], 2), &Run::new()).unwrap();
    assert_eq!(three.image.width(), 3 * 64);
    compare("triptych", &three.image);
}
