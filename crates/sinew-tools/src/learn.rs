//! Learning of a motion model from motion files, resumable between feature vectors.
//!
//! 1. Joints of each file at the working rate, the model's times a whole number, and the body along them ([`mod@sequences`]).
//! 2. Every phase of the model's rate is a sequence: a recording of 120 frames a second gives six of 20.
//! 3. One feature vector after the other ([`features`]) is learned ([`sinew_dynamics::primitives::learning`]); those that are done wait in a file beside the model, so that an interrupted run continues at the
//!    next one, to the same bytes.
//! 4. The model is written whole, with errors of its predictions on motion that was held out.

mod error;
pub mod features;
pub mod sequences;
mod unfinished;

pub use error::LearnError;

use crate::Error;
use features::feature_vectors;
use sequences::{Acclaim, FileFit, Sequences, sequences};
use sinew::files::{FNV_START, fnv};
use sinew::results::error::Occupied;
use sinew::results::write_whole;
use sinew_core::random::Stage;
use sinew_dynamics::primitives::file;
use sinew_dynamics::primitives::learning::{
    Config, LearningProgress, TrainingMotion, counted, learn_feature, noise_sd,
};
use sinew_dynamics::primitives::model::PrimitiveModel;
use sinew_dynamics::primitives::summary::{PrimitiveSummary, summary};
use sinew_motion::follow::NamedBody;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use unfinished::{Found, Unfinished};

/// What to learn from, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnRequest {
    /// Motion files to learn from.
    pub motion: Vec<PathBuf>,
    /// Motion files to predict.
    pub held_out: Vec<PathBuf>,
    /// Skeleton of all AMC files; each has its own beside it if `None`.
    pub skeleton: Option<PathBuf>,
    /// Frames per second of AMC files, which state none; 120 if `None`.
    pub amc_hz: Option<f64>,
    /// Body whose states move.
    pub body: NamedBody,
    /// Frames per second of the model.
    pub fps: f64,
    /// Clusters of each feature vector.
    pub clusters: usize,
    /// Feature vectors in an action primitive.
    pub length: usize,
    /// Seed of all random draws.
    pub seed: u64,
}

/// Part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LearnPhase {
    /// The body is fitted to files.
    Follow,
    /// Feature vectors are learned.
    Learn,
}

/// A progress callback and a stop flag.
pub struct LearnWatch<'a> {
    /// Takes a phase, the files or feature vectors that are done, and all of them.
    pub progress: &'a mut (dyn FnMut(LearnPhase, u64, u64) + Send),
    /// Takes each iteration of the clustering of a feature vector.
    pub iteration: &'a mut (dyn FnMut(&LearningProgress<'_>) + Send),
    /// Set to end after the feature vector at hand.
    pub stop: &'a AtomicBool,
}

/// What was learned.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
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
pub fn learn(request: &LearnRequest, out: &Path, force: bool, watch: &mut LearnWatch<'_>) -> Result<Learned, Error> {
    refuse_output(request, out, force)?;
    let total = request.motion.len() + request.held_out.len();
    let follow = |files: &[PathBuf], before: usize, watch: &mut LearnWatch<'_>| {
        let mut done = |done: usize| (watch.progress)(LearnPhase::Follow, (before + done) as u64, total as u64);
        let acclaim = Acclaim { skeleton: request.skeleton.as_deref(), hz: request.amc_hz };
        sequences(request.body, files, acclaim, request.fps, &mut done)
    };
    let training = follow(&request.motion, 0, watch)?;
    let held_out = follow(&request.held_out, request.motion.len(), watch)?;
    let mut warnings: Vec<String> = training.warnings.iter().chain(&held_out.warnings).cloned().collect();
    let mut config = Config { length: request.length, ..Config::default() };
    config.mixture.components = request.clusters;
    let model = learned(request, &training, &config, out, &mut warnings, watch)?;
    let summaries = model.primitives.iter().map(|primitives| summary(primitives, &held_out.states, model.dim));
    let summaries = summaries.collect::<Result<Vec<_>, _>>().map_err(LearnError::Learning)?;
    let done = [model.primitives.len(), feature_vectors(request.body).len()];
    let is_whole = done[0] == done[1];
    if is_whole {
        let text = file::write(&out.display().to_string(), &model).map_err(LearnError::Unwritable)?;
        write_whole(out, text.as_bytes())?;
        Unfinished::beside(out).remove()?;
    }
    let model = is_whole.then_some(model);
    Ok(Learned { model, done, training: training.files, held_out: held_out.files, summaries, warnings })
}

fn refuse_output(request: &LearnRequest, out: &Path, force: bool) -> Result<(), Error> {
    let Ok(place) = out.canonicalize() else { return Ok(()) };
    let inputs = request.motion.iter().chain(&request.held_out).chain(&request.skeleton);
    if let Some(input) = inputs.into_iter().find(|input| input.canonicalize().is_ok_and(|input| input == place)) {
        return Err(sinew::Error::OutputIsInput { path: out.to_owned(), input: input.clone() }.into());
    }
    if place.is_dir() {
        return Err(sinew::Error::io("write", out)(std::io::ErrorKind::IsADirectory.into()).into());
    }
    if !force {
        return Err(sinew::Error::OutputExists { path: out.to_owned(), found: Occupied::File }.into());
    }
    Ok(())
}

/// The model with the feature vectors that were done before the end or an interrupt.
fn learned(
    request: &LearnRequest,
    training: &Sequences,
    config: &Config,
    out: &Path,
    warnings: &mut Vec<String>,
    watch: &mut LearnWatch<'_>,
) -> Result<PrimitiveModel, Error> {
    let (dim, sequences) = (request.body.tree().dof(), &training.states[..]);
    let state = request.body.name();
    let motion = TrainingMotion { state, dim, frame_rate: request.fps, sequences, horizontal: &NamedBody::HORIZONTAL };
    let longest = sequences.iter().map(|sequence| sequence.len() / dim).max().unwrap_or_default();
    if longest <= request.length {
        return Err(LearnError::NoWindows { length: request.length, frames: longest }.into());
    }
    let noise_sd = noise_sd(&motion, config).map_err(LearnError::Learning)?;
    let features = feature_vectors(request.body);
    let mut model = PrimitiveModel {
        state: state.into(),
        dim,
        frame_rate: request.fps,
        length: request.length,
        noise_sd,
        primitives: vec![],
    };
    let unfinished = Unfinished::beside(out);
    let fingerprint = fingerprint(request, sequences);
    match unfinished.read(fingerprint, &model, &features) {
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
        unfinished.write(fingerprint, &model.primitives)?;
        (watch.progress)(LearnPhase::Learn, index as u64 + 1, total);
    }
    Ok(model)
}

/// Hash of all that decides what is learned.
fn fingerprint(request: &LearnRequest, sequences: &[Vec<f64>]) -> u64 {
    let LearnRequest { body, fps, clusters, length, seed, .. } = request;
    let head = format!("{} {} {fps} {clusters} {length} {seed}", env!("CARGO_PKG_VERSION"), body.name());
    let lengths = sequences.iter().map(|sequence| sequence.len() as u64);
    let numbers = sequences.iter().flatten().map(|x| x.to_bits());
    lengths.chain(numbers).fold(fnv(FNV_START, head.as_bytes()), |hash, bits| fnv(hash, &bits.to_le_bytes()))
}
