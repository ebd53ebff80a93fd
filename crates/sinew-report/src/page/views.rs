//! Where the cameras of a run stand, and what they see of the world.

use super::html::with_code;
use super::recorded::Recorded;
use crate::Error;
use serde_json::{Value, json};
use sinew::config::{Sources, resolve};
use sinew::input::recording::Calibrated;
use sinew_input::flag::flag;
use sinew_observe::Camera;
use sinew_results::stored_array::stored_array;
use sinew_results::tracked::calibrated;
use std::path::Path;

/// A camera in the world.
pub(super) struct View {
    /// Metres; NaN where the folder does not say.
    centre: [f64; 3],
    /// Its right, down and forward axes, and half the width and height of its image at a distance of 1.
    sees: Option<([[f64; 3]; 3], [f64; 2])>,
}

/// The cameras in the order of the set-up.
pub(super) struct Views {
    all: Vec<View>,
}

/// The cameras of a calibration or of the run's own, or where the folder says that they stand.
pub(super) fn views(folder: &Path, recorded: &Recorded, calibration: Option<&Path>) -> Result<Views, Error> {
    let cameras = match calibration {
        Some(calibration) => Some(calibrated(&recorded.setup, calibration)?.0),
        None => cameras_of_run(folder, recorded),
    };
    if let Some(cameras) = cameras {
        return Ok(Views { all: cameras.iter().map(calibrated_view).collect() });
    }
    let count = recorded.setup.camera.len();
    let centres = stored_array(folder, "constant_data/camera_centre")?.filter(|array| array.shape == [count, 3]);
    let centre = |camera: usize| {
        let values = centres.as_ref().and_then(|centres| centres.values.get(3 * camera..3 * camera + 3));
        values.map_or([f64::NAN; 3], |values| [values[0], values[1], values[2]])
    };
    Ok(Views { all: (0..count).map(|camera| View { centre: centre(camera), sees: None }).collect() })
}

/// The cameras of the calibration that `config.toml` names, if it is still the one of the run, by its hash.
fn cameras_of_run(folder: &Path, recorded: &Recorded) -> Option<Vec<Camera>> {
    let config = folder.join("config.toml");
    let settings = config.exists().then(|| resolve(&Sources { file: Some(config), ..Sources::default() }).ok())??;
    let calibration = settings.track().calibration.filter(|path| path.is_file())?;
    let hash = Calibrated::read(&calibration).ok()?.hash;
    let is_it = recorded.summary["input_hashes"]["calibration"] == format!("{hash:016x}");
    is_it.then(|| calibrated(&recorded.setup, &calibration).ok())?.map(|(cameras, _)| cameras)
}

fn calibrated_view(camera: &Camera) -> View {
    let (axes, t) = (camera.rotation, camera.translation);
    let centre = [0, 1, 2].map(|k: usize| -(0..3).map(|row| axes[row][k] * t[row]).sum::<f64>());
    let [width, height] = camera.image_size_px;
    let half = [0.5 * width / camera.intrinsics.fx, 0.5 * height / camera.intrinsics.fy];
    View { centre, sees: Some((axes, half)) }
}

impl Views {
    /// What the page's program reads of each camera.
    pub(super) fn to_json(&self, names: impl Iterator<Item = String>) -> Value {
        let view = |(name, View { centre, sees }): (String, &View)| {
            let (axes, half) = sees.unzip();
            json!({ "name": name, "centre": centre, "axes": axes, "half": half })
        };
        names.zip(&self.all).map(view).collect()
    }

    /// What the page says where it does not know in which direction cameras look.
    pub(super) fn note(&self) -> String {
        let is_known = self.all.iter().all(|view| view.sees.is_some());
        if is_known {
            return String::new();
        }
        with_code(&format!(
            "Cameras are drawn as looking at the person, since the calibration of the run is not where it was, or another: {} of `sinew report` gives their directions.",
            flag("calibration")
        ))
    }
}
