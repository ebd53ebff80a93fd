//! Settings that are of no single method.
//!
//! A setting is a constant, and `values.of(&SEED)` is its value. The same name serves as key in `sinew.toml`, as flag (`--setup-frames` for `setup_frames`) and as environment variable (`SINEW_SETUP_FRAMES`). The order of help and files is that of the table
//! ([`super::table`]). Settings of a single method stand in its file.

#![allow(missing_docs, reason = "the help of a setting says what it is")]

use super::setting::{NamedValues, SAMPLING, SHARE, SettingKind, Typed, choice, setting};
use crate::methods::score::Score;
use sinew_angles::Convention;
use sinew_dynamics::random_walk::Between;
use sinew_input::footage::Init;
use sinew_input::lag::ClockLag;
use std::ops::Range;
use std::path::PathBuf;

const POSITIVE: SettingKind = SettingKind::Number { least: 0.0, excluded: true, most: f64::INFINITY };
/// Beyond these nothing is a camera or a moving person.
const RATE: SettingKind = SettingKind::Number { least: 0.01, excluded: false, most: 1e5 };
const FACTOR: SettingKind = SettingKind::Number { least: 1e-3, excluded: false, most: 1e3 };
const AT_LEAST_ONE: SettingKind = SettingKind::Number { least: 1.0, excluded: false, most: f64::INFINITY };
const NOT_NEGATIVE: SettingKind = SettingKind::Number { least: 0.0, excluded: false, most: f64::INFINITY };
const SHARE_OF_OUTLIERS: SettingKind = SettingKind::Number { least: 0.0, excluded: true, most: 0.5 };
const SCORES: SettingKind = SettingKind::Choice(&Score::NAMES);
const AXES: SettingKind = SettingKind::Choice(&["+x", "-x", "+y", "-y", "+z", "-z"]);
const SETS: SettingKind = SettingKind::Choice(&["avx512", "avx2", "baseline"]);
const INPUT: &str = "Input";
const OUTPUT: &str = "Output";
pub(super) const OF_METHOD: &str = "Method";
const GENERAL: &str = "General";

/// Frames per second that are assumed where none are given.
pub const ASSUMED_FPS: f64 = 30.0;

/// Whom to track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum People {
    /// Everybody.
    All,
    /// The most complete one at the start.
    One,
}

impl NamedValues for People {
    const NAMES: &'static [&'static str] = &["all", "1"];
    const ALL: &'static [Self] = &[Self::All, Self::One];
}

/// Shape of the density of a keypoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseShape {
    /// A Gaussian with a floor for outliers.
    Floor,
    /// Student's t.
    StudentT,
}

impl NamedValues for NoiseShape {
    const NAMES: &'static [&'static str] = &["floor", "student-t"];
    const ALL: &'static [Self] = &[Self::Floor, Self::StudentT];
}

impl NamedValues for Between {
    const NAMES: &'static [&'static str] = &["gaussian", "mixture"];
    const ALL: &'static [Self] = &[Self::Gaussian, Self::Mixture];
}

impl NamedValues for Score {
    const NAMES: &'static [&'static str] = &Self::NAMES;
    const ALL: &'static [Self] = &Self::ALL;
}

impl NamedValues for Convention {
    const NAMES: &'static [&'static str] = &Self::NAMES;
    const ALL: &'static [Self] = &[Self::OpenSim, Self::Isb];
}

pub const CALIBRATION: Typed<Option<PathBuf>> = setting((INPUT, "calibration", SettingKind::Path, "FILE", || None, "calibration of the cameras, of Pose2Sim or another program"));
pub const KEYPOINTS: Typed<Option<PathBuf>> = setting((INPUT, "keypoints", SettingKind::Path, "PATH", || None, "keypoints: a folder <camera>_json per camera, or files of detectors"));
pub const SILHOUETTES: Typed<Option<PathBuf>> = setting((INPUT, "silhouettes", SettingKind::Path, "DIR", || None, "masks of the person, <camera>_<frame>.png or a folder per camera"));
pub const IMAGES: Typed<Option<PathBuf>> = setting((INPUT, "images", SettingKind::Path, "DIR", || None, "images with masks, for edges and (score parts) colours; may be sparse"));
pub const LAYOUT: Typed<Option<String>> = setting((INPUT, "layout", SettingKind::NameOrPath, "NAME", || None, "keypoint layout or mapping file [default: guessed]"));
pub const FRAMES: Typed<Option<Range<u64>>> = setting((INPUT, "frames", SettingKind::Frames, "A..B", || None, "frames to take, by file number [default: all]"));
pub const FPS: Typed<Option<f64>> = setting((INPUT, "fps", RATE, "F", || None, "frames per second [default: 30, with a warning]"));
pub const CAMERAS: Typed<Option<Vec<String>>> = setting((INPUT, "cameras", SettingKind::Names, "LIST", || None, "cameras to use, a,b,c [default: all]"));
pub const PERSON: Typed<Option<usize>> = setting((INPUT, "person", SettingKind::Count(1, 999), "N", || None, "track one of several people: the N-th to come, as `sinew inspect` and people/ number them, from 1 on")).rare();
pub const PEOPLE: Typed<People> = choice((INPUT, "people", "WHO", "whom to track: all whom two cameras see for a quarter of a second in all, or 1, the most complete one at the start")).rare();
pub const SUBJECT: Typed<Option<String>> = setting((INPUT, "subject", SettingKind::Text, "NAME", || None, "who is tracked; `sinew batch` pools what is constant over the trials of one subject")).rare().unhashed();
pub const TRIM: Typed<bool> = setting((INPUT, "trim", SettingKind::Flag, "", || false, "take only the frames that all cameras have"));
pub const LAG: Typed<Option<Vec<(String, ClockLag)>>> = setting((INPUT, "lag", SettingKind::Lags, "LIST", || None, "frames that cameras are late, cam_01=1,cam_03=-2.4; `sinew sync` finds them")).rare();
pub const CONFIDENCE_SCALE: Typed<f64> = setting((INPUT, "confidence_scale", POSITIVE, "C", || 1.0, "confidence that means certainty")).rare();
pub const IMAGE_SCALE: Typed<f64> = setting((INPUT, "image_scale", FACTOR, "S", || 1.0, "size of the images with the keypoints over that of the calibrated images, where they were resized")).rare();
pub const MASK_SCALE: Typed<Option<f64>> = setting((INPUT, "mask_scale", FACTOR, "S", || None, "size of the masks over that of the calibrated images [default: as the keypoints']")).rare();
pub const UP_AXIS: Typed<Option<String>> = setting((INPUT, "up_axis", AXES, "AXIS", || None, "axis of the calibration's world that points up; results are in a world turned to z up [default: +z]")).rare();
pub const UP: Typed<Option<String>> = setting((INPUT, "up", SettingKind::Direction, "X,Y,Z", || None, "direction of the calibration's world that points up, X,Y,Z, or auto: as the person stands; results have it as z")).rare();
pub const BODY: Typed<String> = setting((OF_METHOD, "body", SettingKind::NameOrPath, "NAME", || "h32".into(), "body: h32, cf28, hppf24, hapf31 or a body file"));
pub const SETUP: Typed<Option<PathBuf>> = setting((OF_METHOD, "setup", SettingKind::Path, "FILE", || None, "set-up of an earlier run, its setup.toml"));
pub const INIT: Typed<Option<Init>> = setting((OF_METHOD, "init", SettingKind::NameOrPath, "FROM", || None, "start of silhouettes alone: `keypoints` or a TRC file of points"));
pub const SETUP_FRAMES: Typed<Option<Range<u64>>> = setting((OF_METHOD, "setup_frames", SettingKind::Frames, "A..B", || None, "frames for the set-up, thinned where many [default: all]"));
pub const ANY_SIZE: Typed<bool> = setting((OF_METHOD, "any_size", SettingKind::Flag, "", || false, "take sizes and speeds that no person has")).rare();
pub const SMOOTH: Typed<bool> = setting((OF_METHOD, "smooth", SettingKind::Flag, "", || false, "let every frame see all frames (backward pass)"));
pub const LAG_FRAMES: Typed<u64> = setting((OF_METHOD, "lag_frames", SettingKind::Count(0, 1000), "N", || 0, "let every frame see N frames after it (fixed lag), between the filter and `smooth`")).rare();
pub const PRIOR: Typed<Between> = choice((OF_METHOD, "prior", "NAME", "what a frame hands on to the next: gaussian or mixture")).rare();
pub const MOTION_SCALE: Typed<f64> = setting((OF_METHOD, "motion_scale", FACTOR, "X", || 1.0, "factor on the motion noise that the set-up pass found")).rare();
pub const MOTION_MODEL: Typed<Option<PathBuf>> = setting((OF_METHOD, "motion_model", SettingKind::Path, "FILE", || None, "learned motion in place of the random walk (`sinew learn`)"));
pub const LATENT: Typed<Option<PathBuf>> = setting((OF_METHOD, "latent", SettingKind::Path, "FILE", || None, "latent model of the body's poses to track in (`sinew learn latent`)")).rare();
pub const NOISE: Typed<NoiseShape> = choice((OF_METHOD, "noise", "NAME", "density of a keypoint: floor (a Gaussian with a floor for outliers) or student-t")).rare();
pub const OUTLIER: Typed<f64> = setting((OF_METHOD, "outlier", SHARE_OF_OUTLIERS, "P", || 0.02, "probability of a gross outlier (noise floor)")).rare();
pub const DEGREES: Typed<f64> = setting((OF_METHOD, "degrees", POSITIVE, "N", || 4.0, "degrees of freedom (noise student-t)")).rare();
pub const LEAST_CONFIDENCE: Typed<f64> = setting((OF_METHOD, "least_confidence", SHARE, "C", || 0.1, "keypoints of lower confidence, once scaled, count as missing")).rare();
pub const SCORE: Typed<Option<Score>> = setting((OF_METHOD, "score", SCORES, "NAME", || None, "weighting function of silhouettes: deutscher-reid, bidirectional, coarse-to-fine or parts [default: the method's]")).rare();
pub const KAPPA: Typed<f64> = setting((OF_METHOD, "kappa", POSITIVE, "K", || 100.0, "factor of the weighting functions deutscher-reid and bidirectional")).rare();
pub const RASTER: Typed<usize> = setting((OF_METHOD, "raster", SettingKind::Count(16, 10_000), "PX", || 320, "longest side to which masks are reduced, by whole factors")).rare();
pub const PARTICLES: Typed<Option<usize>> = setting((SAMPLING, "particles", SettingKind::Count(1, 100_000_000), "N", || None, "")).rare();
pub const DRAWS: Typed<usize> = setting((SAMPLING, "draws", SettingKind::Count(1, 100_000), "N", || 64, "draws of a frame that are written")).rare();
pub const SIMD: Typed<Option<String>> = setting((SAMPLING, "simd", SETS, "SET", || None, "instruction set: avx512, avx2 or baseline [default: best]")).rare().unhashed();
pub const MAX_R_HAT: Typed<f64> = setting((SAMPLING, "max_r_hat", AT_LEAST_ONE, "X", || 1.05, "split R-hat above which a frame has not converged")).rare();
pub const MAX_R_HAT_SHARE: Typed<f64> = setting((SAMPLING, "max_r_hat_share", SHARE, "X", || 0.05, "share of such frames above which the run fails (exit 4)")).rare();
pub const MAX_DIVERGENT_SHARE: Typed<f64> = setting((SAMPLING, "max_divergent_share", SHARE, "X", || 0.01, "share of divergent trajectories above which the run fails")).rare();
pub const MIN_ESS: Typed<f64> = setting((SAMPLING, "min_ess", NOT_NEGATIVE, "X", || 10.0, "median effective sample size below which a particle method fails")).rare();
pub const SEED: Typed<u64> = setting((GENERAL, "seed", SettingKind::Count(0, u64::MAX), "N", || 1, "seed of all random streams"));
pub const THREADS: Typed<Option<usize>> = setting((GENERAL, "threads", SettingKind::Count(1, 1024), "N", || None, "threads [default: what the system grants]")).unhashed();
pub const ANGLES: Typed<Convention> = choice((OUTPUT, "angles", "NAME", "whose definitions of joint angles: opensim or isb")).rare();
pub const STATIC: Typed<Option<PathBuf>> = setting((OUTPUT, "static", SettingKind::Path, "DIR", || None, "results of a standing trial of the same person: the zero of joint angles")).rare();
pub const OUT: Typed<Option<PathBuf>> = setting((OUTPUT, "out", SettingKind::Path, "DIR", || None, "output folder [default: sinew-out/<trial>]"));
pub const CHECKPOINT_EVERY: Typed<f64> = setting((OUTPUT, "checkpoint_every", NOT_NEGATIVE, "SECONDS", || 10.0, "time between checkpoints, from which `--resume` continues; 0 after every frame")).rare().unhashed();
pub const FORCE: Typed<bool> = setting((OUTPUT, "force", SettingKind::Flag, "", || false, "replace results that are there")).unhashed();
