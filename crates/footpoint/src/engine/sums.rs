//! The one hot loop, in two passes over a block's candidates: the frame sums, then the gradient's.

use super::block::{Candidates, Position};
use crate::algebra::{Matrix, Vector, add, add_outer_upper, add_scaled, dot, mirror, scale, sub, zero};
use crate::lane::Lane;
use crate::weight::Kernel;

/// Which of the costlier sums of the first pass are needed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Needs {
    /// The second moments W.
    pub(crate) second: bool,
    /// Σ θ n nᵀ.
    pub(crate) axes: bool,
    /// Σ|G_i|², in the second pass.
    pub(crate) sensitivity: bool,
    /// Squared ratio ρ² of the domain's balls to the supports (eq. 1).
    pub(crate) domain: f64,
}

/// Sums of the first pass (SPEC § 1), lengths in units of the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameSums<L, const D: usize> {
    /// S = Σθ.
    pub(crate) weight: L,
    /// Σθ².
    pub(crate) squares: L,
    /// m = Σ θ d.
    pub(crate) first: Vector<L, D>,
    /// W = Σ θ d dᵀ.
    pub(crate) second: Matrix<L, D>,
    /// Nv = Σ θ n_i.
    pub(crate) normals: Vector<L, D>,
    /// Σ θ n_i n_iᵀ.
    pub(crate) axes: Matrix<L, D>,
    /// Σ θ h_i.
    pub(crate) scales: L,
    /// Samples with θ > 0.
    pub(crate) neighbours: L,
    /// Samples whose domain ball contains the position.
    pub(crate) inside: L,
}

/// What a candidate's weight is made of: 1/h² and the factor ω.
#[inline(always)]
fn constants<const D: usize>(list: &Candidates<D>, j: usize) -> (f64, f64) {
    let scale = list.scales.get(j).copied().unwrap_or(list.uniform_scale);
    (1.0 / (scale * scale), list.factors.get(j).copied().unwrap_or(1.0))
}

/// Pass one over all candidates.
#[inline(always)]
pub(crate) fn first_pass<L: Lane, K: Kernel, const D: usize>(
    kernel: K,
    list: &Candidates<D>,
    x: Position<L, D>,
    needs: Needs,
) -> FrameSums<L, D> {
    let token = x.anchor[0].token();
    let nought = L::splat(token, 0.0);
    let mut sums = FrameSums {
        weight: nought,
        squares: nought,
        first: zero(token),
        second: [zero(token); D],
        normals: zero(token),
        axes: [zero(token); D],
        scales: nought,
        neighbours: nought,
        inside: nought,
    };
    let one = L::splat(token, 1.0);
    let end = L::splat(token, kernel.end());
    let domain = L::splat(token, kernel.end() * needs.domain);
    for &place in list.indices() {
        let j = place as usize;
        let d = x.to_sample(list.points[j]);
        let (inverse, factor) = constants(list, j);
        let s2 = dot(d, d) * nought.like(inverse);
        let near = s2.less(end);
        let theta = kernel.theta(s2) * s2.like(factor);
        sums.weight = sums.weight + theta;
        sums.squares = theta.mul_add(theta, sums.squares);
        sums.first = add_scaled(sums.first, d, theta);
        sums.neighbours = sums.neighbours + L::select(near, one, nought);
        sums.inside = sums.inside + L::select(s2.less(domain), one, nought);
        if needs.second {
            add_outer_upper(&mut sums.second, d, theta);
        }
        if let Some(scale) = list.scales.get(j) {
            sums.scales = theta.mul_add(theta.like(*scale), sums.scales);
        }
        if let Some(normal) = list.normals.get(j) {
            let normal = std::array::from_fn(|k| theta.like(normal[k]));
            sums.normals = add_scaled(sums.normals, normal, theta);
            if needs.axes {
                add_outer_upper(&mut sums.axes, normal, theta);
            }
        }
    }
    if list.scales.is_empty() {
        sums.scales = sums.weight * nought.like(list.uniform_scale);
    }
    sums.second = mirror(sums.second);
    sums.axes = mirror(sums.axes);
    sums
}

/// How one sample enters ∇f: its sensitivity is `G_i = −(1/S) [ψ_i c_i d_i + θ_i t_i]` (SPEC § 10), with the scalar
/// c_i and the vector t_i of the definition. All vectors are in units of the grid.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Contraction<L, const D: usize> {
    /// Frames about a(x): c = (n·d + f)(1 + g·u − g·d), t = n − g (n·e) − n (g·e), e = d − u.
    Centred { g: Vector<L, D> },
    /// Frames about x: c = (n·d)(1 − g·d) + f, t = n − g (n·d) − n (g·d).
    AboutX { g: Vector<L, D> },
    /// Averaged normals: c = n·d + f + e·n_i, t = n.
    Normals { e: Vector<L, D> },
    /// Averaged axes: c = n·d + f − (g·n_i)(n·n_i), t = n.
    Axes { g: Vector<L, D> },
}

/// Sums of the second pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SecondSums<L, const D: usize> {
    /// Σ ψ c d.
    pub(crate) gradient: Vector<L, D>,
    /// Σ |ψ c d + θ t|²; zero unless asked for.
    pub(crate) sensitivity: L,
}

/// What the second pass needs to know of the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<L, const D: usize> {
    pub(crate) normal: Vector<L, D>,
    /// u = a(x) − x.
    pub(crate) aside: Vector<L, D>,
    pub(crate) contraction: Contraction<L, D>,
}

/// Pass two over all candidates; the match over definitions stands outside the loop.
#[inline(always)]
pub(crate) fn second_pass<L: Lane, K: Kernel, const D: usize>(
    kernel: K,
    list: &Candidates<D>,
    x: Position<L, D>,
    frame: &Frame<L, D>,
    needs: Needs,
) -> SecondSums<L, D> {
    let n = frame.normal;
    let u = frame.aside;
    let f = -dot(n, u);
    let one = f.like(1.0);
    let normal_of = |j: usize| -> Vector<L, D> {
        let normal = list.normals.get(j).copied().unwrap_or([0.0; D]);
        std::array::from_fn(|k| f.like(normal[k]))
    };
    match frame.contraction {
        Contraction::Centred { g } => {
            let gu = one + dot(g, u);
            let c = |_, d| (dot(n, d) + f) * (gu - dot(g, d));
            contract(kernel, list, x, needs, c, |d| theta_part(n, g, sub(d, u)))
        }
        Contraction::AboutX { g } => {
            let c = |_, d| dot(n, d) * (one - dot(g, d)) + f;
            contract(kernel, list, x, needs, c, |d| theta_part(n, g, d))
        }
        Contraction::Normals { e } => {
            let c = |j, d| dot(n, d) + f + dot(e, normal_of(j));
            contract(kernel, list, x, needs, c, |_| n)
        }
        Contraction::Axes { g } => {
            let c = |j, d| {
                let normal = normal_of(j);
                dot(n, d) + f - dot(g, normal) * dot(n, normal)
            };
            contract(kernel, list, x, needs, c, |_| n)
        }
    }
}

#[inline(always)]
fn contract<L: Lane, K: Kernel, const D: usize>(
    kernel: K,
    list: &Candidates<D>,
    x: Position<L, D>,
    needs: Needs,
    c: impl Fn(usize, Vector<L, D>) -> L,
    t: impl Fn(Vector<L, D>) -> Vector<L, D>,
) -> SecondSums<L, D> {
    let token = x.anchor[0].token();
    let nought = L::splat(token, 0.0);
    let mut sums = SecondSums { gradient: zero(token), sensitivity: nought };
    for &place in list.indices() {
        let j = place as usize;
        let d = x.to_sample(list.points[j]);
        let (inverse, factor) = constants(list, j);
        let s2 = dot(d, d) * nought.like(inverse);
        let psi = kernel.psi(s2) * s2.like(factor * inverse);
        let part = scale(d, psi * c(j, d));
        sums.gradient = add(sums.gradient, part);
        if needs.sensitivity {
            let theta = kernel.theta(s2) * s2.like(factor);
            let whole = add_scaled(part, t(d), theta);
            sums.sensitivity = sums.sensitivity + dot(whole, whole);
        }
    }
    sums
}

/// t = n − g (n·e) − n (g·e).
#[inline(always)]
fn theta_part<L: Lane, const D: usize>(n: Vector<L, D>, g: Vector<L, D>, e: Vector<L, D>) -> Vector<L, D> {
    let turned = scale(g, dot(n, e));
    add_scaled(sub(n, turned), n, -dot(g, e))
}
