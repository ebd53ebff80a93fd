//! Worlds whose z axis does not point up, and the turn that mends them.

use sinew_observe::Camera;

/// The axis that points up in every world of ours.
pub const Z_UP: &str = "+z";

/// The rotation that takes a world whose `up` axis is one of `+x`, `-x`, `+y`, `-y`, `+z`, `-z` to one with z up, for [`Camera::turned`]; `None` for other names.
#[must_use]
pub fn z_up_from(up: &str) -> Option<[[f64; 3]; 3]> {
    Some(match up {
        "+x" => [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        "-x" => [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]],
        "+y" => [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        "-y" => [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
        "+z" => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        "-z" => [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        _ => return None,
    })
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
    let axis = (0..3).find(|&k| before[k] != 0.0).unwrap_or(2);
    AXES[axis][usize::from(before[axis] > 0.0)]
}

/// Cameras in a world turned to z up. Nothing is computed for the usual world, so that its numbers stay as they are.
pub fn upright(cameras: Vec<Camera>, up: &str) -> Vec<Camera> {
    match z_up_from(up) {
        Some(turn) if up != "+z" => cameras.iter().map(|camera| camera.turned(turn)).collect(),
        _ => cameras,
    }
}
