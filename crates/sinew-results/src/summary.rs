//! `summary.json`: what was run, with which settings, and whether to believe it.
//!
//! Everything in it is the same from run to run. A diagnostic *fails* above the [`Limits`]: then the program ends with code 4. Frames without observation and large
//! residuals are warnings.

use serde::Serialize;
use sinew_input::world_turn::WorldTurn;
use sinew_setup::silhouette_overlap::SilhouetteOverlap;
use sinew_setup::uncertainty::Uncertainty;
use std::collections::BTreeMap;

/// Version of the layout of this file.
pub(super) const SCHEMA_VERSION: u32 = 1;

/// R-hat above which a frame is counted.
pub(super) const R_HAT_NOTED: f64 = 1.05;

/// Where diagnostics fail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Split R-hat of a frame.
    pub r_hat: f64,
    /// Share of frames that may be above it.
    pub r_hat_share: f64,
    /// Share of trajectories that may diverge.
    pub divergent_share: f64,
    /// Least median effective sample size of a particle method.
    pub ess: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { r_hat: R_HAT_NOTED, r_hat_share: 0.05, divergent_share: 0.01, ess: 10.0 }
    }
}

/// How a run ended.
#[derive(Clone, Debug, Default)]
pub struct Ending {
    /// Whether all frames were tracked.
    pub complete: bool,
    /// What was tracked, as random streams know it.
    pub identity: Option<String>,
    /// Frames of a live run that were left out, since they came faster than they could be tracked.
    pub skipped_frames: u64,
    /// Warnings of the input and the tracker, each once.
    pub warnings: Vec<String>,
    /// Hashes of the inputs, by name.
    pub input_hashes: BTreeMap<String, String>,
    /// How well the tracked body covers each camera's silhouettes; empty without silhouettes.
    pub coverage: Vec<SilhouetteOverlap>,
    /// Where diagnostics fail.
    pub limits: Limits,
    /// Wall times and dates, for `timings.json`.
    pub timings: serde_json::Map<String, serde_json::Value>,
}

const fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// Content of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Version of this layout.
    pub schema_version: u32,
    /// Whether all frames were tracked.
    pub complete: bool,
    /// Version of the program.
    pub sinew_version: &'static str,
    /// Method.
    pub method: String,
    /// `filtered` or `smoothed`.
    pub kind: &'static str,
    /// Seed.
    pub seed: u64,
    /// What was tracked, as random streams know it; none where nobody was seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub identity: Option<String>,
    /// Instruction set.
    pub isa: String,
    /// Frames per second.
    pub fps: f64,
    /// First frame and the one after the last.
    pub frames: [u64; 2],
    /// Frames written.
    pub frame_count: u64,
    /// Frames in which a camera saw the person.
    pub observed_frames: u64,
    /// Frames, after the first one written, in which tracking was restarted.
    pub restarted_frames: u64,
    /// Frames of a live run that came faster than they could be tracked, and were left out.
    #[serde(skip_serializing_if = "is_zero")]
    pub skipped_frames: u64,
    /// Degrees of freedom of the body.
    pub degrees_of_freedom: usize,
    /// How the calibration's world was turned, if it was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world: Option<WorldTurn>,
    /// Angles of joints.
    pub angles: AnglesSummary,
    /// What the cameras say.
    pub cameras: Vec<CameraSummary>,
    /// Diagnostics.
    pub diagnostics: Diagnostics,
    /// What the uncertainty comes from, where the set-up says what it has of what is constant.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<Uncertainty>,
    /// Diagnostics that failed, in words.
    pub failed_diagnostics: Vec<String>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Hashes of the inputs.
    pub input_hashes: BTreeMap<String, String>,
    /// Settings with their origins.
    pub settings: serde_json::Value,
    /// Hash of the settings, without threads and paths.
    pub settings_hash: String,
}

/// What angles follow, and which of them keypoints do not show.
#[derive(Clone, Debug, Serialize)]
pub struct AnglesSummary {
    /// `opensim` or `isb`.
    pub convention: &'static str,
    /// Share of the frames in which an angle is not seen (`seen` in `angles.csv`), by its name; without those that always are.
    pub unseen: BTreeMap<String, f64>,
    /// What a standing trial took off each angle: mean and standard deviation, degrees, by its name; empty without such a trial.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub zero_deg: BTreeMap<String, [f64; 2]>,
}

/// What a camera says.
#[derive(Clone, Debug, Serialize)]
pub struct CameraSummary {
    /// Name.
    pub name: String,
    /// Frames in which it saw the person.
    pub frames: u64,
    /// Median over the frames of the residual of the mean pose, pixels.
    pub residual_px: Option<f64>,
    /// Constant offset, observed minus projected, pixels.
    pub offset_px: [f64; 2],
    /// How well the tracked body covers its silhouettes, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub silhouettes: Option<SilhouetteOverlap>,
}

/// Spread of a number over the frames.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Frames above 1.05.
    pub frames_above_1_05: u64,
}

/// Diagnostics of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnostics {
    /// Mean acceptance probability; `null` where nothing is accepted or rejected.
    pub acceptance: Option<f64>,
    /// Split R-hat over a frame's chains; `null` for particle methods.
    pub r_hat: Option<Spread>,
    /// Median over the frames of the E-BFMI of their chains; `null` for particle methods.
    pub energy_fraction: Option<f64>,
    /// Median over the frames of the share of particles off the manifold of learned poses; `null` for methods that do not count them.
    pub off_manifold: Option<f64>,
    /// Median effective sample size.
    pub ess_median: Option<f64>,
    /// Least effective sample size.
    pub ess_least: Option<f64>,
    /// Divergent trajectories.
    pub divergences: u64,
    /// Trajectories.
    pub trajectories: u64,
    /// Log evidence of all frames, where the method estimates it.
    pub log_evidence: Option<f64>,
}
