//! Training motion and the latent models that are learned from it, once, and kept beside the cells.
//!
//! Rows are the 25 angles ω at the tracked rate; place and orientation are left out. Three models: a GPDM and a GPLVM of three dimensions, and the hierarchy of the body's table.

use super::contender::Lesson;
use super::motions::{FAST_HZ, FAST_WALKS, HELD_OUT_SEVERAL, HELD_OUT_WALKS, RATE_HZ, SEVERAL, WALKS};
use crate::papers::recorded_trials::Recording;
use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::body::hapf31::{ANGLES, FREE, HIERARCHY};
use sinew::core::lanes::Isa;
use sinew::files::{FNV_START, fnv};
use sinew::latent::hgplvm::PlannedNode;
use sinew::latent::model::LatentModel;
use sinew::latent::training::{Config, Training};
use sinew::latent::{gpdm, gplvm, hgplvm};
use sinew_motion::follow::{NamedBody, follow};
use std::path::Path;

/// Dimensions of a single latent space.
pub(super) const SINGLE: usize = 3;
/// Least change from frame to frame that noise allows for, metres and radians.
const LEAST_STEP: f64 = 1e-3;

/// States of the body along trials.
#[derive(Clone, Debug)]
pub(super) struct Poses {
    /// By trial.
    pub(super) sequences: Vec<Vec<Vec<f64>>>,
    /// Mean distance of the body's joints to the recorded ones, metres, by trial.
    pub(super) errors_m: Vec<(&'static str, f64)>,
}

impl Poses {
    /// Makes the body follow trials that go round.
    fn new(data: &Path, trials: &[Recording], rate_hz: f64) -> Outcome<Self> {
        let (mut sequences, mut errors_m) = (vec![], vec![]);
        for trial in trials {
            let found = follow(NamedBody::Hapf31, &trial.bent(data, rate_hz)?)?;
            sequences.push(found.states);
            errors_m.push((trial.name, found.mean_error_m));
        }
        Ok(Self { sequences, errors_m })
    }

    /// The angles ω, row after row.
    fn rows(&self) -> Vec<f64> {
        self.sequences.iter().flatten().flat_map(|state| state[FREE..].iter().copied()).collect()
    }

    /// The angles ω of each row.
    pub(super) fn angles(&self) -> impl Iterator<Item = &[f64]> {
        self.sequences.iter().flatten().map(|state| &state[FREE..])
    }

    fn mean(&self) -> Vec<f64> {
        let count = self.sequences.iter().map(Vec::len).sum::<usize>() as f64;
        let sum = |j: usize| self.sequences.iter().flatten().map(|state| state[j]).sum::<f64>();
        (0..FREE + ANGLES).map(|j| sum(j) / count).collect()
    }

    /// Largest change of each coordinate between two frames of a trial; both horizontal ones have that of the place.
    fn fastest(&self) -> Vec<f64> {
        let pairs = || self.sequences.iter().flat_map(|states| states.windows(2));
        let largest = |change: &dyn Fn(&[Vec<f64>]) -> f64| pairs().map(change).fold(LEAST_STEP, f64::max);
        let mut fastest: Vec<f64> =
            (0..FREE + ANGLES).map(|j| largest(&|pair| (pair[1][j] - pair[0][j]).abs())).collect();
        let horizontal = largest(&|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        NamedBody::HORIZONTAL.iter().for_each(|&j| fastest[j] = horizontal);
        fastest
    }
}

/// A model that was learned, and how far learning came.
#[derive(Clone, Debug)]
pub(super) struct Learned {
    pub(super) model: LatentModel,
    pub(super) objective: f64,
    pub(super) steps: usize,
}

impl Learned {
    /// Learns a model, or reads it where it was learned from the same.
    fn new(path: &Path, start: impl FnOnce() -> Result<LatentModel, sinew::latent::Error>) -> Outcome<Self> {
        if let Ok(text) = std::fs::read_to_string(path) {
            let mut stored: Value = serde_json::from_str(&text)?;
            let model: LatentModel = serde_json::from_value(stored["model"].take())?;
            model.check()?;
            let objective = stored["objective"].as_f64().unwrap_or(f64::NAN);
            return Ok(Self { model, objective, steps: stored["steps"].as_u64().unwrap_or_default() as usize });
        }
        let mut training = Training::new(start()?, Config::default(), Isa::best())?;
        let progress = training.run(|_| true);
        let learned = Self { objective: progress.objective, steps: progress.steps, model: training.into_model() };
        let Self { model, objective, steps } = &learned;
        std::fs::write(path, json!({ "model": model, "objective": objective, "steps": steps }).to_string())?;
        Ok(learned)
    }
}

/// What was learned from some trials.
#[derive(Clone, Debug)]
pub(super) struct Taught {
    pub(super) poses: Poses,
    /// Other training motion, which nothing was learned from.
    pub(super) held_out: Poses,
    /// Mean of all states.
    pub(super) mean_pose: Vec<f64>,
    /// Largest change of each coordinate between frames.
    pub(super) fastest: Vec<f64>,
    pub(super) gplvm: Learned,
    pub(super) gpdm: Learned,
    pub(super) hierarchy: Learned,
}

impl Taught {
    /// Learns from the trials of a lesson; models are kept in a folder.
    pub(super) fn new(data: &Path, folder: &Path, lesson: Lesson) -> Outcome<Self> {
        let (trials, held_out, rate_hz): (&[Recording], &[Recording], f64) = match lesson {
            Lesson::Walks => (&WALKS, &HELD_OUT_WALKS, RATE_HZ),
            Lesson::Several => (&SEVERAL, &HELD_OUT_SEVERAL, RATE_HZ),
            Lesson::FastWalks => (&FAST_WALKS, &HELD_OUT_WALKS, FAST_HZ),
        };
        let poses = Poses::new(data, trials, rate_hz)?;
        let rows = poses.rows();
        let hash = rows.iter().fold(FNV_START, |hash, x| fnv(hash, &x.to_bits().to_le_bytes()));
        let sequences: Vec<usize> = poses.sequences.iter().map(Vec::len).collect();
        let path = |name: &str| folder.join(format!("{name}-{lesson:?}-{hash:016x}.json"));
        let single = gpdm::Config { dim: SINGLE, ..gpdm::Config::default() };
        let tree = hgplvm::Config { tree: branches(), root_per_motion: false };
        let static_single = gplvm::Config { dim: SINGLE, ..gplvm::Config::default() };
        Ok(Self {
            held_out: Poses::new(data, held_out, rate_hz)?,
            mean_pose: poses.mean(),
            fastest: poses.fastest(),
            gplvm: Learned::new(&path("gplvm"), || gplvm::model(&rows, ANGLES, &static_single))?,
            gpdm: Learned::new(&path("gpdm"), || gpdm::model(&rows, ANGLES, &sequences, &single))?,
            hierarchy: Learned::new(&path("hgplvm"), || hgplvm::model(&rows, ANGLES, &sequences, &[], &tree))?,
            poses,
        })
    }
}

/// The body's latent spaces as the model wants them.
fn branches() -> Vec<PlannedNode> {
    let is_leaf = |n: usize| HIERARCHY.iter().all(|space| space.parent != Some(n));
    let branch = |(n, space): (usize, &sinew::body::hapf31::LatentSpace)| PlannedNode {
        parent: space.parent,
        dim: space.latent_dim,
        columns: if is_leaf(n) { space.coordinates() } else { vec![] },
    };
    HIERARCHY.iter().enumerate().map(branch).collect()
}
