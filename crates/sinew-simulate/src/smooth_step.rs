//! A step from 0 to 1 without corners, and its integral.

/// 0 before 0, 1 after 1, and between them a quintic with two zero derivatives at both ends.
pub(crate) fn step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

/// Integral of [`step`] from 0.
pub(crate) fn step_integral(t: f64) -> f64 {
    let s = t.clamp(0.0, 1.0);
    s * s * s * s * (2.5 + s * (s - 3.0)) + (t - 1.0).max(0.0)
}
