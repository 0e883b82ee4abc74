//! Levin's projection, the reference method (SPEC § 7): the minimum of eq. 16, then a polynomial over its frame.
//!
//! Plain doubles over the samples around one point at a time: here to compare with, not to be fast.

use super::{Landing, Project};
use crate::algebra::{
    Matrix, add, add_outer_upper, add_scaled, direction, dot, length, mirror, scale, sub, tangential,
};
use crate::definition::Kind;
use crate::eigen::{Eigen, eigen};
use crate::least_squares::least_squares;
use crate::run::Run;
use crate::status::Status;
use crate::surface::{Sign, Surface};
use crate::weight::{Kernel, with_kernel};

/// Steps of the search for the minimum, in supports.
const STEP: f64 = 0.1;
/// Times that n is fitted for one t; the change falls by some (t/h)² each time.
const MOST_FITS: u32 = 60;
/// What rounding leaves of a turn.
const LEAST_TURN: f64 = 1e-14;
/// Gaps below this do not determine a frame (SPEC § 3).
const DEGENERATE_GAP: f64 = 1e-12;

/// A sample near the point, lengths in units of the grid.
struct Neighbour<const D: usize> {
    /// p − x.
    way: [f64; D],
    h: f64,
    factor: f64,
    /// Zero where absent.
    normal: [f64; D],
}

/// The plane at q = x + t n with the best n for this t: `∂e/∂n` of eq. 16 vanishes across n.
#[derive(Clone, Copy)]
struct Plane<const D: usize> {
    t: f64,
    normal: [f64; D],
    /// Across n.
    axes: Matrix<f64, D>,
    gap: f64,
    /// −G/S at q, with which e falls or rises: ∂e/∂t = −2G.
    value: f64,
    /// n·∇f_L, exact where t = 0 (SPEC § 7): 0 where the plane turns with x and stays a minimum.
    alignment: f64,
    /// a(q) − q.
    aside: [f64; D],
    /// h(q).
    support: f64,
    /// n·Σθ n_i.
    along: f64,
}

/// The sums at q for one n (d = p − q).
struct Sums<const D: usize> {
    weight: f64,
    first: [f64; D],
    scales: f64,
    normals: [f64; D],
    /// W − (t/2) Σψ (n·d) d dᵀ, its upper triangle: where n is an eigenvector e is stationary across n.
    matrix: Matrix<f64, D>,
    /// G.
    pull: f64,
    /// −∂G/∂t = S + (5/2) Σψ (n·d)² + ½ Σχ (n·d)⁴.
    steepness: f64,
    /// Σψ (n·d)² d.
    cubes: [f64; D],
}

impl<const D: usize> Sums<D> {
    /// (m + T)·P w with w = m + (3/2) T, T = Σψ (n·d)² d: the part of ∂G/∂t that n undoes by turning as q moves along it.
    fn lost_by_turning(&self, pairs: &Eigen<f64, D>) -> f64 {
        let w = add_scaled(self.first, self.cubes, 1.5);
        let across = add(self.first, self.cubes);
        (1..D).fold(0.0, |sum, j| {
            let v = pairs.vectors[j];
            sum + dot(across, v) * dot(v, w) / (pairs.values[j] - pairs.values[0])
        })
    }
}

/// Projects one point, unless the run is cancelled meanwhile. `observe` sees the plane and −G/S at every t that was tried.
pub(super) fn project<const D: usize>(
    surface: &Surface<D>,
    x: [f64; D],
    (how, degree, run): (&Project, Option<u8>, &Run<'_>),
    observe: impl FnMut([f64; D], f64),
) -> (Status, Landing<D>) {
    with_kernel!(surface.definition.weight(), kernel => {
        let search = Search {
            surface,
            kernel,
            how,
            run,
            neighbours: Vec::new(),
            evaluations: 0,
            residual: f64::NAN,
            observe,
        };
        search.project(x, degree)
    })
}

/// One projection under way.
struct Search<'s, K, O, const D: usize> {
    surface: &'s Surface<D>,
    kernel: K,
    how: &'s Project,
    run: &'s Run<'s>,
    neighbours: Vec<Neighbour<D>>,
    evaluations: u32,
    residual: f64,
    observe: O,
}

impl<K: Kernel, O: FnMut([f64; D], f64), const D: usize> Search<'_, K, O, D> {
    fn project(mut self, x: [f64; D], degree: Option<u8>) -> (Status, Landing<D>) {
        let landed = self.plane(x).and_then(|plane| {
            self.accept(&plane)?;
            self.landing(x, &plane, degree)
        });
        let (status, landing) = match landed {
            Ok(landing) => (Status::Ok, landing),
            Err(status) => (status, Landing::NOWHERE),
        };
        (status, Landing { residual: self.residual, evaluations: self.evaluations, ..landing })
    }

    /// The rule of SPEC § 8.
    fn accept(&self, plane: &Plane<D>) -> Result<(), Status> {
        let definition = self.surface.definition.with_kind(Kind::Levin);
        let rule = definition.acceptance();
        if plane.gap < rule.gap {
            Err(Status::Degenerate)
        } else if plane.alignment < rule.alignment || plane.alignment.is_nan() {
            Err(Status::Singular)
        } else if length(tangential(plane.aside, plane.normal))
            > definition.boundary_limit::<D>() * plane.support
        {
            Err(Status::Boundary)
        } else {
            Ok(())
        }
    }

    fn landing(&self, x: [f64; D], plane: &Plane<D>, degree: Option<u8>) -> Result<Landing<D>, Status> {
        let (height, slopes) = match degree {
            None => (0.0, [f64::NAN; D]),
            Some(degree) => self.polynomial(plane, degree).ok_or(Status::Degenerate)?,
        };
        let signed = self.surface.sign() == Sign::Given && plane.along != 0.0;
        let largest = (1..D)
            .fold(plane.normal[0], |m, k| if plane.normal[k].abs() > m.abs() { plane.normal[k] } else { m });
        let decisive = if plane.along != 0.0 { plane.along } else { largest };
        let sign = if decisive < 0.0 { -1.0 } else { 1.0 };
        let moved = plane.t + height;
        let distance = if signed { -moved * sign } else { moved.abs() };
        Ok(Landing {
            point: add_scaled(x, plane.normal, moved),
            surface_normal: scale(direction(sub(plane.normal, slopes)), sign),
            frame_normal: scale(plane.normal, sign),
            distance,
            ..Landing::NOWHERE
        })
    }

    /// The samples around x that matter within this distance of it.
    fn gather(&mut self, x: [f64; D], distance: f64) {
        let Surface { grid, cloud, .. } = self.surface;
        let inverse = 1.0 / grid.unit;
        self.neighbours.clear();
        grid.visit(x.map(|c| c - distance), x.map(|c| c + distance), |stretch| {
            for place in stretch.samples() {
                let point = cloud.points()[grid.original()[place] as usize];
                self.neighbours.push(Neighbour {
                    way: sub(scale(point, inverse), x),
                    h: grid.scales.get(place).copied().unwrap_or(grid.uniform_scale),
                    factor: grid.factors.get(place).copied().unwrap_or(1.0),
                    normal: std::array::from_fn(|k| grid.normals[k].get(place).copied().unwrap_or(0.0)),
                });
            }
        });
    }

    /// The sums at x + t n; *outside* where the domain ends.
    fn sums(&mut self, normal: [f64; D], t: f64) -> Result<Sums<D>, Status> {
        if self.run.is_cancelled() || self.evaluations >= self.how.most_evaluations {
            return Err(Status::NotConverged);
        }
        self.evaluations += 1;
        let ratio = self.surface.definition.domain_ratio();
        let rim = self.kernel.closeness(self.kernel.end() * ratio * ratio);
        let mut inside = false;
        let mut sums = Sums {
            weight: 0.0,
            first: [0.0; D],
            scales: 0.0,
            normals: [0.0; D],
            matrix: [[0.0; D]; D],
            pull: 0.0,
            steepness: 0.0,
            cubes: [0.0; D],
        };
        for sample in &self.neighbours {
            let d = add_scaled(sample.way, normal, -t);
            let inverse = 1.0 / (sample.h * sample.h);
            let closeness = self.kernel.closeness(dot(d, d) * inverse);
            let theta = sample.factor * self.kernel.theta(closeness);
            if theta == 0.0 {
                continue;
            }
            inside |= closeness > rim;
            let psi = sample.factor * inverse * self.kernel.psi(closeness);
            let chi = sample.factor * inverse * inverse * self.kernel.chi(closeness);
            let z = dot(normal, d);
            sums.weight += theta;
            sums.first = add_scaled(sums.first, d, theta);
            sums.scales += theta * sample.h;
            sums.normals = add_scaled(sums.normals, sample.normal, theta);
            add_outer_upper(&mut sums.matrix, d, theta - 0.5 * t * psi * z);
            sums.pull += theta * z + 0.5 * psi * z * z * z;
            sums.cubes = add_scaled(sums.cubes, d, psi * z * z);
            sums.steepness += theta + 2.5 * psi * z * z + 0.5 * chi * z * z * z * z;
        }
        if inside { Ok(sums) } else { Err(Status::Outside) }
    }

    /// The plane for this t: n is fitted again until it stands.
    fn plane_at(&mut self, start: [f64; D], t: f64) -> Result<Plane<D>, Status> {
        let tolerance = (0.1 * self.how.tolerance).max(LEAST_TURN);
        let mut normal = start;
        for _ in 0..MOST_FITS {
            let sums = self.sums(normal, t)?;
            let pairs = eigen(mirror(sums.matrix));
            let gap = (pairs.values[1] - pairs.values[0]) / pairs.values[D - 1];
            if gap.is_nan() || gap < DEGENERATE_GAP {
                return Err(Status::Degenerate);
            }
            let next = pairs.vectors[0];
            let next = if dot(next, normal) < 0.0 { scale(next, -1.0) } else { next };
            let turn = length(sub(next, normal));
            if turn <= tolerance {
                let value = -sums.pull / sums.weight;
                (self.observe)(scale(normal, t), value);
                return Ok(Plane {
                    t,
                    normal,
                    axes: pairs.vectors,
                    gap,
                    value,
                    alignment: (sums.steepness - sums.lost_by_turning(&pairs)) / sums.weight,
                    aside: scale(sums.first, 1.0 / sums.weight),
                    support: sums.scales / sums.weight,
                    along: dot(normal, sums.normals),
                });
            }
            normal = next;
        }
        Err(Status::NotConverged)
    }

    /// The local minimum of e with the smallest |t|: the first between two steps on the way outwards from t = 0 to both
    /// sides, with the n that belongs to every t.
    fn plane(&mut self, x: [f64; D]) -> Result<Plane<D>, Status> {
        self.gather(x, 0.0);
        let start = std::array::from_fn(|k| if k == 0 { 1.0 } else { 0.0 });
        let centre = self.plane_at(start, 0.0)?;
        self.residual = centre.value.abs();
        let reach = self.kernel.end().sqrt();
        self.gather(x, reach * centre.support);
        let mut sides = [(1.0, Ok(centre)), (-1.0, Ok(centre))];
        for k in 1..=(reach / STEP).ceil() as u32 {
            let mut found: Option<Plane<D>> = None;
            for (sign, last) in &mut sides {
                let Ok(before) = *last else { continue };
                let t = *sign * f64::from(k) * STEP * centre.support;
                *last = self.plane_at(before.normal, t);
                let Ok(next) = *last else { continue };
                // e falls outwards there and rises here.
                if *sign * before.value <= 0.0 && *sign * next.value > 0.0 {
                    let minimum = self.between(before, next)?;
                    let nearer = found.is_none_or(|other| minimum.t.abs() < other.t.abs());
                    found = if nearer { Some(minimum) } else { found };
                }
            }
            if let Some(found) = found {
                return Ok(found);
            }
        }
        let statuses = sides.map(|(_, last)| last.err());
        let outside = statuses.contains(&Some(Status::Outside));
        Err(if outside { Status::Outside } else { Status::NotConverged })
    }

    /// The zero of −G/S between two planes where its signs differ: the secant, kept between them (the Illinois rule).
    fn between(&mut self, mut low: Plane<D>, mut high: Plane<D>) -> Result<Plane<D>, Status> {
        let (mut below, mut above) = (low.value, high.value);
        let mut last = if below.abs() < above.abs() { low.t } else { high.t };
        let mut replaced = 0;
        loop {
            let t = (low.t * above - high.t * below) / (above - below);
            let normal = if (t - low.t).abs() < (t - high.t).abs() { low.normal } else { high.normal };
            let next = self.plane_at(normal, t)?;
            let step = (t - last).abs();
            self.residual = step.max(next.value.abs());
            if self.residual <= self.how.tolerance * next.support || next.value == 0.0 {
                return Ok(next);
            }
            last = t;
            // An end that stays twice counts for half.
            if (next.value > 0.0) == (high.value > 0.0) {
                below *= if replaced == 1 { 0.5 } else { 1.0 };
                (high, above, replaced) = (next, next.value, 1);
            } else {
                above *= if replaced == -1 { 0.5 } else { 1.0 };
                (low, below, replaced) = (next, next.value, -1);
            }
        }
    }

    /// The polynomial of this degree that fits the heights over the plane best, with weights θ about q: its value at q,
    /// and its gradient there.
    fn polynomial(&self, plane: &Plane<D>, degree: u8) -> Option<(f64, [f64; D])> {
        let axes = &plane.axes[1..];
        let powers = exponents::<D>(degree);
        if self.neighbours.len() < powers.len() {
            return None;
        }
        let mut columns = vec![Vec::new(); powers.len()];
        let mut heights = Vec::new();
        for sample in &self.neighbours {
            let d = add_scaled(sample.way, plane.normal, -plane.t);
            let closeness = self.kernel.closeness(dot(d, d) / (sample.h * sample.h));
            let root = (sample.factor * self.kernel.theta(closeness)).sqrt();
            if root == 0.0 {
                continue;
            }
            let place: [f64; 2] =
                std::array::from_fn(|k| axes.get(k).map_or(0.0, |&axis| dot(axis, d) / plane.support));
            for (column, [first, second]) in columns.iter_mut().zip(&powers) {
                column.push(root * power(place[0], *first) * power(place[1], *second));
            }
            heights.push(root * dot(plane.normal, d) / plane.support);
        }
        let coefficients = least_squares(columns, heights)?;
        // Constant first, then the axes one by one.
        let gradient = match degree {
            0 => [f64::NAN; D],
            _ => axes
                .iter()
                .zip(&coefficients[1..])
                .fold([0.0; D], |sum, (&axis, &c)| add(sum, scale(axis, c))),
        };
        Some((coefficients[0] * plane.support, gradient))
    }
}

/// By products alone, whose bits are the same everywhere.
fn power(x: f64, exponent: u8) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * x)
}

/// Exponents of all monomials up to a degree, lower degrees first; in one variable for D = 2.
fn exponents<const D: usize>(degree: u8) -> Vec<[u8; 2]> {
    let of_degree = |total: u8| {
        let most = if D == 2 { 0 } else { total };
        (0..=most).map(move |second| [total - second, second])
    };
    (0..=degree).flat_map(of_degree).collect()
}
