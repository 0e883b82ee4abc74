//! Distances to known shapes are the true ones to the bound of the definition, with the right sign, however far the query is.

mod common;

use common::{Csv, Folder, csv_of, dot, gap};
use footpoint::samples::{Random, Samples, plane, sphere, torus};

const RADIUS: f64 = 2.0;

fn write_cloud(folder: &Folder, name: &str, samples: &Samples<3>, shift: [f64; 3]) {
    let at = |p: &[f64; 3]| -> [f64; 3] { std::array::from_fn(|k| p[k] + shift[k]) };
    let rows = samples.points.iter().zip(&samples.normals).map(|(p, n)| [at(p), *n].concat());
    folder.write(name, csv_of("x,y,z,nx,ny,nz", rows));
}

fn write_points(folder: &Folder, name: &str, points: &[[f64; 3]]) {
    folder.write(name, csv_of("x,y,z", points.iter().map(|p| p.to_vec())));
}

/// Unit vectors, evenly spread at random.
fn directions(count: usize) -> Vec<[f64; 3]> {
    sphere(1.0, count, 31).points
}

/// Offsets from the sphere of radius 2: beside it, within a support, and as far as 5000 of these.
const OFFSETS: [f64; 9] = [-1.5, -0.6, -0.1, -0.01, 0.02, 0.15, 0.7, 30.0, 800.0];

/// Queries around the sphere with the offset of each.
fn around() -> (Vec<[f64; 3]>, Vec<f64>) {
    let every = |d: [f64; 3]| OFFSETS.map(|offset| (d.map(|c| c * (RADIUS + offset)), offset));
    directions(20).into_iter().flat_map(every).unzip()
}

/// Feet stand upright under their queries, at the distance that is told, on the sign's side.
fn check_feet(csv: &Csv, queries: &[[f64; 3]], name: &str) {
    let (feet, normals, distances) =
        (csv.vectors::<3>("foot"), csv.vectors::<3>("foot_normal"), csv.numbers("distance"));
    for i in 0..queries.len() {
        let away: [f64; 3] = std::array::from_fn(|k| queries[i][k] - feet[i][k]);
        let length = dot(away, away).sqrt();
        assert!((length - distances[i].abs()).abs() <= 1e-12 * (1.0 + length), "{name} {i}");
        let aside = gap(away, dot(away, normals[i]), normals[i]);
        assert!(aside <= 1e-5 * (0.2 + length), "{name} {i}: {aside} aside at {length}");
    }
}

#[test]
fn inside_and_outside_of_a_sphere() {
    let folder = Folder::new();
    write_cloud(&folder, "cloud.csv", &sphere(RADIUS, 20_000, 5), [0.0; 3]);
    let (queries, offsets) = around();
    write_points(&folder, "q.csv", &queries);
    let report = folder.report("distance q.csv --to cloud.csv --compare points -o d.csv");
    let h = report["surface"]["support"]["median"].as_f64().unwrap();
    assert_eq!(report["distance"]["signed"], true);
    // Two of nine in every direction, or one of them, lie within half a support.
    let walked = report["distance"]["walked"].as_u64().unwrap() as usize;
    assert!((queries.len() / 2..queries.len() * 7 / 9).contains(&walked), "{walked}");
    let csv = folder.csv("d.csv");
    assert!(csv.words("status").iter().all(|s| *s == "ok"), "{:?}", csv.words("status"));
    check_feet(&csv, &queries, "signed");
    // κ h²/10 for poly3: the surface lies that much nearer to the centre.
    let bias = h * h / (10.0 * RADIUS);
    let (distances, biases) = (csv.numbers("distance"), csv.numbers("distance_bias"));
    for i in 0..queries.len() {
        let error = distances[i] - offsets[i] - bias;
        assert!(error.abs() < bias, "{i}: {} for {}", distances[i], offsets[i]);
    }
    // It is told by the curvature, which an uneven sampling blurs: right in the mean.
    let mean = biases.iter().sum::<f64>() / biases.len() as f64;
    assert!((mean / bias - 1.0).abs() < 0.2, "{mean} for {bias}");
    // The surface of degree 3 has no such bias.
    folder.done("distance q.csv --to cloud.csv --compare points -o three.csv --degree 3");
    for (distance, offset) in folder.csv("three.csv").numbers("distance").iter().zip(&offsets) {
        assert!((distance - offset).abs() < 1e-2 * bias, "{distance} for {offset}");
    }
}

#[test]
fn without_normals_there_is_no_sign_and_the_bias_follows() {
    let folder = Folder::new();
    write_cloud(&folder, "cloud.csv", &sphere(RADIUS, 20_000, 5), [0.0; 3]);
    let (queries, offsets) = around();
    write_points(&folder, "q.csv", &queries);
    folder.done("distance q.csv --to cloud.csv --compare points -o signed.csv");
    let report = folder.report("distance q.csv --to cloud.csv --compare points -o d.csv --drop normals");
    assert_eq!(report["distance"]["signed"], false);
    let axes = folder.report("distance q.csv --to cloud.csv --compare points -o a.csv --field axes");
    assert_eq!(axes["distance"]["signed"], false);
    assert!(folder.csv("a.csv").numbers("distance").iter().all(|d| *d >= 0.0));
    let averaged = folder.report("distance q.csv --to cloud.csv --compare points -o b.csv --field averaged");
    assert_eq!(averaged["distance"]["signed"], true);
    let (csv, signed) = (folder.csv("d.csv"), folder.csv("signed.csv"));
    check_feet(&csv, &queries, "unsigned");
    let (distances, biases) = (csv.numbers("distance"), csv.numbers("distance_bias"));
    for i in 0..queries.len() {
        let (d, b) = (signed.numbers("distance")[i], signed.numbers("distance_bias")[i]);
        assert!((distances[i] - d.abs()).abs() < 1e-6, "{i}");
        // The bias makes the ball smaller: from inside it is nearer.
        assert!((biases[i] - b * offsets[i].signum()).abs() < 1e-6, "{i}: {} for {b}", biases[i]);
    }
}

/// The distance of a point to the torus of radii 1 and 0.4.
fn to_torus(p: [f64; 3]) -> f64 {
    (p[0].hypot(p[1]) - 1.0).hypot(p[2]) - 0.4
}

#[test]
fn far_from_a_torus() {
    let folder = Folder::new();
    write_cloud(&folder, "cloud.csv", &torus(1.0, 0.4, 20_000, 3), [0.0; 3]);
    let mut random = Random::new(9);
    // Not on the axis, and not on the circle in the middle, which have no one foot point.
    let queries: Vec<[f64; 3]> = directions(300)
        .into_iter()
        .map(|d| d.map(|c| c * (0.3 + 6.0 * random.uniform())))
        .filter(|p| p[0].hypot(p[1]) > 0.2 && (to_torus(*p) + 0.4).abs() > 0.1)
        .collect();
    write_points(&folder, "q.csv", &queries);
    folder.done("distance q.csv --to cloud.csv --compare points -o d.csv --degree 2");
    let csv = folder.csv("d.csv");
    check_feet(&csv, &queries, "torus");
    let (distances, status) = (csv.numbers("distance"), csv.words("status"));
    for (i, query) in queries.iter().enumerate() {
        let truth = to_torus(*query);
        assert_eq!(status[i], "ok", "{query:?}");
        assert!((distances[i] - truth).abs() < 1e-4, "{query:?}: {} for {truth}", distances[i]);
    }
}

#[test]
fn far_from_a_noisy_torus() {
    let folder = Folder::new();
    let noise = 0.014;
    let noisy = torus(1.0, 0.4, 20_000, 3).with_noise(noise, 4);
    write_points(&folder, "cloud.csv", &noisy.points);
    let mut random = Random::new(9);
    let queries: Vec<[f64; 3]> = directions(400)
        .into_iter()
        .map(|d| d.map(|c| c * 10.0_f64.powf(0.2 + 1.8 * random.uniform())))
        .collect();
    write_points(&folder, "q.csv", &queries);
    let report = folder.report("distance q.csv --to cloud.csv --compare points -o d.csv");
    // Half a spacing of noise at 16 effective neighbours: the surface has bumps and holes.
    assert!(report["distance"]["answered"].as_u64().unwrap() >= 396, "{}", report["statuses"]);
    let csv = folder.csv("d.csv");
    folder.done("project cloud.csv -o feet.csv");
    let feet = folder.csv("feet.csv");
    let status = feet.words("status");
    let samples: Vec<[f64; 3]> =
        feet.points().into_iter().zip(status).filter(|(_, s)| *s == "ok").map(|(p, _)| p).collect();
    for (i, (query, distance)) in queries.iter().zip(csv.numbers("distance")).enumerate() {
        if distance.is_nan() {
            continue;
        }
        assert!((distance - to_torus(*query)).abs() < 3.0 * noise, "{i}: {distance}");
        let mut around: Vec<f64> = samples.iter().map(|p| gap(*query, 1.0, *p)).collect();
        around.sort_by(f64::total_cmp);
        // Walks go down, from the nearest of the samples' own feet or, where they are lost, from the 8th or the 32nd.
        assert!(distance <= around[31] + 1e-6, "{i}: {distance}, {:?}", &around[..3]);
    }
}

/// Half of a real scan's points may be repeats.
#[test]
fn repeats_and_the_order_of_the_cloud_change_nothing() {
    let folder = Folder::new();
    let points = torus(1.0, 0.4, 3000, 3).points;
    write_points(&folder, "cloud.csv", &points);
    let twice: Vec<[f64; 3]> = points.iter().rev().chain(&points).copied().collect();
    write_points(&folder, "twice.csv", &twice);
    let reversed: Vec<[f64; 3]> = points.iter().rev().copied().collect();
    write_points(&folder, "reversed.csv", &reversed);
    let queries: Vec<[f64; 3]> = directions(100).into_iter().map(|d| d.map(|c| 4.0 * c)).collect();
    write_points(&folder, "q.csv", &queries);
    for cloud in ["cloud", "twice", "reversed"] {
        folder.done(&format!(
            "distance q.csv --to {cloud}.csv --compare points -o to_{cloud}.csv --radius 0.2"
        ));
    }
    assert_eq!(folder.bytes("to_cloud.csv"), folder.bytes("to_reversed.csv"));
    let [once, again] = ["to_cloud.csv", "to_twice.csv"].map(|name| folder.csv(name).numbers("distance"));
    for (a, b) in once.iter().zip(&again) {
        assert!((a - b).abs() < 1e-7, "{a} and {b}");
    }
}

#[test]
fn above_below_and_beyond_the_rim_of_a_plane() {
    let folder = Folder::new();
    write_cloud(&folder, "cloud.csv", &plane(1.0, 4000, 2), [0.0; 3]);
    let mut queries = Vec::new();
    for height in [-70.0, -0.4, -0.02, 0.0, 0.3, 5.0] {
        queries.extend([[0.0, 0.1, height], [0.7, -0.6, height]]);
    }
    let inside = queries.len();
    queries.extend([[1.5, 0.0, 0.1], [9.0, 2.0, 30.0], [0.0, -1.3, 0.0]]);
    write_points(&folder, "q.csv", &queries);
    folder.done("distance q.csv --to cloud.csv --compare points -o d.csv");
    let csv = folder.csv("d.csv");
    let (status, feet) = (csv.words("status"), csv.vectors::<3>("foot"));
    for (i, query) in queries.iter().enumerate() {
        if i < inside {
            assert_eq!(status[i], "ok", "{query:?}");
            assert!(
                (csv.numbers("distance")[i] - query[2]).abs() < 1e-12 * (1.0 + query[2].abs()),
                "{query:?}"
            );
            assert!(
                gap(feet[i], 1.0, [query[0], query[1], 0.0]) < 2e-6 * (1.0 + query[2].abs()),
                "{query:?}"
            );
        } else {
            // The nearest point of the rim is no foot point.
            assert_eq!(status[i], "boundary", "{query:?}");
            assert!(feet[i][0].is_nan() && csv.numbers("distance")[i].is_nan(), "{query:?}");
        }
    }
}

#[test]
fn at_survey_coordinates_too() {
    let folder = Folder::new();
    let shift = [500_000.0, 5_000_000.0, 300.0];
    let samples = sphere(RADIUS, 20_000, 5);
    write_cloud(&folder, "cloud.csv", &samples, [0.0; 3]);
    write_cloud(&folder, "moved.csv", &samples, shift);
    let (queries, _) = around();
    write_points(&folder, "q.csv", &queries);
    let moved: Vec<[f64; 3]> = queries.iter().map(|q| std::array::from_fn(|k| q[k] + shift[k])).collect();
    write_points(&folder, "r.csv", &moved);
    folder.done("distance q.csv --to cloud.csv --compare points -o d.csv --noise 0.01 --tolerance 1e-10");
    folder.done("distance r.csv --to moved.csv --compare points -o e.csv --noise 0.01 --tolerance 1e-10");
    let (here, there) = (folder.csv("d.csv"), folder.csv("e.csv"));
    // Coordinates of 5e6 are multiples of 9.3e-10; far feet, which that moves a little, have another sigma there.
    for (column, bound) in [("distance", 5e-9), ("distance_sigma", 1e-7), ("distance_bias", 1e-7)] {
        for (i, (a, b)) in here.numbers(column).iter().zip(there.numbers(column)).enumerate() {
            assert!((a - b).abs() <= bound, "{column} {i}: {a} and {b}");
        }
    }
    assert_eq!(here.words("status"), there.words("status"));
}

#[test]
fn curves_have_distances_too() {
    let folder = Folder::new();
    let circle = footpoint::samples::circle(1.0, 400, 1);
    let rows = circle.points.iter().zip(&circle.normals).map(|(p, n)| [*p, *n].concat());
    folder.write("cloud.csv", csv_of("x,y,nx,ny", rows));
    folder.write("q.csv", csv_of("x,y", [[0.0, 1.2], [-0.5, 0.0], [30.0, 40.0]].iter().map(|p| p.to_vec())));
    folder.done("distance q.csv --to cloud.csv --compare points -o d.csv --degree 3");
    let distances = folder.csv("d.csv").numbers("distance");
    for (distance, truth) in distances.iter().zip([0.2, -0.5, 49.0]) {
        assert!((distance - truth).abs() < 2e-5, "{distance} for {truth}");
    }
}

/// A hundred draws of the samples' noise against the sigma of one.
#[test]
fn sigma_is_the_deviation_of_repeated_draws() {
    let folder = Folder::new();
    let clean = sphere(1.0, 3000, 5);
    let queries: Vec<[f64; 3]> = directions(12)
        .into_iter()
        .zip([1.02, 1.1, 1.6, 0.97].into_iter().cycle())
        .map(|(d, r)| d.map(|c| c * r))
        .collect();
    write_points(&folder, "q.csv", &queries);
    let noise = 0.004;
    let mut draws: Vec<Vec<f64>> = Vec::new();
    let mut told = vec![0.0; queries.len()];
    const DRAWS: usize = 60;
    for seed in 0..DRAWS as u64 {
        let noisy = sphere(1.0, 3000, 5).with_noise(noise, 100 + seed);
        let noisy = Samples { points: noisy.points, normals: clean.normals.clone() };
        write_cloud(&folder, "cloud.csv", &noisy, [0.0; 3]);
        folder.done(
            "distance q.csv --to cloud.csv --compare points -o d.csv --force --radius 0.2 --noise 0.004",
        );
        let csv = folder.csv("d.csv");
        draws.push(csv.numbers("distance"));
        let sigma = csv.numbers("distance_sigma");
        told.iter_mut().zip(&sigma).for_each(|(sum, s)| *sum += s / DRAWS as f64);
    }
    let mut ratio = 0.0;
    for i in 0..queries.len() {
        let mean = draws.iter().map(|d| d[i]).sum::<f64>() / DRAWS as f64;
        let variance = draws.iter().map(|d| (d[i] - mean).powi(2)).sum::<f64>() / (DRAWS - 1) as f64;
        ratio += variance / (told[i] * told[i]) / queries.len() as f64;
    }
    println!("deviation of the draws over sigma: {:.3}", ratio.sqrt());
    // Twelve points of sixty draws: their mean deviation is known to 3 %.
    assert!((ratio.sqrt() - 1.0).abs() < 0.08, "{}", ratio.sqrt());
}
