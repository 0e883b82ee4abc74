//! Every option of casting changes what it should.

use footpoint::samples;
use footpoint::{Cancelled, Cast, Cloud, Definition, Ray, Run, Sought, Surface};
use std::sync::atomic::AtomicBool;

fn sphere() -> Surface<3> {
    Surface::new(Cloud::new(samples::sphere(1.0, 5000, 1).points), Definition::new()).unwrap()
}

const DOWN: Ray<3> = Ray { origin: [0.1, 0.2, 3.0], direction: [0.0, 0.0, -1.0] };

fn every(surface: &Surface<3>, how: &Cast) -> Vec<f64> {
    surface.cast_all(&[DOWN], how).hits.t
}

#[test]
fn the_range_bounds_t() {
    let surface = sphere();
    let both = every(&surface, &Cast::new());
    assert_eq!(both.len(), 2);
    let (front, back) = (both[0], both[1]);
    let within = |from: f64, to: f64| every(&surface, &Cast::new().with_range(from..to));
    assert_eq!(within(0.0, 0.5 * (front + back)).len(), 1);
    assert!((within(0.5 * (front + back), f64::INFINITY)[0] - back).abs() < 1e-6);
    // Bounds in the domain, near the zero but on either side of it.
    assert!(within(0.0, front - 1e-3).is_empty());
    assert_eq!(within(0.0, front + 1e-3).len(), 1);
    assert_eq!(within(front + 1e-3, back - 1e-3).len(), 0);
    assert_eq!(within(front - 1e-3, back + 1e-3).len(), 2);
    assert!(within(f64::NEG_INFINITY, -1.0).is_empty());
    assert_eq!(within(f64::NAN, f64::NAN).len(), 2);
    assert!(within(5.0, 2.0).is_empty(), "an empty range holds nothing");
    // Behind the origin only if asked for.
    let inside = Ray { origin: [0.1, 0.2, 0.0], ..DOWN };
    let hits = surface.cast(&[inside], &Cast::new().with_range(-10.0..10.0));
    assert!(hits.t[0] < -0.5 && surface.cast(&[inside], &Cast::new()).t[0] > 0.5);
}

#[test]
fn a_ray_that_begins_on_the_surface_hits_it_there() {
    let surface = sphere();
    let hit = surface.cast(&[DOWN], &Cast::new());
    let on = Ray { origin: hit.point[0], ..DOWN };
    let again = surface.cast(&[on], &Cast::new());
    assert!(again.t[0].abs() < 1e-6, "{}", again.t[0]);
    let beyond = surface.cast(&[on], &Cast::new().with_range(0.01..f64::INFINITY));
    assert!(beyond.t[0] > 1.5);
}

#[test]
fn a_tighter_tolerance_takes_more_evaluations() {
    let surface = sphere();
    let rays = super::random_rays(&surface, 500, 1);
    let spent = |tolerance: f64| -> u32 {
        surface.cast(&rays, &Cast::new().with_tolerance(tolerance)).evaluations.iter().sum()
    };
    let (loose, usual, tight) = (spent(1e-2), spent(1e-6), spent(1e-12));
    assert!(loose < usual && usual < tight, "{loose} {usual} {tight}");
    assert!(spent(0.0) >= tight && spent(f64::NAN) == spent(0.0));
}

#[test]
fn any_hit_comes_sooner_than_the_first() {
    // Noise makes the way to a hit unclear.
    let points = samples::torus(1.0, 0.4, 5000, 1).with_noise(0.03, 2).points;
    let surface = Surface::new(Cloud::new(points), Definition::new()).unwrap();
    let rays = super::random_rays(&surface, 1000, 1);
    let first = surface.cast(&rays, &Cast::new());
    let any = surface.cast(&rays, &Cast::new().with_sought(Sought::Any));
    let spent = |evaluations: &[u32]| evaluations.iter().sum::<u32>();
    assert!(spent(&any.evaluations) < spent(&first.evaluations));
}

#[test]
fn a_run_can_be_cancelled_and_tells_how_far_it_is() {
    let surface = sphere();
    let rays = super::random_rays(&surface, 500, 1);
    let flag = AtomicBool::new(true);
    let run = Run::new().cancel(&flag);
    assert_eq!(surface.with(&run).cast(&rays, &Cast::new()), Err(Cancelled));
    assert_eq!(surface.with(&run).cast_all(&rays, &Cast::new()), Err(Cancelled));
}

#[test]
fn no_rays_no_hits() {
    let surface = sphere();
    assert!(surface.cast(&[], &Cast::new()).t.is_empty());
    let all = surface.cast_all(&[], &Cast::new());
    assert!(all.hits.t.is_empty() && all.begins == [0]);
}
