//! An image size that does not fit the calibration, and the scale that would.

/// An image size that does not fit a calibrated one.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{camera} calibrated at {:.0}x{:.0}{}, {many} are {}x{}", calibrated[0], calibrated[1], self.declared(), size[0], size[1])]
pub struct SizeMisfit {
    /// Camera.
    pub camera: String,
    /// Word for the images.
    pub many: &'static str,
    /// Size of the calibrated images, pixels.
    pub calibrated: [f64; 2],
    /// Size of the images over that of the calibrated ones, as declared.
    pub scale: Option<f64>,
    /// Size of the images, pixels.
    pub size: [usize; 2],
    /// The scale that would fit, if any does.
    pub fitting: Option<f64>,
}

impl SizeMisfit {
    fn declared(&self) -> String {
        let [width, height] = self.calibrated;
        let times = |scale| format!(", times {scale} is {:.0}x{:.0}", scale * width, scale * height);
        self.scale.map(times).unwrap_or_default()
    }
}
