//! Learning of a motion model from motion files, resumable between feature vectors.
//!
//! 1. Joints of each file at the working rate, the model's times a whole number, and the body along them ([`mod@super::sequences`]).
//! 2. Every phase of the model's rate is a sequence: a recording of 120 frames a second gives six of 20.
//! 3. One feature vector after the other ([`super::features`]) is learned ([`sinew_dynamics::primitives::learning`]); those that are done wait in a file beside the model, so that an interrupted run continues at the
//!    next one, to the same bytes.
//! 4. The model is written whole, with errors of its predictions on motion that was held out.

use super::LearnError;
use super::features::feature_vectors;
use super::motion_files::{Following, LearnPhase, MotionFiles, PhaseReport};
use super::sequences::{FileFit, Sequences};
use super::unfinished::{Found, Unfinished};
use crate::Error;
use crate::follow::NamedBody;
use sinew_core::random::Stage;
use sinew_dynamics::primitives::check::check;
use sinew_dynamics::primitives::file;
use sinew_dynamics::primitives::learning::{
    Config, LearningProgress, TrainingMotion, counted, learn_feature, noise_sd,
};
use sinew_dynamics::primitives::model::{FeatureVector, PrimitiveModel, Primitives};
use sinew_dynamics::primitives::summary::{PrimitiveSummary, summary};
use sinew_results::write_whole;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// What to learn from, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnRequest {
    /// The files, and the body that follows them.
    pub files: MotionFiles,
    /// Clusters of each feature vector.
    pub clusters: usize,
    /// Feature vectors in an action primitive.
    pub length: usize,
    /// Seed of all random draws.
    pub seed: u64,
}

/// A progress callback and a stop flag.
pub struct LearnWatch<'a> {
    /// Takes a phase, the files or feature vectors that are done, and all of them.
    pub progress: &'a mut PhaseReport<'a>,
    /// Takes each iteration of the clustering of a feature vector.
    pub iteration: &'a mut (dyn FnMut(&LearningProgress<'_>) + Send),
    /// Set to end after the feature vector at hand.
    pub stop: &'a AtomicBool,
}

/// What was learned.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedPrimitives {
    /// The model, as it was written; none where the run was interrupted.
    pub model: Option<PrimitiveModel>,
    /// Feature vectors that are done, and all of them.
    pub done: [usize; 2],
    /// How well the body follows the files to learn from.
    pub training: Vec<FileFit>,
    /// How well it follows those that were held out.
    pub held_out: Vec<FileFit>,
    /// What came of each feature vector.
    pub summaries: Vec<PrimitiveSummary>,
    /// What was odd.
    pub warnings: Vec<String>,
}

/// Learns a model and writes it to `out`.
///
/// # Errors
/// Files that cannot be read or followed, an output that exists (without `force`) or is an input, too little motion, and what the disk refuses.
pub fn learn(
    request: &LearnRequest,
    out: &Path,
    force: bool,
    watch: &mut LearnWatch<'_>,
) -> Result<LearnedPrimitives, Error> {
    request.files.refuse_output(out, force)?;
    let Following { training, held_out, mut warnings } = request.files.follow(watch.progress)?;
    let mut config = Config { length: request.length, ..Config::default() };
    config.mixture.components = request.clusters;
    let settings = format!("{} {} {}", request.clusters, request.length, request.seed);
    let fingerprint = request.files.fingerprint(&settings, training.states.iter().map(Vec::as_slice));
    let unfinished = Unfinished::beside(out, fingerprint);
    let model = learned(request, &training, &config, &unfinished, &mut warnings, watch)?;
    let summaries = model.primitives.iter().map(|primitives| summary(primitives, &held_out.states, model.dim));
    let summaries = summaries.collect::<Result<Vec<_>, _>>().map_err(LearnError::Learning)?;
    let done = [model.primitives.len(), feature_vectors(request.files.body).len()];
    let is_whole = done[0] == done[1];
    if is_whole {
        let text = file::write(&out.display().to_string(), &model).map_err(LearnError::Unwritable)?;
        write_whole(out, text.as_bytes())?;
        unfinished.remove()?;
    }
    let model = is_whole.then_some(model);
    Ok(LearnedPrimitives { model, done, training: training.files, held_out: held_out.files, summaries, warnings })
}

/// The model with the feature vectors that were done before the end or an interrupt.
fn learned(
    request: &LearnRequest,
    training: &Sequences,
    config: &Config,
    unfinished: &Unfinished,
    warnings: &mut Vec<String>,
    watch: &mut LearnWatch<'_>,
) -> Result<PrimitiveModel, Error> {
    let MotionFiles { body, fps, .. } = request.files;
    let (state, dim, sequences) = (body.name(), body.tree().dof(), &training.states[..]);
    let motion = TrainingMotion { state, dim, frame_rate: fps, sequences, horizontal: &NamedBody::HORIZONTAL };
    let longest = sequences.iter().map(|sequence| sequence.len() / dim).max().unwrap_or_default();
    if longest <= request.length {
        return Err(LearnError::NoWindows { length: request.length, frames: longest }.into());
    }
    let noise_sd = noise_sd(&motion, config).map_err(LearnError::Learning)?;
    let features = feature_vectors(body);
    let mut model = PrimitiveModel {
        state: state.into(),
        dim,
        frame_rate: fps,
        length: request.length,
        noise_sd,
        primitives: vec![],
    };
    let usable = |primitives: Vec<Primitives>| usable(&model, primitives, &features);
    match unfinished.read(usable) {
        Found::Nothing => {}
        Found::Done(primitives) => model.primitives = primitives,
        Found::Foreign(why) => warnings.push(why),
    }
    let (stage, total) = (Stage::new(request.seed, "learn primitives"), features.len() as u64);
    (watch.progress)(LearnPhase::Learn, model.primitives.len() as u64, total);
    for (index, feature) in features.iter().enumerate().skip(model.primitives.len()) {
        if watch.stop.load(Ordering::SeqCst) {
            break;
        }
        let mut report = counted(&feature.name, index, features.len(), watch.iteration);
        let found = learn_feature(&motion, feature, &model.noise_sd, config, stage.round(index), &mut report);
        drop(report);
        model.primitives.push(found.map_err(LearnError::Learning)?);
        unfinished.write(&model.primitives)?;
        (watch.progress)(LearnPhase::Learn, index as u64 + 1, total);
    }
    Ok(model)
}

/// Feature vectors of an unfinished run, if they are the first of these and make up a model.
fn usable(model: &PrimitiveModel, primitives: Vec<Primitives>, features: &[FeatureVector]) -> Option<Vec<Primitives>> {
    let whole = PrimitiveModel { primitives, ..model.clone() };
    let names = whole.primitives.iter().map(|primitives| &primitives.feature);
    let is_start = whole.primitives.len() <= features.len() && names.zip(features).all(|(a, b)| a == b);
    (is_start && check(&whole).is_ok()).then_some(whole.primitives)
}
