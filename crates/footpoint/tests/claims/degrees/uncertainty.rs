//! Noise is estimated and propagated at every degree, and higher ones have no bias to report.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use super::on_torus;
use crate::common::{dot, length, sub};
use footpoint::samples;
use footpoint::{Cloud, Definition, NormalField, Queries, Support, Surface, Uncertainty};

#[test]
fn distances_have_their_sigma_and_no_bias() {
    let count = 20_000;
    let shape = samples::torus(1.0, 0.4, count, 1);
    for field in [NormalField::CentredCovariance, NormalField::AveragedNormals] {
        for degree in [2, 3] {
            let h = 0.14;
            let noise = 0.1 * h;
            let noisy = shape.clone().with_noise(noise, 2);
            let cloud = Cloud::new(noisy.points).with_normals(shape.normals.clone()).unwrap();
            let definition =
                Definition::new().with_field(field).with_support(Support::Uniform(h)).with_degree(degree);
            let surface = Surface::new(cloud, definition).unwrap();
            let estimate = surface.estimate_noise().sigma;
            let surface = surface.with_uniform_noise(noise).unwrap();
            let found = surface.uncertainty(Queries::Points(&shape.points), &Uncertainty::new()).unwrap();
            // True points, which no noise moved: what their distances scatter by is the surface's error.
            let ok: Vec<usize> = (0..count).filter(|&i| found.feet.status[i].is_ok()).collect();
            let mean = |of: &dyn Fn(usize) -> f64| ok.iter().map(|&i| of(i)).sum::<f64>() / ok.len() as f64;
            let scatter = mean(&|i| {
                let (foot, normal) = on_torus(found.feet.point[i]);
                dot(sub(found.feet.point[i], foot), normal).powi(2)
            });
            let expected = mean(&|i| found.sigma[i].powi(2));
            let ratio = (scatter / expected).sqrt();
            println!("{field} degree {degree}: estimate {:.3}, scatter {ratio:.3} of σ", estimate / noise);
            assert!((estimate / noise - 1.0).abs() < 0.1, "{estimate} {noise}");
            assert!((0.85..1.15).contains(&ratio), "{field} {degree}: {ratio}");
            assert!(ok.iter().all(|&i| found.bias[i] == 0.0));
            let largest =
                ok.iter().fold(0.0_f64, |m, &i| m.max(length(sub(found.feet.point[i], shape.points[i]))));
            assert!(largest < h);
        }
    }
}
