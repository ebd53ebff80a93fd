//! What every lens says of itself.

use sinew_core::lanes::Real;

/// Where a lens shows a point, and the derivative of that by the point, rows x_d and y_d.
pub(crate) struct Image<V> {
    pub at: [V; 2],
    pub derivative: [[V; 2]; 2],
}

/// Over lanes: where points are shown.
pub(crate) trait Distort: Copy {
    /// Where a point is shown; `square` is its r². Beyond the domain any finite numbers. The derivative is of use with `DERIVATIVE` only. Must be `#[inline(always)]`.
    fn image<V: Real, const DERIVATIVE: bool>(&self, at: [V; 2], square: V) -> Image<V>;
}

/// What a file of this folder says of its lens.
pub(crate) trait DistortionModel: Distort {
    /// Whether `Calib.toml` marks it by `fisheye = true`.
    const IS_FISHEYE: bool;
    /// How many coefficients there are, and which: a part of a sentence.
    const COEFFICIENTS: &'static str;

    /// The lens with these coefficients, if it takes that number.
    fn from_coefficients(coefficients: &[f64]) -> Option<Self>;

    /// What [`DistortionModel::from_coefficients`] takes.
    fn coefficients(&self) -> Vec<f64>;

    /// Largest radius up to which the lens is one-to-one, its decentring aside.
    fn valid_radius(&self) -> f64;

    /// Radius at which a point at this radius is shown, decentring aside.
    fn radius_after(&self, radius: f64) -> f64;
}
