//! What a result folder holds of its run: summary, set-up, and tables as series over the frames.

use crate::Error;
use serde_json::Value;
use sinew::files::read_text;
use sinew::setup::Setup;
use sinew_formats::json_text;
use sinew_formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES};
use sinew_results::ReadError;
use sinew_results::folder_table::{FolderTable, NamedSeries};
use sinew_results::people::refuse_several;
use sinew_results::without_summary;
use std::path::Path;

/// Mean and ends of the 90 % interval in each frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Band {
    pub(super) mean: Vec<f64>,
    pub(super) low: Vec<f64>,
    pub(super) high: Vec<f64>,
}

impl Band {
    /// Half the width of the interval of each frame.
    pub(super) fn half_widths(&self) -> impl Iterator<Item = f64> + '_ {
        self.high.iter().zip(&self.low).map(|(high, low)| 0.5 * (high - low))
    }
}

/// A point of the body.
pub(super) struct RecordedPoint {
    pub(super) name: String,
    /// Axis by axis, metres.
    pub(super) axes: [Band; 3],
    /// Standard deviation, axis by axis, metres.
    pub(super) sd: [Vec<f64>; 3],
    /// The same within the run.
    pub(super) sd_within: [Vec<f64>; 3],
}

/// A rotation of the body, degrees.
pub(super) struct RecordedAngle {
    pub(super) name: String,
    pub(super) band: Band,
    /// 1 where keypoints show it, 0 where they do not; NaN where that is not known.
    pub(super) seen: Vec<f64>,
}

/// A result folder.
pub(super) struct Recorded {
    pub(super) summary: Value,
    pub(super) setup: Setup,
    /// Numbers of the frames.
    pub(super) numbers: Vec<f64>,
    /// 2: two cameras or more saw the person, 1: one, 0: none.
    pub(super) quality: Vec<f64>,
    /// 1 where tracking began again.
    pub(super) restarted: Vec<f64>,
    /// R-hat of each frame; NaN where the method has none.
    pub(super) r_hat: Vec<f64>,
    /// Residuals of each camera of the set-up, pixels; NaN where there is none.
    pub(super) residuals_px: Vec<Vec<f64>>,
    pub(super) points: Vec<RecordedPoint>,
    pub(super) angles: Vec<RecordedAngle>,
}

impl Recorded {
    /// Reads a folder.
    pub(super) fn read(folder: &Path) -> Result<Self, Error> {
        refuse_several(folder).map_err(sinew::Error::from)?;
        let path = folder.join("summary.json");
        if !path.exists() {
            return Err(without_summary(folder).into());
        }
        let summary = json_text::parse(&path.display().to_string(), &read_text(&path, MAX_TEXT_BYTES)?)?;
        let path = folder.join("setup.toml");
        if !path.exists() {
            return Err(ReadError::NoFile { folder: folder.to_owned(), file: "setup.toml" }.into());
        }
        let setup = Setup::from_toml(&path.display().to_string(), &read_text(&path, MAX_CONFIG_BYTES)?)?;
        let frames = FolderTable::read(folder, "frames.csv")?;
        let numbers = frames.column("frame")?;
        let count = numbers.len();
        if count == 0 {
            return Err(ReadError::NoFrames(folder.to_owned()).into());
        }
        let none = || vec![f64::NAN; count];
        let residual = |name: &str| Ok(frames.optional(&format!("residual_{name}_px"))?.unwrap_or_else(none));
        let residuals_px = setup.camera.iter().map(|camera| residual(&camera.name)).collect::<Result<_, Error>>()?;
        let joints = FolderTable::read(folder, "joints.csv")?.by_name("joint", &OF_POINTS, count)?;
        let angles = FolderTable::read(folder, "angles.csv")?.by_name("name", &OF_ANGLES, count)?;
        Ok(Self {
            summary,
            quality: frames.column("quality")?,
            restarted: frames.column("restarted")?,
            r_hat: frames.optional("r_hat")?.unwrap_or_else(none),
            setup,
            numbers,
            residuals_px,
            points: joints.into_iter().map(point).collect(),
            angles: angles.into_iter().map(angle).collect(),
        })
    }

    /// Frames a second.
    pub(super) fn fps(&self) -> f64 {
        self.summary["fps"].as_f64().filter(|fps| *fps > 0.0).unwrap_or(1.0)
    }

    /// Sentences that the summary lists under a key.
    pub(super) fn sentences(&self, key: &str) -> Vec<&str> {
        self.summary[key].as_array().into_iter().flatten().filter_map(Value::as_str).collect()
    }
}

const OF_POINTS: [&str; 15] = [
    "x_mean_m",
    "x_q05_m",
    "x_q95_m",
    "y_mean_m",
    "y_q05_m",
    "y_q95_m",
    "z_mean_m",
    "z_q05_m",
    "z_q95_m",
    "x_sd_m",
    "y_sd_m",
    "z_sd_m",
    "x_sd_within_m",
    "y_sd_within_m",
    "z_sd_within_m",
];
const OF_ANGLES: [&str; 4] = ["mean_deg", "q05_deg", "q95_deg", "seen"];

fn point((name, series): NamedSeries) -> RecordedPoint {
    let mut series = series.into_iter();
    let mut next = || series.next().unwrap_or_default();
    let axes = [(); 3].map(|()| Band { mean: next(), low: next(), high: next() });
    let [sd, sd_within] = [(); 2].map(|()| [(); 3].map(|()| next()));
    RecordedPoint { name, axes, sd, sd_within }
}

fn angle((name, series): NamedSeries) -> RecordedAngle {
    let mut series = series.into_iter();
    let mut next = || series.next().unwrap_or_default();
    let band = Band { mean: next(), low: next(), high: next() };
    RecordedAngle { name, band, seen: next() }
}
