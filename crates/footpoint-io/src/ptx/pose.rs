//! The pose of a PTX scan.

use super::MOST;

/// Takes points from a scanner's frame to the common one.
pub(super) struct Pose {
    /// The first three columns of the matrix for row vectors, whose last row is the translation.
    rows: [[f64; 3]; 4],
    identity: bool,
}

const IDENTITY: [[f64; 3]; 4] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]];

impl Pose {
    /// The pose of the matrix in the first four numbers of four lines; `None` if its last column is not
    /// `0 0 0 1` or a number is not finite.
    pub(super) fn new(matrix: [[f64; MOST]; 4]) -> Option<Self> {
        let rows = matrix.map(|[x, y, z, ..]| [x, y, z]);
        let last = matrix.map(|[_, _, _, w, ..]| w);
        let finite = rows.iter().flatten().all(|number| number.is_finite());
        (finite && last == [0.0, 0.0, 0.0, 1.0]).then_some(Self { rows, identity: rows == IDENTITY })
    }

    /// The place of a point in the common frame, the very same where the pose says so.
    pub(super) fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        if self.identity {
            return [x, y, z];
        }
        let [a, b, c, d] = self.rows;
        [0, 1, 2].map(|k| a[k] * x + b[k] * y + c[k] * z + d[k])
    }
}
