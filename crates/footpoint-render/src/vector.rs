//! Small vectors in space.

pub(crate) type Vector = [f64; 3];

pub(crate) fn add_scaled(a: Vector, b: Vector, s: f64) -> Vector {
    std::array::from_fn(|k| a[k] + s * b[k])
}

pub(crate) fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn scale(a: Vector, s: f64) -> Vector {
    a.map(|c| c * s)
}

pub(crate) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// Of length 1; NaN for the zero vector.
pub(crate) fn unit(a: Vector) -> Vector {
    scale(a, 1.0 / length(a))
}

/// Two unit vectors across the unit vector n and across each other.
pub(crate) fn tangents(n: Vector) -> [Vector; 2] {
    let smallest = (0..3).fold(0, |best, k| if n[k].abs() < n[best].abs() { k } else { best });
    let axis = std::array::from_fn(|k| f64::from(u8::from(k == smallest)));
    let t = unit(cross(n, axis));
    [t, cross(n, t)]
}
