//! On and near the medial axis a point has a documented answer: no foot, or one that is near; it never drifts.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use crate::common::{add, in_cube, length, scale, sub};
use footpoint::samples::{self, Random};
use footpoint::{Cloud, Definition, NormalField, Operator, Project, Status, Support, Surface};

const FIELDS: [NormalField; 2] = [NormalField::CentredCovariance, NormalField::Covariance];

/// What became of starts, where `distance` is that to the true surface and `size` the support: a point that is not *ok* stays,
/// one that is stands on the surface and has not passed by it.
fn check(
    points: &[[f64; 3]],
    h: f64,
    starts: &[[f64; 3]],
    distance: impl Fn([f64; 3]) -> f64,
    label: &str,
) -> [usize; 7] {
    let mut all = [0; 7];
    for field in FIELDS {
        let definition = Definition::new().with_field(field).with_support(Support::Uniform(h));
        let surface = Surface::new(Cloud::new(points.to_vec()), definition).unwrap();
        for operator in [Operator::Basic, Operator::AlmostOrthogonal, Operator::Orthogonal] {
            let found = surface.project(starts, &Project::new().with_operator(operator));
            for (i, &start) in starts.iter().enumerate() {
                all[found.status[i] as usize] += 1;
                if !found.status[i].is_ok() {
                    assert_eq!(found.point[i], start, "{label}: a point without a foot stays");
                    assert!(found.distance[i].is_nan() && found.surface_normal[i][0].is_nan());
                    continue;
                }
                let off = distance(found.point[i]) / h;
                assert!(off < 0.25, "{label} {field:?} {operator:?}: {off} h off the surface");
                let moved = length(sub(found.point[i], start));
                assert!(moved <= distance(start) + h, "{label} {field:?} {operator:?}: drifted by {moved}");
            }
        }
    }
    println!("{label}: {all:?}");
    all
}

fn around(centre: [f64; 3], reach: f64, count: usize) -> Vec<[f64; 3]> {
    let mut random = Random::new(2);
    let near = (0..count).map(|_| add(centre, scale(in_cube(&mut random), reach)));
    std::iter::once(centre).chain(near).collect()
}

#[test]
fn the_centre_of_a_sphere() {
    let points = samples::sphere(1.0, 8000, 1).points;
    let off = |p: [f64; 3]| (length(p) - 1.0).abs();
    // No ball reaches the centre.
    let small = check(&points, 0.3, &around([0.0; 3], 0.1, 100), off, "sphere, h = 0.3");
    assert_eq!(small[Status::Outside as usize], 6 * 101);
    // All of them do: what starts beside the centre goes out in its direction or has no foot.
    check(&points, 1.2, &around([0.0; 3], 1e-3, 100), off, "sphere, h = 1.2");
    // Every direction is as good as any other where each sample stands with all its mirror images.
    let mirrored: Vec<[f64; 3]> = points[..300]
        .iter()
        .flat_map(|p| (0..24).map(|i| (*p, i)))
        .map(|([x, y, z], i)| {
            let [x, y, z] = [[x, y, z], [y, z, x], [z, x, y]][i / 8];
            let sign = |bit: usize| if i >> bit & 1 == 1 { -1.0 } else { 1.0 };
            [sign(0) * x, sign(1) * y, sign(2) * z]
        })
        .collect();
    let all = check(&mirrored, 1.2, &[[0.0; 3]], off, "mirrored sphere");
    assert_eq!(all[Status::Degenerate as usize] + all[Status::Singular as usize], 6, "{all:?}");
}

#[test]
fn between_two_sheets() {
    let h = 0.2;
    for gap in [0.8, 1.2, 1.6] {
        let low = samples::plane(1.0, 6000, 3).points;
        let high = samples::plane(1.0, 6000, 4).points.into_iter().map(|p| add(p, [0.0, 0.0, gap * h]));
        let points: Vec<[f64; 3]> = low.into_iter().chain(high).collect();
        let off = |p: [f64; 3]| p[2].abs().min((p[2] - gap * h).abs());
        let starts: Vec<[f64; 3]> = around([0.0, 0.0, 0.5 * gap * h], 0.3, 200)
            .into_iter()
            .map(|p| [p[0], p[1], 0.5 * gap * h + 0.05 * (p[2] - 0.5 * gap * h)])
            .collect();
        check(&points, h, &starts, off, &format!("sheets {gap} h apart"));
    }
}

#[test]
fn the_core_of_a_torus() {
    let points = samples::torus(1.0, 0.3, 20_000, 5).points;
    let off = |p: [f64; 3]| {
        let around = p[0].hypot(p[1]) - 1.0;
        (around.hypot(p[2]) - 0.3).abs()
    };
    let mut random = Random::new(6);
    let starts: Vec<[f64; 3]> = (0..300)
        .map(|i| 0.021 * f64::from(i))
        .map(|u| add([u.cos(), u.sin(), 0.0], scale(in_cube(&mut random), 0.01)))
        .collect();
    let found = check(&points, 0.4, &starts, off, "torus");
    // Most have no foot: around the core every direction across it is nearly as good as any other.
    assert!(found[Status::Ok as usize] < 300 * 6 / 4, "{found:?}");
}
