//! What is the same for all frames of a run.

use crate::Error;
use crate::config::TrackConfig;
use crate::config::settings::Settings;
use crate::input::up_axis::{Z_UP, z_up_from};
use crate::methods::Gives;
use crate::setup::Setup;
use crate::track::TRAJECTORIES;
use crate::track::checkpoint::Checkpoint;
use crate::track::error::TrackError;
use crate::track::pipeline::Pipeline;
use sinew_input::world_turn::WorldTurn;
use sinew_observe::Camera;
use sinew_results::Texts;
use sinew_results::estimate::{Carried, EstimateKind, RunInfo};
use sinew_setup::lasting_sources::PointSources;

/// What is the same for all frames.
pub(super) fn run_info(
    config: &TrackConfig,
    settings: &Settings,
    setup: &Setup,
    pipeline: &Pipeline,
    cameras: Vec<Camera>,
    first_frame: u64,
    setup_toml: String,
) -> RunInfo {
    let kind = match (config.smooth, config.lag_frames) {
        (true, _) => EstimateKind::Smoothed,
        (false, 0) => EstimateKind::Filtered,
        (false, _) => EstimateKind::FixedLag,
    };
    let knows_later = kind != EstimateKind::Filtered;
    let (carried, method) = (pipeline.carried(), settings.method.about());
    let used = || cameras.iter().map(|camera| setup.camera.iter().find(|known| known.name == camera.name));
    RunInfo {
        method: method.name.into(),
        is_weighted: method.gives == Gives::Particles,
        kind,
        body: setup.tree(),
        angles: pipeline.angles().clone(),
        zero: pipeline.zero().cloned(),
        world: world(setup),
        fps: settings.fps,
        first_frame,
        draws: if knows_later { settings.draws.min(TRAJECTORIES) } else { settings.draws },
        carried: if knows_later {
            let Carried { log_evidence, size, detected, .. } = carried;
            Carried { log_evidence, size, detected, ..Carried::default() }
        } else {
            carried
        },
        acting_parts: pipeline.acting_parts().to_vec(),
        seed: settings.seed,
        isa: settings.isa.name().into(),
        camera_offset_px: used().map(|known| known.map_or([0.0; 2], |known| known.offset_px)).collect(),
        sigma_px: used().flatten().map(|known| known.sigma_px).fold(0.0, f64::max),
        sources: sources(setup, &cameras),
        cameras,
        keypoints: pipeline.keypoints(),
        has_masks: config.silhouettes.is_some(),
        setup_toml,
    }
}

/// How the calibration's world was turned.
fn world(setup: &Setup) -> Option<WorldTurn> {
    let turn = z_up_from(&setup.world_up).filter(|_| setup.world_up != Z_UP)?;
    Some(WorldTurn { up: setup.world_up.clone(), sd_deg: setup.world_up_sd_deg, results_from_calibration: turn })
}

/// What the uncertainty comes from that is constant, of a run with the cameras of its set-up. Where the size of the body is unknown, that is more than all of it.
fn sources(setup: &Setup, cameras: &[Camera]) -> Vec<PointSources> {
    let known = setup.lasting.as_ref().filter(|known| known.cameras.len() == cameras.len() && setup.size_sd == 0.0);
    known.map_or_else(Vec::new, |known| known.source.clone())
}

/// The texts of the run as it was begun.
pub(super) fn texts(from: &Checkpoint) -> Result<Texts, Error> {
    let [config_toml, settings, settings_hash] = from.texts.clone();
    let settings = serde_json::from_str(&settings).map_err(TrackError::StoredSettings)?;
    Ok(Texts { config_toml, settings, settings_hash })
}
