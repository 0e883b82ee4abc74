//! The derivatives of Levin's surface are those of its f, and f is what the minimisation pulls with.
#![allow(clippy::print_stdout)]

use crate::common::{
    Columns, VARIANTS, WEIGHTS, differences, dot, largest, length, near_samples, scale, sub,
};
use footpoint::samples::{self, Samples};
use footpoint::{Definition, Kind, Operator, Project, Surface, Want};

/// ∂²f_L/∂x_k∂x_j by differences of the gradient; `None` where a sample enters or leaves a support on the way.
fn turning<const D: usize>(surface: &Surface<D>, x: [f64; D], n: [f64; D], h: f64) -> Option<[[f64; D]; D]> {
    let step = 1e-4 * h;
    let mut rows = [[0.0; D]; D];
    for (k, row) in rows.iter_mut().enumerate() {
        let at = |times: f64| std::array::from_fn(|j| x[j] + if j == k { times * step } else { 0.0 });
        let shifted = [-2.0, -1.0, 1.0, 2.0].map(at);
        let e = surface.evaluate(&shifted, Want::GRADIENT | Want::FRAME_NORMAL | Want::NEIGHBOURS);
        if e.neighbours.iter().any(|&count| count != e.neighbours[0]) {
            return None;
        }
        let g = |i: usize| scale(e.gradient[i], dot(e.frame_normal[i], n).signum() / (12.0 * step));
        *row = std::array::from_fn(|j| g(0)[j] - 8.0 * g(1)[j] + 8.0 * g(2)[j] - g(3)[j]);
    }
    Some(rows)
}

fn check<const D: usize>(shape: &Samples<D>, radius: f64) {
    let (mut worst, mut compared) = ([0.0_f64; 3], 0);
    for variant in VARIANTS {
        for (weight, share) in WEIGHTS {
            let columns = Columns::new(shape, share * radius, variant);
            let surface = columns.surface(Definition::new().with_weight(weight).with_kind(Kind::Levin));
            let queries = near_samples(&columns.points, 40, 0.3 * radius, 5);
            let e = surface.evaluate(&queries, Want::ALL);
            for (i, &x) in queries.iter().enumerate() {
                if e.gap[i].is_nan() || e.gap[i] < 0.1 {
                    continue;
                }
                let (n, h, gradient) = (e.frame_normal[i], e.support[i], e.gradient[i]);
                let Some(difference) = differences(&surface, x, n, h) else { continue };
                let Some(turning) = turning(&surface, x, n, h) else { continue };
                compared += 1;
                // The scalar reference method, at t = 0.
                let how = Project::new().with_operator(Operator::Levin { degree: None });
                let pull = surface.trace(x, &how).values[0].abs();
                let errors = [
                    length(sub(gradient, difference)) / length(gradient).max(1.0),
                    (pull - e.value[i].abs()).abs() / h,
                    largest((0..D).map(|k| length(sub(e.hessian[i][k], turning[k]))))
                        / largest((0..D).map(|k| length(e.hessian[i][k]))),
                ];
                for (j, bound) in [1e-8, 1e-12, 1e-7].into_iter().enumerate() {
                    let case = format!("{weight:?} {variant:?} query {i} {j}");
                    assert!(errors[j] <= bound, "{case}: {:e}, gap {}", errors[j], e.gap[i]);
                    worst[j] = largest([worst[j], errors[j]]);
                }
            }
        }
    }
    println!("D = {D}: {compared} compared, worst {worst:?}");
    assert!(compared > 300, "{compared}");
}

#[test]
fn on_a_noisy_torus() {
    check(&samples::torus(1.0, 0.4, 1600, 1).with_noise(0.02, 2), 0.34);
}

#[test]
fn on_a_noisy_ellipse() {
    check(&samples::ellipse(1.0, 0.6, 250, 3).with_noise(0.01, 4), 0.3);
}
