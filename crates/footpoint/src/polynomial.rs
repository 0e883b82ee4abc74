//! Polynomials over a tangent plane: one coordinate for curves, two for surfaces; the order of their monomials.
//!
//! Monomials stand by degree, and within a degree by falling power of the first coordinate: 1, s, t, s², st, t², …
//! Loops over them run between constants and are unrolled, which turns the tables here into nothing.

use crate::algebra::{Vector, dot, each};
use crate::lane::Lane;

/// The highest degree of a fit.
pub(crate) const HIGHEST: usize = 3;
/// Its monomials on a surface.
pub(crate) const MONOMIALS: usize = 10;
/// Those of a product of two.
pub(crate) const PRODUCTS: usize = 28;

/// How many monomials have at most this degree.
#[inline(always)]
pub(crate) const fn monomials<const D: usize>(degree: usize) -> usize {
    if D == 2 { degree + 1 } else { (degree + 1) * (degree + 2) / 2 }
}

/// Exponents of both coordinates.
const fn exponents<const D: usize>(place: usize) -> [usize; 2] {
    let (mut before, mut degree) = (0, 0);
    if D == 2 {
        return [place, 0];
    }
    while before + degree < place {
        before += degree + 1;
        degree += 1;
    }
    [degree - (place - before), place - before]
}

const fn place<const D: usize>([first, second]: [usize; 2]) -> usize {
    if D == 2 { first } else { (first + second) * (first + second + 1) / 2 + second }
}

/// How monomials follow from each other, for D − 1 coordinates: constants, as `const { &Table::new::<D>() }`.
pub(crate) struct Table {
    /// Which other times which coordinate a monomial is.
    parent: [(usize, usize); PRODUCTS],
    /// Derivatives along each coordinate: the factor, and where what is left stands.
    derivative: [[(f64, usize); PRODUCTS]; 2],
    /// Where the product of two monomials stands.
    pub(crate) product: [[usize; MONOMIALS]; MONOMIALS],
}

impl Table {
    pub(crate) const fn new<const D: usize>() -> Self {
        let mut table = Self {
            parent: [(0, 0); PRODUCTS],
            derivative: [[(0.0, 0); PRODUCTS]; 2],
            product: [[0; MONOMIALS]; MONOMIALS],
        };
        let mut i = 0;
        while i < PRODUCTS {
            let mut axis = 2;
            while axis > 0 {
                axis -= 1;
                let mut left = exponents::<D>(i);
                let factor = left[axis];
                if factor > 0 {
                    left[axis] -= 1;
                    table.derivative[axis][i] = (factor as f64, place::<D>(left));
                    table.parent[i] = (place::<D>(left), axis);
                }
            }
            i += 1;
        }
        let mut i = 0;
        while i < MONOMIALS * MONOMIALS {
            let ([a, b], [c, d]) = (exponents::<D>(i / MONOMIALS), exponents::<D>(i % MONOMIALS));
            table.product[i / MONOMIALS][i % MONOMIALS] = place::<D>([a + c, b + d]);
            i += 1;
        }
        table
    }
}

/// All monomials of at most this degree, times `first`; what is beyond them is not read.
#[inline(always)]
pub(crate) fn powers<L: Lane, const D: usize, const N: usize>(
    first: L,
    coordinates: [L; 2],
    degree: usize,
) -> [L; N] {
    let table = const { &Table::new::<D>() };
    let count = monomials::<D>(degree);
    let mut powers = [first; N];
    // Written out: the compiler leaves so long a loop as it is, with its table.
    macro_rules! steps {
        ($($i:literal)*) => {
            $(if $i < count {
                let (parent, axis) = table.parent[$i];
                powers[$i] = powers[parent] * coordinates[axis];
            })*
        };
    }
    steps!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27);
    powers
}

/// The value of a polynomial of at most this degree.
#[inline(always)]
pub(crate) fn value<L: Lane, const D: usize>(
    coefficients: &[L; MONOMIALS],
    powers: &[L; MONOMIALS],
    degree: usize,
) -> L {
    let mut sum = coefficients[0];
    for i in 1..monomials::<D>(degree) {
        sum = coefficients[i].mul_add(powers[i], sum);
    }
    sum
}

/// Its derivative along a coordinate, of any length of the two columns: `powers` may be moments.
#[inline(always)]
pub(crate) fn slope<L: Lane, const D: usize>(
    coefficients: &[L],
    powers: &[L],
    (axis, degree): (usize, usize),
) -> L {
    let table = const { &Table::new::<D>() };
    let mut sum = powers[0].like(0.0);
    for i in 1..monomials::<D>(degree) {
        let (factor, left) = table.derivative[axis][i];
        if factor > 0.0 {
            sum = (coefficients[i] * sum.like(factor)).mul_add(powers[left], sum);
        }
    }
    sum
}

/// Coordinates over the plane through a position: along it in units of the support, and the height along the normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane<L, const D: usize> {
    pub(crate) normal: Vector<L, D>,
    /// Unit vectors across the normal and each other, over the support; the second is not used on curves.
    pub(crate) along: [Vector<L, D>; 2],
}

impl<L: Copy, const D: usize> Plane<L, D> {
    #[inline(always)]
    pub(crate) fn map<M: Copy>(self, f: impl Fn(L) -> M + Copy) -> Plane<M, D> {
        Plane { normal: each(|k| f(self.normal[k])), along: each(|a| each(|k| f(self.along[a][k]))) }
    }
}

impl<L: Lane, const D: usize> Plane<L, D> {
    /// The plane across this normal. Which of the axes across it are taken makes no difference to what is computed; these turn
    /// smoothly wherever the last component of the normal keeps its sign.
    #[inline(always)]
    pub(crate) fn new(normal: Vector<L, D>, support: L) -> Self {
        let zero = support.like(0.0);
        let inverse = support.like(1.0) / support;
        let mut along = [[zero; D]; 2];
        if D == 2 {
            along[0][0] = -normal[1] * inverse;
            along[0][1] = normal[0] * inverse;
        } else {
            // Duff et al., "Building an orthonormal basis, revisited", 2017.
            let [x, y, z] = [normal[0], normal[1], normal[2]];
            let sign = L::select(z.less(zero), zero.like(-1.0), zero.like(1.0));
            let a = zero.like(-1.0) / (sign + z);
            let b = x * y * a;
            along[0][0] = (sign * x * x).mul_add(a, zero.like(1.0)) * inverse;
            along[0][1] = sign * b * inverse;
            along[0][2] = -sign * x * inverse;
            along[1][0] = b * inverse;
            along[1][1] = (y * y).mul_add(a, sign) * inverse;
            along[1][2] = -y * inverse;
        }
        Self { normal, along }
    }

    #[inline(always)]
    pub(crate) fn coordinates(&self, d: Vector<L, D>) -> ([L; 2], L) {
        let second = if D == 2 { self.normal[0] } else { dot(self.along[1], d) };
        ([dot(self.along[0], d), second], dot(self.normal, d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_monomial_stands_in_its_place() {
        for i in 0..PRODUCTS {
            assert_eq!((place::<3>(exponents::<3>(i)), place::<2>(exponents::<2>(i))), (i, i));
        }
        assert_eq!(exponents::<3>(7), [2, 1]);
        let (surface, curve) = (Table::new::<3>().product, Table::new::<2>().product);
        assert_eq!((surface[1][2], surface[9][9], curve[3][3]), (4, 27, 6));
    }

    #[test]
    fn values_and_slopes_are_those_of_the_polynomial() {
        let c: [f64; MONOMIALS] = std::array::from_fn(|i| 1.0 + i as f64);
        let [s, t] = [0.3, -0.7];
        let powers = powers::<f64, 3, MONOMIALS>(1.0, [s, t], 3);
        let expected = 1.0
            + 2.0 * s
            + 3.0 * t
            + 4.0 * s * s
            + 5.0 * s * t
            + 6.0 * t * t
            + 7.0 * s * s * s
            + 8.0 * s * s * t
            + 9.0 * s * t * t
            + 10.0 * t * t * t;
        assert!((value::<f64, 3>(&c, &powers, 3) - expected).abs() < 1e-14);
        let along_t = 3.0 + 5.0 * s + 12.0 * t + 8.0 * s * s + 18.0 * s * t + 30.0 * t * t;
        assert!((slope::<f64, 3>(&c, &powers, (1, 3)) - along_t).abs() < 1e-14);
    }

    #[test]
    fn planes_are_across_their_normals() {
        for normal in [[0.6, 0.0, 0.8], [0.0, 0.0, -1.0], [0.48, -0.6, -0.64]] {
            let Plane { along: [a, b], .. } = Plane::new(normal, 2.0);
            for (product, expected) in [
                (dot(a, normal), 0.0),
                (dot(b, normal), 0.0),
                (dot(a, b), 0.0),
                (dot(a, a), 0.25),
                (dot(b, b), 0.25),
            ] {
                assert!((product - expected).abs() < 1e-15, "{normal:?}");
            }
        }
    }
}
