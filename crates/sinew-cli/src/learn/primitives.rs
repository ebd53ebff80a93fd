//! `sinew learn primitives`: a motion model from motion files.

use super::super::args::General;
use super::super::ended::Ended;
use super::super::error::Error;
use super::super::interrupt;
use super::super::learn_args::PrimitivesArgs;
use super::super::report::{self, Report};
use super::super::table::{aligned, columns};
use super::{PhaseProgress, fit_as_json, fit_rows, motion_files, place};
use serde_json::json;
use sinew::dynamics::primitives::learning::LearningProgress;
use sinew::dynamics::primitives::summary::{PredictionErrors, PrimitiveSummary};
use sinew::run::threads::{wanted, with_threads};
use sinew_motion::learn::primitives::{LearnRequest, LearnWatch, LearnedPrimitives, learn};
use sinew_motion::learn::sequences::FileFit;
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &PrimitivesArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let (out, config) = place(general)?;
    let request = LearnRequest {
        files: motion_files(&args.files),
        clusters: args.clusters,
        length: args.length,
        seed: config.seed,
    };
    let stop = interrupt::flag("the feature vector");
    let shown = PhaseProgress::new(general, "vectors");
    let mut progress = |phase, done, total| shown.at(phase, done, total);
    let mut before = 0.0;
    let mut iteration = |at: &LearningProgress<'_>| {
        // The first of a feature vector has none before it.
        if at.iteration > 0 {
            let change = ((at.log_likelihood - before) / before).abs();
            shown.detail(|progress| progress.iteration(at.feature, at.iteration, change));
        }
        before = at.log_likelihood;
    };
    let learned = with_threads(wanted(&config), || {
        let mut watch = LearnWatch { progress: &mut progress, iteration: &mut iteration, stop: &stop };
        Ok::<_, Error>(learn(&request, Path::new(out), general.force, &mut watch)?)
    })?;
    shown.end();
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

fn as_text(request: &LearnRequest, learned: &LearnedPrimitives, out: &str) -> String {
    let LearnRequest { files, length, seed, .. } = request;
    let (body, fps) = (files.body.name(), files.fps);
    let mut rows = fit_rows(&learned.training, &learned.held_out);
    rows.push(("model".into(), format!("{body}, {fps} frames per second, primitives of {length}, seed {seed}")));
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

fn as_json(request: &LearnRequest, learned: &LearnedPrimitives, out: &str) -> serde_json::Value {
    let files = |fits: &[FileFit]| fits.iter().map(fit_as_json).collect::<Vec<_>>();
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
        "body": request.files.body.name(),
        "fps": request.files.fps,
        "length": request.length,
        "seed": request.seed,
        "motion": files(&learned.training),
        "held_out": files(&learned.held_out),
        "feature_vectors": learned.summaries.iter().map(vector).collect::<Vec<_>>(),
        "warnings": learned.warnings,
    })
}
