//! The squared sensitivity is the sum of |∂f/∂p_i|² that moving each sample measures, and those derivatives sum to −∇f.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use crate::common::{
    Columns, Variant, WEIGHTS, add, definitions, dot, first_order, length, near_samples, scale, sub,
};
use footpoint::samples::{self, Samples};
use footpoint::{Definition, Run, Surface, Want, Weight};

/// ∂f/∂p_i of every sample, by differences of the fourth order; `None` where a sample enters or leaves the support.
fn measured<const D: usize>(
    columns: &Columns<D>,
    definition: Definition,
    x: [f64; D],
    n: [f64; D],
) -> Option<Vec<[f64; D]>> {
    let step = 3e-4 * columns.radius;
    let mut moved = columns.clone();
    // Tens of thousands of tiny clouds: threads would spend their time on waking up.
    let run = Run::new().threads(1);
    let want = Want::VALUE | Want::FRAME_NORMAL | Want::NEIGHBOURS;
    let mut neighbours = None;
    let mut all = Vec::new();
    for i in 0..columns.points.len() {
        let mut derivative = [0.0; D];
        for k in 0..D {
            let mut f = |times: f64| {
                moved.points[i][k] = columns.points[i][k] + times * step;
                let surface =
                    Surface::build(moved.cloud(), definition.with_support(moved.support()), &run).unwrap();
                let e = surface.with(&run).evaluate(&[x], want).unwrap();
                moved.points[i][k] = columns.points[i][k];
                let count = *neighbours.get_or_insert(e.neighbours[0]);
                (count == e.neighbours[0]).then_some(e.value[0] * dot(e.frame_normal[0], n).signum())
            };
            derivative[k] = (f(-2.0)? - 8.0 * f(-1.0)? + 8.0 * f(1.0)? - f(2.0)?) / (12.0 * step);
        }
        all.push(derivative);
    }
    Some(all)
}

fn check<const D: usize>(shape: &Samples<D>, radius: f64) {
    let (mut worst, mut compared) = ([0.0_f64; 2], 0);
    for (weight, share) in [WEIGHTS[1], WEIGHTS[3], WEIGHTS[4]] {
        // Only samples in reach matter; a wide margin keeps them all.
        let radius = share * radius;
        let reach = 1.4 * radius * weight.reach();
        let variants = if weight == Weight::Poly3 {
            vec![Variant::Uniform, Variant::PerSampleAndFactors]
        } else {
            vec![Variant::PerSampleAndFactors]
        };
        for variant in variants {
            let whole = Columns::new(shape, radius, variant);
            let count = if weight == Weight::Poly3 { 3 } else { 2 };
            for (q, x) in near_samples(&whole.points, count, 0.3 * radius, 8).into_iter().enumerate() {
                let near = (0..whole.points.len()).filter(|&i| length(sub(whole.points[i], x)) < reach);
                let columns = whole.select(&near.collect::<Vec<_>>());
                for definition in definitions() {
                    let definition = definition.with_weight(weight);
                    let e = columns.surface(definition).evaluate(&[x], first_order());
                    if e.gap[0] < 0.1 {
                        continue;
                    }
                    let Some(derivatives) = measured(&columns, definition, x, e.frame_normal[0]) else {
                        continue;
                    };
                    compared += 1;
                    let squares: f64 = derivatives.iter().map(|&g| dot(g, g)).sum();
                    let sum = derivatives.iter().fold([0.0; D], |sum, &g| add(sum, g));
                    let gradient = e.gradient[0];
                    let errors = [
                        (e.squared_sensitivity[0] - squares).abs() / squares,
                        length(sub(scale(sum, -1.0), gradient)) / length(gradient).max(1.0),
                    ];
                    for (j, what) in ["sum of squares", "−ΣG = ∇f"].into_iter().enumerate() {
                        let case =
                            format!("{what}: {weight:?} {:?} {variant:?} query {q}", definition.kind());
                        assert!(errors[j] <= 1e-8, "{case}: {:e}", errors[j]);
                        worst[j] = worst[j].max(errors[j]);
                    }
                }
            }
        }
    }
    println!("D = {D}: {compared} compared, worst {worst:?}");
    assert!(compared >= 20, "{compared}");
}

#[test]
fn on_a_noisy_torus() {
    check(&samples::torus(1.0, 0.4, 1000, 1).with_noise(0.02, 2), 0.29);
}

#[test]
fn on_a_noisy_ellipse() {
    check(&samples::ellipse(1.0, 0.6, 160, 3).with_noise(0.01, 4), 0.25);
}
