//! What files contain, in a few lines, and what is odd about them.
//!
//! | module | looks at |
//! |---|---|
//! | [`files`](self::file_facts) | one calibration, keypoint folder, motion file or result folder |
//! | [`fit`] | a calibration and keypoints together: do they belong to each other? |

pub mod fit;
mod keypoints;

use crate::files::read_text;
use crate::motion::{self, Content, Format};
use crate::{Error, recording};
use sinew_formats::calib_toml::{self, Calibration};
use sinew_formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES};
use std::path::{Path, PathBuf};

/// What is known about something.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// What it is.
    pub title: String,
    /// Name and value of each fact.
    pub rows: Vec<(String, String)>,
    /// What is odd.
    pub odd: Vec<String>,
}

impl Facts {
    pub(crate) fn new(title: String) -> Self {
        Self { title, ..Self::default() }
    }

    pub(crate) fn row(&mut self, name: impl Into<String>, value: impl Into<String>) {
        self.rows.push((name.into(), value.into()));
    }
}

/// What a path leads to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Calibration file.
    Calibration(PathBuf),
    /// Keypoint folder.
    Keypoints(PathBuf),
    /// Motion file.
    Motion(PathBuf),
    /// Result folder.
    Results(PathBuf),
}

/// Tells what a path leads to, by its name and what lies in it.
///
/// # Errors
/// A path that does not exist, or is nothing that can be inspected.
pub fn subject(path: &Path) -> Result<Subject, Error> {
    let found = std::fs::metadata(path).map_err(Error::io("read", path))?;
    let path_buf = path.to_owned();
    if found.is_dir() {
        let is_result =
            ["summary.json", "markers.trc", "markers.trc.partial"].iter().any(|name| path.join(name).exists());
        return Ok(if is_result { Subject::Results(path_buf) } else { Subject::Keypoints(path_buf) });
    }
    match path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).as_deref() {
        Some("toml") => Ok(Subject::Calibration(path_buf)),
        Some("trc" | "bvh" | "mot" | "sto" | "csv" | "amc") => Ok(Subject::Motion(path_buf)),
        _ => Err(Error::Usage {
            message: format!("{}: nothing that can be inspected", path.display()),
            help: "give a calibration (.toml), a keypoint folder, a motion file (.trc, .bvh, .mot, .csv) or a result folder".into(),
        }),
    }
}

/// What is known about one subject.
///
/// # Errors
/// What the readers refuse.
pub fn file_facts(subject: &Subject, layout: Option<&str>) -> Result<Facts, Error> {
    match subject {
        Subject::Calibration(path) => {
            let text = read_text(path, MAX_CONFIG_BYTES)?;
            Ok(calibration(path, &calib_toml::read(&path.display().to_string(), &text)?))
        }
        Subject::Keypoints(path) => keypoints::facts(path, layout),
        Subject::Motion(path) => motion_file(path),
        Subject::Results(path) => results(path),
    }
}

/// Height of a person for the question whether a calibration is in metres.
const HEIGHT_M: f64 = 1.7;

fn calibration(path: &Path, calibration: &Calibration) -> Facts {
    let mut facts = Facts::new(format!("{}: calibration of {} cameras", path.display(), calibration.cameras.len()));
    for camera in &calibration.cameras {
        let [width, height] = camera.image_size_px;
        let [x, y, z] = camera.centre();
        let lens = if camera.distortion == Default::default() { "no distortion" } else { "distortion" };
        let place = format!(
            "{width} x {height} px, focal length {:.0} px, {lens}, at ({x:.2}, {y:.2}, {z:.2}) m",
            camera.intrinsics.fx
        );
        facts.row(&camera.name, place);
    }
    facts.odd.extend(calibration.warnings.iter().map(ToString::to_string));
    facts.odd.extend(calib_toml::far_cameras(&calibration.cameras, HEIGHT_M).map(|warning| warning.to_string()));
    for (index, camera) in calibration.cameras.iter().enumerate() {
        let near = |other: &&sinew_observe::Camera| {
            camera.centre().iter().zip(other.centre()).all(|(a, b)| (a - b).abs() < 0.01)
        };
        if let Some(other) = calibration.cameras[..index].iter().find(near) {
            facts.odd.push(format!("{} and {} stand at the same place", other.name, camera.name));
        }
    }
    facts
}

fn motion_file(path: &Path) -> Result<Facts, Error> {
    if Format::of(path)? == Format::Amc {
        return Err(Error::Usage {
            message: format!("{} holds angles without a skeleton", path.display()),
            help: "convert it first: `sinew convert FILE.amc out.bvh --skeleton FILE.asf`".into(),
        });
    }
    let motion = motion::read(path, None, None)?;
    let kind = match &motion.content {
        Content::Points(points) => format!("{} points", points.names.len()),
        Content::Coordinates(coordinates) => format!("{} coordinates", coordinates.columns.len()),
        Content::Skeleton(skeleton) => format!("skeleton of {} joints", skeleton.joints.len()),
    };
    let mut facts = Facts::new(format!("{}: {}, {kind}", path.display(), motion.format.name()));
    let seconds = if motion.rate_hz > 0.0 { motion.frames() as f64 / motion.rate_hz } else { 0.0 };
    facts.row("frames", format!("{} at {} per second, {seconds:.2} s", motion.frames(), motion.rate_hz));
    let names: Vec<String> = match &motion.content {
        Content::Points(points) => points.names.clone(),
        Content::Coordinates(coordinates) => coordinates.columns.clone(),
        Content::Skeleton(skeleton) => skeleton.joints.iter().map(|joint| joint.name.clone()).collect(),
    };
    facts.row("names", shortened(&names));
    if let Some(points) = motion.points() {
        let all = points.frames.iter().flatten();
        let missing = all.clone().filter(|point| point.is_none()).count();
        if missing > 0 {
            facts.row("missing", format!("{missing} of {} points", points.names.len() * points.frames.len()));
        }
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for point in all.flatten() {
            for k in 0..3 {
                (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
            }
        }
        if low[0] <= high[0] {
            let range = |k: usize| format!("{:.2} to {:.2}", low[k], high[k]);
            facts.row("world, m", format!("x {}, y {}, z {} (up)", range(0), range(1), range(2)));
            if high[2] - low[2] > 20.0 {
                facts.odd.push(format!(
                    "points spread over {:.0} m in height; is the unit of the file right?",
                    high[2] - low[2]
                ));
            }
        }
    }
    facts.odd.extend(motion.warnings);
    Ok(facts)
}

/// Names shown before a list is cut short.
const LISTED: usize = 12;

fn shortened(names: &[String]) -> String {
    let listed = names.iter().take(LISTED).cloned().collect::<Vec<_>>().join(" ");
    if names.len() > LISTED { format!("{listed} and {} more", names.len() - LISTED) } else { listed }
}

fn results(path: &Path) -> Result<Facts, Error> {
    let summary_path = path.join("summary.json");
    let mut facts = Facts::new(format!("{}: results", path.display()));
    if !summary_path.exists() {
        facts.odd.push("no summary.json: the run was stopped before its end, or still runs".into());
        return Ok(facts);
    }
    let text = read_text(&summary_path, MAX_TEXT_BYTES)?;
    let summary: serde_json::Value = sinew_formats::json_text::parse(&summary_path.display().to_string(), &text)?;
    let text_of = |value: &serde_json::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let version = text_of(&summary["sinew_version"]);
    facts.title = format!(
        "{}: results of sinew {version}, {} {}",
        path.display(),
        text_of(&summary["kind"]),
        text_of(&summary["method"])
    );
    let frames = format!(
        "{} ({}..{}), {} observed, {} per second",
        summary["frame_count"], summary["frames"][0], summary["frames"][1], summary["observed_frames"], summary["fps"]
    );
    facts.row("frames", frames);
    facts.row("seed", format!("{}, instruction set {}", summary["seed"], text_of(&summary["isa"])));
    let number =
        |value: &serde_json::Value, digits: usize| value.as_f64().map_or("-".into(), |x| format!("{x:.digits$}"));
    let diagnostics = &summary["diagnostics"];
    if diagnostics["r_hat"].is_object() {
        facts.row(
            "R-hat",
            format!(
                "median {}, 95 % {}",
                number(&diagnostics["r_hat"]["median"], 3),
                number(&diagnostics["r_hat"]["p95"], 3)
            ),
        );
    }
    facts.row("effective size", format!("median {}", number(&diagnostics["ess_median"], 0)));
    for camera in summary["cameras"].as_array().into_iter().flatten() {
        facts.row(
            text_of(&camera["name"]),
            format!("residual {} px, {} frames", number(&camera["residual_px"], 1), camera["frames"]),
        );
    }
    if summary["complete"] != true {
        facts.odd.push("the run was interrupted: not all frames are there".into());
    }
    for list in ["failed_diagnostics", "warnings"] {
        facts.odd.extend(summary[list].as_array().into_iter().flatten().map(text_of));
    }
    Ok(facts)
}

/// Opens a recording for [`fit::facts`].
///
/// # Errors
/// As [`recording::Recording::open`].
pub fn open(
    calibration: &Path,
    keypoints: &Path,
    layout: Option<&str>,
    trim: bool,
) -> Result<recording::Recording, Error> {
    let options = recording::Options { layout: layout.map(Into::into), trim, ..recording::Options::default() };
    recording::Recording::open(calibration, keypoints, &options)
}
