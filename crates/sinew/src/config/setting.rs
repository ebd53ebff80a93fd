//! The settings of a run: name, kind, range, default and meaning of each, in one table.
//!
//! The same name serves as key in `sinew.toml`, as flag (`--setup-frames` for `setup_frames`) and as environment variable (`SINEW_SETUP_FRAMES`).

/// What a setting's value may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A file or folder; relative ones are taken from the folder of the file that says so.
    Path,
    /// A known name, or a path if it ends in `.toml` or `.trc`.
    NameOrPath,
    /// One of these names.
    Choice(&'static [&'static str]),
    /// A whole number between these, both included.
    Count(u64, u64),
    /// A number between these, the first excluded if the flag says so.
    Number {
        /// Least value.
        least: f64,
        /// Whether the least value itself is out.
        excluded: bool,
        /// Greatest value.
        most: f64,
    },
    /// Yes or no.
    Flag,
    /// Frame numbers `A..B`, A included, B not.
    Frames,
    /// A list of names.
    Names,
    /// Whole frames of cameras, `cam_01=1,cam_03=-2`.
    Lags,
}

/// A setting.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Heading under which the help shows it.
    pub group: &'static str,
    /// Name.
    pub key: &'static str,
    /// Values.
    pub kind: Kind,
    /// Word for the value in the help.
    pub value: &'static str,
    /// Value where nobody gives one, as it would be typed; empty for none.
    pub default: &'static str,
    /// Meaning, with the unit and what happens without it.
    pub help: &'static str,
    /// Whether it changes numbers: threads and paths do not.
    pub hashed: bool,
    /// Whether only the long help shows it.
    pub rare: bool,
}

type Columns = (&'static str, &'static str, Kind, &'static str, &'static str, &'static str);

const fn common((group, key, kind, value, default, help): Columns) -> Setting {
    let hashed = !matches!(kind, Kind::Path);
    Setting { group, key, kind, value, default, help, hashed, rare: false }
}

const fn rare(columns: Columns) -> Setting {
    Setting { rare: true, ..common(columns) }
}

const fn unhashed(setting: Setting) -> Setting {
    Setting { hashed: false, ..setting }
}

const POSITIVE: Kind = Kind::Number { least: 0.0, excluded: true, most: f64::INFINITY };
/// Beyond these nothing is a camera or a moving person.
const RATE: Kind = Kind::Number { least: 0.01, excluded: false, most: 1e5 };
const FACTOR: Kind = Kind::Number { least: 1e-3, excluded: false, most: 1e3 };
const SHARE: Kind = Kind::Number { least: 0.0, excluded: false, most: 1.0 };
const AT_LEAST_ONE: Kind = Kind::Number { least: 1.0, excluded: false, most: f64::INFINITY };
const NOT_NEGATIVE: Kind = Kind::Number { least: 0.0, excluded: false, most: f64::INFINITY };
const METHODS: Kind = Kind::Choice(&["hmc", "bootstrap", "annealed", "partitioned", "coarse-to-fine"]);
const SCORES: Kind = Kind::Choice(&["deutscher-reid", "bidirectional", "coarse-to-fine", "parts"]);
const RATE_OF_SURVIVAL: Kind = Kind::Number { least: 0.0, excluded: true, most: 0.99 };
const PRIORS: Kind = Kind::Choice(&["gaussian", "mixture"]);
const NOISES: Kind = Kind::Choice(&["floor", "student-t"]);
const OUTLIER: Kind = Kind::Number { least: 0.0, excluded: true, most: 0.5 };
const AXES: Kind = Kind::Choice(&["+x", "-x", "+y", "-y", "+z", "-z"]);
const SETS: Kind = Kind::Choice(&["avx512", "avx2", "baseline"]);
const INPUT: &str = "Input";
const OUTPUT: &str = "Output";
const METHOD: &str = "Method";
const SAMPLING: &str = "Sampling";
const GENERAL: &str = "General";

/// Every setting.
#[rustfmt::skip]
pub const SETTINGS: [Setting; SETTING_COUNT] = [
    common((INPUT, "calibration", Kind::Path, "FILE", "", "calibration of the cameras (Calib.toml of Pose2Sim)")),
    common((INPUT, "keypoints", Kind::Path, "DIR", "", "keypoints, one folder <camera>_json per camera")),
    common((INPUT, "silhouettes", Kind::Path, "DIR", "", "masks of the person, <camera>_<frame>.png or a folder per camera")),
    common((INPUT, "images", Kind::Path, "DIR", "", "images with the masks, for edges; sparse ones are used where they are")),
    common((INPUT, "layout", Kind::NameOrPath, "NAME", "", "keypoint layout or mapping file [default: guessed]")),
    common((INPUT, "frames", Kind::Frames, "A..B", "", "frames to take, by file number [default: all]")),
    common((INPUT, "fps", RATE, "F", "", "frames per second [default: 30, with a warning]")),
    common((INPUT, "cameras", Kind::Names, "LIST", "", "cameras to use, a,b,c [default: all]")),
    rare((INPUT, "person", Kind::Count(0, 999), "N", "", "which person: 0 is the most complete one on whom the cameras agree at the start [default: 0]")),
    common((INPUT, "trim", Kind::Flag, "", "false", "take only the frames that all cameras have")),
    rare((INPUT, "lag", Kind::Lags, "LIST", "", "frames that cameras are late, cam_01=1,cam_03=-2; `sinew inspect` finds them")),
    rare((INPUT, "confidence_scale", POSITIVE, "C", "1", "confidence that means certainty")),
    rare((INPUT, "image_scale", FACTOR, "S", "1", "size of the images with the keypoints over that of the calibrated images, where they were resized")),
    rare((INPUT, "mask_scale", FACTOR, "S", "", "size of the masks over that of the calibrated images [default: as the keypoints']")),
    rare((INPUT, "up_axis", AXES, "AXIS", "", "axis of the calibration's world that points up; results are in a world turned to z up [default: +z]")),
    common((METHOD, "method", METHODS, "NAME", "hmc", "hmc, bootstrap, annealed, partitioned or coarse-to-fine")),
    common((METHOD, "body", Kind::NameOrPath, "NAME", "h32", "body: h32, cf28 or a body file")),
    common((METHOD, "setup", Kind::Path, "FILE", "", "set-up of an earlier run, its setup.toml")),
    common((METHOD, "init", Kind::NameOrPath, "FROM", "", "start of silhouettes alone: `keypoints` or a TRC file of points")),
    common((METHOD, "setup_frames", Kind::Frames, "A..B", "", "frames for the set-up, thinned where many [default: all]")),
    rare((METHOD, "any_size", Kind::Flag, "", "false", "take sizes and speeds that no person has")),
    common((METHOD, "smooth", Kind::Flag, "", "false", "let every frame see all frames (backward pass)")),
    rare((METHOD, "prior", PRIORS, "NAME", "gaussian", "what a frame hands on to the next: gaussian or mixture")),
    rare((METHOD, "motion_scale", FACTOR, "X", "1", "factor on the motion noise that the set-up pass found")),
    rare((METHOD, "noise", NOISES, "NAME", "floor", "density of a keypoint: floor (a Gaussian with a floor for outliers) or student-t")),
    rare((METHOD, "outlier", OUTLIER, "P", "0.02", "probability of a gross outlier (noise floor)")),
    rare((METHOD, "degrees", POSITIVE, "N", "4", "degrees of freedom (noise student-t)")),
    rare((METHOD, "least_confidence", SHARE, "C", "0.1", "keypoints of lower confidence, once scaled, count as missing")),
    rare((SAMPLING, "chains", Kind::Count(1, 100_000), "N", "16", "chains of a frame (hmc)")),
    rare((SAMPLING, "updates", Kind::Count(1, 1_000_000), "N", "32", "updates of each chain in a frame; four times as many where the chains disagree (hmc)")),
    rare((SAMPLING, "burn_in", Kind::Count(0, 1_000_000), "N", "8", "first samples of each chain that are discarded (hmc)")),
    rare((SAMPLING, "jitter", SHARE, "X", "0.2", "relative jitter of the step size (hmc)")),
    rare((SAMPLING, "particles", Kind::Count(1, 100_000_000), "N", "", "particles [default: 10000 bootstrap, 200 annealed, 1000 partitioned, 300 coarse-to-fine]")),
    rare((SAMPLING, "layers", Kind::Count(1, 1000), "N", "5", "layers (annealed)")),
    rare((SAMPLING, "survival", RATE_OF_SURVIVAL, "X", "0.5", "share of the particles that survives a layer (annealed)")),
    rare((SAMPLING, "adaptive", Kind::Flag, "", "false", "diffuse no coordinate wider than the particles that survived, soft partitions (annealed)")),
    rare((SAMPLING, "crossover", SHARE, "X", "0.5", "share of the particles that is crossed in each layer (annealed); 0 is the filter of 2000")),
    rare((SAMPLING, "fine", Kind::Count(1, 100_000_000), "N", "500", "particles of the fine level (coarse-to-fine)")),
    rare((METHOD, "score", SCORES, "NAME", "", "weighting function of silhouettes: deutscher-reid, bidirectional, coarse-to-fine or parts [default: the method's]")),
    rare((METHOD, "kappa", POSITIVE, "K", "100", "factor of the weighting functions deutscher-reid and bidirectional")),
    rare((METHOD, "raster", Kind::Count(16, 10_000), "PX", "320", "longest side to which masks are reduced, by whole factors")),
    rare((SAMPLING, "draws", Kind::Count(1, 100_000), "N", "64", "draws of a frame that are written")),
    unhashed(rare((SAMPLING, "simd", SETS, "SET", "", "instruction set: avx512, avx2 or baseline [default: best]"))),
    rare((SAMPLING, "max_r_hat", AT_LEAST_ONE, "X", "1.05", "split R-hat above which a frame has not converged")),
    rare((SAMPLING, "max_r_hat_share", SHARE, "X", "0.05", "share of such frames above which the run fails (exit 4)")),
    rare((SAMPLING, "max_divergent_share", SHARE, "X", "0.01", "share of divergent trajectories above which the run fails")),
    rare((SAMPLING, "min_ess", NOT_NEGATIVE, "X", "10", "median effective sample size below which a particle method fails")),
    common((GENERAL, "seed", Kind::Count(0, u64::MAX), "N", "1", "seed of all random streams")),
    unhashed(common((GENERAL, "threads", Kind::Count(1, 1024), "N", "", "threads [default: what the system grants]"))),
    common((OUTPUT, "out", Kind::Path, "DIR", "", "output folder [default: sinew-out/<trial>]")),
    unhashed(rare((OUTPUT, "checkpoint_every", NOT_NEGATIVE, "SECONDS", "10", "time between checkpoints, from which `--resume` goes on; 0 after every frame"))),
    unhashed(common((OUTPUT, "force", Kind::Flag, "", "false", "replace results that are there"))),
];

const SETTING_COUNT: usize = 52;

/// The setting of that name.
#[must_use]
pub fn find(key: &str) -> Option<&'static Setting> {
    SETTINGS.iter().find(|setting| setting.key == key)
}

/// Settings that say where to write and how to behave, not what to compute: they are not repeated in `config.toml`.
#[must_use]
pub fn is_local(key: &str) -> bool {
    matches!(key, "out" | "force" | "threads" | "checkpoint_every")
}
