//! The gradient is that of f: it agrees with dual numbers through an independent brute force and with differences.
#![allow(clippy::print_stdout, clippy::unwrap_used)]

use crate::common::{
    Columns, FIELDS, VARIANTS, WEIGHTS, add, differences, dot, largest, length, near_samples, scale, sub,
};
use footpoint::samples::{self, Samples};
use footpoint::{Definition, NormalField, Want, Weight};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use num_dual::{Dual64, DualNum};

/// θ(s²) as SPEC § 1 writes it.
fn theta<T: DualNum<Primitive = f64> + Copy>(weight: Weight, s2: T) -> T {
    let one = T::from(1.0);
    match weight {
        // At s = 0 the root has no derivative, but θ has: it is 0.
        Weight::Wendland if s2.re() == 0.0 => one,
        Weight::Wendland if s2.re() < 1.0 => (one - s2.sqrt()).powi(4) * (s2.sqrt() * 4.0 + 1.0),
        Weight::Poly2 if s2.re() < 1.0 => (one - s2).powi(2),
        Weight::Poly3 if s2.re() < 1.0 => (one - s2).powi(3),
        Weight::Poly4 if s2.re() < 1.0 => (one - s2).powi(4),
        Weight::Gaussian { cut } if (-s2.re()).exp() >= cut => (-s2).exp(),
        _ => T::from(0.0),
    }
}

/// The eigenvector number `own` of a symmetric matrix in any dual arithmetic: the real pair, then one Newton step on
/// [(A − λ) n = 0, (n·n − 1)/2 = 0] with the real inverse Jacobian. That makes the first derivative exact.
fn eigenvector<T: DualNum<Primitive = f64> + Copy, const D: usize>(a: [[T; D]; D], largest: bool) -> [T; D] {
    let real = DMatrix::from_fn(D, D, |i, j| a[i][j].re());
    let pairs = SymmetricEigen::new(real.clone());
    let mut order: Vec<usize> = (0..D).collect();
    order.sort_by(|&i, &j| pairs.eigenvalues[i].total_cmp(&pairs.eigenvalues[j]));
    let own = order[if largest { D - 1 } else { 0 }];
    let (lambda, n) = (pairs.eigenvalues[own], pairs.eigenvectors.column(own).into_owned());
    let mut jacobian = DMatrix::zeros(D + 1, D + 1);
    for i in 0..D {
        for j in 0..D {
            jacobian[(i, j)] = real[(i, j)] - if i == j { lambda } else { 0.0 };
        }
        (jacobian[(i, D)], jacobian[(D, i)]) = (-n[i], n[i]);
    }
    let inverse = jacobian.try_inverse().unwrap();
    let mut residual = vec![T::from(0.0); D + 1];
    for i in 0..D {
        residual[i] = (0..D).fold(T::from(-lambda * n[i]), |sum, j| sum + a[i][j] * n[j]);
    }
    residual[D] = T::from((DVector::dot(&n, &n) - 1.0) / 2.0);
    std::array::from_fn(|i| (0..=D).fold(T::from(n[i]), |sum, j| sum - residual[j] * inverse[(i, j)]))
}

/// f(x) by its definition, over all samples, in any dual arithmetic; the sign is that of `like`.
fn brute_force<T: DualNum<Primitive = f64> + Copy, const D: usize>(
    columns: &Columns<D>,
    (weight, field, degree): (Weight, NormalField, u8),
    x: [T; D],
    like: [f64; D],
) -> T {
    let zero = T::from(0.0);
    let normals = columns.normals.as_ref().unwrap();
    let terms: Vec<([T; D], T, [f64; D])> = (0..columns.points.len())
        .map(|i| {
            let d: [T; D] = std::array::from_fn(|k| -x[k] + columns.points[i][k]);
            let h = columns.supports.as_ref().map_or(columns.radius, |s| s[i]);
            let factor = columns.factors.as_ref().map_or(1.0, |f| f[i]);
            let s2 = d.iter().fold(zero, |sum, &c| sum + c * c) / (h * h);
            (d, theta(weight, s2) * factor, normals[i])
        })
        .collect();
    let sum = terms.iter().fold(zero, |sum, t| sum + t.1);
    let u: [T; D] = std::array::from_fn(|k| terms.iter().fold(zero, |s, t| s + t.0[k] * t.1) / sum);
    let n: [T; D] = if field == NormalField::AveragedNormals {
        let total: [T; D] = std::array::from_fn(|k| terms.iter().fold(zero, |s, t| s + t.1 * t.2[k]));
        let size = total.iter().fold(zero, |s, &c| s + c * c).sqrt();
        total.map(|c| c / size)
    } else {
        let mut matrix = [[zero; D]; D];
        for &(d, theta, normal) in &terms {
            let v: [T; D] = match field {
                NormalField::Covariance => d,
                NormalField::CentredCovariance => std::array::from_fn(|k| d[k] - u[k]),
                _ => normal.map(T::from),
            };
            for i in 0..D {
                for j in 0..D {
                    matrix[i][j] += v[i] * v[j] * theta;
                }
            }
        }
        eigenvector(matrix, field == NormalField::AveragedAxes)
    };
    let sign = if (0..D).map(|k| n[k].re() * like[k]).sum::<f64>() < 0.0 { 1.0 } else { -1.0 };
    if degree > 0 {
        return constant_of_fit(&terms, n, degree, columns.radius) * sign;
    }
    (0..D).fold(zero, |s, k| s + n[k] * u[k]) * sign
}

/// The value at x of the polynomial that fits the heights over the plane across n (SPEC § 12), by normal equations: the
/// real solution, then one Newton step with the real inverse, which makes the first derivative exact.
fn constant_of_fit<T: DualNum<Primitive = f64> + Copy, const D: usize>(
    terms: &[([T; D], T, [f64; D])],
    n: [T; D],
    degree: u8,
    unit: f64,
) -> T {
    let zero = T::from(0.0);
    let inner = |a: [T; D], b: [T; D]| (0..D).fold(zero, |sum, k| sum + a[k] * b[k]);
    // Axes from those of space, by Gram and Schmidt; the fit does not depend on them.
    let mut axes: Vec<[T; D]> = Vec::new();
    let mut spare: Vec<usize> = (0..D).collect();
    spare.sort_by(|&i, &j| n[i].re().abs().total_cmp(&n[j].re().abs()));
    for &k in &spare[..D - 1] {
        let mut axis: [T; D] = std::array::from_fn(|j| T::from(f64::from(u8::from(j == k))));
        for other in [n].iter().chain(&axes) {
            let along = inner(axis, *other);
            axis = std::array::from_fn(|j| axis[j] - other[j] * along);
        }
        let size = inner(axis, axis).sqrt();
        axes.push(axis.map(|c| c / size));
    }
    let row = |d: [T; D]| -> Vec<T> {
        let s: Vec<T> = axes.iter().map(|&axis| inner(axis, d) / unit).collect();
        let power = |c: T, exponent: u8| (0..exponent).fold(T::from(1.0), |product, _| product * c);
        let mut row = Vec::new();
        for total in 0..=degree {
            for second in 0..=(if D == 2 { 0 } else { total }) {
                let other = if D == 2 { T::from(1.0) } else { power(s[1], second) };
                row.push(power(s[0], total - second) * other);
            }
        }
        row
    };
    let size = row(terms[0].0).len();
    let (mut a, mut b) = (vec![vec![zero; size]; size], vec![zero; size]);
    for &(d, theta, _) in terms.iter().filter(|t| t.1.re() > 0.0) {
        let (row, height) = (row(d), inner(n, d));
        for i in 0..size {
            b[i] += row[i] * theta * height;
            for j in 0..size {
                a[i][j] += row[i] * row[j] * theta;
            }
        }
    }
    let inverse = DMatrix::from_fn(size, size, |i, j| a[i][j].re()).try_inverse().unwrap();
    let solution: Vec<f64> =
        (0..size).map(|i| (0..size).map(|j| inverse[(i, j)] * b[j].re()).sum()).collect();
    (0..size).fold(T::from(solution[0]), |c, i| {
        let left = (0..size).fold(b[i], |left, j| left - a[i][j] * solution[j]);
        c + left * inverse[(0, i)]
    })
}

/// Every field, and every degree where it has one.
fn settings() -> impl Iterator<Item = (NormalField, u8)> {
    let degrees = |field| (1..=3).map(move |degree| (field, degree));
    let fields = FIELDS.into_iter().map(|field| (field, 0));
    fields.chain(degrees(NormalField::CentredCovariance)).chain(degrees(NormalField::AveragedNormals))
}

/// Largest errors of all settings: against dual numbers, value against brute force, against differences.
fn check<const D: usize>(shape: &Samples<D>, radius: f64) {
    let mut worst = [0.0_f64; 3];
    let (mut compared, mut differenced, mut by_degree) = (0, 0, [0; 4]);
    for variant in VARIANTS {
        for (weight, share) in WEIGHTS {
            for (field, degree) in settings() {
                let columns = Columns::new(shape, share * radius, variant);
                let definition = Definition::new().with_weight(weight).with_field(field).with_degree(degree);
                let surface = columns.surface(definition);
                let queries = if degree == 0 { 14 } else { 5 };
                let mut queries = near_samples(&columns.points, queries, 0.3 * radius, 5);
                // r = 0: exactly at samples.
                queries.extend(&columns.points[..4]);
                let e = surface.evaluate(&queries, Want::ALL);
                for (i, &x) in queries.iter().enumerate() {
                    if e.gap[i].is_nan() || e.gap[i] < 0.1 || !e.status[i].is_ok() {
                        continue;
                    }
                    compared += 1;
                    by_degree[usize::from(degree)] += 1;
                    let (n, h) = (e.frame_normal[i], e.support[i]);
                    let mut error = [0.0; 3];
                    let size = length(e.gradient[i]).max(1.0);
                    let dual: [f64; D] = std::array::from_fn(|k| {
                        let x = std::array::from_fn(|j| Dual64::new(x[j], f64::from(u8::from(j == k))));
                        brute_force(&columns, (weight, field, degree), x, n).eps
                    });
                    error[0] = length(sub(e.gradient[i], dual)) / size;
                    error[1] = (e.value[i] - brute_force(&columns, (weight, field, degree), x, n)).abs() / h;
                    if let Some(difference) = differences(&surface, x, n, h) {
                        differenced += 1;
                        error[2] = length(sub(e.gradient[i], difference)) / size;
                    }
                    let bounds = if degree == 0 { [1e-11, 1e-13, 1e-8] } else { [1e-11, 1e-12, 1e-8] };
                    for j in 0..3 {
                        let what = ["dual numbers", "value", "differences"][j];
                        let case = format!("{what}: {weight:?} {field:?} {degree} {variant:?} query {i}");
                        assert!(error[j] <= bounds[j], "{case}: {:e}, gap {}", error[j], e.gap[i]);
                        worst[j] = largest([worst[j], error[j]]);
                    }
                }
            }
        }
    }
    println!("D = {D}: {by_degree:?} compared by degree, {differenced} by differences, worst {worst:?}");
    assert!(by_degree.iter().all(|&count| count > 200), "{by_degree:?}");
    assert!(compared > 1000 && differenced > 500, "{compared} {differenced}");
}

#[test]
fn on_a_noisy_torus() {
    let shape = samples::torus(1.0, 0.4, 1600, 1);
    check(&shape.with_noise(0.02, 2), 0.34);
}

#[test]
fn on_a_noisy_ellipse() {
    check(&samples::ellipse(1.0, 0.6, 250, 3).with_noise(0.01, 4), 0.3);
}

#[test]
fn on_a_noisy_sphere_at_survey_offsets_far_from_the_origin() {
    // Exact differences of exact multiples: the brute force sees the same cloud.
    let mut shape = samples::sphere(1.0, 900, 5).with_noise(0.02, 6);
    for p in &mut shape.points {
        *p = p.map(|c| (c * 2.0_f64.powi(20)).round() / 2.0_f64.powi(20));
    }
    let moved: Vec<[f64; 3]> = shape.points.iter().map(|&p| add(p, [4.5e5, 5.3e6, 100.0])).collect();
    let near = Columns::new(&shape, 0.4, VARIANTS[0]);
    let far = Columns { points: moved, ..near.clone() };
    for field in FIELDS {
        let queries = &near.points[..200];
        let there: Vec<[f64; 3]> = queries.iter().map(|&p| add(p, [4.5e5, 5.3e6, 100.0])).collect();
        let a = near.field(field).evaluate(queries, Want::ALL);
        let b = far.field(field).evaluate(&there, Want::ALL);
        for i in 0..queries.len() {
            let sign = dot(a.frame_normal[i], b.frame_normal[i]).signum();
            let error = length(sub(a.gradient[i], scale(b.gradient[i], sign)));
            assert!(error <= 1e-11 * length(a.gradient[i]).max(1.0), "{field:?} {i}: {error:e}");
        }
    }
}
