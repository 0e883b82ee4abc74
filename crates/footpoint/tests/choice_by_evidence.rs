//! `Cloud::choose` finds radius and degree whose errors are near the least of a grid, says what error to expect, keeps sheets
//! apart, and does not depend on order or threads.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use footpoint::samples::{Samples, plane, torus};
use footpoint::{Aim, Choice, Cloud, Definition, Queries, Run, Support, Surface, Want, Weight};

const COUNT: usize = 20_000;

fn choices(points: &[[f64; 3]], run: &Run<'_>) -> Vec<Choice> {
    Cloud::new(points).choose(Weight::Poly3, run).unwrap()
}

fn of(choices: &[Choice], aim: Aim) -> Choice {
    *choices.iter().find(|choice| choice.aim == aim).unwrap()
}

/// The torus's normal at the foot of a point: noise moves points along the surface too, to places of other normals.
fn true_normal(p: &[f64; 3]) -> [f64; 3] {
    let aside = p[0].hypot(p[1]);
    let way = [p[0] - p[0] / aside, p[1] - p[1] / aside, p[2]];
    let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
    way.map(|c| c / length)
}

/// A torus with noise of 0.3 spacings.
fn noisy_torus() -> Samples<3> {
    let spacing = (4.0 * std::f64::consts::PI.powi(2) * 0.4 / COUNT as f64).sqrt();
    torus(1.0, 0.4, COUNT, 3).with_noise(0.3 * spacing, 5)
}

/// Root mean square angle to the truth as it follows from the best 70 % of every twentieth sample, for two normal components.
fn angle(cloud: &Samples<3>, radius: f64, degree: u8) -> f64 {
    let definition = Definition::new().with_support(Support::Uniform(radius)).with_degree(degree);
    let surface = Surface::new(Cloud::new(cloud.points.clone()), definition).unwrap();
    let some: Vec<[f64; 3]> = cloud.points.iter().copied().step_by(20).collect();
    let found = surface.evaluate(Queries::Points(&some), Want::SURFACE_NORMAL).surface_normal;
    let sine = |a: &[f64; 3], b: &[f64; 3]| {
        let dot: f64 = (0..3).map(|k| a[k] * b[k]).sum();
        1.0 - (dot * dot).min(1.0)
    };
    let mut squares: Vec<f64> = found.iter().zip(&some).map(|(a, p)| sine(a, &true_normal(p))).collect();
    squares.sort_by(f64::total_cmp);
    squares.truncate(squares.len() * 7 / 10);
    (squares.iter().sum::<f64>() / squares.len() as f64 / 0.484).sqrt()
}

#[test]
fn normals_of_noisy_samples_are_near_the_best_of_a_grid_and_as_good_as_promised() {
    let cloud = noisy_torus();
    let choice = of(&choices(&cloud.points, &Run::new()), Aim::Normals);
    let found = angle(&cloud, choice.radius, choice.degree);
    let grid = [0.5, 0.7, 1.0, 1.4].map(|f| [0, 2, 3].map(|degree| angle(&cloud, f * choice.radius, degree)));
    let best = grid.as_flattened().iter().copied().fold(f64::INFINITY, f64::min);
    println!("{choice:?}: error {found:.4}, best {best:.4}");
    assert!(found < 1.25 * best, "{found} against {best}");
    assert!((0.6..1.6).contains(&(choice.expected / found)), "{} for {found}", choice.expected);
}

#[test]
fn without_noise_narrow_radii_of_high_degree_are_taken() {
    let choice = of(&choices(&torus(1.0, 0.4, COUNT, 3).points, &Run::new()), Aim::Positions);
    assert!(choice.degree > 1 && choice.effective_neighbours < 33.0, "{choice:?}");
}

#[test]
fn sheets_that_narrow_radii_tell_apart_stay_apart() {
    // Spacing 0.02 on each side, six spacings apart.
    let side = plane(1.0, COUNT / 2, 7).points;
    let raised = plane(1.0, COUNT / 2, 8).points.into_iter().map(|[x, y, z]| [x, y, z + 0.12]);
    let points: Vec<[f64; 3]> = side.into_iter().chain(raised).collect();
    let noisy = Samples { points, normals: Vec::new() }.with_noise(0.006, 9);
    for choice in choices(&noisy.points, &Run::new()) {
        assert!(choice.radius < 0.3, "one radius holds both sheets: {choice:?}");
    }
}

#[test]
fn the_choice_is_the_same_for_any_order_and_threads_and_scales_with_the_cloud() {
    let points = noisy_torus().points;
    let choice = choices(&points, &Run::new().threads(1));
    assert_eq!(choice.len(), 3);
    let backward: Vec<[f64; 3]> = points.iter().rev().copied().collect();
    assert_eq!(choice, choices(&backward, &Run::new().threads(2)));
    let large: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| c * 1024.0)).collect();
    for (small, large) in choice.iter().zip(choices(&large, &Run::new())) {
        assert_eq!((small.radius * 1024.0, small.degree), (large.radius, large.degree));
    }
}

#[test]
fn too_few_samples_give_no_choice() {
    assert!(choices(&torus(1.0, 0.4, 12, 3).points, &Run::new()).is_empty());
    assert!(Cloud::<3>::default().choose(Weight::Poly3, &Run::new()).is_err());
}
