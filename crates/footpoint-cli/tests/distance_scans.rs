//! One scan of the Stanford bunny lies a tenth of a millimetre from the surface of another.

mod common;

use common::{Folder, csv_of, numbers_of, shared};
use std::path::Path;

/// The rotation R(q)ᵀ and translation of a scan in `bun.conf`: `bmesh FILE tx ty tz qx qy qz qw`.
fn pose(range: &Path, file: &str) -> ([[f64; 3]; 3], [f64; 3]) {
    let text = std::fs::read_to_string(range.join("bun.conf")).unwrap();
    let line = text.lines().find(|line| line.split_whitespace().nth(1) == Some(file)).unwrap();
    let n: Vec<f64> = line.split_whitespace().skip(2).map(|word| word.parse().unwrap()).collect();
    let (x, y, z, w) = (n[3], n[4], n[5], n[6]);
    let transposed = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
        [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
        [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    (transposed, [n[0], n[1], n[2]])
}

/// A scan in the common frame, in metres.
fn place(folder: &Folder, range: &Path, file: &str, name: &str) {
    let table = footpoint_io::read(&range.join(file)).unwrap().table;
    let axes = ["x", "y", "z"].map(|axis| numbers_of(&table, axis));
    let (rotation, shift) = pose(range, file);
    let rows = (0..table.rows()).map(|i| {
        (0..3).map(|k| (0..3).map(|c| rotation[k][c] * axes[c][i]).sum::<f64>() + shift[k]).collect()
    });
    folder.write(name, csv_of("x,y,z", rows));
}

#[test]
fn bun045_to_bun000() {
    let Some(range) = shared("data/range") else { return };
    let folder = Folder::new();
    place(&folder, &range, "bun000.ply", "000.csv");
    place(&folder, &range, "bun045.ply", "045.csv");
    let report = folder.report(
        "distance 045.csv --to 000.csv --compare points -o d.csv --radius 0.0016 --field centred --weight poly3 --noise auto",
    );
    let found = &report["distance"];
    let median = found["median"].as_f64().unwrap();
    println!("median {median}, {found}");
    assert_eq!((found["signed"].as_bool(), report["points"].as_u64()), (Some(false), Some(40_097)));
    assert!((0.07e-3..0.10e-3).contains(&median), "{median}");
    // They overlap by some nine tenths, and where they do not, the surface ends.
    let answered = found["answered"].as_u64().unwrap();
    assert!((34_000..38_000).contains(&answered), "{answered}");
    let statuses = report["statuses"].as_array().unwrap();
    let boundary = statuses.iter().find(|count| count["status"] == "boundary").unwrap();
    let rest = 40_097 - answered;
    assert!(boundary["points"].as_u64().unwrap() * 100 > rest * 99, "{statuses:?}");
    // The registration of these two is what the noise does not explain.
    assert!(found["share_beyond_two_sigma"].as_f64().unwrap() > 0.5);
    let registered = folder
        .report("distance 045.csv --to 000.csv --compare points -o r.csv --radius 0.0016 --noise auto --registration 0.0001");
    let beyond = registered["distance"]["share_beyond_two_sigma"].as_f64().unwrap();
    println!("beyond 2 sigma with 0.1 mm for the registration: {beyond}");
    assert!(beyond < 0.25, "{beyond}");
}
