//! The settings of a tracking run as one plain value.

use super::Resolved;
use super::value::Value;
use crate::track::{Method, Score};
use sinew_dynamics::random_walk::Between;
use sinew_observe::Noise;
use sinew_observe::image_score::ImageScore;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Settings of a tracking run.
#[derive(Clone, Debug)]
pub struct TrackConfig {
    /// Calibration file.
    pub calibration: Option<PathBuf>,
    /// Keypoint folder.
    pub keypoints: Option<PathBuf>,
    /// Folder of masks.
    pub silhouettes: Option<PathBuf>,
    /// Folder of images.
    pub images: Option<PathBuf>,
    /// Size of the masks over that of the calibrated images; that of the keypoints' images if `None`.
    pub mask_scale: Option<f64>,
    /// Where tracking from silhouettes alone begins.
    pub init: Option<Init>,
    /// Name of a layout or path of a mapping file.
    pub layout: Option<String>,
    /// Confidence that means certainty.
    pub confidence_scale: f64,
    /// Size of the images over that of the calibrated ones.
    pub image_scale: f64,
    /// Frames to track.
    pub frames: Option<Range<u64>>,
    /// Frames per second.
    pub fps: Option<f64>,
    /// Cameras to use.
    pub cameras: Option<Vec<String>>,
    /// Whether sizes and speeds that no person has are taken.
    pub any_size: bool,
    /// Frames that cameras are late.
    pub lag: Vec<(String, i64)>,
    /// Which person: 0 is the most complete one at the start.
    pub person: Option<usize>,
    /// Whether cameras may begin and end apart.
    pub trim: bool,
    /// Axis of the calibration's world that points up; `+z`, or what the set-up says, if `None`.
    pub up_axis: Option<String>,
    /// Tracker.
    pub method: Method,
    /// `h32`, `cf28` or the path of a body file.
    pub body: String,
    /// What a frame hands on to the next.
    pub prior: Between,
    /// Density of a keypoint.
    pub noise: Noise,
    /// Keypoints of lower confidence count as missing.
    pub least_confidence: f64,
    /// Factor on the motion noise that the set-up pass found.
    pub motion_scale: f64,
    /// Set-up of an earlier run.
    pub setup: Option<PathBuf>,
    /// Frames for the set-up pass.
    pub setup_frames: Option<Range<u64>>,
    /// Whether a backward pass follows.
    pub smooth: bool,
    /// Seed.
    pub seed: u64,
    /// Chains of a frame.
    pub chains: usize,
    /// Updates of each chain in a frame.
    pub updates: usize,
    /// First samples of each chain that are discarded.
    pub burn_in: usize,
    /// Particles.
    pub particles: usize,
    /// Layers of the annealed filter.
    pub layers: usize,
    /// Share of the particles that survives a layer.
    pub survival: f64,
    /// Whether diffusion adapts to the particles that survived.
    pub adaptive: bool,
    /// Share of the particles that is crossed in each layer.
    pub crossover: f64,
    /// Particles of the fine level.
    pub fine: usize,
    /// Weighting function of silhouettes.
    pub score: ImageScore,
    /// Longest side to which masks are reduced, pixels.
    pub raster: usize,
    /// Draws of a frame that are written.
    pub draws: usize,
    /// Relative jitter of the step size.
    pub jitter: f64,
    /// Instruction set; the best if `None`.
    pub simd: Option<String>,
    /// Threads; as many as the system grants if `None`.
    pub threads: Option<usize>,
    /// Where diagnostics fail.
    pub limits: crate::results::Limits,
    /// Output folder.
    pub out: PathBuf,
    /// Seconds between checkpoints.
    pub checkpoint_every: f64,
    /// Whether results there may be replaced.
    pub force: bool,
}

/// Where tracking from silhouettes alone begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Init {
    /// Keypoints, which are not used for tracking.
    Keypoints,
    /// Points in space over time, a TRC file.
    Points(PathBuf),
}

impl Resolved {
    /// The settings of a tracking run.
    #[must_use]
    pub fn track(&self) -> TrackConfig {
        let trial = self.trial_folder().and_then(|folder| Some(folder.file_name()?.to_string_lossy().into_owned()));
        let default_out = || Path::new("sinew-out").join(trial.clone().unwrap_or_else(|| "trial".into()));
        let method = self.text("method").and_then(|name| Method::named(&name)).unwrap_or_default();
        let score = self.text("score").and_then(|name| Score::named(&name)).unwrap_or_else(|| method.usual_score());
        TrackConfig {
            calibration: self.path("calibration"),
            keypoints: self.path("keypoints"),
            silhouettes: self.path("silhouettes"),
            images: self.path("images"),
            mask_scale: self.number("mask_scale"),
            init: match (self.path("init"), self.text("init").as_deref()) {
                (Some(path), _) => Some(Init::Points(path)),
                (None, Some(_)) => Some(Init::Keypoints),
                (None, None) => None,
            },
            layout: self.text("layout"),
            confidence_scale: self.number("confidence_scale").unwrap_or(1.0),
            image_scale: self.number("image_scale").unwrap_or(1.0),
            frames: self.frames("frames"),
            fps: self.number("fps"),
            cameras: match self.get("cameras") {
                Some(Value::Names(names)) => Some(names.clone()),
                _ => None,
            },
            any_size: self.flag("any_size"),
            lag: match self.get("lag") {
                Some(Value::Lags(lags)) => lags.clone(),
                _ => vec![],
            },
            person: self.count("person").and_then(|person| usize::try_from(person).ok()),
            trim: self.flag("trim"),
            up_axis: self.text("up_axis"),
            method,
            body: self.text("body").unwrap_or_default(),
            prior: match self.text("prior").as_deref() {
                Some("mixture") => Between::Mixture,
                _ => Between::Gaussian,
            },
            noise: match self.text("noise").as_deref() {
                Some("student-t") => Noise::StudentT { degrees: self.number("degrees").unwrap_or(4.0) },
                _ => Noise::OutlierFloor { outlier: self.number("outlier").unwrap_or(0.02) },
            },
            least_confidence: self.number("least_confidence").unwrap_or_default(),
            motion_scale: self.number("motion_scale").unwrap_or(1.0),
            setup: self.path("setup"),
            setup_frames: self.frames("setup_frames"),
            smooth: self.flag("smooth"),
            seed: self.count("seed").unwrap_or_default(),
            chains: self.size("chains"),
            particles: self.count("particles").map_or_else(|| method.usual_particles(), |_| self.size("particles")),
            layers: self.size("layers"),
            survival: self.number("survival").unwrap_or(0.5),
            adaptive: self.flag("adaptive"),
            crossover: self.number("crossover").unwrap_or_default(),
            fine: self.size("fine"),
            score: score.with_kappa(self.number("kappa").unwrap_or(1.0)),
            raster: self.size("raster"),
            draws: self.size("draws"),
            updates: self.size("updates"),
            burn_in: self.size("burn_in"),
            jitter: self.number("jitter").unwrap_or_default(),
            simd: self.text("simd"),
            threads: self.count("threads").map(|threads| usize::try_from(threads).unwrap_or(usize::MAX)),
            limits: crate::results::Limits {
                r_hat: self.number("max_r_hat").unwrap_or(f64::INFINITY),
                r_hat_share: self.number("max_r_hat_share").unwrap_or(1.0),
                divergent_share: self.number("max_divergent_share").unwrap_or(1.0),
                ess: self.number("min_ess").unwrap_or_default(),
            },
            out: self.path("out").unwrap_or_else(default_out),
            checkpoint_every: self.number("checkpoint_every").unwrap_or_default(),
            force: self.flag("force"),
        }
    }
}
