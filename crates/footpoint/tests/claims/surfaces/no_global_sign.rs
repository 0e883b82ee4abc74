//! Fields without signs need none: surfaces with one side are evaluated and projected on like any other.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use crate::common::{add, dot, in_cube, length, median, rows_of_text, scale, shared, sub};
use footpoint::samples::{self, Random, Samples};
use footpoint::{Cloud, Definition, NormalField, Operator, Project, Queries, Sign, Support, Surface, Want};
use std::f64::consts::TAU;

const H: f64 = 0.2;
const UNSIGNED: [NormalField; 3] =
    [NormalField::Covariance, NormalField::CentredCovariance, NormalField::AveragedAxes];

/// Normals with random signs: no orientation is left in them.
fn axes(shape: &Samples<3>) -> Vec<[f64; 3]> {
    let mut random = Random::new(3);
    shape.normals.iter().map(|&n| scale(n, if random.uniform() < 0.5 { -1.0 } else { 1.0 })).collect()
}

fn surface(shape: &Samples<3>, field: NormalField) -> Surface<3> {
    let mut cloud = Cloud::new(shape.points.clone());
    if field == NormalField::AveragedAxes {
        cloud = cloud.with_normals(axes(shape)).unwrap();
    }
    Surface::new(cloud, Definition::new().with_field(field).with_support(Support::Uniform(H))).unwrap()
}

fn shapes() -> [(&'static str, Samples<3>); 2] {
    [
        ("Möbius strip", samples::moebius(1.0, 0.35, 20_000, 8)),
        ("Klein bottle", samples::klein(2.0, 0.8, 60_000, 9)),
    ]
}

#[test]
fn surfaces_with_one_side_are_projected_on() {
    for (name, shape) in shapes() {
        let mut random = Random::new(5);
        let picks: Vec<usize> =
            (0..3000).map(|_| (random.uniform() * shape.points.len() as f64) as usize).collect();
        // Inside the strip, and away from where the bottle crosses itself.
        let usable = |p: [f64; 3]| match name {
            "Möbius strip" => {
                let u = p[1].atan2(p[0]);
                length(sub(p, [u.cos(), u.sin(), 0.0])) < 0.2
            }
            _ => {
                let u = p[1].atan2(p[0]);
                length(sub(p, [2.0 * u.cos(), 2.0 * u.sin(), 0.0])) > 2.0 * H
            }
        };
        let picks: Vec<usize> = picks.into_iter().filter(|&i| usable(shape.points[i])).collect();
        assert!(picks.len() > 500);
        let starts: Vec<[f64; 3]> =
            picks.iter().map(|&i| add(shape.points[i], scale(in_cube(&mut random), 0.15 * H))).collect();
        for field in UNSIGNED {
            let surface = surface(&shape, field);
            assert_eq!(surface.sign(), Sign::Arbitrary);
            for operator in [Operator::Basic, Operator::AlmostOrthogonal, Operator::Orthogonal] {
                let found = surface.project(&starts, &Project::new().with_operator(operator));
                let ok = found.status.iter().filter(|s| s.is_ok()).count();
                assert!(ok == starts.len(), "{name} {field:?} {operator:?}: {ok} of {}", starts.len());
                assert!(found.distance.iter().all(|&d| (0.0..0.6 * H).contains(&d)), "unsigned distances");
                let normal = |i: usize| dot(found.surface_normal[i], shape.normals[picks[i]]).abs();
                let angle = median((0..picks.len()).map(normal)).acos();
                assert!(angle < 0.1, "{name} {field:?}: {angle}");
            }
        }
    }
}

#[test]
fn once_around_the_strip_the_carried_sign_has_turned() {
    let (_, shape) = &shapes()[0];
    for field in UNSIGNED {
        let surface = surface(shape, field);
        let steps = 400;
        let along: Vec<[f64; 3]> = (0..=steps)
            .map(|i| TAU * f64::from(i) / f64::from(steps))
            .map(|u| [u.cos(), u.sin(), 0.0])
            .collect();
        let e = surface.evaluate(&along, Want::FRAME_NORMAL | Want::GRADIENT | Want::VALUE);
        assert!(e.status.iter().all(|s| s.is_ok()));
        let mut carried = 1.0;
        for i in 0..along.len() - 1 {
            let turn = dot(e.frame_normal[i], e.frame_normal[i + 1]);
            assert!(turn.abs() > 0.99, "the axis itself is continuous: {turn}");
            carried *= turn.signum();
        }
        // Back at the start the answer is the same, the way there turned it over.
        assert!(dot(e.frame_normal[0], e.frame_normal[steps as usize]) > 1.0 - 1e-12);
        assert_eq!(carried, -1.0, "{field:?}");
        // n and ∇f turn together wherever one asks.
        assert!((0..along.len()).all(|i| dot(e.frame_normal[i], e.gradient[i]) > 0.5));
    }
}

#[test]
fn axes_do_not_feel_the_signs_of_the_normals() {
    for (name, shape) in shapes() {
        let definition =
            Definition::new().with_field(NormalField::AveragedAxes).with_support(Support::Uniform(H));
        let with = |normals: Vec<[f64; 3]>| {
            let cloud = Cloud::new(shape.points.clone()).with_normals(normals).unwrap();
            Surface::new(cloud, definition).unwrap()
        };
        let want = Want::VALUE | Want::FRAME_NORMAL | Want::GRADIENT;
        let one = with(shape.normals.clone()).evaluate(Queries::Samples, want);
        let other = with(axes(&shape)).evaluate(Queries::Samples, want);
        let mut turned = 0;
        for i in 0..shape.points.len() {
            // The sum of the normals decides the sign of the answer (SPEC § 3), and nothing else of it.
            let sign = dot(one.frame_normal[i], other.frame_normal[i]).signum();
            turned += usize::from(sign < 0.0);
            assert_eq!(one.value[i], sign * other.value[i], "{name}");
            assert_eq!(one.gradient[i], scale(other.gradient[i], sign), "{name}");
        }
        assert!(turned > 1000, "{turned}");
    }
}

#[test]
fn a_real_file_with_unsigned_normals() {
    let Some(file) = shared("data").map(|f| f.join("cloud/cgal_fin90_with_PCA_normals.xyz")) else { return };
    let rows = rows_of_text(&std::fs::read_to_string(file).unwrap(), usize::MAX);
    let part = |from: usize| -> Vec<[f64; 3]> {
        rows.iter().map(|row| std::array::from_fn(|k| row[from + k])).collect()
    };
    let (points, normals) = (part(0), part(3));
    let cloud = || Cloud::new(points.clone()).with_normals(normals.clone()).unwrap();
    let of = |field| Surface::new(cloud(), Definition::new().with_field(field)).unwrap();
    let (axes, centred) = (of(NormalField::AveragedAxes), of(NormalField::CentredCovariance));
    let found = axes.project(Queries::Samples, &Project::new());
    let ok = found.status.iter().filter(|s| s.is_ok()).count() as f64 / points.len() as f64;
    let e = centred.evaluate(Queries::Samples, Want::FRAME_NORMAL);
    let a = axes.evaluate(Queries::Samples, Want::FRAME_NORMAL);
    let angles = (0..points.len()).map(|i| dot(e.frame_normal[i], a.frame_normal[i]).abs().min(1.0).acos());
    let angle = median(angles.filter(|a| a.is_finite()));
    println!("fin90: {ok:.4} ok, axes against covariance {:.2}°", angle.to_degrees());
    assert!(ok > 0.9 && angle < 0.2, "{ok} {angle}");
}
