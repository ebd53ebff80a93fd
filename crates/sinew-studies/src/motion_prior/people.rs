//! Walks that are tracked, each on a fitted body, and the motion model learned from others.

use crate::support::outcome::Outcome;
use crate::support::primitives::{Lesson, learned};
use sinew::body::{KinematicTree, Proportions};
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::dynamics::primitives::model::PrimitiveModel;
use sinew::formats::{amc, asf};
use sinew::latent::file::{LatentKind, StoredModel};
use sinew::latent::gpdm;
use sinew::latent::training::{self, Training};
use sinew_body::points::Trajectories;
use sinew_motion::cmu;
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::features::pose_coordinates;
use sinew_motion::learn::selection::{ChosenRows, first_phases, middles};
use sinew_motion::learn::sequences::{Acclaim, Sequences, sequences};
use sinew_motion::retarget::retarget;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Frames per second that are tracked.
pub(super) const RATE_HZ: f64 = 20.0;

/// Trials of one frame rate below the data folder.
struct Folder {
    name: &'static str,
    recorded_hz: f64,
}

const CMU: Folder = Folder { name: "cmu_amc", recorded_hz: 120.0 };
const SUBJECT_35: Folder = Folder { name: "cmu_amc_35", recorded_hz: 30.0 };

/// What is learned from.
const TRAINING: [(&Folder, &[&str]); 2] = [
    (&CMU, &["07_02", "07_05", "07_06", "07_08", "07_10", "49_19"]),
    (
        &SUBJECT_35,
        &[
            "walk_01", "walk_02", "walk_03", "walk_04", "walk_05", "walk_06", "walk_07", "walk_08", "walk_09",
            "walk_10", "walk_11", "walk_12", "run_01", "run_02", "run_03", "run_04", "run_05",
        ],
    ),
];

/// Walks that training lacks.
pub(super) const TEST: [&str; 8] = ["07_01", "07_04", "07_07", "07_09", "walk_13", "walk_14", "walk_15", "walk_16"];
/// People and motions that training lacks, their first seconds.
pub(super) const UNSEEN: [&str; 2] = ["01_01", "135_06"];
/// Frames of each.
const UNSEEN_FRAMES: usize = 200;

/// A walk of training that the pilot tracks, and leaves out of training.
pub(super) const PILOT: [&str; 1] = ["07_05"];

/// Feature vectors in an action primitive, and clusters at most: the paper's.
const LENGTH: usize = 3;
const CLUSTERS: usize = 80;

/// Someone who walks.
pub(super) struct Person {
    pub(super) trial: &'static str,
    pub(super) body: KinematicTree,
    pub(super) proportions: Proportions,
    pub(super) states: Vec<Vec<f64>>,
    pub(super) points: Trajectories,
}

impl Person {
    /// The person of a trial, on the standard body that was fitted to it.
    pub(super) fn new(data: &Path, trial: &'static str) -> Outcome<Self> {
        let folder = if trial.starts_with("walk") { SUBJECT_35 } else { CMU };
        let skeleton = match trial.split_once('_') {
            Some((subject, _)) if !trial.starts_with("walk") => subject,
            _ => "35",
        };
        let text = |file: String| std::fs::read_to_string(data.join(folder.name).join(file));
        let skeleton = asf::read(skeleton, &text(format!("{skeleton}.asf"))?)?;
        let motion = amc::read(trial, &text(format!("{trial}.amc"))?, &skeleton)?;
        let mut recorded = cmu::joints(&skeleton, &motion, folder.recorded_hz / RATE_HZ);
        if UNSEEN.contains(&trial) {
            recorded.frames.truncate(UNSEEN_FRAMES);
        }
        let fitted = retarget(&recorded).ok_or("no pose in the first frame")?;
        Ok(Self {
            trial,
            body: fitted.body,
            proportions: fitted.proportions,
            states: fitted.states,
            points: fitted.points,
        })
    }
}

/// What was learned from the training trials.
pub(super) struct Models {
    pub(super) primitives: Arc<PrimitiveModel>,
    pub(super) latent: Arc<StoredModel>,
}

impl Models {
    /// Of all training trials but some, from their files where there are any.
    pub(super) fn new(folder: &Path, data: &Path, without: &[&str]) -> Outcome<Self> {
        let primitives = Arc::new(primitives(&folder.join("model.json"), data, without)?);
        Ok(Self { primitives, latent: Arc::new(latent(&folder.join("latent.json"), data, without)?) })
    }
}

/// Files of a folder of training but some.
fn training_files(data: &Path, folder: &Folder, trials: &[&str], without: &[&str]) -> Vec<PathBuf> {
    let trials = trials.iter().filter(|trial| !without.contains(trial));
    trials.map(|trial| data.join(folder.name).join(trial).with_extension("amc")).collect()
}

/// The latent model of poses of the walks of both folders' people: a GPDM of three coordinates, balanced.
fn latent(path: &Path, data: &Path, without: &[&str]) -> Outcome<StoredModel> {
    let name = path.display().to_string();
    if let Ok(text) = std::fs::read_to_string(path) {
        return Ok(sinew::latent::file::read(&name, &text)?);
    }
    let [(cmu, trials), (subject_35, others)] = TRAINING;
    let walks = |trials: &[&'static str], prefix: &str| -> Vec<&'static str> {
        trials.iter().copied().filter(|trial| trial.starts_with(prefix)).collect()
    };
    let (mut sequences, chosen) = (vec![], pose_coordinates(NamedBody::H32));
    for (folder, trials) in [(cmu, walks(trials, "07")), (subject_35, walks(others, "walk"))] {
        let files = training_files(data, folder, &trials, without);
        let acclaim = Acclaim { hz: Some(folder.recorded_hz), ..Acclaim::default() };
        let (body, found) = (NamedBody::H32, sequences_of(&files, acclaim)?);
        sequences.extend(first_phases(&found, body.tree().dof(), &chosen));
    }
    let columns = chosen.len();
    let ChosenRows { rows, lengths, .. } = middles(&sequences, columns, LATENT_ROWS)?;
    let model = gpdm::model(&rows, columns, &lengths, &gpdm::Config::default())?;
    let mut training = Training::new(model, training::Config::default(), Isa::best())?;
    training.run(|_| true);
    let model = training.into_model();
    let state = NamedBody::H32.name().into();
    let stored = StoredModel { state, frame_rate: RATE_HZ, free: chosen.start, kind: LatentKind::Gpdm, model };
    std::fs::write(path, sinew::latent::file::write(&name, &stored)?)?;
    Ok(stored)
}

fn sequences_of(files: &[PathBuf], acclaim: Acclaim<'_>) -> Outcome<Sequences> {
    Ok(sequences(NamedBody::H32, files, acclaim, RATE_HZ, &mut |_| {})?)
}

/// Poses that the latent model is learned from, at most.
const LATENT_ROWS: usize = 400;

/// The model of the whole body of all training trials but some, from its file where there is one.
fn primitives(path: &Path, data: &Path, without: &[&str]) -> Outcome<PrimitiveModel> {
    let states = || {
        let mut states = vec![];
        for (folder, trials) in TRAINING {
            let files = training_files(data, folder, trials, without);
            let acclaim = Acclaim { hz: Some(folder.recorded_hz), ..Acclaim::default() };
            states.extend(sequences_of(&files, acclaim)?.states);
        }
        Ok(states)
    };
    let lesson = Lesson { body: NamedBody::H32, rate_hz: RATE_HZ, length: LENGTH, clusters: CLUSTERS };
    learned(path, &lesson, Stage::new(1, "motion prior models"), states)
}
