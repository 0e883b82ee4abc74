//! A vase with a formula: where its surface is, which way it faces, how far a point is from it.
//!
//! The surface is star-shaped about the origin: |x| = R(x/|x|), cut off above by a level plane.
//! R is built from smooth functions of the direction's Cartesian components, never of longitude
//! and latitude, so the surface is analytic at the poles too.

/// Mean radius of the vase, in metres.
const SIZE: f64 = 0.2;
/// Height of the plane that cuts the vase open, in metres above the origin.
const RIM: f64 = 0.185;

/// The outline without the lip: coefficients of 1, z, z², z³ of the direction's height z. Heights and
/// depths here and below are shares of [`SIZE`].
const OUTLINE: [f64; 4] = [1.0, -0.15, -0.45, -0.35];
/// The widening above the neck: a band about the north pole, where the surface is cut away.
const LIP: Band = Band { centre: 1.0, width: 0.3 };
const LIP_HEIGHT: f64 = 1.9;

/// Twisted lobes, and the rounding of the creases between them (0 would be sharp).
const LOBES: Spiral = Spiral { count: 10, turn: 8.0 };
const LOBE_DEPTH: f64 = 0.08;
const LOBE_ROUNDING: f64 = 0.12;

/// Fine ripples that wind the other way across the lobes, strongest on the belly.
const RIPPLES: Spiral = Spiral { count: 14, turn: -32.0 };
const RIPPLE_HEIGHT: f64 = 0.0048;
const RIPPLE_BAND: Band = Band { centre: -0.05, width: 0.65 };

/// Distance from the axis, on the unit sphere, below which lobes and ripples fade out.
const FADE: f64 = 0.21;

/// Gentle dents that spare the vase a perfect symmetry: height, frequency and phase of
/// `sin(frequency . u + phase)`.
const DENTS: [(f64, [f64; 3], f64); 2] = [(0.012, [3.1, 1.7, 2.3], 0.4), (0.010, [-2.2, 4.1, -1.9], 1.1)];

/// Directions used to bound the surface's slope and radius.
const BOUND_SAMPLES: u32 = 20_000;

/// An open vase of known shape: the exact surface that a simulated scan is compared with.
///
/// One smooth sheet without thickness, about 0.4 m across and high (all lengths in metres): ten twisted
/// lobes, ripples across them a millimetre high, a neck, a lip. Only the part below
/// [`Vessel::rim_height`] exists for the scanner; distances refer to the surface before the cut.
#[derive(Debug, Clone)]
pub struct Vessel {
    /// No point of the cut surface is further than this from the origin.
    reach: f64,
    /// Bound of the gradient of the gauge, 1/metre: what makes marching along a ray safe.
    steepest: f64,
}

/// Where a ray first meets the vase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in metres.
    pub range: f64,
    /// The point of the surface, in metres.
    pub point: [f64; 3],
    /// Outward unit normal of the surface there, whichever side was hit.
    pub normal: [f64; 3],
}

impl Default for Vessel {
    fn default() -> Self {
        Self::new()
    }
}

impl Vessel {
    /// The vase. Costs a few milliseconds, which go into bounding its size and slope.
    pub fn new() -> Self {
        let (mut reach, mut steepest) = (0.0_f64, 0.0_f64);
        for k in 0..BOUND_SAMPLES {
            let u = spread(k, BOUND_SAMPLES);
            let r = radius(u).0;
            if r * u[2] <= RIM {
                reach = reach.max(r);
            }
            steepest = steepest.max(norm(gauge(u).1));
        }
        // The samples lie several times closer than the finest detail is wide; the margins cover the rest.
        Self { reach: 1.02 * reach, steepest: 1.05 * steepest }
    }

    /// Height of the open rim in metres: the vase is the part of its surface with `z` not above it.
    pub fn rim_height(&self) -> f64 {
        RIM
    }

    /// Radius in metres of a ball about the origin that holds the whole vase.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Signed distance of `x` from the surface before the cut (positive outside), the foot point of
    /// `x` on it, and the outward unit normal there; in metres.
    ///
    /// Newton's method, to rounding error. The foot point is the nearest point when `x` is within 0.01 m
    /// of the surface; further off it may be the nearest of its neighbourhood only.
    pub fn distance(&self, x: [f64; 3]) -> (f64, [f64; 3], [f64; 3]) {
        let mut foot = land(x);
        let mut normal = unit(gauge(foot).1);
        for _ in 0..60 {
            let off = sub(x, foot);
            let step = tangential_step(foot, normal, off);
            // Halve the step while it leads away by more than rounding; Newton's own almost always passes.
            let leads_away = |next| norm(sub(x, next)) > norm(off) + 1e-15 * SIZE;
            let mut share = 1.0;
            while share > 1e-3 && leads_away(land(add(foot, step, share))) {
                share *= 0.5;
            }
            foot = land(add(foot, step, share));
            normal = unit(gauge(foot).1);
            if norm(step) < 1e-14 * SIZE {
                break;
            }
        }
        (dot(sub(x, foot), normal), foot, normal)
    }

    /// First point where the ray from `origin` along the unit vector `direction` meets the vase, from
    /// outside or, through the opening, from inside.
    pub fn first_hit(&self, origin: [f64; 3], direction: [f64; 3]) -> Option<Hit> {
        // A step this short can only jump over a graze shallower than step² / (8 x radius of curvature),
        // less than a micrometre.
        let shortest = 1e-3 * SIZE;
        let (mut near, end) = self.span(origin, direction)?;
        let mut near_value = gauge_value(add(origin, direction, near)) - 1.0;
        while near < end {
            // The gauge cannot reach 1 within this step, unless the step is the shortest one.
            let far = (near + (near_value.abs() / self.steepest).max(shortest)).min(end);
            let far_value = gauge_value(add(origin, direction, far)) - 1.0;
            if (near_value > 0.0) != (far_value > 0.0) {
                let range = crossing(origin, direction, near, far, near_value > 0.0);
                let point = add(origin, direction, range);
                return Some(Hit { range, point, normal: unit(gauge(point).1) });
            }
            (near, near_value) = (far, far_value);
        }
        None
    }

    /// The piece of the ray inside the ball that holds the vase and below the rim.
    fn span(&self, origin: [f64; 3], direction: [f64; 3]) -> Option<(f64, f64)> {
        let middle = -dot(origin, direction);
        let half_squared = self.reach * self.reach + middle * middle - dot(origin, origin);
        if half_squared <= 0.0 {
            return None;
        }
        let half = half_squared.sqrt();
        let (mut start, mut end) = ((middle - half).max(0.0), middle + half);
        let climb = direction[2];
        let room = RIM - origin[2];
        if climb > 0.0 {
            end = end.min(room / climb);
        } else if climb < 0.0 {
            start = start.max(room / climb);
        } else if room < 0.0 {
            return None;
        }
        (start < end).then_some((start, end))
    }
}

/// The range between `near` and `far` where the ray crosses the surface: Newton's method, kept inside the
/// bracket by bisection.
fn crossing(origin: [f64; 3], direction: [f64; 3], near: f64, far: f64, near_outside: bool) -> f64 {
    let (mut low, mut high) = (near, far);
    let mut range = 0.5 * (low + high);
    for _ in 0..60 {
        let (value, gradient) = gauge(add(origin, direction, range));
        if (value > 1.0) == near_outside {
            low = range;
        } else {
            high = range;
        }
        let newton = range - (value - 1.0) / dot(gradient, direction);
        // Where the slope is zero, `newton` is no number and fails this comparison as well.
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        let step = (next - range).abs();
        range = next;
        if step <= 2.0 * f64::EPSILON * range {
            break;
        }
    }
    range
}

/// Newton's step towards the foot point of `foot + off`, along the tangent plane at `foot`.
fn tangential_step(foot: [f64; 3], normal: [f64; 3], off: [f64; 3]) -> [f64; 3] {
    let height = dot(off, normal);
    let axis = if normal[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let first = unit(cross(normal, axis));
    let second = cross(normal, first);
    // The curvature by differences of exact normals: it steers the steps only; where they end depends on
    // the exact gradient alone.
    let h = 1e-5 * SIZE;
    let bend = |t: [f64; 3]| {
        let ahead = unit(gauge(add(foot, t, h)).1);
        let behind = unit(gauge(add(foot, t, -h)).1);
        let turn = sub(ahead, behind);
        [dot(turn, first) / (2.0 * h), dot(turn, second) / (2.0 * h)]
    };
    let (p, q) = (bend(first), bend(second));
    let (a, b, c) = (1.0 + height * p[0], 0.5 * height * (p[1] + q[0]), 1.0 + height * q[1]);
    let rest = [dot(off, first), dot(off, second)];
    let det = a * c - b * b;
    // Beyond the centre of curvature Newton's step leads to a farthest point; the plain one still descends.
    let [s, t] = if a > 0.0 && det > 1e-6 {
        [(c * rest[0] - b * rest[1]) / det, (a * rest[1] - b * rest[0]) / det]
    } else {
        rest
    };
    let step = add(scale(first, s), second, t);
    scale(step, (0.25 * SIZE / norm(step).max(f64::MIN_POSITIVE)).min(1.0))
}

/// The point of the surface in the direction of `x`.
fn land(x: [f64; 3]) -> [f64; 3] {
    let u = unit(x);
    scale(u, radius(u).0)
}

/// The `k`-th of `count` unit vectors spread evenly over the sphere, on a spiral of the golden angle.
fn spread(k: u32, count: u32) -> [f64; 3] {
    let z = 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count);
    let (sin, cos) = (2.399_963_229_728_653 * f64::from(k)).sin_cos();
    let s = (1.0 - z * z).sqrt();
    [s * cos, s * sin, z]
}

/// The gauge |x| / R(x/|x|), which is 1 on the surface, less inside, more outside; and its gradient.
///
/// It grows in proportion along every ray from the origin, so one bound on its slope holds everywhere.
#[inline(always)]
fn gauge(x: [f64; 3]) -> (f64, [f64; 3]) {
    let length = norm(x).max(f64::MIN_POSITIVE);
    let u = scale(x, 1.0 / length);
    let (r, gradient) = radius(u);
    let tangential = add(gradient, u, -dot(gradient, u));
    (length / r, scale(add(u, tangential, -1.0 / r), 1.0 / r))
}

/// The gauge alone; inlining lets the compiler drop the gradient.
pub(super) fn gauge_value(x: [f64; 3]) -> f64 {
    gauge(x).0
}

/// R(u) in metres and its gradient by the components of `u`.
#[inline(always)]
fn radius(u: [f64; 3]) -> (f64, [f64; 3]) {
    let z = u[2];
    let [c0, c1, c2, c3] = OUTLINE;
    let (lip, lip_slope) = LIP.at(z);
    let mut value = c0 + z * (c1 + z * (c2 + z * c3)) + LIP_HEIGHT * lip;
    let mut gradient = [0.0, 0.0, c1 + z * (2.0 * c2 + z * 3.0 * c3) + LIP_HEIGHT * lip_slope];

    // Round lobes between narrow creases: the root of a wave that stays clear of zero.
    let (wave, wave_gradient) = LOBES.at(u);
    let root = (1.0 + LOBE_ROUNDING - wave).sqrt();
    value += LOBE_DEPTH * (root - 1.0);
    gradient = add(gradient, wave_gradient, -0.5 * LOBE_DEPTH / root);

    let (band, band_slope) = RIPPLE_BAND.at(z);
    let (wave, wave_gradient) = RIPPLES.at(u);
    value += RIPPLE_HEIGHT * band * wave;
    gradient = add(gradient, wave_gradient, RIPPLE_HEIGHT * band);
    gradient[2] += RIPPLE_HEIGHT * band_slope * wave;

    for (height, frequency, phase) in DENTS {
        let (sin, cos) = (dot(frequency, u) + phase).sin_cos();
        value += height * sin;
        gradient = add(gradient, frequency, height * cos);
    }
    (SIZE * value, scale(gradient, SIZE))
}

/// A wave around the axis, `cos(count x longitude + turn x height)`, fading smoothly towards the poles.
struct Spiral {
    count: i32,
    turn: f64,
}

impl Spiral {
    /// Value and gradient: the real part of `w^count e^(i turn z)` with `w = (x + iy) / √(x² + y² + FADE²)`.
    #[inline(always)]
    fn at(&self, [x, y, z]: [f64; 3]) -> (f64, [f64; 3]) {
        let inverse = 1.0 / (x * x + y * y + FADE * FADE).sqrt();
        let w = [x * inverse, y * inverse];
        let (sin, cos) = (self.turn * z).sin_cos();
        // One factor w short, as the derivative of the power needs it.
        let mut short = [cos, sin];
        let mut square = w;
        let mut left = self.count - 1;
        while left > 0 {
            if left & 1 == 1 {
                short = times(short, square);
            }
            square = times(square, square);
            left >>= 1;
        }
        let [value, quadrature] = times(short, w);
        let n = f64::from(self.count);
        let gradient = [
            n * inverse * (short[0] - w[0] * value),
            -n * inverse * (short[1] + w[1] * value),
            -self.turn * quadrature,
        ];
        (value, gradient)
    }
}

/// A smooth bump along the height: 1 at `centre`, 1/4 at `width` from it.
struct Band {
    centre: f64,
    width: f64,
}

impl Band {
    /// Value and derivative at height `z`.
    #[inline(always)]
    fn at(&self, z: f64) -> (f64, f64) {
        let t = (z - self.centre) / self.width;
        let bell = 1.0 / (1.0 + t * t);
        (bell * bell, -4.0 * t * bell * bell * bell / self.width)
    }
}

/// Product of two complex numbers.
fn times(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// `a + s b`.
pub(super) fn add(a: [f64; 3], b: [f64; 3], s: f64) -> [f64; 3] {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

pub(super) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    add(a, b, -1.0)
}

pub(super) fn scale(a: [f64; 3], s: f64) -> [f64; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn unit(a: [f64; 3]) -> [f64; 3] {
    scale(a, 1.0 / norm(a).max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradient_agrees_with_differences() {
        for k in 0..2000 {
            let x = scale(spread(k, 2000), 0.1 + 0.0001 * f64::from(k));
            let (_, gradient) = gauge(x);
            for axis in 0..3 {
                let mut e = [0.0; 3];
                e[axis] = 1.0;
                let h = 1e-6;
                let slope = (gauge_value(add(x, e, h)) - gauge_value(add(x, e, -h))) / (2.0 * h);
                assert!((slope - gradient[axis]).abs() < 1e-6, "{slope} {}", gradient[axis]);
            }
        }
    }

    #[test]
    fn points_set_off_along_the_normal_come_back() {
        let vessel = Vessel::new();
        for (k, height) in (0..3000).zip([-0.01, -0.003, 0.0, 0.002, 0.01].into_iter().cycle()) {
            let foot = land(spread(k, 3000));
            // The part above the rim is cut away; what is promised holds below it.
            if foot[2] > RIM {
                continue;
            }
            let normal = unit(gauge(foot).1);
            let (distance, back, back_normal) = vessel.distance(add(foot, normal, height));
            assert!((distance - height).abs() < 1e-13, "{distance} {height}");
            assert!(norm(sub(foot, back)) < 1e-13 && norm(sub(normal, back_normal)) < 1e-11);
        }
    }
}
