//! The degree that the samples tell is nearly the best, for positions and for normals, and depends on the samples alone.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use super::{angle, on_torus};
use crate::common::{length, scale, shuffled, sub};
use footpoint::samples::{self, Samples};
use footpoint::{Cloud, Definition, DegreeAim, Kind, NormalField, Project, Queries, Run, Support, Surface};
use std::f64::consts::PI;

type Truth = fn([f64; 3]) -> ([f64; 3], [f64; 3]);

const COUNT: usize = 5000;

fn shapes() -> [(&'static str, Samples<3>, f64, Truth); 3] {
    let on_sphere: Truth = |x| (scale(x, 1.0 / length(x)), scale(x, 1.0 / length(x)));
    [
        ("torus", samples::torus(1.0, 0.4, COUNT, 1), 4.0 * PI * PI * 0.4, on_torus),
        ("sphere", samples::sphere(1.0, COUNT, 2), 4.0 * PI, on_sphere),
        ("plane", samples::plane(1.0, COUNT, 3), 4.0, |x| ([x[0], x[1], 0.0], [0.0, 0.0, 1.0])),
    ]
}

#[test]
fn the_choice_is_at_most_a_quarter_worse_than_the_best() {
    let mut chosen = [0; 4];
    for (name, shape, area, truth) in shapes() {
        for noise in [0.05, 0.2, 0.5] {
            let samples = shape.clone().with_noise(noise * (area / COUNT as f64).sqrt(), 7);
            for effective_neighbours in [16.0, 64.0] {
                let definition = Definition::new().with_support(Support::Auto { effective_neighbours });
                let mut surface = Surface::new(Cloud::new(samples.points.clone()), definition).unwrap();
                let mut errors = Vec::new();
                for degree in [0, 2, 3] {
                    surface = surface.with_degree(degree).unwrap();
                    let p = surface.project(Queries::Samples, &Project::new());
                    let ok: Vec<usize> = (0..COUNT).filter(|&i| p.status[i].is_ok()).collect();
                    let mean =
                        |of: &dyn Fn(usize) -> f64| ok.iter().map(|&i| of(i)).sum::<f64>() / ok.len() as f64;
                    let off = mean(&|i| length(sub(p.point[i], truth(p.point[i]).0)).powi(2)).sqrt();
                    let turned = mean(&|i| angle(p.surface_normal[i], truth(p.point[i]).1));
                    errors.push((degree, [off, turned]));
                }
                for (k, aim) in [DegreeAim::Position, DegreeAim::Normal].into_iter().enumerate() {
                    let choice = surface.choose_degree(aim);
                    let own = errors.iter().find(|e| e.0 == choice.degree).unwrap().1[k];
                    let best = errors.iter().map(|e| e.1[k]).fold(f64::INFINITY, f64::min);
                    let case = format!("{name}, noise {noise}, {effective_neighbours}, {aim:?}");
                    assert!(own <= 1.25 * best, "{case}: {errors:?}, {choice:?}");
                    chosen[usize::from(choice.degree)] += 1;
                }
            }
        }
    }
    println!("chosen degrees: {chosen:?}");
    assert!(chosen[0] > 5 && chosen[2] > 5, "{chosen:?}");
}

#[test]
fn without_noise_higher_degrees_are_chosen() {
    let surface = |field| {
        let shape = samples::torus(1.0, 0.4, COUNT, 1);
        let cloud = Cloud::new(shape.points).with_normals(shape.normals).unwrap();
        Surface::new(cloud, Definition::new().with_field(field)).unwrap()
    };
    for field in [NormalField::CentredCovariance, NormalField::AveragedNormals] {
        let choice = surface(field).choose_degree(DegreeAim::Position);
        assert!(choice.degree >= 2, "{choice:?}");
        assert_eq!(choice.evidence.len(), if field.needs_normals() { 4 } else { 3 });
    }
    for definition in
        [Definition::new().with_kind(Kind::Levin), Definition::new().with_field(NormalField::Covariance)]
    {
        let shape = samples::torus(1.0, 0.4, COUNT, 1);
        let choice =
            Surface::new(Cloud::new(shape.points), definition).unwrap().choose_degree(DegreeAim::Normal);
        assert_eq!((choice.degree, choice.evidence.len()), (0, 0));
    }
}

#[test]
fn the_choice_depends_on_the_samples_alone() {
    let shape = samples::torus(1.0, 0.4, COUNT, 1).with_noise(0.01, 2);
    let supports: Vec<f64> = (0..COUNT).map(|i| 0.15 + 0.05 * (i % 7) as f64 / 7.0).collect();
    let order = shuffled(COUNT, 3);
    for support in [Support::Uniform(0.17), Support::FromSamples] {
        let made = |order: &[usize], degree: u8| {
            let points: Vec<[f64; 3]> = order.iter().map(|&i| shape.points[i]).collect();
            let radii: Vec<f64> = order.iter().map(|&i| supports[i]).collect();
            let cloud = Cloud::new(points).with_supports(radii).unwrap();
            Surface::new(cloud, Definition::new().with_support(support).with_degree(degree)).unwrap()
        };
        let straight: Vec<usize> = (0..COUNT).collect();
        let expected = made(&straight, 0).choose_degree(DegreeAim::Normal);
        assert_eq!(expected.probes, expected.probes.clamp(1500, 2000));
        assert_eq!(made(&order, 3).choose_degree(DegreeAim::Normal), expected);
        let one = Run::new().threads(1);
        assert_eq!(made(&order, 1).with(&one).choose_degree(DegreeAim::Normal).unwrap(), expected);
    }
    let flag = std::sync::atomic::AtomicBool::new(true);
    let cancelled = Run::new().cancel(&flag);
    let surface = Surface::new(Cloud::new(shape.points), Definition::new()).unwrap();
    assert!(surface.with(&cancelled).choose_degree(DegreeAim::Position).is_err());
}
