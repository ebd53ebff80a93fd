//! Vectors of three numbers.

pub(super) use sinew_body::points::{between, distance};

/// A point, a direction or a ray.
pub(super) type Vector = [f64; 3];

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `a + s b`.
pub(super) fn along(a: Vector, s: f64, b: Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

pub(super) fn minus(a: Vector, b: Vector) -> Vector {
    along(a, -1.0, b)
}

pub(super) fn length(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

/// The direction of a vector; `None` where it has none.
pub(super) fn unit(a: Vector) -> Option<Vector> {
    let norm = length(a);
    (norm > 1e-9).then(|| a.map(|x| x / norm))
}

/// The part of `a` across a unit vector, as a unit vector; `None` where they are parallel.
pub(super) fn across(a: Vector, direction: Vector) -> Option<Vector> {
    unit(along(a, -dot(a, direction), direction))
}
