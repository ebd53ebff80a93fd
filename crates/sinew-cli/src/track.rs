//! `sinew track`: settings, checks, the run, and its answer.

use super::args::{General, TrackArgs};
use super::claimed::claimed;
use super::ended::Ended;
use super::error::Error;
use super::gait;
use super::interrupt;
use super::progress::PassProgress;
use super::report::{self, Report};
use super::report_page;
use super::resume::{Stopped, complete, refuse_other_number, same_run, stopped_run};
use super::settings::reading;
use super::stated_rate::with_stated_rate;
use super::table::table;
use super::threads::{wanted, with_threads};
use super::track_pieces::{FromFootage, RESUME, calibration, setup_frames, show, within};
use super::whom::{Whom, looked_for};
use super::{sync, track_people, write_calibration};
use sinew::config::{Resolved, TrackConfig};
use sinew::input::footage::Footage;
use sinew::input::footage::Init;
use sinew::input::one_person::OnePerson;
use sinew::input::roll::Roll;
use sinew::results::{Claim, ResultFolder, problem, refuse_inputs};
use sinew::track::checkpoint::Checkpoint;
use sinew::track::job;
use sinew::track::job::{Outcome, Watch};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Runs the command.
pub(crate) fn run(args: &TrackArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let (flags, mut resolved) = with_stated_rate(&args.settings.given, general, report)?;
    report.warnings(&resolved.warnings);
    report.warnings(&resolved.idle_flags());
    if args.sync {
        resolved = sync::synchronised(&flags, resolved, general, report)?;
    }
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
    let calibration = calibration(&config)?;
    let read_from = read_from(&config, &calibration, general);
    // Mistakes in the settings are said before what is in the folder.
    refuse_inputs(&config.out, &read_from)?;
    if let Some(path) = &args.write_calibration {
        write_calibration::check(path, &config, &read_from)?;
    }
    if args.report {
        report_page::refuse_others(&config.out.join(report_page::PAGE), general.force)?;
    }
    job::check_settings(&resolved)?;
    let claimed = || if args.resume { Ok(None) } else { claimed(&config, &read_from, report).map(Some) };
    let (claim, whom) = looked_for(&resolved, &calibration, general, report, claimed)?;
    if args.resume {
        refuse_other_number(&config.out, matches!(whom, Whom::Everybody(_)))?;
    }
    let chosen = match whom {
        Whom::Everybody(roll) => {
            return track_people::run((args, &resolved, &roll), claim, &calibration, &read_from, general, report);
        }
        Whom::One(roll, person) => Some((roll, person)),
        Whom::MostComplete => None,
    };
    let mut recording = Footage::open(&config.files(&calibration), &reading(&config))?;
    let frames = setup_frames(&config, &recording)?;
    let run =
        SingleRun { args, resolved: &resolved, calibration: &calibration, read_from: &read_from, general, report };
    match &chosen {
        None => run.track(&mut recording, frames, claim),
        Some((roll, person)) => {
            let frames = within(&frames, &roll.people[*person].frames);
            run.track(&mut OnePerson { source: &mut recording, roll, person: *person }, frames, claim)
        }
    }
}

/// A run of one person.
struct SingleRun<'a> {
    args: &'a TrackArgs,
    resolved: &'a Resolved,
    calibration: &'a Path,
    read_from: &'a [PathBuf],
    general: &'a General,
    report: &'a Report,
}

impl SingleRun<'_> {
    fn track<S: FromFootage>(
        &self,
        source: &mut S,
        setup_frames: Range<u64>,
        claim: Option<Claim>,
    ) -> Result<Ended, Error> {
        let Self { args, resolved, read_from, general, report, .. } = *self;
        let config = resolved.track();
        if !args.resume {
            track_people::forget_people(&config, read_from)?;
        }
        let (claim, from) = match (claim, args.resume) {
            (Some(claim), _) => (claim, None),
            (None, false) => (claimed(&config, read_from, report)?, None),
            (None, true) => match stopped_run(&config, read_from, report)? {
                Stopped::Complete(claim, summary) => {
                    let hashes = |source: &S| source.footage().input_hashes();
                    same_run(source, setup_frames, resolved, &claim, &summary, general, hashes)?;
                    ResultFolder::forget(&claim)?;
                    self.refine(&config)?;
                    show(args, self.calibration, &config.out, report)?;
                    return complete(&summary, &config.out, args, report);
                }
                Stopped::At(claim, checkpoint) => (claim, Some(*checkpoint)),
            },
        };
        let outcome = tracked(source, setup_frames, resolved, claim, from, general);
        let outcome = outcome.inspect_err(|error| {
            if let Error::Library(sinew::Error::Checkpoint { .. }) = error {
                return;
            }
            // What is odd about the input may be why it could not be tracked.
            report.warnings(&source.footage().warnings());
            if config.out.join(problem::NAME).exists() {
                report.note(&format!("the frames before are kept in {}; {RESUME}", config.out.display()));
            }
        })?;
        self.refine(&config)?;
        report_page::forget(&config.out)?;
        gait::forget(&config.out)?;
        if outcome.summary.frame_count > 0 {
            show(args, self.calibration, &config.out, report)?;
        }
        answer(&outcome, &config.out, args, report)
    }

    /// Writes the calibration that the run found, if it is wanted.
    fn refine(&self, config: &TrackConfig) -> Result<(), Error> {
        let path = self.args.write_calibration.as_ref();
        path.map_or(Ok(()), |path| write_calibration::write(path, config, self.calibration, self.report))
    }
}

/// Files and folders that a run reads.
pub(crate) fn read_from(config: &TrackConfig, calibration: &Path, general: &General) -> Vec<PathBuf> {
    let mut read_from = vec![calibration.to_owned()];
    read_from.extend([&config.keypoints, &config.silhouettes, &config.images].into_iter().flatten().cloned());
    if let Some(Init::Points(path)) = &config.init {
        read_from.push(path.clone());
    }
    read_from.extend([&config.setup, &config.standing].into_iter().flatten().cloned());
    read_from.extend(general.config.clone());
    read_from.extend(Some(PathBuf::from(&config.body)).filter(|body| body.is_file()));
    read_from
}

/// One run into its own folder, without an answer; of one of several people, if he is named.
pub(crate) fn track_into_folder(
    resolved: &Resolved,
    chosen: Option<(&Roll, usize)>,
    read_from: &[PathBuf],
    general: &General,
    report: &Report,
) -> Result<Outcome, Error> {
    let config = resolved.track();
    refuse_inputs(&config.out, read_from)?;
    job::check_settings(resolved)?;
    let mut recording = Footage::open(&config.files(&calibration(&config)?), &reading(&config))?;
    let frames = setup_frames(&config, &recording)?;
    let claim = claimed(&config, read_from, report)?;
    let Some((roll, person)) = chosen else {
        return tracked(&mut recording, frames, resolved, claim, None, general);
    };
    let frames = within(&frames, &roll.people[person].frames);
    let mut source = OnePerson { source: &mut recording, roll, person };
    tracked(&mut source, frames, resolved, claim, None, general)
}

/// The run itself, with its progress.
fn tracked<S: FromFootage>(
    source: &mut S,
    setup_frames: Range<u64>,
    resolved: &Resolved,
    claim: Claim,
    from: Option<Checkpoint>,
    general: &General,
) -> Result<Outcome, Error> {
    with_threads(wanted(&resolved.track()), || {
        let mut progress = PassProgress::new(general);
        let stop = interrupt::flag("the frame");
        let mut at = |pass, done, total| progress.at(pass, done, total);
        let mut watch = Watch { progress: &mut at, stop: &stop };
        let inputs = |source: &S| (source.footage().warnings(), source.footage().input_hashes());
        job::track(source, setup_frames, resolved, claim, &mut watch, inputs, from)
    })
}

/// Says what the run came to.
fn answer(outcome: &Outcome, out: &Path, args: &TrackArgs, report: &Report) -> Result<Ended, Error> {
    let summary = &outcome.summary;
    report.warnings(&summary.warnings);
    if args.answer.json {
        report::answer_json(&serde_json::to_value(summary).unwrap_or_default())?;
    } else {
        report::answer(&table(outcome, out))?;
    }
    if !summary.complete {
        report.note(&format!("interrupted; what was done is written and marked incomplete; {RESUME}"));
        return Ok(Ended::Interrupted);
    }
    summary.failed_diagnostics.iter().for_each(|failed| report.failed(failed));
    Ok(if summary.failed_diagnostics.is_empty() { Ended::Done } else { Ended::Doubtful })
}
