//! Step one of Levin's projection is a local minimum of its energy, and repeated it lands on Levin's surface.
#![allow(clippy::print_stdout)]

use crate::common::{
    Columns, VARIANTS, Variant, WEIGHTS, across, add, dot, in_cube, largest, length, median, near_samples,
    scale, sub,
};
use footpoint::samples::{self, Random, Samples};
use footpoint::{Acceptance, Definition, Kind, Operator, Project, Want, Weight};

const STEP_ONE: Operator = Operator::Levin { degree: None };

/// Eq. 16 by its letter.
fn energy<const D: usize>(columns: &Columns<D>, weight: Weight, x: [f64; D], n: [f64; D], t: f64) -> f64 {
    let q = add(x, scale(n, t));
    (0..columns.points.len())
        .map(|i| {
            let d = sub(columns.points[i], q);
            let h = columns.supports.as_ref().map_or(columns.radius, |s| s[i]);
            let s2 = dot(d, d) / (h * h);
            let rest = (1.0 - s2).max(0.0);
            let theta = match weight {
                Weight::Poly2 => rest.powi(2),
                Weight::Poly3 => rest.powi(3),
                Weight::Poly4 => rest.powi(4),
                Weight::Wendland => {
                    let s = s2.sqrt().min(1.0);
                    (1.0 - s).powi(4) * (4.0 * s + 1.0)
                }
                _ => (-s2).exp(),
            };
            columns.factors.as_ref().map_or(1.0, |f| f[i]) * theta * dot(n, d).powi(2)
        })
        .sum()
}

fn lowest<const D: usize>(shape: &Samples<D>, radius: f64) {
    let mut random = Random::new(31);
    let mut judged = 0;
    for variant in VARIANTS {
        for (weight, share) in WEIGHTS {
            let columns = Columns::new(shape, share * radius, variant);
            let definition = Definition::new().with_weight(weight).with_acceptance(Acceptance::EVERY_ZERO);
            let surface = columns.surface(definition);
            let starts = near_samples(&columns.points, 25, 0.15 * radius, 6);
            let how = Project::new().with_operator(STEP_ONE).with_tolerance(1e-12);
            let p = surface.project(&starts, &how);
            for (i, &x) in starts.iter().enumerate().filter(|(i, _)| p.status[*i].is_ok()) {
                judged += 1;
                let (n, way) = (p.frame_normal[i], sub(p.point[i], x));
                let t = dot(way, n);
                assert!(length(across(way, n)) < 1e-14, "q lies on the line along n");
                let here = energy(&columns, weight, x, n, t);
                for _ in 0..20 {
                    let size = 1e-3 * 10.0_f64.powf(random.uniform());
                    let turned = add(n, scale(in_cube(&mut random), size));
                    let turned = scale(turned, 1.0 / length(turned));
                    let there = t + size * columns.radius * (2.0 * random.uniform() - 1.0);
                    let higher = energy(&columns, weight, x, turned, there) - here;
                    assert!(higher > 0.0, "{weight:?} {variant:?} {i}: {higher:e} of {here:e}");
                }
            }
        }
    }
    assert!(judged > 450, "{judged}");
}

#[test]
fn it_is_a_local_minimum_in_n_and_t() {
    lowest(&samples::torus(1.0, 0.4, 1000, 1).with_noise(0.02, 2), 0.34);
    lowest(&samples::ellipse(1.0, 0.6, 200, 3).with_noise(0.01, 4), 0.3);
}

/// Medians of |t|/h of each repetition, and of |f_L|/h after it.
fn repeated<const D: usize>(shape: &Samples<D>, radius: f64, weight: Weight) -> [[f64; 2]; 4] {
    let columns = Columns::new(shape, radius, Variant::PerSample);
    let definition = Definition::new().with_weight(weight).with_kind(Kind::Levin);
    let surface = columns.surface(definition);
    let starts = near_samples(&columns.points, 400, 0.15 * radius, 7);
    let how = Project::new().with_operator(STEP_ONE).with_tolerance(1e-13);
    let stays = |x: &[f64; D]| surface.project(&[*x], &how).status[0].is_ok();
    let mut at: Vec<[f64; D]> = starts.into_iter().filter(stays).collect();
    assert!(at.len() > 360, "{}", at.len());
    std::array::from_fn(|_| {
        let p = surface.project(&at, &how);
        let e = surface.evaluate(&p.point, Want::VALUE | Want::SUPPORT);
        let ok: Vec<usize> = (0..at.len()).filter(|&i| p.status[i].is_ok()).collect();
        let ways = ok.iter().map(|&i| length(sub(p.point[i], at[i])) / e.support[i]);
        let found = [median(ways), median(ok.iter().map(|&i| e.value[i].abs() / e.support[i]))];
        at = ok.iter().map(|&i| p.point[i]).collect();
        found
    })
}

fn lands<const D: usize>(shape: &Samples<D>, radius: f64) {
    for weight in [Weight::Poly3, Weight::Poly4] {
        let found = repeated(shape, radius, weight);
        let falls: Vec<f64> = (0..2).map(|k| found[k][0] / found[k + 1][0]).collect();
        println!("D = {D} {weight:?}: |t|/h and |f_L|/h {found:?}; t falls by {falls:.0?}");
        assert!(found[0][0] > 0.02, "the starts are not near");
        assert!(falls.iter().all(|&f| f > 200.0), "{falls:?}");
        assert!(found[3][1] < 1e-12, "{:e}", found[3][1]);
    }
}

#[test]
fn repeated_it_lands_on_the_zeros_of_f() {
    lands(&samples::torus(1.0, 0.4, 2000, 1).with_noise(0.01, 2), 0.3);
    lands(&samples::ellipse(1.0, 0.6, 300, 3).with_noise(0.005, 4), 0.25);
}

#[test]
fn points_of_the_surface_stay() {
    let columns = Columns::new(&samples::torus(1.0, 0.4, 2000, 1).with_noise(0.01, 2), 0.3, Variant::Factors);
    let surface = columns.surface(Definition::new().with_kind(Kind::Levin));
    let starts = near_samples(&columns.points, 300, 0.1 * 0.3, 8);
    let feet = surface.project(&starts, &Project::new().with_tolerance(1e-12));
    let ok: Vec<[f64; 3]> =
        (0..starts.len()).filter(|&i| feet.status[i].is_ok()).map(|i| feet.point[i]).collect();
    assert!(ok.len() > 290);
    let again = surface.project(&ok, &Project::new().with_operator(STEP_ONE).with_tolerance(1e-12));
    let moved = largest((0..ok.len()).map(|i| length(sub(again.point[i], ok[i])) / 0.3));
    assert!(again.status.iter().all(|s| s.is_ok()) && moved < 3e-12, "{moved:e}");
}
