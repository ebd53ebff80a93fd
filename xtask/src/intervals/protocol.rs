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
/// Least probability of ranks as unequal as those found, were they uniform (over coordinates by Bonferroni).
pub(super) const LEAST_P: f64 = 0.01;
/// Of angles, lengths, distances and displacements, about [`NOMINAL`].
pub(super) const DERIVED: f64 = 5.0;
/// Mean distance of a reliability curve from the diagonal, percent.
pub(super) const RELIABILITY: f64 = 5.0;

/// Seed of the first simulated rig.
pub(super) const FIRST_RIG: u64 = 1;

/// Seed of the first demo of what follows from draws.
pub(super) const FIRST_DERIVED: u64 = 1001;

/// Levels of reliability curves. With [`DRAWS`] draws all their central intervals are exact.
pub(super) const CURVE: [f64; 19] =
    [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95];
/// Draws among which truths are ranked.
pub(super) const DRAWS: usize = 119;
/// Bins of ranks that are tested for uniformity.
pub(super) const BINS: usize = 20;

/// Keypoints of all recordings.
pub(super) const LAYOUT: &str = "BODY_25B";

/// Frames per second of the real recording.
pub(super) const FPS: f64 = 60.0;

pub(super) const CAMERAS: [&str; 4] = ["cam_01", "cam_02", "cam_03", "cam_04"];

/// The real recording.
pub(super) struct Recording {
    pub(super) calibration: PathBuf,
    pub(super) keypoints: PathBuf,
}

impl Recording {
    pub(super) fn flags(&self, cameras: &[&str]) -> Vec<String> {
        let (calibration, keypoints, cameras) = (shown(&self.calibration), shown(&self.keypoints), cameras.join(","));
        let rate = FPS.to_string();
        let flags = ["--calibration", &calibration, "--keypoints", &keypoints, "--cameras", &cameras, "--fps", &rate];
        let rest = ["--layout", LAYOUT, "--threads", "1", "--force", "--no-progress"];
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
