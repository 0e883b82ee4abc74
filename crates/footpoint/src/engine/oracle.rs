//! The oracle: every sum over all samples, every derivative as SPEC § 4 writes it, nothing clever.

use crate::algebra::{Matrix, add, dot, length, scale, sub};
use crate::eigen::eigen;
use crate::field::NormalField;
use crate::weight::{Kernel, Weight, with_kernel};

/// f, n and ∇f at one point, up to one common sign.
pub(crate) struct Answer<const D: usize> {
    pub(crate) value: f64,
    pub(crate) normal: [f64; D],
    pub(crate) gradient: [f64; D],
    pub(crate) average: [f64; D],
}

/// A sample: point, normal, support, factor.
pub(crate) type Sample<const D: usize> = ([f64; D], [f64; D], f64, f64);

pub(crate) fn evaluate<const D: usize>(
    samples: &[Sample<D>],
    weight: Weight,
    field: NormalField,
    x: [f64; D],
) -> Answer<D> {
    let weights = |r2: f64, h: f64, factor: f64| with_kernel!(weight, k => (factor * k.theta(k.closeness(r2 / (h * h))), factor * k.psi(k.closeness(r2 / (h * h))) / (h * h)));
    let outer = |a: [f64; D], b: [f64; D]| -> Matrix<f64, D> { a.map(|ai| b.map(|bj| ai * bj)) };
    let plus = |m: &mut Matrix<f64, D>, o: Matrix<f64, D>, s: f64| {
        (0..D).for_each(|i| (0..D).for_each(|j| m[i][j] += s * o[i][j]));
    };
    let (mut s, mut m, mut nv) = (0.0, [0.0; D], [0.0; D]);
    for &(p, normal, h, factor) in samples {
        let d = sub(p, x);
        let (theta, _) = weights(dot(d, d), h, factor);
        s += theta;
        m = add(m, scale(d, theta));
        nv = add(nv, scale(normal, theta));
    }
    let u = scale(m, 1.0 / s);
    // What the frame is fitted to: d, e = d − u, or n_i.
    let vector = |d: [f64; D], normal: [f64; D]| match field {
        NormalField::Covariance => d,
        NormalField::CentredCovariance => sub(d, u),
        NormalField::AveragedNormals | NormalField::AveragedAxes => normal,
    };
    let (mut matrix, mut ds, mut dm) = ([[0.0; D]; D], [0.0; D], [[0.0; D]; D]);
    let (mut dmatrix, mut dnv) = ([[[0.0; D]; D]; D], [[0.0; D]; D]);
    for &(p, normal, h, factor) in samples {
        let d = sub(p, x);
        let v = vector(d, normal);
        let (theta, psi) = weights(dot(d, d), h, factor);
        plus(&mut matrix, outer(v, v), theta);
        for k in 0..D {
            ds[k] -= psi * d[k];
            dm[k] = add(dm[k], scale(d, -psi * d[k]));
            dnv[k] = add(dnv[k], scale(normal, -psi * d[k]));
            plus(&mut dmatrix[k], outer(v, v), -psi * d[k]);
        }
    }
    for k in 0..D {
        dm[k][k] -= s;
        if field == NormalField::Covariance {
            let e: [f64; D] = std::array::from_fn(|i| f64::from(u8::from(i == k)));
            plus(&mut dmatrix[k], outer(e, m), -1.0);
            plus(&mut dmatrix[k], outer(m, e), -1.0);
        }
    }
    let pairs = eigen(matrix);
    let own = if field == NormalField::AveragedAxes { D - 1 } else { 0 };
    let n = match field {
        NormalField::AveragedNormals => scale(nv, 1.0 / length(nv)),
        _ => pairs.vectors[own],
    };
    let gradient = std::array::from_fn(|k| {
        let dn = if field == NormalField::AveragedNormals {
            scale(sub(dnv[k], scale(n, dot(n, dnv[k]))), 1.0 / length(nv))
        } else {
            let turned: [f64; D] = dmatrix[k].map(|row| dot(row, n));
            (0..D).filter(|&j| j != own).fold([0.0; D], |sum, j| {
                let v = pairs.vectors[j];
                sub(sum, scale(v, dot(v, turned) / (pairs.values[j] - pairs.values[own])))
            })
        };
        let du = scale(sub(dm[k], scale(u, ds[k])), 1.0 / s);
        -dot(dn, u) - dot(n, du)
    });
    Answer { value: -dot(n, u), normal: n, gradient, average: add(x, u) }
}

/// f_L, n and ∇f_L of Levin's surface as SPEC § 7 writes them, with the whole of J.
pub(crate) fn levin<const D: usize>(samples: &[Sample<D>], weight: Weight, x: [f64; D]) -> Answer<D> {
    let terms: Vec<([f64; D], [f64; 3])> = samples
        .iter()
        .map(|&(p, _, h, factor)| {
            let d = sub(p, x);
            let weights = with_kernel!(weight, k => {
                let closeness = k.closeness(dot(d, d) / (h * h));
                [k.theta(closeness), k.psi(closeness) / (h * h), k.chi(closeness) / (h * h * h * h)]
            });
            (d, weights.map(|w| factor * w))
        })
        .collect();
    let (mut s, mut m, mut psi_sum, mut w) = (0.0, [0.0; D], [0.0; D], [[0.0; D]; D]);
    for &(d, [theta, psi, _]) in &terms {
        s += theta;
        m = add(m, scale(d, theta));
        psi_sum = add(psi_sum, scale(d, psi));
        w = std::array::from_fn(|i| add(w[i], scale(d, theta * d[i])));
    }
    let pairs = eigen(w);
    let n = pairs.vectors[0];
    let (mut g, mut g_gradient, mut squares, mut cubes) = (0.0, scale(n, -s), 0.0, [0.0; D]);
    // (∂W/∂x_k) n, a row for each k.
    let mut turned: Matrix<f64, D> = std::array::from_fn(|k| scale(m, -n[k]));
    for &(d, [theta, psi, chi]) in &terms {
        let z = dot(n, d);
        g += theta * z + 0.5 * psi * z * z * z;
        squares += psi * z * z;
        cubes = add(cubes, scale(d, psi * z * z));
        g_gradient = sub(g_gradient, scale(d, psi * z + 0.5 * chi * z * z * z));
        turned = std::array::from_fn(|k| sub(turned[k], scale(d, psi * d[k] * z)));
    }
    for k in 0..D {
        turned[k][k] -= dot(m, n);
    }
    g_gradient = sub(g_gradient, scale(n, 1.5 * squares));
    let across = add(m, scale(cubes, 1.5));
    for k in 0..D {
        let dn = (1..D).fold([0.0; D], |total, j| {
            let v = pairs.vectors[j];
            sub(total, scale(v, dot(v, turned[k]) / (pairs.values[j] - pairs.values[0])))
        });
        g_gradient[k] += dot(dn, across);
    }
    let value = -g / s;
    let gradient = sub(scale(psi_sum, value / s), scale(g_gradient, 1.0 / s));
    Answer { value, normal: n, gradient, average: add(x, scale(m, 1.0 / s)) }
}
