//! Every setting of a run, in one table.
//!
//! The same name serves as key in `sinew.toml`, as flag (`--setup-frames` for `setup_frames`) and as environment variable (`SINEW_SETUP_FRAMES`). Settings of a single method stand in its file.

use super::setting::{DefaultValue, Row, SAMPLING, SHARE, Setting, SettingKind, computed};
use super::settings::Settings;
use crate::methods::about::About;
use crate::methods::list;
use crate::methods::score::Score;
use sinew_angles::Convention;
use std::sync::LazyLock;

const POSITIVE: SettingKind = SettingKind::Number { least: 0.0, excluded: true, most: f64::INFINITY };
/// Beyond these nothing is a camera or a moving person.
const RATE: SettingKind = SettingKind::Number { least: 0.01, excluded: false, most: 1e5 };
const FACTOR: SettingKind = SettingKind::Number { least: 1e-3, excluded: false, most: 1e3 };
const AT_LEAST_ONE: SettingKind = SettingKind::Number { least: 1.0, excluded: false, most: f64::INFINITY };
const NOT_NEGATIVE: SettingKind = SettingKind::Number { least: 0.0, excluded: false, most: f64::INFINITY };
const SCORES: SettingKind = SettingKind::Choice(&Score::NAMES);
const PRIORS: SettingKind = SettingKind::Choice(&["gaussian", "mixture"]);
const NOISES: SettingKind = SettingKind::Choice(&["floor", "student-t"]);
const OUTLIER: SettingKind = SettingKind::Number { least: 0.0, excluded: true, most: 0.5 };
const AXES: SettingKind = SettingKind::Choice(&["+x", "-x", "+y", "-y", "+z", "-z"]);
const SETS: SettingKind = SettingKind::Choice(&["avx512", "avx2", "baseline"]);
const CONVENTIONS: SettingKind = SettingKind::Choice(&Convention::NAMES);
const INPUT: &str = "Input";
const OUTPUT: &str = "Output";
const METHOD: &str = "Method";
const GENERAL: &str = "General";

const fn common(row: Row) -> Setting {
    Setting::new(row)
}

const fn rare(row: Row) -> Setting {
    Setting { rare: true, ..Setting::new(row) }
}

const fn unhashed(setting: Setting) -> Setting {
    Setting { hashed: false, ..setting }
}

/// Settings before the settings of single methods.
#[rustfmt::skip]
const FIRST: &[Setting] = &[
    common((INPUT, "calibration", SettingKind::Path, "FILE", "", "calibration of the cameras, of Pose2Sim or another program")),
    common((INPUT, "keypoints", SettingKind::Path, "PATH", "", "keypoints: a folder <camera>_json per camera, or files of detectors")),
    common((INPUT, "silhouettes", SettingKind::Path, "DIR", "", "masks of the person, <camera>_<frame>.png or a folder per camera")),
    common((INPUT, "images", SettingKind::Path, "DIR", "", "images with masks, for edges and (score parts) colours; may be sparse")),
    common((INPUT, "layout", SettingKind::NameOrPath, "NAME", "", "keypoint layout or mapping file [default: guessed]")),
    common((INPUT, "frames", SettingKind::Frames, "A..B", "", "frames to take, by file number [default: all]")),
    common((INPUT, "fps", RATE, "F", "", "frames per second [default: 30, with a warning]")),
    common((INPUT, "cameras", SettingKind::Names, "LIST", "", "cameras to use, a,b,c [default: all]")),
    rare((INPUT, "person", SettingKind::Count(1, 999), "N", "", "track one of several people: the N-th to come, as `sinew inspect` and people/ number them, from 1 on")),
    rare((INPUT, "people", SettingKind::Choice(&["all", "1"]), "WHO", "all", "whom to track: all whom two cameras see for a quarter of a second in all, or 1, the most complete one at the start")),
    unhashed(rare((INPUT, "subject", SettingKind::Text, "NAME", "", "who is tracked; `sinew batch` pools what is constant over the trials of one subject"))),
    common((INPUT, "trim", SettingKind::Flag, "", "false", "take only the frames that all cameras have")),
    rare((INPUT, "lag", SettingKind::Lags, "LIST", "", "frames that cameras are late, cam_01=1,cam_03=-2.4; `sinew sync` finds them")),
    rare((INPUT, "confidence_scale", POSITIVE, "C", "1", "confidence that means certainty")),
    rare((INPUT, "image_scale", FACTOR, "S", "1", "size of the images with the keypoints over that of the calibrated images, where they were resized")),
    rare((INPUT, "mask_scale", FACTOR, "S", "", "size of the masks over that of the calibrated images [default: as the keypoints']")),
    rare((INPUT, "up_axis", AXES, "AXIS", "", "axis of the calibration's world that points up; results are in a world turned to z up [default: +z]")),
    rare((INPUT, "up", SettingKind::Direction, "X,Y,Z", "", "direction of the calibration's world that points up, X,Y,Z, or auto: as the person stands; results have it as z")),
    common((METHOD, "method", SettingKind::Choice(&[]), "NAME", "", "")),
    common((METHOD, "body", SettingKind::NameOrPath, "NAME", "h32", "body: h32, cf28, hppf24, hapf31 or a body file")),
    common((METHOD, "setup", SettingKind::Path, "FILE", "", "set-up of an earlier run, its setup.toml")),
    common((METHOD, "init", SettingKind::NameOrPath, "FROM", "", "start of silhouettes alone: `keypoints` or a TRC file of points")),
    common((METHOD, "setup_frames", SettingKind::Frames, "A..B", "", "frames for the set-up, thinned where many [default: all]")),
    rare((METHOD, "any_size", SettingKind::Flag, "", "false", "take sizes and speeds that no person has")),
    common((METHOD, "smooth", SettingKind::Flag, "", "false", "let every frame see all frames (backward pass)")),
    rare((METHOD, "lag_frames", SettingKind::Count(0, 1000), "N", "0", "let every frame see N frames after it (fixed lag), between the filter and `smooth`")),
    rare((METHOD, "prior", PRIORS, "NAME", "gaussian", "what a frame hands on to the next: gaussian or mixture")),
    computed((METHOD, "motion_scale", FACTOR, "X", || Settings::default().motion_scale.to_string(), "factor on the motion noise that the set-up pass found")),
    common((METHOD, "motion_model", SettingKind::Path, "FILE", "", "learned motion in place of the random walk (`sinew learn`)")),
    rare((METHOD, "latent", SettingKind::Path, "FILE", "", "latent model of the body's poses to track in (`sinew learn latent`)")),
    rare((METHOD, "noise", NOISES, "NAME", "floor", "density of a keypoint: floor (a Gaussian with a floor for outliers) or student-t")),
    rare((METHOD, "outlier", OUTLIER, "P", "0.02", "probability of a gross outlier (noise floor)")),
    rare((METHOD, "degrees", POSITIVE, "N", "4", "degrees of freedom (noise student-t)")),
    computed((METHOD, "least_confidence", SHARE, "C", || Settings::default().least_confidence.to_string(), "keypoints of lower confidence, once scaled, count as missing")),
];

/// Settings after the settings of single methods.
#[rustfmt::skip]
const LAST: &[Setting] = &[
    rare((METHOD, "score", SCORES, "NAME", "", "weighting function of silhouettes: deutscher-reid, bidirectional, coarse-to-fine or parts [default: the method's]")),
    rare((METHOD, "kappa", POSITIVE, "K", "100", "factor of the weighting functions deutscher-reid and bidirectional")),
    computed((METHOD, "raster", SettingKind::Count(16, 10_000), "PX", || Settings::default().raster.to_string(), "longest side to which masks are reduced, by whole factors")),
    computed((SAMPLING, "draws", SettingKind::Count(1, 100_000), "N", || Settings::default().draws.to_string(), "draws of a frame that are written")),
    unhashed(rare((SAMPLING, "simd", SETS, "SET", "", "instruction set: avx512, avx2 or baseline [default: best]"))),
    rare((SAMPLING, "max_r_hat", AT_LEAST_ONE, "X", "1.05", "split R-hat above which a frame has not converged")),
    rare((SAMPLING, "max_r_hat_share", SHARE, "X", "0.05", "share of such frames above which the run fails (exit 4)")),
    rare((SAMPLING, "max_divergent_share", SHARE, "X", "0.01", "share of divergent trajectories above which the run fails")),
    rare((SAMPLING, "min_ess", NOT_NEGATIVE, "X", "10", "median effective sample size below which a particle method fails")),
    Setting { rare: false, ..computed((GENERAL, "seed", SettingKind::Count(0, u64::MAX), "N", || Settings::default().seed.to_string(), "seed of all random streams")) },
    unhashed(common((GENERAL, "threads", SettingKind::Count(1, 1024), "N", "", "threads [default: what the system grants]"))),
    rare((OUTPUT, "angles", CONVENTIONS, "NAME", "opensim", "whose definitions of joint angles: opensim or isb")),
    rare((OUTPUT, "static", SettingKind::Path, "DIR", "", "results of a standing trial of the same person: the zero of joint angles")),
    common((OUTPUT, "out", SettingKind::Path, "DIR", "", "output folder [default: sinew-out/<trial>]")),
    unhashed(rare((OUTPUT, "checkpoint_every", NOT_NEGATIVE, "SECONDS", "10", "time between checkpoints, from which `--resume` continues; 0 after every frame"))),
    unhashed(common((OUTPUT, "force", SettingKind::Flag, "", "false", "replace results that are there"))),
];

/// Names as a sentence lists them.
fn listed(names: &[&str]) -> String {
    match names {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => names.concat(),
    }
}

fn particles(methods: &[&'static About]) -> Setting {
    let usual = |about: &&About| about.particles.map(|count| format!("{} {}", count(), about.name));
    let usual: Vec<String> = methods.iter().filter_map(usual).collect();
    let help = format!("particles [default: {}]", usual.join(", ")).leak();
    Setting { help, ..rare((SAMPLING, "particles", SettingKind::Count(1, 100_000_000), "N", "", "")) }
}

/// The table of a list of methods.
#[must_use]
pub fn table(methods: &[&'static About]) -> Vec<Setting> {
    let mut all = FIRST.to_vec();
    let mut has_particles = false;
    for about in methods {
        if about.particles.is_some() && !has_particles {
            all.push(particles(methods));
            has_particles = true;
        }
        all.extend_from_slice(about.settings);
    }
    all.extend_from_slice(LAST);
    if let Some(method) = all.iter_mut().find(|setting| setting.key == "method") {
        let names: &'static [&'static str] = methods.iter().map(|about| about.name).collect::<Vec<_>>().leak();
        method.kind = SettingKind::Choice(names);
        method.help = listed(names).leak();
        method.default = names.first().map_or(DefaultValue::Unset, |name| DefaultValue::Text(name));
    }
    all
}

/// Every setting.
#[must_use]
pub fn settings() -> &'static [Setting] {
    static TABLE: LazyLock<Vec<Setting>> = LazyLock::new(|| table(&list::METHODS));
    &TABLE
}

/// The setting of that name.
#[must_use]
pub fn find(key: &str) -> Option<&'static Setting> {
    settings().iter().find(|setting| setting.key == key)
}

/// Settings that say where to write and how to behave, not what to compute: they are not repeated in `config.toml`.
#[must_use]
pub fn is_local(key: &str) -> bool {
    matches!(key, "out" | "force" | "threads" | "checkpoint_every")
}
