//! What is run, and the bounds of what comes of it.

use crate::support::program::shown;
use std::path::{Path, PathBuf};

/// Seed of the first demo.
pub(super) const FIRST_SEED: u64 = 101;

/// Bounds of the share inside 90 % intervals, percent, fixed before the first run.
pub(super) const NOMINAL: f64 = 90.0;
pub(super) const WITHIN: f64 = 3.0;
pub(super) const LEFT_OUT: [f64; 2] = [86.0, 94.0];
pub(super) const EACH_CAMERA: [f64; 2] = [80.0, 98.0];
pub(super) const TWO_USED: [f64; 2] = [84.0, 96.0];
/// Of the recording that no tuning has touched: three cameras used, and two.
pub(super) const UNTOUCHED: [[f64; 2]; 2] = [[84.0, 96.0], [84.0, 96.0]];
pub(super) const PAIRS: f64 = 85.0;
/// Least probability of ranks as unequal as those found, were they uniform (over coordinates by Bonferroni).
pub(super) const LEAST_P: f64 = 0.01;
/// Of angles, lengths, distances and displacements, about [`NOMINAL`].
pub(super) const DERIVED: f64 = 5.0;
/// Mean distance of a reliability curve from the diagonal, percent.
pub(super) const RELIABILITY: f64 = 5.0;

/// First seed of runs of recordings.
pub(super) const FIRST_RUN: u64 = 1;

/// Seed of the first simulated rig.
pub(super) const FIRST_RIG: u64 = 1;

/// Seed of the first demo of what follows from draws.
pub(super) const FIRST_DERIVED: u64 = 1001;

/// First seed of demos whose angles are held against the truth.
pub(super) const FIRST_ANGLES: u64 = 2101;

/// Levels of reliability curves. With [`DRAWS`] draws all their central intervals are exact.
pub(super) const CURVE: [f64; 19] =
    [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95];
/// Draws among which truths are ranked.
pub(super) const DRAWS: usize = 119;
/// Bins of ranks that are tested for uniformity.
pub(super) const BINS: usize = 20;

/// Keypoints of all recordings.
pub(super) const LAYOUT: &str = "BODY_25B";

/// Cameras of the recording that was tuned on.
pub(super) const CAMERAS: [&str; 4] = ["cam_01", "cam_02", "cam_03", "cam_04"];

/// A real recording, and how it is judged.
pub(super) struct Recording {
    pub(super) calibration: PathBuf,
    pub(super) keypoints: PathBuf,
    pub(super) cameras: [&'static str; 4],
    /// What the files of keypoints call the cameras.
    pub(super) files: [&'static str; 4],
    pub(super) fps: f64,
    pub(super) frames: usize,
    /// What the names of its cells of left-out cameras begin with.
    pub(super) cells: &'static str,
    /// Bounds of all cameras together, of three and of two used.
    pub(super) bounds: [[f64; 2]; 2],
    /// Bound of each camera, of three used.
    pub(super) each: Option<[f64; 2]>,
}

impl Recording {
    pub(super) fn flags(&self, cameras: &[&str], seed: u64) -> Vec<String> {
        let (calibration, keypoints, cameras) = (shown(&self.calibration), shown(&self.keypoints), cameras.join(","));
        let (rate, seed) = (self.fps.to_string(), seed.to_string());
        let flags = ["--calibration", &calibration, "--keypoints", &keypoints, "--cameras", &cameras, "--fps", &rate];
        let rest = ["--layout", LAYOUT, "--seed", &seed, "--threads", "1", "--force", "--no-progress"];
        flags.into_iter().chain(rest).map(str::to_owned).collect()
    }

    /// Name of the cell of a run with some cameras left out.
    pub(super) fn cell(&self, used: &[&str], seed: u64) -> String {
        format!("{}/{}/{seed}", self.cells, used.join("+"))
    }

    /// The sets of cameras that runs use: of three, then of two.
    pub(super) fn sets(&self) -> Vec<Vec<&'static str>> {
        [sets(&self.cameras, 3), sets(&self.cameras, 2)].concat()
    }

    /// The file of keypoints of a camera and frame.
    pub(super) fn file(&self, camera: &str, frame: u64) -> Option<PathBuf> {
        let name = self.files[self.cameras.iter().position(|known| *known == camera)?];
        Some(self.keypoints.join(format!("{name}_json/{name}.{frame:04}.json")))
    }
}

/// The recording that was tuned on.
pub(super) fn tuned_on(folder: &Path) -> Recording {
    Recording {
        calibration: folder.join("Calib.toml"),
        keypoints: folder.join("T01_BalancingTrial/pose"),
        cameras: CAMERAS,
        files: ["cam01", "cam02", "cam03", "cam04"],
        fps: 60.0,
        frames: 100,
        cells: "left out",
        bounds: [LEFT_OUT, TWO_USED],
        each: Some(EACH_CAMERA),
    }
}

/// All sets of a size of some cameras.
pub(super) fn sets(cameras: &[&'static str; 4], size: usize) -> Vec<Vec<&'static str>> {
    let chosen = |bits: &u32| bits.count_ones() as usize == size;
    let names = |bits: u32| (0..cameras.len()).filter(|c| bits >> c & 1 == 1).map(|c| cameras[c]).collect();
    (0..1_u32 << cameras.len()).filter(chosen).map(names).collect()
}

pub(super) fn is_in(value: f64, [low, high]: [f64; 2]) -> bool {
    (low..=high).contains(&value)
}
