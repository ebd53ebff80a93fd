//! `sinew learn primitives`: a motion model from motion files.

use super::args::General;
use super::ended::Ended;
use super::error::{Error, Written};
use super::interrupt;
use super::learn_args::PrimitivesArgs;
use super::progress::Progress;
use super::report::{self, Report};
use super::table::{aligned, columns};
use super::threads::with_threads;
use serde_json::json;
use sinew::config::{Sources, resolve};
use sinew::dynamics::primitives::learning::LearningProgress;
use sinew::dynamics::primitives::summary::{PredictionErrors, PrimitiveSummary};
use sinew_motion::follow::NamedBody;
use sinew_tools::learn::sequences::FileFit;
use sinew_tools::learn::{LearnPhase, LearnRequest, LearnWatch, Learned, learn};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Runs the command.
pub(crate) fn run(args: &PrimitivesArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let Some(out) = general.out.as_deref() else {
        return Err(Error::NoPlace(Written::Model));
    };
    let config = resolve(&Sources { flags: general.settings(), environment: Vec::new(), file: None })?.track();
    let request = LearnRequest {
        motion: args.motion.clone(),
        held_out: args.held_out.clone(),
        skeleton: args.skeleton.clone(),
        amc_hz: args.amc_fps,
        body: NamedBody::find(&args.body).unwrap_or(NamedBody::H32),
        fps: args.fps,
        clusters: args.clusters,
        length: args.length,
        seed: config.tracking.seed,
    };
    let stop = interrupt::flag("the feature vector");
    let current: Mutex<Option<(LearnPhase, Progress)>> = Mutex::new(None);
    let shown = || current.lock().unwrap_or_else(PoisonError::into_inner);
    let mut progress = |phase, done, total| {
        let mut current = shown();
        if !current.as_ref().is_some_and(|(known, _)| *known == phase) {
            let (what, unit) = match phase {
                LearnPhase::Follow => ("fitting", "files"),
                LearnPhase::Learn => ("learning", "vectors"),
            };
            // The bar before is cleared first.
            *current = None;
            *current = Some((phase, Progress::counting(general, what, unit, total)));
        }
        if let Some((_, progress)) = &mut *current {
            progress.at(done);
        }
    };
    let mut before = 0.0;
    let mut iteration = |at: &LearningProgress<'_>| {
        // The first of a feature vector has none before it.
        if let (1.., Some((_, progress))) = (at.iteration, &*shown()) {
            progress.iteration(at.feature, at.iteration, ((at.log_likelihood - before) / before).abs());
        }
        before = at.log_likelihood;
    };
    let learned = with_threads(&config, || {
        let mut watch = LearnWatch { progress: &mut progress, iteration: &mut iteration, stop: &stop };
        learn(&request, Path::new(out), general.force, &mut watch)
    })?;
    *shown() = None;
    report.warnings(&learned.warnings);
    if learned.model.is_none() {
        let [done, all] = learned.done;
        report
            .note(&format!("interrupted after {done} of {all} feature vectors; the same command continues from there"));
        return Ok(Ended::Interrupted);
    }
    if args.answer.json {
        report::answer_json(&as_json(&request, &learned, out))?;
    } else {
        report::answer(&as_text(&request, &learned, out))?;
    }
    Ok(Ended::Done)
}

fn as_text(request: &LearnRequest, learned: &Learned, out: &str) -> String {
    let LearnRequest { body, fps, length, seed, .. } = request;
    let mut rows = vec![("motion".to_owned(), fits(&learned.training))];
    if !learned.held_out.is_empty() {
        rows.push(("held out".into(), fits(&learned.held_out)));
    }
    rows.push((
        "model".into(),
        format!("{}, {fps} frames per second, primitives of {length}, seed {seed}", body.name()),
    ));
    rows.push(("written".into(), out.to_owned()));
    let features: Vec<Vec<String>> = learned.summaries.iter().map(cells).collect();
    let predicted = learned.summaries.iter().any(|summary| summary.held_out.is_some());
    let shown = if predicted { HEADS.len() } else { ALWAYS };
    let heads: Vec<String> = HEADS[..shown].iter().map(|head| (*head).to_owned()).collect();
    let note = if predicted {
        "\nErrors on the held-out motion, root mean square in radians; all but `lost` (by the principal components)\n\
         are of one step ahead: by what follows in the cluster (6), by the step that follows (7), by the mean of\n\
         the three models, by no change, by constant velocity.\n"
    } else {
        ""
    };
    format!("{}\n{}{note}", aligned(&rows), columns(&heads, &features))
}

/// Heads of the table of feature vectors.
const HEADS: [&str; 11] = [
    "vector",
    "windows",
    "clusters",
    "filled",
    "variance",
    "lost",
    "next (6)",
    "step (7)",
    "switching",
    "no change",
    "velocity",
];

/// Those that are known without held-out motion.
const ALWAYS: usize = 5;

fn cells(summary: &PrimitiveSummary) -> Vec<String> {
    let PrimitiveSummary { feature, windows, requested, clusters, well_filled, share, held_out, .. } = summary;
    let mut cells = vec![
        feature.clone(),
        windows.to_string(),
        format!("{clusters} of {requested}"),
        well_filled.to_string(),
        format!("{:.1} %", 100.0 * share),
    ];
    if let Some(errors) = held_out {
        let PredictionErrors { next, step, switching, no_change, constant_velocity, reconstruction, .. } = *errors;
        cells.extend([reconstruction, next, step, switching, no_change].map(|error| format!("{error:.4}")));
        cells.push(constant_velocity.map_or_else(|| "-".into(), |error| format!("{error:.4}")));
    }
    cells
}

/// How well the body follows some files.
fn fits(files: &[FileFit]) -> String {
    let frames: usize = files.iter().map(|file| file.frames).sum();
    let weighted: f64 = files.iter().map(|file| file.mean_error_m * file.frames as f64).sum();
    let errors = files.iter().map(|file| 1000.0 * file.mean_error_m);
    let (least, most) = errors.fold((f64::INFINITY, 0.0_f64), |(least, most), e| (least.min(e), most.max(e)));
    let plural = if files.len() == 1 { "file" } else { "files" };
    format!(
        "{} {plural}, {frames} frames, joints missed by {:.1} mm on average ({least:.1} to {most:.1})",
        files.len(),
        1000.0 * weighted / frames.max(1) as f64
    )
}

fn as_json(request: &LearnRequest, learned: &Learned, out: &str) -> serde_json::Value {
    let file = |fit: &FileFit| {
        json!({
            "file": fit.path.to_string_lossy(),
            "frames": fit.frames,
            "recorded_hz": fit.recorded_hz,
            "working_hz": fit.working_hz,
            "mean_error_mm": 1000.0 * fit.mean_error_m,
        })
    };
    let errors = |errors: &PredictionErrors| {
        json!({
            "steps": errors.steps,
            "reconstruction": errors.reconstruction,
            "next": errors.next,
            "step": errors.step,
            "switching": errors.switching,
            "no_change": errors.no_change,
            "constant_velocity": errors.constant_velocity,
        })
    };
    let vector = |summary: &PrimitiveSummary| {
        json!({
            "name": summary.feature,
            "coordinates": summary.coordinates,
            "windows": summary.windows,
            "requested": summary.requested,
            "clusters": summary.clusters,
            "well_filled": summary.well_filled,
            "variance_share": summary.share,
            "held_out_rms_rad": summary.held_out.as_ref().map(errors),
        })
    };
    json!({
        "out": out,
        "body": request.body.name(),
        "fps": request.fps,
        "length": request.length,
        "seed": request.seed,
        "motion": learned.training.iter().map(file).collect::<Vec<_>>(),
        "held_out": learned.held_out.iter().map(file).collect::<Vec<_>>(),
        "feature_vectors": learned.summaries.iter().map(vector).collect::<Vec<_>>(),
        "warnings": learned.warnings,
    })
}
