//! On a real scan, too, casting finds what dense sampling finds.

use super::dense::compare;
use crate::common::shared;
use footpoint::{Cloud, Definition, Surface};

fn check(rays: usize) {
    let Some(data) = shared("data/range") else { return };
    let text = std::fs::read_to_string(data.join("bun000.ply")).unwrap();
    let rows = text.lines().skip_while(|line| *line != "end_header").skip(1);
    let points: Vec<[f64; 3]> = rows
        .filter_map(|row| {
            let numbers: Vec<f64> = row.split_whitespace().map_while(|word| word.parse().ok()).collect();
            numbers.try_into().ok()
        })
        .collect();
    assert_eq!(points.len(), 40_256);
    let surface = Surface::new(Cloud::new(points), Definition::new()).unwrap();
    let found = compare(&surface, &super::random_rays(&surface, rays, 2));
    println!("bun000: {found:?}");
    assert!(found.hits > rays / 2 && found.wrong == 0, "{found:?}");
    assert!(found.missed as f64 <= 1e-4 * found.hits.max(10_000) as f64, "{found:?}");
}

#[test]
fn a_scan_loses_no_hit() {
    check(1000);
}

#[test]
#[ignore = "minutes long"]
fn a_scan_loses_hardly_a_hit_of_many() {
    check(100_000);
}
