//! Hessians are the derivatives of ∇f, and curvatures of clean surfaces are nearer to the truth than degree 0's.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use super::on_torus;
use crate::common::{Columns, Variant, add, dot, length, median, near_samples, scale, sub};
use footpoint::samples::{self, Samples};
use footpoint::{Definition, NormalField, Project, Queries, Support, Surface, Want, Weight};

fn differences<const D: usize>(shape: &Samples<D>, radius: f64) {
    let (mut worst, mut compared) = (0.0_f64, 0);
    for (weight, share) in [(Weight::Poly4, 1.1), (Weight::Wendland, 1.2)] {
        for variant in [Variant::Uniform, Variant::PerSampleAndFactors] {
            for field in [NormalField::CentredCovariance, NormalField::AveragedNormals] {
                for degree in 1..=3 {
                    let columns = Columns::new(shape, share * radius, variant);
                    let definition =
                        Definition::new().with_weight(weight).with_field(field).with_degree(degree);
                    let surface = columns.surface(definition);
                    let at = near_samples(&columns.points, 5, 0.2 * radius, 4);
                    let e = surface.evaluate(&at, Want::ALL);
                    for (i, &x) in at.iter().enumerate() {
                        if !e.status[i].is_ok() || e.gap[i] < 0.1 {
                            continue;
                        }
                        let step = 1e-4 * radius;
                        let rows: [[f64; D]; D] = std::array::from_fn(|k| {
                            let side = |s: f64| {
                                let aside: [f64; D] =
                                    std::array::from_fn(|j| if j == k { s * step } else { 0.0 });
                                let e2 =
                                    surface.evaluate(&[add(x, aside)], Want::GRADIENT | Want::FRAME_NORMAL);
                                let sign = dot(e2.frame_normal[0], e.frame_normal[i]).signum();
                                scale(e2.gradient[0], sign)
                            };
                            // Of fourth order in the step.
                            let near = scale(sub(side(1.0), side(-1.0)), 2.0 / 3.0);
                            let far = scale(sub(side(2.0), side(-2.0)), 1.0 / 12.0);
                            scale(sub(near, far), 1.0 / step)
                        });
                        let size = e.hessian[i].iter().map(|&row| length(row)).fold(1.0 / radius, f64::max);
                        let error =
                            (0..D).map(|k| length(sub(rows[k], e.hessian[i][k]))).fold(0.0, f64::max) / size;
                        assert!(error < 1e-5, "{weight:?} {variant:?} {field} {degree} {i}: {error:e}");
                        worst = worst.max(error);
                        compared += 1;
                    }
                }
            }
        }
    }
    println!("D = {D}: {compared} compared, worst {worst:e}");
    assert!(compared > 80, "{compared}");
}

#[test]
fn hessians_are_differences_of_gradients() {
    differences(&samples::torus(1.0, 0.4, 1600, 1).with_noise(0.01, 2), 0.3);
    differences(&samples::ellipse(1.0, 0.6, 250, 3).with_noise(0.005, 4), 0.3);
}

#[test]
fn curvatures_of_a_clean_torus() {
    let shape = samples::torus(1.0, 0.4, 20_000, 5);
    let off = |degree: u8| {
        let definition = Definition::new()
            .with_weight(Weight::Poly4)
            .with_support(Support::Auto { effective_neighbours: 24.0 })
            .with_degree(degree);
        let surface = Surface::new(footpoint::Cloud::new(shape.points.clone()), definition).unwrap();
        let feet = surface.project(Queries::Samples, &Project::new()).point;
        let e = surface.evaluate(&feet, Want::CURVATURE | Want::SURFACE_NORMAL);
        median((0..feet.len()).map(|i| {
            let (_, n) = on_torus(feet[i]);
            let around = feet[i][0].hypot(feet[i][1]);
            let truth = 0.5 * (1.0 / 0.4 + dot(n, [feet[i][0] / around, feet[i][1] / around, 0.0]) / around);
            (e.curvature.mean[i] * dot(n, e.surface_normal[i]).signum() - truth).abs() / truth
        }))
    };
    let found = [0, 2, 3].map(off);
    println!("mean curvature off by {found:?}, medians");
    assert!(found[1] < 0.1 * found[0] && found[2] < 0.1 * found[0], "{found:?}");
}
