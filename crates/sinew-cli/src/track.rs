//! `sinew track`: settings, checks, the run, and what to tell about it.

use super::args::{General, TrackArgs};
use super::progress::Progress;
use super::report::{self, Report};
use super::{Ended, interrupt};
use sinew::Error;
use sinew::config::{Init, Resolved, Sources, TrackConfig, resolve};
use sinew::input::footage::Footage;
use sinew::input::recording::Options;
use sinew::results::problem::{self, Problem};
use sinew::results::{Claim, RESULT_NAMES, ResultFolder, claim, claim_to_resume};
use sinew::track::checkpoint::{self, Checkpoint};
use sinew::track::job;
use sinew::track::job::{Outcome, Pass, Watch};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Runs the command.
pub(crate) fn run(args: &TrackArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let resolved = settings(&args.settings.given, general)?;
    report.warnings(&resolved.warnings);
    report.warnings(&resolved.idle_flags());
    if args.print_config {
        if args.answer.json {
            report::answer_json(&resolved.to_json())?;
        } else {
            report::answer(&resolved.describe())?;
        }
        return Ok(Ended::Done);
    }
    report.detail(&resolved.describe());
    let config = resolved.track();
    let calibration = inputs(&config)?;
    let options = reading(&config);
    let mut read_from = vec![calibration.clone()];
    read_from.extend([&config.keypoints, &config.silhouettes, &config.images].into_iter().flatten().cloned());
    if let Some(Init::Points(path)) = &config.init {
        read_from.push(path.clone());
    }
    read_from.extend(config.setup.clone());
    read_from.extend(general.config.clone());
    read_from.extend(Some(PathBuf::from(&config.body)).filter(|body| body.is_file()));
    let (claim, from) = match args.resume {
        false => (claimed(&config, &read_from, report)?, None),
        true => match stopped_run(&config, &read_from, report)? {
            Stopped::Complete(claim, summary) => {
                let recording = Footage::open(&config, &calibration, &options)?;
                same_run(recording, &resolved, &claim, &summary, general)?;
                ResultFolder::forget(&claim)?;
                return complete(&summary, &config.out, args, report);
            }
            Stopped::At(claim, checkpoint) => (claim, Some(*checkpoint)),
        },
    };
    let mut recording = Footage::open(&config, &calibration, &options)?;
    let setup_frames = setup_frames(&config, &recording)?;
    let outcome = with_threads(&config, || {
        let mut progress = PassProgress::new(general);
        let stop = interrupt::flag();
        let mut tell = |pass, done, total| progress.at(pass, done, total);
        let mut watch = Watch { progress: &mut tell, stop: &stop };
        let inputs = |recording: &Footage| (recording.warnings(), recording.input_hashes());
        job::track(&mut recording, setup_frames, &resolved, claim, &mut watch, inputs, from)
    });
    let outcome = outcome.inspect_err(|error| {
        if let Error::Checkpoint { .. } = error {
            return;
        }
        // What is odd about the input may be why it could not be tracked.
        report.warnings(&recording.warnings());
        if config.out.join(problem::NAME).exists() {
            report.note(&format!("the frames before are kept in {}; {GO_ON}", config.out.display()));
        }
    })?;
    tell(&outcome, &config.out, args, report)
}

/// Frames of the set-up: those asked for, as far as they are there, or all.
fn setup_frames(config: &TrackConfig, recording: &Footage) -> Result<Range<u64>, Error> {
    Ok(match &config.setup_frames {
        None => recording.available(),
        Some(asked) => {
            let all = recording.available();
            let cut = asked.start.max(all.start)..asked.end.min(all.end);
            if cut.is_empty() {
                return Err(Error::Input {
                    message: format!(
                        "set-up frames {}..{} were asked for; the recording has {}..{}",
                        asked.start, asked.end, all.start, all.end
                    ),
                    help: Some("`--setup-frames A..B` takes the numbers in the file names, A included, B not".into()),
                });
            }
            cut
        }
    })
}

/// Settings from all their sources.
pub(crate) fn settings(flags: &[(&'static str, String)], general: &General) -> Result<Resolved, Error> {
    let flags = [flags, &general.settings()].concat();
    let environment =
        std::env::vars_os().filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)));
    let mut environment: Vec<(String, String)> = environment.filter(|(name, _)| name.starts_with("SINEW_")).collect();
    environment.sort();
    resolve(&Sources { flags, environment, file: general.config.clone() })
}

/// What to take from a recording.
pub(crate) fn reading(config: &TrackConfig) -> Options {
    Options {
        layout: config.layout.clone(),
        confidence_scale: config.confidence_scale,
        image_scale: config.image_scale,
        frames: config.frames.clone(),
        cameras: config.cameras.clone(),
        trim: config.trim,
        lag: config.lag.clone(),
    }
}

/// The calibration, if there is something to track with it; else what to try.
fn inputs(config: &TrackConfig) -> Result<PathBuf, Error> {
    let is_seen = config.keypoints.is_some() || config.silhouettes.is_some();
    match &config.calibration {
        Some(calibration) if is_seen => Ok(calibration.clone()),
        calibration => {
            let missing = match (calibration, is_seen) {
                (None, false) => "neither calibration nor keypoints were given",
                (None, true) => "no calibration was given",
                (Some(_), _) => "no keypoints were given",
            };
            Err(Error::Usage {
                message: missing.into(),
                help: "try one of\n  sinew track --calibration Calib.toml --keypoints pose --fps 60\n  sinew track --calibration Calib.toml --silhouettes masks --keypoints pose --method annealed --fps 60\n  sinew demo"
                    .into(),
            })
        }
    }
}

/// The output folder, for us alone.
pub(crate) fn claimed(config: &TrackConfig, inputs: &[PathBuf], report: &Report) -> Result<Claim, Error> {
    let claim = claim(&config.out, inputs, config.force)?;
    report.warnings(stale(&claim).as_slice());
    if claim.is_resumable {
        let out = config.out.display();
        report
            .warnings(&[format!("{out} holds a run that was stopped; it is begun anew (`--resume` goes on with it)")]);
    }
    Ok(claim)
}

/// What a run that ended early can be told to do.
const GO_ON: &str = "the same command with `--resume` goes on from there";

/// What `--resume` finds.
enum Stopped {
    /// A run that came to its end, with its summary.
    Complete(Claim, serde_json::Value),
    /// A run that was stopped.
    At(Claim, Box<Checkpoint>),
}

/// The run to go on with, in its folder, for us alone.
fn stopped_run(config: &TrackConfig, inputs: &[PathBuf], report: &Report) -> Result<Stopped, Error> {
    let claim = claim_to_resume(&config.out, inputs)?;
    if let Some(stale) = stale(&claim) {
        // Who is gone on with was stopped: no wonder.
        report.note(&stale);
    }
    let path = config.out.join("summary.json");
    let summary: Option<serde_json::Value> =
        std::fs::read_to_string(&path).ok().and_then(|text| serde_json::from_str(&text).ok());
    let is_unfinished = RESULT_NAMES.iter().any(|name| config.out.join(format!("{name}.partial")).exists());
    if let Some(summary) = summary.filter(|summary| summary["complete"] == true && !is_unfinished) {
        return Ok(Stopped::Complete(claim, summary));
    }
    if !claim.is_resumable && (claim.stale_lock_of.is_some() || is_unfinished) {
        return Err(Error::checkpoint(&config.out, Problem::BeforeFirst));
    }
    Ok(Stopped::At(claim, Box::new(checkpoint::read(&config.out)?)))
}

/// Refuses complete results of other settings or data.
fn same_run(
    mut recording: Footage,
    resolved: &Resolved,
    claim: &Claim,
    summary: &serde_json::Value,
    general: &General,
) -> Result<(), Error> {
    let mut progress = PassProgress::new(general);
    let stop = interrupt::flag();
    let mut tell = |pass, done, total| progress.at(pass, done, total);
    let mut watch = Watch { progress: &mut tell, stop: &stop };
    let frames = setup_frames(&resolved.track(), &recording)?;
    job::check_complete(&mut recording, frames, resolved, claim.folder(), summary, &mut watch, Footage::input_hashes)
}

/// Says that there is nothing to go on with.
fn complete(summary: &serde_json::Value, out: &Path, args: &TrackArgs, report: &Report) -> Result<Ended, Error> {
    if args.answer.json {
        report::answer_json(summary)?;
    } else {
        report::answer(&format!(
            "nothing to do: the results in {} are complete, of these settings and data\n",
            out.display()
        ))?;
    }
    let failed: Vec<&str> =
        summary["failed_diagnostics"].as_array().into_iter().flatten().filter_map(|text| text.as_str()).collect();
    failed.iter().for_each(|failed| report.failed(failed));
    Ok(if failed.is_empty() { Ended::Done } else { Ended::Doubtful })
}

/// That a run before left its lock, if one did.
fn stale(claim: &Claim) -> Option<String> {
    let pid = claim.stale_lock_of?;
    let folder = claim.folder().display();
    Some(format!("process {pid} left its lock in {folder}; it is gone, the lock is taken over"))
}

/// Runs in a pool of the threads asked for.
pub(crate) fn with_threads<T: Send>(
    config: &TrackConfig,
    run: impl FnOnce() -> Result<T, Error> + Send,
) -> Result<T, Error> {
    let granted = std::thread::available_parallelism().map_or(1, |n| n.get());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(config.threads.unwrap_or(granted)).build();
    let pool = pool.map_err(|error| Error::Numerical { message: format!("threads cannot be started: {error}") })?;
    pool.install(run)
}

/// One progress a pass.
pub(crate) struct PassProgress<'a> {
    general: &'a General,
    current: Option<(Pass, Progress)>,
}

impl<'a> PassProgress<'a> {
    pub(crate) fn new(general: &'a General) -> Self {
        Self { general, current: None }
    }

    pub(crate) fn at(&mut self, pass: Pass, done: u64, total: u64) {
        let same = self.current.as_ref().is_some_and(|(current, _)| *current == pass);
        if !same {
            let what = match pass {
                Pass::Check => "reading again",
                Pass::SetUp => "set-up",
                Pass::Track => "tracking",
                Pass::Smooth => "smoothing",
            };
            // The bar before is cleared first.
            self.current = None;
            self.current = Some((pass, Progress::start(self.general, what, total)));
        }
        if let Some((_, progress)) = &mut self.current {
            progress.at(done);
        }
    }
}

/// Says what came of it.
fn tell(outcome: &Outcome, out: &Path, args: &TrackArgs, report: &Report) -> Result<Ended, Error> {
    let summary = &outcome.summary;
    report.warnings(&summary.warnings);
    if args.answer.json {
        report::answer_json(&serde_json::to_value(summary).unwrap_or_default())?;
    } else {
        report::answer(&table(outcome, out))?;
    }
    Ok(ended(outcome, report))
}

/// The end of a run by its summary.
pub(crate) fn ended(outcome: &Outcome, report: &Report) -> Ended {
    if !outcome.summary.complete {
        report.note(&format!("interrupted; what was done is written and marked incomplete; {GO_ON}"));
        return Ended::Interrupted;
    }
    for failed in &outcome.summary.failed_diagnostics {
        report.failed(failed);
    }
    if outcome.summary.failed_diagnostics.is_empty() { Ended::Done } else { Ended::Doubtful }
}

fn table(outcome: &Outcome, out: &Path) -> String {
    let summary = &outcome.summary;
    let [first, end] = summary.frames;
    let mut rows: Vec<(String, String)> = vec![
        ("frames".into(), format!("{} ({first}..{end}), {} observed", summary.frame_count, summary.observed_frames)),
        ("method".into(), format!("{}, {}, seed {}, {}", summary.method, summary.kind, summary.seed, summary.isa)),
        ("speed".into(), format!("{:.1} ms per frame", outcome.ms_per_frame)),
    ];
    let diagnostics = &summary.diagnostics;
    if let Some(r_hat) = diagnostics.r_hat {
        rows.push((
            "R-hat".into(),
            format!("median {:.3}, 95 % {:.3}, {} frames above 1.05", r_hat.median, r_hat.p95, r_hat.frames_above_1_05),
        ));
    }
    if let Some(ess) = diagnostics.ess_median {
        rows.push(("effective size".into(), format!("median {ess:.0}")));
    }
    for camera in &summary.cameras {
        let [u, v] = camera.offset_px;
        let keypoints = camera
            .residual_px
            .map(|residual| format!("residual {residual:.1} px, offset {u:+.1} {v:+.1} px, {} frames", camera.frames));
        let masks = camera.silhouettes.filter(|masks| masks.frames > 0).map(|masks| {
            let [precision, recall] = [masks.precision, masks.recall].map(|share| 100.0 * share);
            format!("{precision:.0} % of the body in {recall:.0} % of the mask, {} masks", masks.frames)
        });
        let told: Vec<String> = keypoints.into_iter().chain(masks).collect();
        let told = if told.is_empty() {
            format!("no observation, offset {u:+.1} {v:+.1} px, 0 frames")
        } else {
            told.join("; ")
        };
        rows.push((camera.name.clone(), told));
    }
    rows.push(("results".into(), out.display().to_string()));
    aligned(&rows)
}

/// Two columns.
pub(crate) fn aligned(rows: &[(String, String)]) -> String {
    let width = rows.iter().map(|(left, _)| left.chars().count()).max().unwrap_or_default();
    rows.iter().map(|(left, right)| format!("{left:width$}  {right}\n")).collect()
}
