//! `sinew learn latent`: a latent model from motion files.

use super::super::args::General;
use super::super::ended::Ended;
use super::super::error::Error;
use super::super::interrupt;
use super::super::learn_args::LatentArgs;
use super::super::report::{self, Report};
use super::super::table::aligned;
use super::{PhaseProgress, fit_as_json, fit_rows, motion_files, place};
use serde_json::json;
use sinew::run::threads::{wanted, with_threads};
use sinew_latent::file::LatentKind;
use sinew_latent::training::Progress;
use sinew_motion::learn::latent::{LatentRequest, LatentWatch, LearnedLatent, learn};
use sinew_motion::learn::reconstruction::Reconstruction;
use sinew_motion::learn::sequences::FileFit;
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &LatentArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let (out, config) = place(general)?;
    let kind = LatentKind::find(&args.model).unwrap_or(LatentKind::Gpdm);
    report.warnings(&idle(args, kind));
    let request = LatentRequest {
        files: motion_files(&args.files),
        kind,
        dim: args.dim,
        rows: args.rows,
        balanced: kind == LatentKind::Gpdm && args.balanced.unwrap_or(true),
        back: kind != LatentKind::Hgplvm && args.back,
        root_per_motion: kind == LatentKind::Hgplvm && args.root_per_motion,
        steps: args.steps,
    };
    let stop = interrupt::flag("the step");
    let shown = PhaseProgress::new(general, "steps");
    let mut progress = |phase, done, total| shown.at(phase, done, total);
    let mut step = |at: &Progress| shown.detail(|progress| progress.value(at.steps, "objective", at.objective));
    let learned = with_threads(wanted(&config), || {
        let mut warning = |warning: &str| report.warnings(&[warning.to_owned()]);
        let mut watch = LatentWatch { progress: &mut progress, step: &mut step, warning: &mut warning, stop: &stop };
        Ok::<_, Error>(learn(&request, Path::new(out), general.force, &mut watch)?)
    })?;
    shown.end();
    if learned.model.is_none() {
        let steps = learned.progress.steps;
        report.note(&format!("interrupted after {steps} steps; the same command continues from there"));
        return Ok(Ended::Interrupted);
    }
    if args.answer.json {
        report::answer_json(&as_json(&request, &learned, out))?;
    } else {
        report::answer(&as_text(&request, &learned, out))?;
    }
    Ok(Ended::Done)
}

/// Flags that the kind of model has no use for.
fn idle(args: &LatentArgs, kind: LatentKind) -> Vec<String> {
    let flags = [
        ("balanced", args.balanced.is_some() && kind != LatentKind::Gpdm),
        ("back", args.back && kind == LatentKind::Hgplvm),
        ("root-per-motion", args.root_per_motion && kind != LatentKind::Hgplvm),
    ];
    let idle = flags.into_iter().filter(|(_, is_idle)| *is_idle);
    idle.map(|(flag, _)| format!("`--{flag}` has no use with `--model {kind}`")).collect()
}

/// Coordinates of the latents, node by node.
fn dimensions(learned: &LearnedLatent) -> Vec<usize> {
    learned.model.iter().flat_map(|stored| stored.model.nodes.iter().map(|node| node.dim)).collect()
}

fn as_text(request: &LatentRequest, learned: &LearnedLatent, out: &str) -> String {
    let LatentRequest { files, kind, .. } = request;
    let mut rows = fit_rows(&learned.training, &learned.held_out);
    let (used, available) = (learned.lengths.iter().sum::<usize>(), learned.available);
    let sequences = if learned.lengths.len() == 1 { "sequence" } else { "sequences" };
    let cut = if used < available { format!(", the middle of each; {available} in all") } else { String::new() };
    rows.push(("rows".into(), format!("{used} in {} {sequences}{cut}", learned.lengths.len())));
    let coordinates = match &dimensions(learned)[..] {
        [only] => format!("{only} coordinates"),
        all => format!(
            "{} coordinates in {} nodes",
            all.iter().map(usize::to_string).collect::<Vec<_>>().join(", "),
            all.len()
        ),
    };
    rows.push((
        "model".into(),
        format!("{kind} of {}, {} frames per second, {coordinates}", files.body.name(), files.fps),
    ));
    let Progress { steps, objective, .. } = learned.progress;
    let ended = if steps >= request.steps { ", the most allowed" } else { "" };
    let seconds = learned.took.as_secs_f64();
    rows.push(("objective".into(), format!("{objective:.2} after {steps} steps{ended}, in {seconds:.1} s")));
    let [training, held_out] = &learned.reconstruction;
    let shown = |found: &Reconstruction| {
        let Reconstruction { rms_rad, poses } = found;
        format!("{:.2} degrees root mean square over {poses} poses", rms_rad.to_degrees())
    };
    rows.extend(training.iter().map(|found| ("there and back".to_owned(), shown(found))));
    rows.extend(held_out.iter().map(|found| ("held out".to_owned(), shown(found))));
    rows.push(("written".into(), out.to_owned()));
    aligned(&rows)
}

fn as_json(request: &LatentRequest, learned: &LearnedLatent, out: &str) -> serde_json::Value {
    let files = |fits: &[FileFit]| fits.iter().map(fit_as_json).collect::<Vec<_>>();
    let degrees = learned.reconstruction.map(|found| found.map(|found| found.rms_rad.to_degrees()));
    json!({
        "out": out,
        "model": request.kind.name(),
        "body": request.files.body.name(),
        "fps": request.files.fps,
        "dimensions": dimensions(learned),
        "rows": learned.lengths.iter().sum::<usize>(),
        "rows_available": learned.available,
        "sequences": learned.lengths,
        "objective": learned.progress.objective,
        "steps": learned.progress.steps,
        "seconds": learned.took.as_secs_f64(),
        "training_rms_deg": degrees[0],
        "held_out_rms_deg": degrees[1],
        "motion": files(&learned.training),
        "held_out": files(&learned.held_out),
        "warnings": learned.warnings,
    })
}
