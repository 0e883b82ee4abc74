//! Where a scan stands: from its own frame to the common frame of its file.

/// A rotation and a translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// A quaternion `w x y z` of length 1.
    pub rotation: [f64; 4],
    /// In metres.
    pub translation: [f64; 3],
}

impl Pose {
    /// The pose of this rotation, brought to length 1; `None` if it has no length.
    pub(super) fn new(rotation: [f64; 4], translation: [f64; 3]) -> Option<Self> {
        let square: f64 = rotation.iter().map(|c| c * c).sum();
        if !(square.is_finite() && square > 0.0) || translation.iter().any(|c| !c.is_finite()) {
            return None;
        }
        Some(Self { rotation: rotation.map(|c| c / square.sqrt()), translation })
    }

    pub(super) fn is_identity(&self) -> bool {
        let [_, x, y, z] = self.rotation;
        [x, y, z] == [0.0; 3] && self.translation == [0.0; 3]
    }

    /// A direction of the scan's own frame in the common frame.
    pub fn turn(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [w, i, j, k] = self.rotation;
        // v + 2 w (u × v) + 2 u × (u × v), u the vector part.
        let [a, b, c] = [j * z - k * y, k * x - i * z, i * y - j * x].map(|n| 2.0 * n);
        [x + w * a + j * c - k * b, y + w * b + k * a - i * c, z + w * c + i * b - j * a]
    }

    /// A point of the scan's own frame in the common frame.
    pub fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let ([x, y, z], [a, b, c]) = (self.turn(point), self.translation);
        [x + a, y + b, z + c]
    }

    /// A point of the common frame in the scan's own frame.
    pub fn undo(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let ([a, b, c], [w, i, j, k]) = (self.translation, self.rotation);
        let back = Self { rotation: [w, -i, -j, -k], translation: [0.0; 3] };
        back.turn([x - a, y - b, z - c])
    }
}
