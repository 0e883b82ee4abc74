//! A hit is a point of the ray on the surface, with the normals that it has there; other rays say why they have none.

use crate::common::{add, dot, length, scale, sub};
use footpoint::samples;
use footpoint::{Cast, Cloud, Definition, Queries, Ray, Run, Sign, Status, Support, Surface, Want};

fn sphere() -> Surface<3> {
    Surface::new(Cloud::new(samples::sphere(1.0, 5000, 1).points), Definition::new()).unwrap()
}

#[test]
fn points_lie_on_the_ray_and_on_the_surface() {
    let surface = sphere();
    let h = surface.support().median;
    let rays = super::random_rays(&surface, 2000, 3);
    for tolerance in [1e-3, 1e-6, 1e-12] {
        let hits = surface.cast(&rays, &Cast::new().with_tolerance(tolerance));
        let there =
            surface.evaluate(Queries::Points(&hits.point), Want::VALUE | Want::FRAME_NORMAL | Want::GRADIENT);
        let mut count = 0;
        for (i, ray) in rays.iter().enumerate().filter(|(i, _)| hits.status[*i].is_ok()) {
            count += 1;
            let along = add(ray.origin, scale(ray.direction, hits.t[i]));
            assert!(length(sub(along, hits.point[i])) <= 1e-13 * length(ray.origin).max(1.0));
            assert!(there.value[i].abs() <= tolerance * h + 1e-15, "{tolerance}: {}", there.value[i] / h);
            let normal = hits.surface_normal[i];
            assert!((length(normal) - 1.0).abs() < 1e-14 && dot(normal, ray.direction) <= 0.0);
            let gradient = there.gradient[i];
            assert!(length(sub(gradient, hits.gradient[i])) <= 1e-8 * length(gradient));
            assert!(length(sub(there.frame_normal[i], hits.frame_normal[i])) <= 1e-8);
            assert!(
                length(sub(normal, scale(gradient, dot(gradient, normal).signum() / length(gradient))))
                    < 1e-8
            );
        }
        assert!(count > 1000);
    }
}

#[test]
fn a_sphere_is_where_it_is() {
    let surface = sphere();
    let h = surface.support().median;
    let rays: Vec<Ray<3>> = (0..400)
        .map(|i| {
            let (x, y) = (f64::from(i % 20) / 20.0 - 0.475, f64::from(i / 20) / 20.0 - 0.475);
            Ray { origin: [x, y, 3.0], direction: [0.0, 0.0, -2.0] }
        })
        .collect();
    let hits = surface.cast(&rays, &Cast::new());
    let mut angles = 0.0;
    for i in 0..rays.len() {
        let [x, y, z] = hits.point[i];
        // The bias of degree 0 is h²/10 toward the centre (SPEC § 11), and as much again is allowed for sampling.
        assert!(((x * x + y * y + z * z).sqrt() - 1.0).abs() < 0.2 * h * h, "{:?}", hits.point[i]);
        assert!((hits.t[i] - (3.0 - z) / 2.0).abs() < 1e-12, "t is measured in lengths of the direction");
        angles +=
            dot(hits.surface_normal[i], scale(hits.point[i], 1.0 / length(hits.point[i]))).min(1.0).acos();
    }
    let mean = (angles / rays.len() as f64).to_degrees();
    assert!(mean < 1.2, "mean angle to the sphere's normal: {mean} degrees");
}

#[test]
fn statuses_say_why_there_is_no_hit() {
    let plane = samples::plane(1.0, 4000, 1).points;
    let surface =
        Surface::new(Cloud::new(plane), Definition::new().with_support(Support::Uniform(0.2))).unwrap();
    let down = |x: f64, y: f64| Ray { origin: [x, y, 1.0], direction: [0.0, 0.0, -1.0] };
    let rays = [
        down(0.1, 0.2),
        down(3.0, 0.0),
        down(1.12, 0.0),
        Ray { origin: [0.0, 0.0, 1.0], direction: [0.0, 0.0, 1.0] },
        Ray { origin: [f64::NAN, 0.0, 1.0], direction: [0.0, 0.0, -1.0] },
        Ray { origin: [0.0, 0.0, 1.0], direction: [0.0; 3] },
        Ray { origin: [0.0, 0.0, 1.0], direction: [0.0, f64::INFINITY, 1.0] },
        Ray { origin: [-3.0, 0.0, 0.5], direction: [1.0, 0.0, 0.0] },
        Ray { origin: [1e300, 0.0, 0.5], direction: [1.0, 0.0, 0.0] },
    ];
    let hits = surface.cast(&rays, &Cast::new());
    use Status::{Boundary, Invalid, Ok, Outside};
    let expected = [Ok, Outside, Boundary, Outside, Invalid, Invalid, Invalid, Outside, Outside];
    assert_eq!(hits.status, expected);
    for i in 1..rays.len() {
        assert!(hits.t[i].is_nan() && hits.point[i][0].is_nan() && hits.gradient[i][2].is_nan());
    }
    assert_eq!(hits.evaluations[1], 0, "far from all samples nothing is evaluated");
}

#[test]
fn the_sign_of_gradients_is_given_or_arbitrary_and_normals_face_the_ray() {
    let sphere = samples::sphere(1.0, 5000, 1);
    let cloud = Cloud::new(sphere.points).with_normals(sphere.normals).unwrap();
    let surface = Surface::new(cloud, Definition::new()).unwrap();
    assert_eq!(surface.sign(), Sign::Given);
    let ray = Ray { origin: [0.0, 0.0, 3.0], direction: [0.0, 0.0, -1.0] };
    let all = surface.cast_all(&[ray], &Cast::new());
    assert_eq!(all.of(0), 0..2);
    for (row, z) in [(0, 1.0), (1, -1.0)] {
        assert!((all.hits.point[row][2] - z).abs() < 0.01);
        assert!(all.hits.gradient[row][2] * z > 0.9 && all.hits.frame_normal[row][2] * z > 0.9, "outward");
        assert!(all.hits.surface_normal[row][2] > 0.9, "toward the ray");
    }
}

#[test]
fn bits_depend_on_the_ray_alone() {
    let surface = sphere();
    let rays = super::random_rays(&surface, 3000, 9);
    let hits = surface.cast(&rays, &Cast::new());
    let one = surface.with(&Run::new().threads(1)).cast(&rays, &Cast::new()).unwrap();
    assert_eq!(format!("{hits:?}"), format!("{one:?}"));
    let backward: Vec<Ray<3>> = rays.iter().rev().copied().collect();
    let backward = surface.cast(&backward, &Cast::new());
    for i in 0..rays.len() {
        let other = rays.len() - 1 - i;
        assert_eq!(hits.t[i].to_bits(), backward.t[other].to_bits());
        assert_eq!(hits.gradient[i].map(f64::to_bits), backward.gradient[other].map(f64::to_bits));
        assert_eq!(hits.status[i], backward.status[other]);
        assert_eq!(hits.evaluations[i], backward.evaluations[other]);
    }
}

#[test]
fn survey_coordinates_change_nothing_but_last_digits() {
    let offset = [4_500_000.0, 5_400_000.0, 512.0];
    let near = sphere();
    let moved: Vec<[f64; 3]> = near.cloud().points().iter().map(|p| add(*p, offset)).collect();
    let far = Surface::new(Cloud::new(moved), *near.definition()).unwrap();
    let rays = super::random_rays(&near, 1000, 4);
    let moved: Vec<Ray<3>> =
        rays.iter().map(|ray| Ray { origin: add(ray.origin, offset), direction: ray.direction }).collect();
    let how = Cast::new().with_tolerance(1e-12);
    let (here, there) = (near.cast(&rays, &how), far.cast(&moved, &how));
    assert_eq!(here.status, there.status);
    for i in 0..rays.len() {
        if here.status[i].is_ok() {
            // A unit in the last place of the coordinates is 1e-9; grazing rays stretch it.
            let slant = dot(here.surface_normal[i], rays[i].direction).abs() / length(rays[i].direction);
            assert!(length(sub(there.point[i], add(here.point[i], offset))) < 2e-8 / slant.powi(2).max(1e-4));
        }
    }
}
