//! The settings of a run: name, kind, range, default and meaning of each, in one table.
//!
//! The same name serves as key in `sinew.toml`, as flag (`--setup-frames` for `setup_frames`) and as environment variable (`SINEW_SETUP_FRAMES`).

/// What a setting's value may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A file or folder; relative ones are taken from the folder of the file that says so.
    Path,
    /// A known name, or a path if it ends in `.toml`.
    NameOrPath,
    /// One of these names.
    Choice(&'static [&'static str]),
    /// A whole number of at least this.
    Count(u64),
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
}

/// A setting.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Name.
    pub key: &'static str,
    /// Values.
    pub kind: Kind,
    /// Value where nobody gives one, as it would be typed; empty for none.
    pub default: &'static str,
    /// Meaning, with the unit.
    pub help: &'static str,
    /// Whether it changes numbers: threads and paths do not.
    pub hashed: bool,
}

const fn setting(key: &'static str, kind: Kind, default: &'static str, help: &'static str) -> Setting {
    let hashed = !matches!(kind, Kind::Path);
    Setting { key, kind, default, help, hashed }
}

const fn unhashed(setting: Setting) -> Setting {
    Setting { hashed: false, ..setting }
}

const POSITIVE: Kind = Kind::Number { least: 0.0, excluded: true, most: f64::INFINITY };
const SHARE: Kind = Kind::Number { least: 0.0, excluded: false, most: 1.0 };
const AT_LEAST_ONE: Kind = Kind::Number { least: 1.0, excluded: false, most: f64::INFINITY };
const NOT_NEGATIVE: Kind = Kind::Number { least: 0.0, excluded: false, most: f64::INFINITY };

/// Every setting.
pub const SETTINGS: [Setting; 29] = [
    setting("calibration", Kind::Path, "", "calibration of the cameras, `Calib.toml` of Pose2Sim"),
    setting("keypoints", Kind::Path, "", "folder of keypoints, one folder `<camera>_json` per camera"),
    setting("layout", Kind::NameOrPath, "", "keypoint layout, or a mapping file; guessed from the keypoints"),
    setting("confidence_scale", POSITIVE, "1", "confidence that means certainty"),
    setting("frames", Kind::Frames, "", "frames to track, by the numbers in the file names; all"),
    setting("fps", POSITIVE, "", "frames per second; 30 with a warning"),
    setting("cameras", Kind::Names, "", "cameras to use; all with keypoints"),
    setting(
        "person",
        Kind::Count(0),
        "",
        "index of the person in the first frame's files; the most complete one that all cameras agree on",
    ),
    setting("trim", Kind::Flag, "false", "take only the frames that all cameras have"),
    setting("method", Kind::Choice(&["hmc", "bootstrap"]), "hmc", "tracker"),
    setting("body", Kind::NameOrPath, "h32", "body: h32, cf28 or a body file"),
    setting("prior", Kind::Choice(&["gaussian", "mixture"]), "gaussian", "what a frame hands on to the next"),
    setting("setup", Kind::Path, "", "set-up of an earlier run, `setup.toml`"),
    setting("setup_frames", Kind::Frames, "", "frames for the set-up pass; all"),
    setting("smooth", Kind::Flag, "false", "let every frame see all frames, by a backward pass"),
    setting("seed", Kind::Count(0), "1", "seed of all random streams"),
    setting("chains", Kind::Count(1), "16", "chains of a frame (hmc)"),
    setting("particles", Kind::Count(1), "4096", "particles (bootstrap)"),
    setting("draws", Kind::Count(1), "64", "draws of a frame that are written"),
    setting("jitter", SHARE, "0.2", "relative jitter of the step size (hmc)"),
    unhashed(setting(
        "simd",
        Kind::Choice(&["avx512", "avx2", "baseline"]),
        "",
        "instruction set; the best of the processor",
    )),
    unhashed(setting("threads", Kind::Count(1), "", "threads; as many as the system grants")),
    setting("max_r_hat", AT_LEAST_ONE, "1.05", "split R-hat above which a frame counts as not converged"),
    setting("max_r_hat_share", SHARE, "0.05", "share of frames above it at which the run fails"),
    setting("max_divergent_share", SHARE, "0.01", "share of divergent trajectories at which the run fails"),
    setting("min_ess", NOT_NEGATIVE, "10", "median effective sample size below which a particle method fails"),
    setting("out", Kind::Path, "", "output folder; sinew-out/<trial>"),
    unhashed(setting("force", Kind::Flag, "false", "replace results that are there")),
    unhashed(setting("quiet", Kind::Flag, "false", "show errors only")),
];

/// The setting of that name.
#[must_use]
pub fn find(key: &str) -> Option<&'static Setting> {
    SETTINGS.iter().find(|setting| setting.key == key)
}

/// Settings that say where to write and how to behave, not what to compute: they are not repeated in `config.toml`.
#[must_use]
pub fn is_local(key: &str) -> bool {
    matches!(key, "out" | "force" | "threads" | "quiet")
}
