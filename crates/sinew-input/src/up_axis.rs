//! Worlds whose z axis does not point up, and the turn that mends them.
//!
//! What points up is an axis (`-y`) or a direction `X,Y,Z` in the calibration's world, of any length.

use sinew_observe::Camera;

/// The axis that points up in every world of ours.
pub const Z_UP: &str = "+z";

/// The rotation that takes a world to one with z up, for [`Camera::turned`]; `up` is one of `+x`, `-x`, `+y`, `-y`, `+z`, `-z`, or a direction. `None` for other names.
#[must_use]
pub fn z_up_from(up: &str) -> Option<[[f64; 3]; 3]> {
    Some(match up {
        "+x" => [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        "-x" => [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]],
        "+y" => [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        "-y" => [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
        "+z" => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        "-z" => [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        _ => return direction(up).map(z_from_direction),
    })
}

/// The unit vector of a direction `X,Y,Z`; `None` for other texts and for no direction.
#[must_use]
pub fn direction(text: &str) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = text.split(',').map(|number| number.trim().parse().ok()).collect::<Option<_>>()?;
    let &[x, y, z] = numbers.as_slice() else { return None };
    let length = x.hypot(y).hypot(z);
    (length.is_finite() && length > 0.0).then(|| [x, y, z].map(|coordinate| coordinate / length))
}

/// A direction as [`direction`] reads it.
#[must_use]
pub fn direction_text([x, y, z]: [f64; 3]) -> String {
    format!("{x:.6},{y:.6},{z:.6}")
}

/// The smallest turn that takes a unit vector to z. A vector that points down is turned about x by half a turn first, where the smallest turn has no axis.
fn z_from_direction([x, y, z]: [f64; 3]) -> [[f64; 3]; 3] {
    /// Below this there is no axis.
    const DOWN: f64 = -0.999;
    if z < DOWN {
        return z_from_direction([x, -y, -z]).map(|[a, b, c]| [a, -b, -c]);
    }
    let share = 1.0 / (1.0 + z);
    [[1.0 - share * x * x, -share * x * y, -x], [-share * x * y, 1.0 - share * y * y, -y], [x, y, z]]
}

/// Names of the axes, downwards and upwards.
pub const AXES: [[&str; 2]; 3] = [["-x", "+x"], ["-y", "+y"], ["-z", "+z"]];

/// The name, in a world whose axis `declared` was turned to z, of the axis that is now called `turned`: what is to be declared instead.
#[must_use]
pub fn axis_before_turning(turned: &str, declared: &str) -> &'static str {
    let along = |name: &str| {
        let axis = ["x", "y", "z"].iter().position(|axis| name.ends_with(axis)).unwrap_or(2);
        (axis, if name.starts_with('-') { -1.0 } else { 1.0 })
    };
    let (row, sign) = along(turned);
    let before = z_up_from(declared).map_or([0.0, 0.0, 1.0], |turn| turn[row].map(|x| sign * x));
    let axis = (0..3).max_by(|&a, &b| before[a].abs().total_cmp(&before[b].abs())).unwrap_or(2);
    AXES[axis][usize::from(before[axis] > 0.0)]
}

/// Cameras in a world turned to z up. Nothing is computed for the usual world, so that its numbers stay as they are.
pub fn upright(cameras: Vec<Camera>, up: &str) -> Vec<Camera> {
    match z_up_from(up) {
        Some(turn) if up != "+z" => cameras.iter().map(|camera| camera.turned(turn)).collect(),
        _ => cameras,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_turned_to_z() {
        for up in ["0,0,2", "2,0,0", "-0.4, 1.2, -1.1", "0,0,-1", "0.001,0.002,-1", "1e-3,0,5"] {
            let turn = z_up_from(up).unwrap();
            let unit = direction(up).unwrap();
            for (row, wanted) in turn.iter().zip([0.0, 0.0, 1.0]) {
                assert!(
                    (row.iter().zip(unit).map(|(a, b)| a * b).sum::<f64>() - wanted).abs() < 1e-12,
                    "{up}: {turn:?}"
                );
            }
            for (i, a) in turn.iter().enumerate() {
                for (j, b) in turn.iter().enumerate() {
                    let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                    assert!((product - f64::from(i == j)).abs() < 1e-12, "{up}: {turn:?}");
                }
            }
            let [a, b, c] = turn;
            let determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                + a[2] * (b[0] * c[1] - b[1] * c[0]);
            assert!((determinant - 1.0).abs() < 1e-12, "{up}");
        }
        for text in ["0,0,0", "1,2", "1,2,3,4", "up", "nan,0,1", "inf,0,1", ""] {
            assert_eq!(z_up_from(text), None, "{text}");
        }
        let read = direction(&direction_text([0.6, 0.0, -0.8])).unwrap();
        assert!((read[0] - 0.6).abs() < 1e-6 && (read[2] + 0.8).abs() < 1e-6);
    }
}
