//! Two parallel sheets are two hits where they are far enough apart, and one where they have merged (SPEC § 8).

use super::dense::compare;
use footpoint::samples::{self, Random};
use footpoint::{Cast, Cloud, Definition, Ray, Support, Surface};

/// Shares of the rays with no, one, two, three and more hits, for sheets this many supports apart.
fn shares(apart: f64, neighbours: f64) -> [f64; 4] {
    let (half, count) = (1.0, 4000);
    let spacing = (4.0 * half * half / f64::from(count)).sqrt();
    let h = spacing * (neighbours / std::f64::consts::PI).sqrt();
    let mut points = Vec::new();
    for (side, seed) in [(-0.5, 1), (0.5, 2)] {
        let sheet = samples::plane(half, count as usize, seed).with_noise(0.02 * h, seed + 7);
        points.extend(sheet.points.iter().map(|p| [p[0], p[1], p[2] + side * apart * h]));
    }
    let surface =
        Surface::new(Cloud::new(points), Definition::new().with_support(Support::Uniform(h))).unwrap();
    let mut random = Random::new(3);
    let inner = half - 2.0 * h;
    let rays: Vec<Ray<3>> = (0..2000)
        .map(|_| {
            let mut across = || inner * (2.0 * random.uniform() - 1.0);
            let (from, to) = ([across(), across(), 1.0], [across(), across(), -1.0]);
            // Not steeper than 45 degrees off the normal, so that the ray stays over the sheets.
            let to = [from[0] + 0.5 * (to[0] - from[0]), from[1] + 0.5 * (to[1] - from[1]), -1.0];
            Ray { origin: from, direction: std::array::from_fn(|k| to[k] - from[k]) }
        })
        .collect();
    let all = surface.cast_all(&rays, &Cast::new());
    let found = compare(&surface, &rays[..400]);
    assert!(found.missed + found.wrong == 0, "{found:?}");
    let mut counts = [0; 4];
    for i in 0..rays.len() {
        counts[all.of(i).len().min(3)] += 1;
    }
    counts.map(|count| f64::from(count) / rays.len() as f64)
}

#[test]
fn sheets_further_apart_than_a_support_are_two() {
    // With few neighbours, unevenly spread, the sheet between the two is sometimes accepted as a third.
    for (neighbours, two) in [(30.0, 0.93), (100.0, 0.95)] {
        let shares = shares(1.2, neighbours);
        println!("1.2 h apart, {neighbours} neighbours: {shares:?}");
        assert!(shares[2] >= two && shares[2] + shares[3] >= 0.999, "{shares:?}");
    }
}

#[test]
fn sheets_nearer_than_their_merging_distance_are_one() {
    let shares = shares(0.5, 100.0);
    println!("0.5 h apart, 100 neighbours: {shares:?}");
    assert!(shares[1] >= 0.95, "{shares:?}");
}

/// In between both happen, so this only tells what does.
#[test]
fn between_them_no_ray_is_empty() {
    for neighbours in [30.0, 100.0] {
        let shares = shares(0.8, neighbours);
        println!("0.8 h apart, {neighbours} neighbours: {shares:?}");
        assert!(shares[0] <= 0.05, "{shares:?}");
    }
}
