//! One HTML page that shows a result: the person in 3D, curves with bands, the run's doubts.
//!
//! 1. The tables of the folder are read (`recorded`), and the ellipsoids of its points from the draws (`spread`).
//! 2. Numbers are rounded to steps and coded as differences from frame to frame (`columns`, `payload`).
//! 3. They are deflated, written in base64 (`packed`) and put into the page, beside the program that shows them.
//!
//! Words and tables of the page are HTML and need no program. The page fetches nothing. What runs in the browser lies in `page/browser`, the libraries that it uses in `vendor`, where a README says how they are made.
//!
//! The same folder gives the same bytes. Above [`LARGEST_BYTES`] every second frame is left out, or more, and the page says so.

mod advice;
mod angle_words;
mod bones;
mod camera_table;
mod columns;
mod comparison;
mod doubts;
pub mod html;
mod packed;
mod payload;
mod recorded;
mod run_words;
mod settings_table;
mod source_bars;
mod spread;
mod validation;
mod verdict;
mod views;

use crate::Error;
use html::{escaped, filled};
use recorded::Recorded;
use std::path::{Path, PathBuf};

/// Largest page, bytes, that shows every frame, unless another is requested.
pub const LARGEST_BYTES: usize = 3_000_000;

/// What the page is made from besides the result folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportRequest {
    /// Calibration of the run, for the directions in which its cameras look.
    pub calibration: Option<PathBuf>,
    /// `validation.csv` of a `sinew validate` of the recording.
    pub validation: Option<PathBuf>,
    /// Largest page, bytes: above it frames are left out.
    pub largest_bytes: usize,
}

impl Default for ReportRequest {
    fn default() -> Self {
        Self { calibration: None, validation: None, largest_bytes: LARGEST_BYTES }
    }
}

/// A page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReportPage {
    /// The HTML file.
    pub html: String,
    /// Frames of the result.
    pub frames: usize,
    /// Every n-th of them is shown.
    pub every: usize,
}

const TEMPLATE: &str = include_str!("page/browser/page.html");
const STYLE: &str = include_str!("page/browser/page.css");
const VENDOR_STYLE: &str = include_str!("../vendor/uPlot.min.css");
const VENDOR: &str = include_str!("../vendor/bundle.min.js");

/// Terms of the libraries, which go with every copy of them.
const LICENCES: [&str; 2] = [include_str!("../vendor/LICENSE.three"), include_str!("../vendor/LICENSE.uplot")];

/// The parts of the program, in the order in which they run.
const PROGRAM: [&str; 7] = [
    include_str!("page/browser/payload.js"),
    include_str!("page/browser/scene.js"),
    include_str!("page/browser/orbit.js"),
    include_str!("page/browser/canvas_view.js"),
    include_str!("page/browser/webgl_view.js"),
    include_str!("page/browser/plots.js"),
    include_str!("page/browser/player.js"),
];

/// The page of a result folder.
///
/// # Errors
/// A folder without results or files of it, tables that do not belong together, a calibration that cannot be read or lacks a camera of the run.
pub fn page(folder: &Path, request: &ReportRequest) -> Result<ReportPage, Error> {
    let recorded = Recorded::read(folder)?;
    let factors = spread::factors(folder, &recorded)?;
    let views = views::views(folder, &recorded, request.calibration.as_deref())?;
    let vendor = packed::packed(VENDOR.as_bytes());
    let validated = request.validation.as_deref().map(validation::found).transpose()?;
    let verdict = verdict::verdict(&recorded, validated.as_deref());
    let beside = comparison::section(folder)?;
    let frames = recorded.numbers.len();
    let mut every = 1;
    loop {
        let payload = packed::packed(&payload::payload(&recorded, &factors, &views, every));
        let html = assembled(folder, &recorded, &views, every, &beside, [&verdict, &payload, &vendor]);
        if html.len() <= request.largest_bytes || every >= frames {
            return Ok(ReportPage { html, frames, every });
        }
        every += 1.max(every * (html.len() - request.largest_bytes) / payload.len().max(1));
    }
}

/// The text of the page.
fn assembled(
    folder: &Path,
    recorded: &Recorded,
    views: &views::Views,
    every: usize,
    [reference, link]: &[String; 2],
    [verdict, payload, vendor]: [&str; 3],
) -> String {
    let title = escaped(&name(folder));
    let parts = [
        ("title", title),
        ("style", format!("{VENDOR_STYLE}\n{STYLE}")),
        ("subtitle", run_words::subtitle(recorded)),
        ("verdict", verdict.to_owned()),
        ("left_out", run_words::left_out(every)),
        ("directions", views.note()),
        ("doubts", doubts::list(recorded)),
        ("cameras", camera_table::camera_table(recorded)),
        ("reference", reference.clone()),
        ("reference_link", link.clone()),
        ("sources", source_bars::bars(&recorded.summary)),
        ("diagnostics", run_words::diagnostics(recorded)),
        ("settings", settings_table::settings_table(&recorded.summary)),
        ("licences", escaped(&LICENCES.join("\n\n"))),
        ("payload", payload.to_owned()),
        ("vendor", vendor.to_owned()),
        ("program", PROGRAM.concat()),
    ];
    filled(TEMPLATE, &parts)
}

/// Name of a folder, also of `.`.
fn name(folder: &Path) -> String {
    let last = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let whole = || folder.canonicalize().ok().as_deref().and_then(last);
    last(folder).or_else(whole).unwrap_or_else(|| folder.display().to_string())
}
