//! Rotations as 3 × 3 matrices, rows first.

/// A 3 × 3 matrix, rows first.
pub type Matrix = [[f64; 3]; 3];

/// The rotation that turns nothing.
pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// `a b`.
#[must_use]
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let column = |j: usize| b.map(|row| row[j]);
    a.map(|row| [0, 1, 2].map(|j| dot(row, column(j))))
}

/// `m v`.
#[must_use]
pub fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| dot(row, v))
}

/// Right-handed rotation about a unit vector, radians (Rodrigues' formula).
#[must_use]
pub fn about([x, y, z]: [f64; 3], angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    let t = 1.0 - c;
    [
        [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
    ]
}

/// Whether rows are unit vectors across each other, and right-handed, to 1e-6; not where a number is not finite.
pub(crate) fn is_rotation(m: &Matrix) -> bool {
    let [a, b, c] = *m;
    let is = |found: f64, expected: f64| (found - expected).abs() < 1e-6;
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    is(dot(a, a), 1.0) && is(dot(b, b), 1.0) && is(dot(a, b), 0.0) && (0..3).all(|k| is(cross[k], c[k]))
}

fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}
