//! Learning of a latent model from motion files, resumable to the same bytes.
//!
//! 1. Joints of each file at the working rate, and the body along them ([`mod@super::sequences`]); angles are continuous in time. Position and orientation of the root are left out, and feet, of which recordings do not say how they roll.
//! 2. Of each recording one phase at the rate of the model, cut where there is too much ([`super::selection`]).
//! 3. A model ([`sinew_latent`]) from principal components, and L-BFGS; its state waits in a file beside the model every fifty steps and when it is interrupted.
//! 4. The model is written whole, with errors of poses that go through it and back ([`super::reconstruction`]).

use super::LearnError;
use super::features::pose_coordinates;
use super::limbs::{branches, components};
use super::motion_files::{Following, LearnPhase, MotionFiles, PhaseReport};
use super::reconstruction::{Reconstruction, reconstruction};
use super::selection::{ChosenRows, first_phases, middles};
use super::sequences::FileFit;
use super::unfinished::{Found, Unfinished};
use crate::Error;
use sinew_core::lanes::Isa;
use sinew_latent::file::{self, LatentKind, StoredModel};
use sinew_latent::model::LatentModel;
use sinew_latent::training::{Config, Learning, Progress, Training};
use sinew_latent::{gpdm, gplvm, hgplvm};
use sinew_results::write_whole;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Steps from one stored state to the next.
const STORED: usize = 50;

/// Ridge of the regression that starts a back constraint.
const RIDGE: f64 = 1e-3;

/// Poses that are sent through the model and back, at most, for the training and for the held-out motion.
const TRIED: usize = 400;

/// What to learn from, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct LatentRequest {
    /// The files, and the body that follows them.
    pub files: MotionFiles,
    /// What kind of model.
    pub kind: LatentKind,
    /// Coordinates of a latent.
    pub dim: usize,
    /// Rows to learn from, at most.
    pub rows: usize,
    /// Whether the dynamics of a GPDM count D/q times.
    pub balanced: bool,
    /// Whether the latents of a GPLVM or GPDM are a smooth function of the poses.
    pub back: bool,
    /// Whether each file has a root of its own in an HGPLVM.
    pub root_per_motion: bool,
    /// Steps at most.
    pub steps: usize,
}

/// Progress callbacks and a stop flag.
pub struct LatentWatch<'a> {
    /// Takes a phase, the files or steps that are done, and all of them.
    pub progress: &'a mut PhaseReport<'a>,
    /// Takes every step.
    pub step: &'a mut (dyn FnMut(&Progress) + Send),
    /// Takes what is odd, before anything is learned.
    pub warning: &'a mut (dyn FnMut(&str) + Send),
    /// Set to end after the step at hand.
    pub stop: &'a AtomicBool,
}

/// What was learned.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedLatent {
    /// The model, as it was written; none where the run was interrupted.
    pub model: Option<StoredModel>,
    /// Where learning ended.
    pub progress: Progress,
    /// Time of the steps of this run.
    pub took: Duration,
    /// Rows of each sequence that was learned from.
    pub lengths: Vec<usize>,
    /// Rows that there were.
    pub available: usize,
    /// How well the body follows the files to learn from.
    pub training: Vec<FileFit>,
    /// How well it follows those that were held out.
    pub held_out: Vec<FileFit>,
    /// Poses of the training motion through the model and back, then of the held-out motion, where there is any.
    pub reconstruction: [Option<Reconstruction>; 2],
    /// What was odd.
    pub warnings: Vec<String>,
}

/// Learns a model and writes it to `out`.
///
/// # Errors
/// Files that cannot be read or followed, an output that exists (without `force`) or is an input, motion in too few ways, and what the disk refuses.
pub fn learn(
    request: &LatentRequest,
    out: &Path,
    force: bool,
    watch: &mut LatentWatch<'_>,
) -> Result<LearnedLatent, Error> {
    request.files.refuse_output(out, force)?;
    let Following { training, held_out, mut warnings } = request.files.follow(watch.progress)?;
    let (dim, chosen) = (request.files.body.tree().dof(), pose_coordinates(request.files.body));
    let selection = middles(&first_phases(&training, dim, &chosen), chosen.len(), request.rows)?;
    let LatentRequest { kind, dim: q, balanced, back, root_per_motion, steps, .. } = request;
    let settings = format!("{kind} {q} {balanced} {back} {root_per_motion} {steps} {:?}", selection.lengths);
    let unfinished =
        Unfinished::beside(out, request.files.fingerprint(&settings, std::iter::once(&selection.rows[..])));
    let mut learning = begun(request, &selection, &unfinished, &mut warnings)?;
    warnings.iter().for_each(|warning| (watch.warning)(warning));
    let started = Instant::now();
    let progress = climbed(&mut learning, request.steps, &unfinished, watch)?;
    let took = started.elapsed();
    let mut learned = LearnedLatent {
        model: None,
        progress,
        took,
        lengths: selection.lengths,
        available: selection.available,
        training: training.files.clone(),
        held_out: held_out.files.clone(),
        reconstruction: [None; 2],
        warnings,
    };
    if !progress.finished {
        return Ok(learned);
    }
    let MotionFiles { body, fps, .. } = request.files;
    let stored = StoredModel {
        state: body.name().into(),
        frame_rate: fps,
        free: chosen.start,
        kind: request.kind,
        model: learning.into_model(),
    };
    let text = file::write(&out.display().to_string(), &stored).map_err(LearnError::UnwritableLatent)?;
    let others = first_phases(&held_out, dim, &chosen).concat();
    for (found, poses) in learned.reconstruction.iter_mut().zip([&stored.model.data, &others]) {
        *found = reconstruction(&stored.model, poses, TRIED).map_err(LearnError::Latent)?;
    }
    write_whole(out, text.as_bytes())?;
    unfinished.remove()?;
    learned.model = Some(stored);
    Ok(learned)
}

/// Learning from where an unfinished run left it, or from the start.
fn begun(
    request: &LatentRequest,
    selection: &ChosenRows,
    unfinished: &Unfinished,
    warnings: &mut Vec<String>,
) -> Result<Training, Error> {
    match unfinished.read(|state: Learning| Training::resume(state, Isa::best()).ok()) {
        Found::Done(training) => return Ok(training),
        Found::Nothing => {}
        Found::Foreign(why) => warnings.push(why),
    }
    let config = Config { steps: request.steps, ..Config::default() };
    Ok(Training::new(model(request, selection)?, config, Isa::best()).map_err(LearnError::Latent)?)
}

/// The model at its start.
fn model(request: &LatentRequest, selection: &ChosenRows) -> Result<LatentModel, LearnError> {
    let ChosenRows { rows, lengths, .. } = selection;
    let columns = pose_coordinates(request.files.body).len();
    let (dim, back) = (request.dim, request.back.then_some(RIDGE));
    let found = components(rows, columns, &(0..columns).collect::<Vec<_>>(), dim);
    if found < dim {
        return Err(LearnError::FewComponents { found, wanted: dim });
    }
    let model = match request.kind {
        LatentKind::Gplvm => {
            let mut model = gplvm::model(rows, columns, &gplvm::Config { dim, back, ..gplvm::Config::default() });
            if let Ok(model) = &mut model {
                model.sequences.clone_from(lengths);
            }
            model
        }
        LatentKind::Gpdm => {
            let config = gpdm::Config { dim, back, balanced: request.balanced, ..gpdm::Config::default() };
            gpdm::model(rows, columns, lengths, &config)
        }
        LatentKind::Hgplvm => {
            let tree = branches(request.files.body, rows, dim)?;
            let config = hgplvm::Config { tree, root_per_motion: request.root_per_motion };
            hgplvm::model(rows, columns, lengths, &vec![1; lengths.len()], &config)
        }
    };
    model.map_err(LearnError::Latent)
}

/// Steps to the end or an interrupt, which leaves the state in the unfinished file.
fn climbed(
    learning: &mut Training,
    steps: usize,
    unfinished: &Unfinished,
    watch: &mut LatentWatch<'_>,
) -> Result<Progress, Error> {
    let mut progress = learning.progress();
    (watch.progress)(LearnPhase::Learn, progress.steps as u64, steps as u64);
    while !progress.finished {
        if watch.stop.load(Ordering::SeqCst) {
            unfinished.write(learning.state())?;
            break;
        }
        let before = progress.steps;
        progress = learning.step();
        (watch.progress)(LearnPhase::Learn, progress.steps as u64, steps as u64);
        (watch.step)(&progress);
        if progress.steps > before && progress.steps.is_multiple_of(STORED) {
            unfinished.write(learning.state())?;
        }
    }
    Ok(progress)
}
