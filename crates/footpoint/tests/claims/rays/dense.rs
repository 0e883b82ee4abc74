//! The reference: f at points h/50 apart, every change of its sign narrowed by halving, the zeros accepted by SPEC § 8.

use crate::common::{add, dot, length, scale};
use footpoint::{AllHits, Cast, Evaluations, Queries, Ray, Run, Surface, Want};

const STEP: f64 = 0.02;

fn at<const D: usize>(ray: &Ray<D>, t: f64) -> [f64; D] {
    add(ray.origin, scale(ray.direction, t))
}

/// All t at which the ray meets the surface.
pub(super) fn zeros<const D: usize>(surface: &Surface<D>, ray: &Ray<D>) -> Vec<f64> {
    let (h, run) = (surface.support().median, Run::new().threads(1));
    let reach = surface.support().largest * if h > 0.0 { 1.01 } else { 0.0 };
    let (mut from, mut to) = (0.0_f64, f64::INFINITY);
    for k in 0..D {
        let along = |p: &[f64; D]| p[k];
        let points = surface.cloud().points();
        let low = points.iter().map(along).fold(f64::INFINITY, f64::min) - reach;
        let high = points.iter().map(along).fold(f64::NEG_INFINITY, f64::max) + reach;
        let (a, b) = ((low - ray.origin[k]) / ray.direction[k], (high - ray.origin[k]) / ray.direction[k]);
        from = from.max(a.min(b));
        to = to.min(a.max(b));
    }
    let step = STEP * h / length(ray.direction);
    let count = if to > from { ((to - from) / step).ceil() as usize } else { 0 };
    let points: Vec<[f64; D]> = (0..count).map(|i| at(ray, from + i as f64 * step)).collect();
    let want = Want::VALUE | Want::FRAME_NORMAL;
    let seen = surface.with(&run).evaluate(Queries::Points(&points), want).unwrap();
    let mut found = Vec::new();
    for i in 1..count {
        let (last, here) = (point(&seen, i - 1), point(&seen, i));
        let Some(value) = carried(last, here) else { continue };
        if last.0 * value <= 0.0 {
            let between = (from + (i - 1) as f64 * step, from + i as f64 * step);
            found.extend(narrowed(surface, ray, between, last));
        }
    }
    found
}

/// f and n.
type Point<const D: usize> = (f64, [f64; D]);

fn point<const D: usize>(seen: &Evaluations<D>, i: usize) -> Point<D> {
    (seen.value[i], seen.frame_normal[i])
}

/// f with the sign of the point before, unless the frame has turned by more than 60 degrees or does not exist.
fn carried<const D: usize>(last: Point<D>, here: Point<D>) -> Option<f64> {
    let along = dot(last.1, here.1);
    (along.abs() >= 0.5).then_some(here.0 * along.signum())
}

fn narrowed<const D: usize>(
    surface: &Surface<D>,
    ray: &Ray<D>,
    (mut from, mut to): (f64, f64),
    mut last: Point<D>,
) -> Option<f64> {
    let run = Run::new().threads(1);
    let want = Want::VALUE
        | Want::FRAME_NORMAL
        | Want::GRADIENT
        | Want::GAP
        | Want::ECCENTRICITY
        | Want::SUPPORT
        | Want::SURFACE_NORMAL;
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        let seen = surface.with(&run).evaluate(&[at(ray, middle)], want).unwrap();
        let here = point(&seen, 0);
        let value = carried(last, here)?;
        if value.abs() <= 1e-7 * seen.support[0] {
            let rule = surface.definition().acceptance();
            let accepted = dot(seen.frame_normal[0], seen.gradient[0]) >= rule.alignment
                && seen.gap[0] >= rule.gap
                && seen.eccentricity[0] <= surface.definition().boundary_limit::<D>()
                && seen.status[0].is_ok();
            return accepted.then_some(middle);
        }
        if last.0 * value > 0.0 {
            from = middle;
            last = (value, here.1.map(|c| c * dot(last.1, here.1).signum()));
        } else {
            to = middle;
        }
    }
    None
}

/// How casting compares with dense sampling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Comparison {
    /// Hits of dense sampling.
    pub(super) hits: usize,
    /// Those of them that casting has not.
    pub(super) missed: usize,
    /// Hits of casting alone where f or the rule says that there is none.
    pub(super) wrong: usize,
    /// Those that are right: dense sampling stepped over two zeros.
    pub(super) finer: usize,
}

/// Compares all hits of all rays; `first` and `any` hits must agree with them.
pub(super) fn compare<const D: usize>(surface: &Surface<D>, rays: &[Ray<D>]) -> Comparison {
    let all = surface.cast_all(rays, &Cast::new());
    agree_with_first_and_any(surface, rays, &all);
    let mut result = Comparison::default();
    let halves = rays.len() / 2;
    let dense = |range: std::ops::Range<usize>| -> Vec<Vec<f64>> {
        range.map(|i| zeros(surface, &rays[i])).collect()
    };
    let mut found = Vec::new();
    std::thread::scope(|scope| {
        let second = scope.spawn(|| dense(halves..rays.len()));
        found.extend(dense(0..halves));
        found.extend(second.join().unwrap());
    });
    for (i, (ray, expected)) in rays.iter().zip(found).enumerate() {
        let near = 1e-3 * surface.support().median / length(ray.direction);
        let cast = &all.hits.t[all.of(i)];
        let is_in = |list: &[f64], t: f64| list.iter().any(|other| (other - t).abs() <= near);
        result.hits += expected.len();
        for &t in expected.iter().filter(|&&t| !is_in(cast, t)) {
            result.missed += 1;
            describe(surface, ray, t, cast);
        }
        for &t in cast.iter().filter(|&&t| !is_in(&expected, t)) {
            let again = narrowed(surface, ray, (t - near, t + near), point_at(surface, ray, t - near));
            if again.is_some() { result.finer += 1 } else { result.wrong += 1 }
        }
    }
    result
}

/// Says where a hit was lost, and how.
fn describe<const D: usize>(surface: &Surface<D>, ray: &Ray<D>, t: f64, cast: &[f64]) {
    let want = Want::GRADIENT | Want::FRAME_NORMAL | Want::GAP | Want::ECCENTRICITY;
    let seen = surface.evaluate(&[at(ray, t)], want);
    let slope = dot(seen.gradient[0], ray.direction).abs() / length(ray.direction);
    let aligned = dot(seen.gradient[0], seen.frame_normal[0]);
    let (gap, aside) = (seen.gap[0], seen.eccentricity[0]);
    println!(
        "lost: {ray:?} at t {t}, slope {slope:.3}, n·∇f {aligned:.2}, gap {gap:.2}, aside {aside:.2}; cast {cast:?}"
    );
}

fn point_at<const D: usize>(surface: &Surface<D>, ray: &Ray<D>, t: f64) -> Point<D> {
    point(&surface.evaluate(&[at(ray, t)], Want::VALUE | Want::FRAME_NORMAL), 0)
}

fn agree_with_first_and_any<const D: usize>(surface: &Surface<D>, rays: &[Ray<D>], all: &AllHits<D>) {
    let first = surface.cast(rays, &Cast::new());
    let any = surface.cast(rays, &Cast::new().with_sought(footpoint::Sought::Any));
    for i in 0..rays.len() {
        let expected = all.hits.t[all.of(i)].first().copied();
        assert_eq!(first.status[i].is_ok(), expected.is_some(), "ray {i}");
        assert_eq!(first.t[i].to_bits(), expected.unwrap_or(f64::NAN).to_bits(), "ray {i}");
        assert_eq!(any.status[i].is_ok(), expected.is_some(), "ray {i}");
    }
}
