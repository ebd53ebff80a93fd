//! Motion models of the study, learned once and kept beside its cells.

use super::motions::{RATE_HZ, WORKING_HZ};
use crate::papers::recorded_trials::Recording;
use crate::support::outcome::Outcome;
use crate::support::primitives::{Lesson, learned};
use rayon::prelude::*;
use sinew::core::random::Stage;
use sinew::dynamics::primitives::model::PrimitiveModel;
use sinew::dynamics::primitives::windows::subsampled;
use sinew::files::{FNV_START, fnv};
use sinew_motion::follow::{NamedBody, follow};
use std::path::Path;

/// Training motion as states of the body.
pub(super) struct Training {
    /// Every phase of every trial.
    pub(super) sequences: Vec<Vec<f64>>,
    /// Mean of all states.
    pub(super) mean_pose: Vec<f64>,
    /// Mean distances of the body's joints to the recorded ones, metres, by trial.
    pub(super) errors_m: Vec<(&'static str, f64)>,
    /// Hash of the sequences, in the names of the models' files: models of other training are not read.
    hash: u64,
}

/// Working frames of a tracked one.
const PHASES: usize = (WORKING_HZ / RATE_HZ) as usize;

impl Training {
    /// Makes the body follow the trials, which go round as CMB does.
    pub(super) fn new(data: &Path, trials: &[Recording]) -> Outcome<Self> {
        let dim = NamedBody::Hppf24.tree().dof();
        let followed = trials.par_iter().map(|trial| -> Outcome<_> {
            let found = follow(NamedBody::Hppf24, &trial.bent(data, WORKING_HZ)?)?;
            Ok((subsampled(&found.states.concat(), dim, PHASES)?, (trial.name, found.mean_error_m)))
        });
        let followed = followed.collect::<Vec<_>>().into_iter().collect::<Outcome<Vec<_>>>()?;
        let (sequences, errors_m): (Vec<_>, Vec<_>) = followed.into_iter().unzip();
        let sequences = sequences.concat();
        let count = sequences.iter().map(Vec::len).sum::<usize>() / dim;
        let sum = |j: usize| sequences.iter().flat_map(|all| all.iter().skip(j).step_by(dim)).sum::<f64>();
        let hash = sequences.iter().flatten().fold(FNV_START, |hash, x| fnv(hash, &x.to_bits().to_le_bytes()));
        Ok(Self { mean_pose: (0..dim).map(|j| sum(j) / count as f64).collect(), sequences, errors_m, hash })
    }

    /// A model of action primitives of `length` D with at most `clusters` C clusters, from its file in a folder where there is one.
    pub(super) fn model(&self, folder: &Path, length: usize, clusters: usize) -> Outcome<PrimitiveModel> {
        let path = folder.join(format!("model-D{length}-C{clusters}-{:016x}.json", self.hash));
        let lesson = Lesson { body: NamedBody::Hppf24, rate_hz: RATE_HZ, length, clusters };
        learned(&path, &lesson, Stage::new(1, "hppf models"), || Ok(self.sequences.clone()))
    }
}
