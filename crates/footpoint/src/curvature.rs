//! Curvature of the level set of f through a point, from ∇f and the second derivatives (SPEC § 4).

use crate::algebra::{Matrix, Vector, dot, length, scale};

/// Curvatures at one point, in units of one over those of ∇f's steps; NaN where ∇f has no direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Curvature<const D: usize> {
    /// In 2-D the curvature of the curve.
    pub(crate) mean: f64,
    /// NaN in 2-D.
    pub(crate) gaussian: f64,
    /// The larger first; in 2-D the curvature and NaN.
    pub(crate) principal: [f64; 2],
    /// Unit vectors; in 2-D the tangent and NaN.
    pub(crate) directions: [Vector<f64, D>; 2],
}

impl<const D: usize> Curvature<D> {
    pub(crate) const NOWHERE: Self =
        Self { mean: f64::NAN, gaussian: f64::NAN, principal: [f64::NAN; 2], directions: [[f64::NAN; D]; 2] };

    /// Positive where the surface bends toward −∇f. `normal` is ∇f/|∇f|.
    pub(crate) fn new(gradient: Vector<f64, D>, normal: Vector<f64, D>, hessian: Matrix<f64, D>) -> Self {
        if normal[0].is_nan() {
            return Self::NOWHERE;
        }
        let inverse = 1.0 / length(gradient);
        let [t, s] = tangents(normal);
        // The second derivatives along the surface: a 2×2 matrix there, a number along a curve.
        let along = |a: Vector<f64, D>, b: Vector<f64, D>| dot(a, hessian.map(|row| dot(row, b))) * inverse;
        if D == 2 {
            let curvature = along(t, t);
            return Self {
                mean: curvature,
                principal: [curvature, f64::NAN],
                directions: [with_sign(t), [f64::NAN; D]],
                ..Self::NOWHERE
            };
        }
        let (tt, ts, ss) = (along(t, t), along(t, s), along(s, s));
        let (mean, half) = (0.5 * tt + 0.5 * ss, 0.5 * tt - 0.5 * ss);
        let radius = half.hypot(ts);
        // The larger root's eigenvector is (half + radius, ts) or (ts, radius − half): the longer does not cancel.
        let (first, second) = if half < 0.0 { (ts, radius - half) } else { (half + radius, ts) };
        let size = first.hypot(second);
        let (cosine, sine) = if size > 0.0 { (first / size, second / size) } else { (1.0, 0.0) };
        let turned = |a: f64, b: f64| std::array::from_fn(|k| a * t[k] + b * s[k]);
        Self {
            mean,
            gaussian: tt * ss - ts * ts,
            principal: [mean + radius, mean - radius],
            directions: [with_sign(turned(cosine, sine)), with_sign(turned(-sine, cosine))],
        }
    }
}

/// An orthonormal basis across the unit vector n; in 2-D its first vector alone.
fn tangents<const D: usize>(n: Vector<f64, D>) -> [Vector<f64, D>; 2] {
    let (mut t, mut s) = ([0.0; D], [0.0; D]);
    if D == 2 {
        (t[0], t[1]) = (-n[1], n[0]);
        return [t, s];
    }
    // Without a division by zero, for either sign of the last component (Duff et al. 2017).
    let (x, y, z) = (n[0], n[1], n[D - 1]);
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    (t[0], t[1], t[D - 1]) = (1.0 + sign * x * x * a, sign * b, -sign * x);
    (s[0], s[1], s[D - 1]) = (b, sign + y * y * a, -y);
    [t, s]
}

/// Axes have no sign of their own: the component of largest magnitude is positive.
fn with_sign<const D: usize>(axis: Vector<f64, D>) -> Vector<f64, D> {
    let largest = axis.iter().fold(0.0_f64, |m, &c| if c.abs() > m.abs() { c } else { m });
    scale(axis, 1.0_f64.copysign(largest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::direction;
    use crate::samples::Random;

    #[test]
    fn a_quadric_has_the_curvatures_of_its_formulas() {
        let mut random = Random::new(3);
        for _ in 0..1000 {
            let r: [f64; 9] = std::array::from_fn(|_| random.normal());
            let (g, h) = ([r[0], r[1], r[2]], [[r[3], r[4], r[5]], [r[4], r[6], r[7]], [r[5], r[7], r[8]]]);
            let c = Curvature::new(g, direction(g), h);
            let size = length(g);
            let hg = h.map(|row| dot(row, g));
            let mean = (size * size * (h[0][0] + h[1][1] + h[2][2]) - dot(g, hg)) / (2.0 * size.powi(3));
            let adjugate = |i: usize, j: usize| {
                let (a, b) = ((i + 1) % 3, (i + 2) % 3);
                let (c, d) = ((j + 1) % 3, (j + 2) % 3);
                h[a][c] * h[b][d] - h[a][d] * h[b][c]
            };
            let gaussian = (0..3)
                .flat_map(|i| (0..3).map(move |j| (i, j)))
                .map(|(i, j)| g[i] * adjugate(i, j) * g[j])
                .sum::<f64>()
                / size.powi(4);
            let scale = 1.0 + c.principal[0].abs().max(c.principal[1].abs()).powi(2);
            assert!((c.mean - mean).abs() < 1e-12 * scale && (c.gaussian - gaussian).abs() < 1e-12 * scale);
            let [k1, k2] = c.principal;
            assert!(k1 >= k2 && (k1 * k2 - gaussian).abs() < 1e-12 * scale);
            for (k, v) in c.principal.into_iter().zip(c.directions) {
                let bent: f64 = dot(v, h.map(|row| dot(row, v))) / size;
                assert!((bent - k).abs() < 1e-12 * scale, "{bent} {k}");
                assert!(dot(v, g).abs() < 1e-14 * size && (length(v) - 1.0).abs() < 1e-14);
            }
            assert!(dot(c.directions[0], c.directions[1]).abs() < 1e-14);
        }
    }

    #[test]
    fn a_circle_has_one_over_its_radius_and_a_flat_point_has_directions() {
        // f = |x|²/2 − … at (0, 3): g = x, H = I.
        let c = Curvature::new([0.0, 3.0], [0.0, 1.0], [[1.0, 0.0], [0.0, 1.0]]);
        assert!((c.mean - 1.0 / 3.0).abs() < 1e-15 && c.gaussian.is_nan() && c.principal[1].is_nan());
        assert_eq!(c.directions[0], [1.0, 0.0]);
        let flat = Curvature::new([0.0, 0.0, -2.0], [0.0, 0.0, -1.0], [[0.0; 3]; 3]);
        assert!(flat.principal == [0.0; 2] && (length(flat.directions[1]) - 1.0).abs() < 1e-15);
        assert!(Curvature::new([0.0; 3], [f64::NAN; 3], [[1.0; 3]; 3]).mean.is_nan());
    }
}
