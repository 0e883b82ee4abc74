//! How far step one of Levin's projection is from orthogonal to the surface that it leads to.
#![allow(clippy::print_stdout)]

use crate::common::{Columns, Variant, dot, length, median, near_samples, scale, sub};
use footpoint::samples::{self, Samples};
use footpoint::{Cloud, Definition, Kind, Operator, Project, Run, Want};

/// Shares of h that points start at, on both sides.
const HEIGHTS: [f64; 4] = [0.05, 0.1, 0.15, 0.2];

/// For each height the median and the worst of twenty of the angle between x − q and ∇f_L(q) in degrees, and the median
/// distance of q from the foot point of x, in h.
fn angles<const D: usize>(shape: &Samples<D>, radius: f64) -> [[f64; 3]; 4] {
    let columns = Columns::new(shape, radius, Variant::Uniform);
    let surface = columns.surface(Definition::new().with_kind(Kind::Levin));
    let step_one = Project::new().with_operator(Operator::Levin { degree: None }).with_tolerance(1e-10);
    let foot = Project::new().with_tolerance(1e-10);
    let starts = near_samples(&shape.points, 800, 0.02 * radius, 41);
    let feet = surface.project(&starts, &foot);
    HEIGHTS.map(|height| {
        let lifted: Vec<[f64; D]> = (0..starts.len())
            .filter(|&i| feet.status[i].is_ok())
            .map(|i| {
                let side = if i % 2 == 0 { height } else { -height };
                crate::common::add(feet.point[i], scale(feet.surface_normal[i], side * radius))
            })
            .collect();
        let (q, foot) = (surface.project(&lifted, &step_one), surface.project(&lifted, &foot));
        let ok = (0..lifted.len()).filter(|&i| q.status[i].is_ok() && foot.status[i].is_ok());
        let ok: Vec<usize> = ok.collect();
        assert!(ok.len() > lifted.len() * 8 / 10, "{} of {}", ok.len(), lifted.len());
        let normal = surface.evaluate(&q.point, Want::SURFACE_NORMAL).surface_normal;
        let mut found: Vec<f64> = ok
            .iter()
            .map(|&i| {
                let way = sub(lifted[i], q.point[i]);
                (dot(way, normal[i]).abs() / length(way)).min(1.0).acos().to_degrees()
            })
            .collect();
        found.sort_unstable_by(f64::total_cmp);
        let aside = ok.iter().map(|&i| length(sub(q.point[i], foot.point[i])) / radius);
        [found[found.len() / 2], found[found.len() * 19 / 20], median(aside)]
    })
}

fn print(label: &str, found: &[[f64; 3]; 4]) {
    for (height, [middle, high, aside]) in HEIGHTS.iter().zip(found) {
        println!(
            "{label}, {height} h away: angle {middle:.2} degrees (95 %: {high:.2}), {aside:.4} h from the foot point"
        );
    }
}

#[test]
fn on_a_torus() {
    let shape = samples::torus(1.0, 0.4, 20_000, 1);
    // Thirty neighbours.
    let radius = 0.087;
    let exact = angles(&shape, radius);
    print("random sampling without noise", &exact);
    let half = 0.5 * footpoint::spacing(&Cloud::new(shape.points.clone()), &Run::new()).unwrap();
    let noisy = angles(&shape.with_noise(half, 2), radius);
    print("noise of half a spacing", &noisy);
    // The numbers that its documentation names, whatever the distance.
    for (found, [middle, high, aside]) in [(exact, [0.62, 2.06, 0.0105]), (noisy, [1.36, 4.65, 0.0242])] {
        for (height, found) in HEIGHTS.into_iter().zip(found) {
            let ratios = [found[0] / middle, found[1] / high, found[2] / (aside * height)];
            assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < 0.1), "{height}: {ratios:?}");
        }
    }
}
