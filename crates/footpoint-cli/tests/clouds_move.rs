//! A cloud moved exactly by whole cells has the same normals, bit for bit, and its projected points move with it.

mod common;

use common::{Folder, bits, csv_of};
use footpoint::samples::torus;

/// Coordinates are whole multiples of this, so that moves below are exact.
const STEP: f64 = 1.0 / (1 << 20) as f64;

#[test]
fn by_whole_cells() {
    let samples = torus(1.0, 0.4, 3000, 21).with_noise(0.02, 22);
    let points = samples.points.iter().map(|p| p.map(|c| (c / STEP).round() * STEP));
    let points: Vec<[f64; 3]> = points.collect();
    let folder = Folder::new();
    let write = |name: &str, shift: [f64; 3]| {
        let rows = points.iter().zip(&samples.normals).map(|(p, n)| {
            let moved: [f64; 3] = std::array::from_fn(|k| p[k] + shift[k]);
            assert!((0..3).all(|k| moved[k] - shift[k] == p[k]), "the move is exact");
            [moved, *n].concat()
        });
        folder.write(name, csv_of("x,y,z,nx,ny,nz", rows));
    };
    write("here.csv", [0.0; 3]);
    for options in ["--radius 0.25", "--radius 0.1 --weight gaussian --field averaged", "--per-sample 16"] {
        let report = folder.report(&format!("normals here.csv -o n0.csv --force {options} --normal both"));
        let side = report["surface"]["cell_side"].as_f64().unwrap();
        folder.report(&format!("project here.csv -o p0.csv --force {options} --tolerance 1e-9"));
        let (n0, p0) = (folder.csv("n0.csv"), folder.csv("p0.csv"));
        assert!(p0.words("status").iter().filter(|s| **s == "ok").count() > 2900);
        for cells in [[3.0, -5.0, 2.0], [-1e6, 2e6, 123_456.0], [0.0, 5e6, -7.0]] {
            let shift = cells.map(|c| c * side);
            write("there.csv", shift);
            folder.done(&format!("normals there.csv -o n1.csv --force {options} --normal both"));
            let n1 = folder.csv("n1.csv");
            for name in ["surface_normal", "frame_normal"] {
                for axis in ["x", "y", "z"] {
                    let column = format!("{name}_{axis}");
                    let same = bits(&n0.numbers(&column)) == bits(&n1.numbers(&column));
                    assert!(same, "{options} {column} after a move by {shift:?}");
                }
            }
            assert_eq!(n0.words("status"), n1.words("status"));

            folder.done(&format!("project there.csv -o p1.csv --force {options} --tolerance 1e-9"));
            let p1 = folder.csv("p1.csv");
            for name in ["distance", "evaluations", "surface_normal_x", "status"] {
                assert_eq!(p0.words(name), p1.words(name), "{options} {name} after a move by {shift:?}");
            }
            // The result moves exactly; where it stands, before and after, is rounded to a double.
            for (k, axis) in ["x", "y", "z"].iter().enumerate() {
                for (from, to) in p0.numbers(axis).iter().zip(p1.numbers(axis)) {
                    let rounding = f64::EPSILON * from.abs().max(to.abs());
                    let off = ((to - shift[k]) - from).abs();
                    assert!(off <= rounding, "{options} {axis} by {shift:?}: {off:e} above {rounding:e}");
                }
            }
        }
    }
}
