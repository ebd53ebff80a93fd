//! What is run, and the bounds of what comes of it.

use crate::program::shown;
use std::path::PathBuf;

/// Seed of the first demo.
pub(super) const FIRST_SEED: u64 = 101;

/// Bounds of the share inside 90 % intervals, percent, fixed before the first run.
pub(super) const NOMINAL: f64 = 90.0;
pub(super) const WITHIN: f64 = 3.0;
pub(super) const LEFT_OUT: [f64; 2] = [86.0, 94.0];
pub(super) const EACH_CAMERA: [f64; 2] = [80.0, 98.0];
pub(super) const TWO_USED: [f64; 2] = [84.0, 96.0];
pub(super) const PAIRS: f64 = 85.0;

pub(super) const CAMERAS: [&str; 4] = ["cam_01", "cam_02", "cam_03", "cam_04"];

/// The real recording.
pub(super) struct Recording {
    pub(super) calibration: PathBuf,
    pub(super) keypoints: PathBuf,
}

impl Recording {
    pub(super) fn flags(&self, cameras: &[&str]) -> Vec<String> {
        let (calibration, keypoints, cameras) = (shown(&self.calibration), shown(&self.keypoints), cameras.join(","));
        let flags = ["--calibration", &calibration, "--keypoints", &keypoints, "--cameras", &cameras];
        let rest = ["--layout", "BODY_25B", "--fps", "60", "--threads", "1", "--force", "--no-progress"];
        flags.into_iter().chain(rest).map(str::to_owned).collect()
    }
}

/// All sets of cameras of a size.
pub(super) fn sets(size: usize) -> Vec<Vec<&'static str>> {
    let chosen = |bits: &u32| bits.count_ones() as usize == size;
    let names = |bits: u32| (0..CAMERAS.len()).filter(|c| bits >> c & 1 == 1).map(|c| CAMERAS[c]).collect();
    (0..1_u32 << CAMERAS.len()).filter(chosen).map(names).collect()
}

pub(super) fn verdict(met: bool) -> &'static str {
    if met { "met" } else { "**missed**" }
}

pub(super) fn is_in(value: f64, [low, high]: [f64; 2]) -> bool {
    (low..=high).contains(&value)
}
