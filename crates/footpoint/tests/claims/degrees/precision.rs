//! Single precision agrees with double at every degree.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use super::angle;
use crate::common::near_samples;
use footpoint::samples;
use footpoint::{Cloud, Definition, NormalField, Precision, Support, Surface, Want};

#[test]
fn single_precision_keeps_its_bounds() {
    let shape = samples::torus(1.0, 0.4, 20_000, 1).with_noise(0.01, 2);
    let at = near_samples(&shape.points, 3000, 0.05, 3);
    // |f| over h, and the angle of ∇f: what the documentation of `Precision` promises.
    let bounds = [(0, 4e-7, 2e-5), (1, 4e-7, 2e-5), (2, 3e-6, 1e-4), (3, 1e-5, 1e-4)];
    for field in [NormalField::CentredCovariance, NormalField::AveragedNormals] {
        for (degree, value, normal) in bounds {
            let found = [Precision::Double, Precision::Single].map(|precision| {
                let definition = Definition::new()
                    .with_field(field)
                    .with_support(Support::Auto { effective_neighbours: 24.0 })
                    .with_precision(precision)
                    .with_degree(degree);
                let cloud = Cloud::new(shape.points.clone()).with_normals(shape.normals.clone()).unwrap();
                let surface = Surface::new(cloud, definition).unwrap();
                let h = surface.support().median;
                (h, surface.evaluate(&at, Want::VALUE | Want::SURFACE_NORMAL))
            });
            let [(h, double), (_, single)] = found;
            let (mut worst, mut compared) = ([0.0_f64; 2], 0);
            for i in 0..at.len() {
                if double.status[i].is_ok() && single.status[i].is_ok() {
                    compared += 1;
                    worst[0] = worst[0].max((double.value[i].abs() - single.value[i].abs()).abs() / h);
                    worst[1] = worst[1].max(angle(double.surface_normal[i], single.surface_normal[i]));
                }
            }
            println!("{field} degree {degree}: {compared} compared, worst {worst:?}");
            assert!(compared > 2900, "{compared}");
            assert!(worst[0] <= value && worst[1] <= normal, "{field} {degree}: {worst:?}");
        }
    }
}
