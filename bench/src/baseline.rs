//! The rival: kiddo's radius query, scalar sums in doubles and nalgebra's eigenvectors, one query after the other.
//!
//! Centred covariance with the weight `poly3`: f, n and the exact gradient (eqs. 2 and 9), as a good programmer would
//! write them without vector lanes: no allocation per query, coordinates about the query, the gradient contracted to one
//! vector, and queries in the order of the tree's leaves, so that its nodes stay in the cache.

use kiddo::leaf_strategies::FlatVec;
use kiddo::{Eytzinger, KdTree, SquaredEuclidean};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Of kiddo's immutable trees the one that was fastest here; `ImmutableKdTree` differs in its leaves.
type Tree = KdTree<f64, u32, Eytzinger, FlatVec<f64, u32, 3, 32>, 3, 32>;

/// Rows written together, so that the misses of the cache overlap: one by one they made it a tenth slower.
const BATCH: usize = 1024;

/// The index of the samples.
pub(crate) struct Baseline {
    tree: Tree,
}

/// f, n and ∇f at the samples, in their order.
#[derive(Default)]
pub(crate) struct Answers {
    pub(crate) rows: Vec<Local>,
    /// Samples in the supports, over all queries.
    pub(crate) pairs: usize,
}

/// f, n and ∇f at one position, with the sign that nalgebra gives n. One cache line, because rows are written at random.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Local {
    pub(crate) value: f64,
    pub(crate) normal: [f64; 3],
    pub(crate) gradient: [f64; 3],
}

/// A sample in the support: its way from the query, and 1 − s².
struct Neighbour {
    way: Vector3<f64>,
    inside: f64,
}

impl Baseline {
    /// Indexes the samples; `None` where kiddo refuses them.
    pub(crate) fn build(points: &[[f64; 3]]) -> Option<Self> {
        Some(Self { tree: Tree::new_from_slice(points).ok()? })
    }

    /// Evaluates at the samples, into columns whose memory is used again.
    pub(crate) fn evaluate(&self, radius: f64, answers: &mut Answers) {
        let Answers { rows, pairs } = answers;
        rows.resize(self.tree.size(), Local::default());
        *pairs = 0;
        let mut neighbours = Vec::new();
        let mut batch = Vec::with_capacity(BATCH);
        let mut scatter = |batch: &mut Vec<(u32, Local)>| {
            for (sample, local) in batch.drain(..) {
                rows[sample as usize] = local;
            }
        };
        for (sample, position) in self.tree.iter() {
            self.gather(&position, radius, &mut neighbours);
            *pairs += neighbours.len();
            batch.push((sample, evaluate(&neighbours, radius)));
            if batch.len() == BATCH {
                scatter(&mut batch);
            }
        }
        scatter(&mut batch);
    }

    fn gather(&self, position: &[f64; 3], radius: f64, neighbours: &mut Vec<Neighbour>) {
        neighbours.clear();
        let centre = Vector3::from(*position);
        let inverse = 1.0 / (radius * radius);
        let query = self.tree.query(position).within::<SquaredEuclidean<f64>>(radius * radius);
        query.unsorted().with_points().visit(|found| {
            let inside = 1.0 - found.distance * inverse;
            neighbours.push(Neighbour { way: Vector3::from(found.point) - centre, inside });
        });
    }
}

fn evaluate(neighbours: &[Neighbour], radius: f64) -> Local {
    let mut weight = 0.0;
    let [mut x, mut y, mut z] = [0.0; 3];
    let [mut xx, mut xy, mut xz, mut yy, mut yz, mut zz] = [0.0; 6];
    for Neighbour { way, inside } in neighbours {
        let theta = inside * inside * inside;
        let (wx, wy, wz) = (theta * way.x, theta * way.y, theta * way.z);
        weight += theta;
        x += wx;
        y += wy;
        z += wz;
        xx += wx * way.x;
        xy += wx * way.y;
        xz += wx * way.z;
        yy += wy * way.y;
        yz += wy * way.z;
        zz += wz * way.z;
    }
    let u = Vector3::new(x, y, z) / weight;
    let covariance = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) / weight - u * u.transpose();
    let eigen = SymmetricEigen::new(covariance);
    let smallest = eigen.eigenvalues.imin();
    let normal: Vector3<f64> = eigen.eigenvectors.column(smallest).into();
    let mut turn = Vector3::zeros();
    for other in (0..3).filter(|&other| other != smallest) {
        let axis = eigen.eigenvectors.column(other);
        turn += axis * (axis.dot(&u) / (eigen.eigenvalues[other] - eigen.eigenvalues[smallest]));
    }
    let value = -normal.dot(&u);
    let offset = 1.0 + turn.dot(&u);
    let [mut x, mut y, mut z] = [0.0; 3];
    for Neighbour { way, inside } in neighbours {
        let height = normal.x * way.x + normal.y * way.y + normal.z * way.z + value;
        let along = offset - (turn.x * way.x + turn.y * way.y + turn.z * way.z);
        let factor = inside * inside * (height * along);
        x += factor * way.x;
        y += factor * way.y;
        z += factor * way.z;
    }
    // ψ without its factor that is the same for all.
    let scale = -6.0 / (radius * radius * weight);
    let gradient = normal + Vector3::new(x, y, z) * scale;
    Local { value, normal: normal.into(), gradient: gradient.into() }
}
#[cfg(test)]
mod tests {
    use super::*;
    use footpoint::samples::torus;

    #[test]
    fn the_gradient_agrees_with_differences() {
        let points = torus(1.0, 0.4, 3000, 5).with_noise(0.02, 6).points;
        let baseline = Baseline::build(&points).unwrap();
        let (radius, step) = (0.2, 1e-5);
        let mut neighbours = Vec::new();
        let mut at = |position: [f64; 3]| {
            baseline.gather(&position, radius, &mut neighbours);
            evaluate(&neighbours, radius)
        };
        for point in points.iter().take(50) {
            let here = at(*point);
            let normal = Vector3::from(here.normal);
            for axis in 0..3 {
                let mut beside = |by: f64| {
                    let mut position = *point;
                    position[axis] += by;
                    let there = at(position);
                    there.value * normal.dot(&Vector3::from(there.normal)).signum()
                };
                let slope = (beside(step) - beside(-step)) / (2.0 * step);
                assert!((slope - here.gradient[axis]).abs() < 1e-6, "{slope} {:?}", here.gradient);
            }
        }
    }

    #[test]
    fn answers_are_in_the_order_of_the_samples() {
        let points = torus(1.0, 0.4, 2000, 5).with_noise(0.01, 6).points;
        let baseline = Baseline::build(&points).unwrap();
        let mut answers = Answers::default();
        baseline.evaluate(0.2, &mut answers);
        let mut neighbours = Vec::new();
        for (point, row) in points.iter().zip(&answers.rows) {
            baseline.gather(point, 0.2, &mut neighbours);
            assert_eq!(row.value, evaluate(&neighbours, 0.2).value);
        }
    }
}
