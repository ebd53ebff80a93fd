//! A result as input of OpenSim's scale tool and inverse kinematics.
//!
//! | file | what |
//! |---|---|
//! | `markers.trc` | the points of the result |
//! | `marker_set.xml` | where a model has them (`marker_set`) |
//! | `scale.xml` | scales the model by distances between them (`scale_setup`) |
//! | `ik.xml` | fits the scaled model to them, each with a weight from its posterior, and holds what they do not show (`ik_setup`) |
//! | `weights.csv` | the same weights frame by frame (`weights`) |
//! | `ik_over_time.py` | inverse kinematics with weights that change, which `ik.xml` cannot say |
//! | `README.txt` | the commands |
//!
//! The model is the user's. Without one, `model.osim` stands for it, every body is taken to be there, and no coordinate is.

pub(crate) mod error;
mod ik_setup;
mod marker_set;
mod scale_setup;
mod weights;

pub use error::OpensimError;

use crate::Error;
use marker_set::ModelMarker;
use sinew::files::read_text;
use sinew::setup::Setup;
use sinew_formats::osim_model::{self, OsimModel};
use sinew_formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES};
use sinew_formats::trc;
use sinew_results::people::refuse_several;
use sinew_results::{ReadError, without_summary};
use std::path::Path;
use weights::MarkerWeights;

/// Name of the model where none is given.
const STAND_IN: &str = "model.osim";

const IK_OVER_TIME: &str = include_str!("opensim/ik_over_time.py");
const README: &str = include_str!("opensim/README.txt");

/// What is written.
#[derive(Clone, Debug, PartialEq)]
pub struct OpensimFiles {
    /// Names with texts.
    pub files: Vec<(&'static str, String)>,
    /// Markers that have a place in the model, with their weights.
    pub weights: Vec<(String, f64)>,
    /// Points of the result that have none.
    pub left_out: Vec<String>,
    /// Frames of the result.
    pub frames: usize,
}

/// Names of the files that are written.
pub const OPENSIM_NAMES: [&str; 7] =
    ["markers.trc", "marker_set.xml", "scale.xml", "ik.xml", "weights.csv", "ik_over_time.py", "README.txt"];

/// Files for a result folder and a model.
///
/// # Errors
/// A folder without results or files of it, a model that is none, and a result of which the model has too few points.
pub fn opensim_files(folder: &Path, model: Option<&Path>) -> Result<OpensimFiles, Error> {
    refuse_several(folder).map_err(sinew::Error::from)?;
    if !folder.join("summary.json").exists() {
        return Err(without_summary(folder).into());
    }
    let path = folder.join("markers.trc");
    let text = read_text(&path, MAX_TEXT_BYTES)?;
    let markers = trc::read(&path.display().to_string(), &text)?;
    let parts = model.map(parts).transpose()?;
    let bodies = parts.as_ref().map(|parts| &parts.bodies[..]);
    let coordinates = parts.as_ref().map(|parts| &parts.coordinates[..]);
    let names = &markers.header.markers;
    let has = |marker: &ModelMarker| {
        let in_model = bodies.is_none_or(|bodies| bodies.contains(&marker.body));
        in_model && names.contains(&marker.name)
    };
    let mut placed = marker_set::markers(&setup(folder)?.tree());
    placed.retain(has);
    let is_placed = |name: &str| placed.iter().any(|marker| marker.name == name);
    if let Some(missing) = marker_set::NEEDED.iter().find(|name| !is_placed(name)) {
        let folder = folder.to_owned();
        return Err(OpensimError::NoMarker { folder, missing, model: model.map(Path::to_owned) }.into());
    }
    let weights = MarkerWeights::read(folder, &placed)?;
    let time = |frame: Option<&trc::TrcFrame>| frame.map_or(0.0, |frame| frame.time_s);
    let range = [time(markers.frames.first()), time(markers.frames.last())];
    let model_file = match model {
        Some(path) => whole(path).display().to_string(),
        None => STAND_IN.to_owned(),
    };
    let readme = README.replace("{{model}}", &model_line(model)).replace("{{held}}", held_line(model));
    let texts = [
        text,
        marker_set::to_xml(&placed),
        scale_setup::to_xml(&model_file, &placed, bodies, range),
        ik_setup::to_xml(&weights, coordinates, range),
        weights.to_csv()?,
        IK_OVER_TIME.to_owned(),
        readme,
    ];
    let left_out = names.iter().filter(|name| !is_placed(name)).cloned().collect();
    let shown = weights.names.iter().cloned().zip(weights.constant()).collect();
    let files = OPENSIM_NAMES.into_iter().zip(texts).collect();
    Ok(OpensimFiles { files, weights: shown, left_out, frames: markers.frames.len() })
}

fn setup(folder: &Path) -> Result<Setup, Error> {
    let path = folder.join("setup.toml");
    if !path.exists() {
        let missing = ReadError::NoFile { folder: folder.to_owned(), file: "setup.toml" };
        return Err(missing.into());
    }
    Ok(Setup::from_toml(&path.display().to_string(), &read_text(&path, MAX_CONFIG_BYTES)?)?)
}

/// The path from the root: setup files lie elsewhere than where the command was called.
fn whole(path: &Path) -> std::path::PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

fn model_line(model: Option<&Path>) -> String {
    match model {
        Some(path) => format!("The model is {}.", whole(path).display()),
        None => format!("Put a model here under the name {STAND_IN} first."),
    }
}

const fn held_line(model: Option<&Path>) -> &'static str {
    match model {
        Some(_) => "ik.xml does so if the model has it.",
        None => "In ik.xml set <apply> to\ntrue for the one that your model has.",
    }
}

fn parts(path: &Path) -> Result<OsimModel, Error> {
    Ok(osim_model::read(&path.display().to_string(), &read_text(path, MAX_TEXT_BYTES)?)?)
}
