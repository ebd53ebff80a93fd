//! Pinhole camera with Brown distortion.
//!
//! A world point `P` (metres) becomes `P_c = R P + t` in the camera frame (x right, y down, z forward), then
//!
//! ```text
//! (x, y) = (X_c / Z_c, Y_c / Z_c)          r² = x² + y²
//! x_d = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2 x²)
//! y_d = y (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p2 x y + p1 (r² + 2 y²)
//! u = fx x_d + cx,   v = fy y_d + cy       (pixels)
//! ```
//!
//! Points with depth `Z_c` ≤ [`MIN_DEPTH_M`] have no projection.

/// Depth in metres at or below which a point is not seen by a camera.
pub const MIN_DEPTH_M: f64 = 0.05;

/// Focal lengths and principal point, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Focal length along u.
    pub fx: f64,
    /// Focal length along v.
    pub fy: f64,
    /// Principal point, u.
    pub cx: f64,
    /// Principal point, v.
    pub cy: f64,
}

/// Brown distortion coefficients (all zero: none).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Distortion {
    /// Radial coefficient of r².
    pub k1: f64,
    /// Radial coefficient of r⁴.
    pub k2: f64,
    /// First tangential coefficient.
    pub p1: f64,
    /// Second tangential coefficient.
    pub p2: f64,
    /// Radial coefficient of r⁶.
    pub k3: f64,
}

/// A calibrated camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name, as the calibration gives it.
    pub name: String,
    /// Image width and height, pixels.
    pub image_size_px: [f64; 2],
    /// Focal lengths and principal point.
    pub intrinsics: Intrinsics,
    /// Lens distortion.
    pub distortion: Distortion,
    /// Rotation, camera from world, rows first.
    pub rotation: [[f64; 3]; 3],
    /// Translation, camera from world, metres.
    pub translation: [f64; 3],
}
