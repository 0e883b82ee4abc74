//! Small vectors and matrices over any lane scalar.

use crate::lane::Lane;

pub(crate) type Vector<L, const D: usize> = [L; D];
pub(crate) type Matrix<L, const D: usize> = [[L; D]; D];

/// The vector with these components. Always inlined, which the standard library's arrays of functions are not: code for a
/// processor level must not call code for another.
#[inline(always)]
pub(crate) fn each<T: Copy, const D: usize>(component: impl Fn(usize) -> T) -> [T; D] {
    let mut vector = [component(0); D];
    for k in 1..D {
        vector[k] = component(k);
    }
    vector
}

#[inline(always)]
pub(crate) fn zero<L: Lane, const D: usize>(token: L::Token) -> Vector<L, D> {
    [L::splat(token, 0.0); D]
}

#[inline(always)]
pub(crate) fn dot<L: Lane, const D: usize>(a: Vector<L, D>, b: Vector<L, D>) -> L {
    let mut sum = a[0] * b[0];
    for k in 1..D {
        sum = a[k].mul_add(b[k], sum);
    }
    sum
}

#[inline(always)]
pub(crate) fn add<L: Lane, const D: usize>(a: Vector<L, D>, b: Vector<L, D>) -> Vector<L, D> {
    each(|k| a[k] + b[k])
}

#[inline(always)]
pub(crate) fn sub<L: Lane, const D: usize>(a: Vector<L, D>, b: Vector<L, D>) -> Vector<L, D> {
    each(|k| a[k] - b[k])
}

#[inline(always)]
pub(crate) fn scale<L: Lane, const D: usize>(a: Vector<L, D>, factor: L) -> Vector<L, D> {
    each(|k| a[k] * factor)
}

/// `a + factor b`.
#[inline(always)]
pub(crate) fn add_scaled<L: Lane, const D: usize>(
    a: Vector<L, D>,
    b: Vector<L, D>,
    factor: L,
) -> Vector<L, D> {
    each(|k| b[k].mul_add(factor, a[k]))
}

/// The part of `a` that is orthogonal to the unit vector `n`.
#[inline(always)]
pub(crate) fn tangential<L: Lane, const D: usize>(a: Vector<L, D>, n: Vector<L, D>) -> Vector<L, D> {
    add_scaled(a, n, -dot(n, a))
}

/// Adds `factor v vᵀ` to the upper triangle of `m`.
#[inline(always)]
pub(crate) fn add_outer_upper<L: Lane, const D: usize>(m: &mut Matrix<L, D>, v: Vector<L, D>, factor: L) {
    for i in 0..D {
        let row = v[i] * factor;
        for j in i..D {
            m[i][j] = row.mul_add(v[j], m[i][j]);
        }
    }
}

/// The symmetric matrix whose upper triangle is given.
#[inline(always)]
pub(crate) fn mirror<L: Lane, const D: usize>(mut m: Matrix<L, D>) -> Matrix<L, D> {
    for i in 1..D {
        for j in 0..i {
            m[i][j] = m[j][i];
        }
    }
    m
}

/// Length of a vector of any size that a double can hold: no overflow, no underflow on the way.
pub(crate) fn length<const D: usize>(a: [f64; D]) -> f64 {
    let largest = a.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if largest == 0.0 || !largest.is_finite() || a.iter().any(|c| c.is_nan()) {
        return if a.iter().any(|c| c.is_nan()) { f64::NAN } else { largest };
    }
    let unit = a.map(|c| c / largest);
    largest * dot(unit, unit).sqrt()
}

/// `a / |a|`, or NaN in every component where `a` has no direction (zero, infinite or NaN).
pub(crate) fn direction<const D: usize>(a: [f64; D]) -> [f64; D] {
    let largest = a.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    if largest == 0.0 || !a.iter().all(|c| c.is_finite()) {
        return [f64::NAN; D];
    }
    let unit = a.map(|c| c / largest);
    let length = dot(unit, unit).sqrt();
    unit.map(|c| c / length)
}

/// Lexicographic order of finite vectors; zeros of either sign are equal.
pub(crate) fn compare<const D: usize>(a: [f64; D], b: [f64; D]) -> std::cmp::Ordering {
    // Adding zero turns −0 into +0.
    (0..D)
        .map(|k| (a[k] + 0.0).total_cmp(&(b[k] + 0.0)))
        .find(|order| order.is_ne())
        .unwrap_or(std::cmp::Ordering::Equal)
}

/// The exponent e with 2^e ≤ |x| < 2^(e+1), for finite x; zero has that of the smallest number.
pub(crate) fn exponent(x: f64) -> i32 {
    if x == 0.0 {
        return -1074;
    }
    let bits = ((x.to_bits() >> 52) & 0x7ff) as i32;
    if bits == 0 {
        // A denormal number: bring it into the normal range first.
        return exponent(x * 2.0_f64.powi(100)) - 100;
    }
    bits - 1023
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_survive_any_magnitude() {
        for magnitude in [1e-300, 1e-20, 1.0, 1e20, 1e300] {
            let unit = direction([3.0 * magnitude, 0.0, -4.0 * magnitude]);
            assert!((unit[0] - 0.6).abs() < 1e-15 && (unit[2] + 0.8).abs() < 1e-15, "{magnitude}");
            assert!((length([3.0 * magnitude, 4.0 * magnitude]) / magnitude - 5.0).abs() < 1e-14);
        }
        assert!(direction([0.0, 0.0])[0].is_nan());
        assert!(direction([f64::NAN, 1.0])[1].is_nan());
        assert!(length([f64::NAN, 1.0]).is_nan());
    }

    #[test]
    fn exponents_are_exact_at_powers_of_two_and_for_denormals() {
        for e in [-1070, -1022, -3, 0, 1, 52, 1023] {
            assert_eq!(exponent(2.0_f64.powi(e.max(-1022)) * 2.0_f64.powi((e + 1022).min(0))), e);
        }
        assert_eq!(exponent(-1.999), 0);
        assert_eq!(exponent(0.0), exponent(5e-324));
        assert_eq!(exponent(2.0_f64.next_down()), 0);
    }
}
