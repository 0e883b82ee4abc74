//! What the normals of two near samples say about their signs.

/// Largest height of a reliable edge's end over the other's tangent plane, in reaches: sheets further apart are not joined.
const HIGHEST: f32 = 0.5;
/// Least |cosine| between the normals of a reliable edge. Three axes that are pairwise less than 60 degrees apart can always
/// be signed alike, so reliable edges never contradict each other in a triangle: only around something.
const LEAST_COSINE: f32 = 0.5;

/// An edge between two near samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    /// From 0, best, to 2; reliable edges are below 1, doubtful ones from 1 on.
    pub(super) weight: f32,
    /// Whether the normals, as they are, point to different sides.
    pub(super) opposed: bool,
}

impl Edge {
    /// The edge between samples of these unit normals, with the way from one to the other in units of the reach; the same
    /// from either end. `None` where a normal is absent.
    ///
    /// A reliable edge compares the normals as they are. A doubtful one compares the one with the mirror image of the other
    /// in the plane between the samples, as across a sharp edge or a thin wall; the reach in the denominator lets the mirror
    /// fade where the samples are so near that their noise decides.
    #[inline]
    pub(super) fn between<const D: usize>(a: [f32; D], b: [f32; D], way: [f32; D]) -> Option<Self> {
        let (cosine, rise_a, rise_b) = (dot(a, b), dot(a, way), dot(b, way));
        if cosine.is_nan() {
            return None;
        }
        let height = rise_a.abs().max(rise_b.abs());
        if cosine.abs() > LEAST_COSINE && height <= HIGHEST {
            // At most 3/4.
            let weight = (1.0 - cosine.abs()).max(0.0) + height * height;
            return Some(Self { weight, opposed: cosine < 0.0 });
        }
        let mirrored = cosine - 2.0 * rise_a * rise_b / (dot(way, way) + HIGHEST * HIGHEST);
        Some(Self { weight: 2.0 - mirrored.abs().min(1.0), opposed: mirrored < 0.0 })
    }

    /// Whether the signs of the ends hang together without doubt.
    #[inline]
    pub(super) fn is_reliable(self) -> bool {
        self.weight < 1.0
    }
}

#[inline]
fn dot<const D: usize>(a: [f32; D], b: [f32; D]) -> f32 {
    let mut sum = a[0] * b[0];
    for k in 1..D {
        sum += a[k] * b[k];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_the_same_from_both_ends_and_judge_the_known_cases() {
        let up = [0.0, 0.0, 1.0];
        let down = [0.0, 0.0, -1.0];
        for (a, b, way, reliable, opposed) in [
            // A flat sheet, its normals alike or not.
            (up, up, [0.6, 0.0, 0.1], true, false),
            (up, down, [0.6, 0.0, -0.1], true, true),
            // Nearer to each other than the noise is large.
            (up, up, [0.01, 0.0, 0.3], true, false),
            // Both sides of a thin wall: outward normals differ.
            (up, down, [0.0, 0.0, 0.9], false, false),
            (up, up, [0.1, 0.0, 0.8], false, true),
            // Across a right angle, from above to the side: convex, and concave with the other normal reversed.
            (up, [1.0, 0.0, 0.0], [0.5, 0.0, -0.5], false, false),
            (up, [-1.0, 0.0, 0.0], [0.5, 0.0, -0.5], false, true),
            (up, [-1.0, 0.0, 0.0], [0.5, 0.0, 0.5], false, false),
        ] {
            let edge = Edge::between(a, b, way).unwrap();
            assert_eq!((edge.is_reliable(), edge.opposed), (reliable, opposed), "{a:?} {b:?} {way:?}");
            assert_eq!(Edge::between(b, a, way.map(|c: f32| -c)), Some(edge));
            assert!((0.0..=2.0).contains(&edge.weight));
        }
        assert_eq!(Edge::between(up, [f32::NAN; 3], [0.1; 3]), None);
    }
}
