//! Rotations of 3-space as files give them: Rodrigues vectors, matrices with rounding errors, Euler angles.
//!
//! A Rodrigues vector has the direction of the axis and the length of the angle. Matrices are rows first. The product
//! `R_c(γ) R_b(β) R_a(α)` turns about the fixed axis a first.

/// A 3 × 3 matrix, rows first.
pub type Matrix = [[f64; 3]; 3];

/// The matrix that changes nothing.
pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Matrix product.
#[must_use]
pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let bt = transpose(b);
    a.map(|row| bt.map(|column| dot(row, column)))
}

/// Transpose, which for a rotation is the inverse.
#[must_use]
pub fn transpose(m: &Matrix) -> Matrix {
    let [[a, b, c], [d, e, f], [g, h, i]] = *m;
    [[a, d, g], [b, e, h], [c, f, i]]
}

/// Matrix times vector.
#[must_use]
pub fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| dot(row, v))
}

fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

/// Determinant.
#[must_use]
pub fn determinant(&[a, b, c]: &Matrix) -> f64 {
    dot(a, cross(b, c))
}

/// Rotation about a coordinate axis (0, 1, 2), radians.
#[must_use]
pub fn about_axis(axis: usize, angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    match axis {
        0 => [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
        1 => [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
        _ => [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
    }
}

/// Rotation of a Rodrigues vector.
#[must_use]
pub fn from_rodrigues([x, y, z]: [f64; 3]) -> Matrix {
    let angle = x.hypot(y).hypot(z);
    if angle < f64::MIN_POSITIVE {
        return IDENTITY;
    }
    let (s, c) = (0.5 * angle).sin_cos();
    from_quaternion([c, s * x / angle, s * y / angle, s * z / angle])
}

/// Rodrigues vector of a rotation, length at most π. Goes through the quaternion, so that it is exact near π too.
#[must_use]
pub fn to_rodrigues(m: &Matrix) -> [f64; 3] {
    let [w, x, y, z] = to_quaternion(m);
    let sine = x.hypot(y).hypot(z);
    let (w, sign) = if w < 0.0 { (-w, -1.0) } else { (w, 1.0) };
    let scale = if sine < 1e-150 { 2.0 } else { 2.0 * sine.atan2(w) / sine };
    [x, y, z].map(|v| sign * scale * v)
}

fn from_quaternion([w, x, y, z]: [f64; 4]) -> Matrix {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// Unit quaternion (w, x, y, z) of a rotation.
#[must_use]
pub fn to_quaternion(&[[a, b, c], [d, e, f], [g, h, i]]: &Matrix) -> [f64; 4] {
    // Four times the squares of w, x, y, z: dividing by the largest keeps the precision.
    let squares = [1.0 + a + e + i, 1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i];
    let [ww, xx, yy, zz] = squares;
    let largest = squares.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let unscaled = if ww == largest {
        [ww, h - f, c - g, d - b]
    } else if xx == largest {
        [h - f, xx, b + d, c + g]
    } else if yy == largest {
        [c - g, b + d, yy, f + h]
    } else {
        [d - b, c + g, f + h, zz]
    };
    let norm = unscaled.iter().map(|v| v * v).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
    unscaled.map(|v| v / norm)
}

/// Largest entry of `R'R − 1`.
#[must_use]
pub fn orthonormality_error(m: &Matrix) -> f64 {
    let square = product(&transpose(m), m);
    let differences = square.iter().flatten().zip(IDENTITY.iter().flatten()).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, |worst, d| if d > worst || d.is_nan() { d } else { worst })
}

/// Nearest rotation to a matrix that is almost one (Newton's iteration for the polar factor, Higham 1986).
#[must_use]
pub fn nearest_rotation(m: &Matrix) -> Matrix {
    let mut r = *m;
    for _ in 0..20 {
        if orthonormality_error(&r) <= 4.0 * f64::EPSILON {
            break;
        }
        let [a, b, c] = r;
        let scale = 1.0 / determinant(&r);
        let inverse_transpose = [cross(b, c), cross(c, a), cross(a, b)].map(|row| row.map(|v| v * scale));
        let pairs = r.into_iter().zip(inverse_transpose);
        let mean: Vec<[f64; 3]> =
            pairs.map(|(x, y)| [0.5 * (x[0] + y[0]), 0.5 * (x[1] + y[1]), 0.5 * (x[2] + y[2])]).collect();
        if let [x, y, z] = mean[..] {
            r = [x, y, z];
        }
    }
    r
}

/// Angles `[z, y, x]` in radians with `R = R_z R_y R_x`; y lies in \[−π/2, π/2\], and x is 0 where z and x cannot be distinguished.
#[must_use]
pub fn to_zyx(&[[a, b, _], [d, e, _], [g, h, i]]: &Matrix) -> [f64; 3] {
    let cos_y = h.hypot(i);
    if cos_y < 1e-9 {
        return [(-b).atan2(e), (-g).atan2(cos_y), 0.0];
    }
    [d.atan2(a), (-g).atan2(cos_y), h.atan2(i)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(a: &Matrix, b: &Matrix) -> f64 {
        a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_quarter_turn_about_z_takes_x_to_y() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for turn in [about_axis(2, quarter), from_rodrigues([0.0, 0.0, quarter])] {
            let [x, y, z] = apply(&turn, [1.0, 0.0, 0.0]);
            assert!(x.abs() < 1e-15 && (y - 1.0).abs() < 1e-15 && z == 0.0);
        }
    }

    #[test]
    fn vectors_and_matrices_agree_up_to_half_a_turn() {
        for v in [[0.0; 3], [1e-9, 0.0, 0.0], [0.3, -0.2, 0.5], [3.0, 0.5, 0.7], [0.0, -std::f64::consts::PI, 0.0]] {
            let m = from_rodrigues(v);
            assert!(orthonormality_error(&m) < 1e-15, "{v:?}");
            assert!((determinant(&m) - 1.0).abs() < 1e-15, "{v:?}");
            assert!(distance(&m, &from_rodrigues(to_rodrigues(&m))) < 1e-15, "{v:?}");
        }
    }

    #[test]
    fn the_nearest_rotation_is_one_and_near() {
        let m = from_rodrigues([0.3, -0.2, 0.5]);
        let off = m.map(|row| row.map(|v| v + 1e-4));
        let repaired = nearest_rotation(&off);
        assert!(orthonormality_error(&repaired) < 1e-15);
        assert!(distance(&repaired, &off) < 3e-4);
    }

    #[test]
    fn zyx_angles_rebuild_the_matrix() {
        for [z, y, x] in [[0.4, -0.9, 2.0], [-3.0, 1.5, -1.0], [0.7, std::f64::consts::FRAC_PI_2, 0.2]] {
            let build =
                |[z, y, x]: [f64; 3]| product(&product(&about_axis(2, z), &about_axis(1, y)), &about_axis(0, x));
            let m = build([z, y, x]);
            assert!(distance(&m, &build(to_zyx(&m))) < 1e-9, "{z} {y} {x}");
        }
    }
}
