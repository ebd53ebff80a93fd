//! `sinew learn`: models from motion files. Here is what all kinds of models share.

pub(crate) mod latent;
pub(crate) mod primitives;

use super::args::General;
use super::error::{Error, Written};
use super::learn_args::MotionArgs;
use super::progress::Progress;
use serde_json::json;
use sinew::config::{Sources, TrackConfig, resolve};
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::motion_files::{LearnPhase, MotionFiles};
use sinew_motion::learn::sequences::FileFit;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The place to write to, and the settings that every command has.
fn place(general: &General) -> Result<(&str, TrackConfig), Error> {
    let Some(out) = general.out.as_deref() else {
        return Err(Error::NoPlace(Written::Model));
    };
    Ok((out, resolve(&Sources { flags: general.settings(), environment: Vec::new(), file: None })?.track()))
}

fn motion_files(args: &MotionArgs) -> MotionFiles {
    MotionFiles {
        motion: args.motion.clone(),
        held_out: args.held_out.clone(),
        skeleton: args.skeleton.clone(),
        amc_hz: args.amc_fps,
        body: NamedBody::find(&args.body).unwrap_or(NamedBody::H32),
        fps: args.fps,
    }
}

/// One progress a phase.
struct PhaseProgress<'a> {
    general: &'a General,
    /// What is counted while the model is learned.
    unit: &'static str,
    current: Mutex<Option<(LearnPhase, Progress)>>,
}

impl<'a> PhaseProgress<'a> {
    const fn new(general: &'a General, unit: &'static str) -> Self {
        Self { general, unit, current: Mutex::new(None) }
    }

    fn shown(&self) -> MutexGuard<'_, Option<(LearnPhase, Progress)>> {
        self.current.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn at(&self, phase: LearnPhase, done: u64, total: u64) {
        let mut current = self.shown();
        if !current.as_ref().is_some_and(|(known, _)| *known == phase) {
            let (what, unit) = match phase {
                LearnPhase::Follow => ("fitting", "files"),
                LearnPhase::Learn => ("learning", self.unit),
            };
            // The bar before is cleared first.
            *current = None;
            *current = Some((phase, Progress::counting(self.general, what, unit, total)));
        }
        if let Some((_, progress)) = &mut *current {
            progress.at(done);
        }
    }

    /// Shows more of the phase at hand.
    fn detail(&self, show: impl FnOnce(&Progress)) {
        if let Some((_, progress)) = &*self.shown() {
            show(progress);
        }
    }

    fn end(&self) {
        *self.shown() = None;
    }
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

/// The same as rows of an answer: what is learned from, and what is held out.
fn fit_rows(training: &[FileFit], held_out: &[FileFit]) -> Vec<(String, String)> {
    let named = [("motion", training), ("held out", held_out)];
    let given = named.into_iter().filter(|(_, files)| !files.is_empty());
    given.map(|(name, files)| (name.to_owned(), fits(files))).collect()
}

fn fit_as_json(fit: &FileFit) -> serde_json::Value {
    json!({
        "file": fit.path.to_string_lossy(),
        "frames": fit.frames,
        "recorded_hz": fit.recorded_hz,
        "working_hz": fit.working_hz,
        "mean_error_mm": 1000.0 * fit.mean_error_m,
    })
}
