//! `sinew track` of everybody: who is there, then a run a person, each into a folder of its own.
//!
//! A person is tracked as though he were alone, with the same seed: results of one depend on others only where it is decided who is who.
//! People are tracked beside each other where there are threads for it.

use super::args::{General, TrackArgs};
use super::ended::Ended;
use super::error::Error;
use super::gait;
use super::interrupt;
use super::progress::Progress;
use super::report::{self, Report};
use super::report_page;
use super::resume::{Stopped, same_run, stopped_run};
use super::settings::reading;
use super::table::columns;
use super::threads::{beside_each_other, wanted, with_threads};
use super::track_pieces::{RESUME, setup_frames, show};
use super::write_calibration;
use sinew::config::{Resolved, TrackConfig};
use sinew::input::footage::Footage;
use sinew::input::one_person::OnePerson;
use sinew::input::roll::Roll;
use sinew::input::source::FrameSource as _;
use sinew::observe::association;
use sinew::results::people::{PeopleSummary, person_folder};
use sinew::results::{Claim, OWN_NAMES, RESULT_NAMES, ResultFolder, claim, claim_to_resume};
use sinew::track::checkpoint::Checkpoint;
use sinew::track::job::{self, RunPhase, Watch};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Everybody, if there are several, and the output folder, if it was `claimed` before they were looked for.
pub(crate) fn looked_for(
    config: &TrackConfig,
    calibration: &Path,
    general: &General,
    claimed: impl Fn() -> Result<Option<Claim>, Error>,
) -> Result<(Option<Claim>, Option<Roll>), Error> {
    if !config.everybody {
        return Ok((None, None));
    }
    let mut recording = Footage::open(&config.files(calibration), &reading(config))?;
    let frames = recording.frames();
    if recording.cameras().len() < 2 {
        return Ok((None, None));
    }
    // Mistakes in the settings are said before what is in the folder.
    setup_frames(config, &recording)?;
    let claim = claimed()?;
    let mut progress = Progress::start(general, "who is there", frames.end - frames.start);
    let stop = interrupt::flag("the frame");
    let fps = config.settings()?.fps;
    let roll = Roll::call(&mut recording, frames, fps, &association::Config::default(), |done| {
        progress.at(done);
        if stop.load(std::sync::atomic::Ordering::Relaxed) {
            return Err(sinew::Error::Interrupted("while people were looked for; nothing was written"));
        }
        Ok(())
    })?;
    drop(progress);
    Ok((claim, (roll.people.len() > 1).then_some(roll)))
}

/// Folder of the tracked person whom two cameras saw in most frames: his set-up knows most of the cameras.
fn most_seen(out: &Path, roll: &Roll) -> PathBuf {
    let is_tracked = |person: &usize| out.join(person_folder(*person)).join("setup.toml").is_file();
    let most = (0..roll.people.len())
        .filter(is_tracked)
        .max_by_key(|&person| (roll.people[person].seen, std::cmp::Reverse(person)));
    out.join(person_folder(most.unwrap_or_default()))
}

/// What stays the same from person to person.
struct Run<'a> {
    args: &'a TrackArgs,
    resolved: &'a Resolved,
    calibration: &'a Path,
    read_from: &'a [PathBuf],
    roll: &'a Roll,
    general: &'a General,
    report: &'a Report,
}

/// Tracks everybody.
pub(crate) fn run(
    (args, resolved, roll): (&TrackArgs, &Resolved, &Roll),
    claim: Option<Claim>,
    calibration: &Path,
    read_from: &[PathBuf],
    general: &General,
    report: &Report,
) -> Result<Ended, Error> {
    let config = resolved.track();
    let run = Run { args, resolved, calibration, read_from, roll, general, report };
    let _claim = claim.map_or_else(|| claim_to_resume(&config.out, read_from), Ok)?;
    if !args.resume {
        forget_people(&config, read_from)?;
        forget_one(&config.out)?;
    }
    let cameras = Footage::open(&config.files(calibration), &reading(&config))?;
    let cameras = cameras.cameras().iter().map(|camera| camera.name.clone()).collect();
    let mut summary = PeopleSummary::begun(cameras, &roll.people);
    summary.write(&config.out)?;
    report.note(&format!("{} people, each tracked into a folder of {}", roll.people.len(), config.out.display()));
    let refused = everybody(&run, &config, &mut summary)?;
    let interrupted = !summary.complete;
    summary.write(&config.out)?;
    if let Some(path) = args.write_calibration.as_ref().filter(|_| !interrupted) {
        write_calibration::write(
            path,
            &resolved.into_folder(&most_seen(&config.out, roll)).track(),
            calibration,
            report,
        )?;
    }
    let ended = answer(&summary, &config.out, args, report)?;
    match refused.filter(|_| summary.people.iter().all(|person| person.failed.is_some())) {
        Some(error) => Err(error.into()),
        None => Ok(ended),
    }
}

/// Tracks people beside each other, as many as there are threads; the first error that only concerns one of them.
fn everybody(run: &Run<'_>, config: &TrackConfig, summary: &mut PeopleSummary) -> Result<Option<sinew::Error>, Error> {
    let (people, threads) = (run.roll.people.len(), wanted(config));
    let workers = threads.min(people);
    let progress = PeopleProgress::start(run, config.smooth);
    let track = |person| one(run, person, threads / workers, &progress);
    let ends = |outcome: &Result<Tracked, Error>| match outcome {
        Ok(tracked) => !tracked.complete,
        Err(Error::Library(error)) => !is_refusal(error),
        Err(_) => true,
    };
    let outcomes = beside_each_other(people, workers, track, ends);
    drop(progress);
    let mut refused = None;
    let mut interrupted = false;
    for (tracked, outcome) in summary.people.iter_mut().zip(outcomes) {
        match outcome {
            Some(Ok(Tracked { complete, failed_diagnostics, warnings })) => {
                let said = |warning: &String| format!("person {}: {warning}", tracked.person);
                run.report.warnings(&warnings.iter().map(said).collect::<Vec<_>>());
                tracked.failed_diagnostics = failed_diagnostics;
                tracked.complete = complete;
                interrupted |= !complete;
            }
            Some(Err(Error::Library(error))) if is_refusal(&error) => {
                run.report.warnings(&[format!("person {} is not tracked: {error}", tracked.person)]);
                tracked.failed = Some(error.to_string());
                refused = refused.or(Some(error));
            }
            Some(Err(Error::Library(sinew::Error::Interrupted(_)))) | None => interrupted = true,
            Some(Err(error)) => return Err(error),
        }
    }
    summary.complete = !interrupted;
    Ok(refused)
}

/// Whether a person cannot be tracked, and others may be.
const fn is_refusal(error: &sinew::Error) -> bool {
    matches!(error, sinew::Error::Recording(_) | sinew::Error::Tracking(_))
}

/// Progress over everybody's frames.
struct PeopleProgress {
    shown: Mutex<(Progress, Vec<[u64; 2]>)>,
}

impl PeopleProgress {
    fn start(run: &Run<'_>, smooth: bool) -> Self {
        let people = &run.roll.people;
        let frames: u64 = people.iter().map(|person| person.frames.end - person.frames.start).sum();
        let total = if smooth { 2 * frames } else { frames };
        let progress = Progress::counting(run.general, "tracking", "frames of all", total);
        Self { shown: Mutex::new((progress, vec![[0; 2]; people.len()])) }
    }

    fn at(&self, person: usize, pass: RunPhase, done: u64) {
        let place = match pass {
            RunPhase::Track => 0,
            RunPhase::Smooth => 1,
            RunPhase::Check | RunPhase::SetUp => return,
        };
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        shown.1[person][place] = done;
        let all = shown.1.iter().flatten().sum();
        shown.0.at(all);
    }
}

/// Removes the results of people of a run before; refuses results and stopped runs that are not to be replaced.
pub(crate) fn forget_people(config: &TrackConfig, read_from: &[PathBuf]) -> Result<(), Error> {
    let folder = config.out.join("people");
    if !folder.is_dir() {
        return Ok(());
    }
    let failed = |error| sinew::Error::io("read", &folder)(error);
    for entry in std::fs::read_dir(&folder).map_err(failed)? {
        drop(claim(&entry.map_err(failed)?.path(), read_from, config.force)?);
    }
    std::fs::remove_dir_all(&folder).map_err(sinew::Error::io("remove", &folder))?;
    removed(&config.out.join("people.csv"))
}

/// Removes the results of a run of one person, in whose place results of several come.
fn forget_one(out: &Path) -> Result<(), Error> {
    RESULT_NAMES.iter().chain(&OWN_NAMES).try_for_each(|name| removed(&out.join(name)))?;
    report_page::forget(out)?;
    Ok(gait::forget(out)?)
}

/// Removes a file or a folder, if it is there.
fn removed(path: &Path) -> Result<(), Error> {
    let done = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    match done {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(sinew::Error::io("remove", path)(error).into())
        }
        _ => Ok(()),
    }
}

/// How the run of a person ended.
struct Tracked {
    complete: bool,
    failed_diagnostics: Vec<String>,
    warnings: Vec<String>,
}

/// One person, from the beginning or from where his run was stopped.
fn one(run: &Run<'_>, person: usize, threads: usize, progress: &PeopleProgress) -> Result<Tracked, Error> {
    let out = run.resolved.track().out.join(person_folder(person));
    let resolved = run.resolved.into_folder(&out);
    let config = resolved.track();
    let mut recording = Footage::open(&config.files(run.calibration), &reading(&config))?;
    let frames = within(&setup_frames(&config, &recording)?, &run.roll.people[person].frames);
    let mut source = OnePerson { source: &mut recording, roll: run.roll, person };
    let (claim, from): (_, Option<Checkpoint>) = if run.args.resume && out.is_dir() {
        match stopped_run(&config, run.read_from, run.report)? {
            Stopped::Complete(claim, summary) => {
                let hashes = |source: &OnePerson<'_, Footage>| source.source.input_hashes();
                let silent = General { no_progress: true, ..run.general.clone() };
                same_run(&mut source, frames, &resolved, &claim, &summary, &silent, hashes)?;
                ResultFolder::forget(&claim)?;
                show(run.args, run.calibration, &out, run.report)?;
                progress.at(
                    person,
                    RunPhase::Track,
                    run.roll.people[person].frames.end - run.roll.people[person].frames.start,
                );
                return Ok(Tracked { complete: true, failed_diagnostics: failed_in(&summary), warnings: vec![] });
            }
            Stopped::At(claim, checkpoint) => (claim, Some(*checkpoint)),
        }
    } else {
        (claim(&out, run.read_from, config.force)?, None)
    };
    let outcome = with_threads(threads, || {
        let stop = interrupt::flag("the frame");
        let mut at = |pass, done, _| progress.at(person, pass, done);
        let mut watch = Watch { progress: &mut at, stop: &stop };
        let inputs = |source: &OnePerson<'_, Footage>| (source.source.warnings(), source.source.input_hashes());
        job::track(&mut source, frames, &resolved, claim, &mut watch, inputs, from)
    })?;
    if outcome.summary.frame_count > 0 {
        show(run.args, run.calibration, &out, run.report)?;
    }
    let summary = outcome.summary;
    Ok(Tracked {
        complete: summary.complete,
        failed_diagnostics: summary.failed_diagnostics,
        warnings: summary.warnings,
    })
}

/// Frames for the set-up that show the person, or all of his where there are none.
fn within(asked: &Range<u64>, frames: &Range<u64>) -> Range<u64> {
    let both = asked.start.max(frames.start)..asked.end.min(frames.end);
    if both.is_empty() { frames.clone() } else { both }
}

fn failed_in(summary: &serde_json::Value) -> Vec<String> {
    let all = summary["failed_diagnostics"].as_array().into_iter().flatten();
    all.filter_map(|text| text.as_str()).map(str::to_owned).collect()
}

/// Says what became of everybody.
fn answer(summary: &PeopleSummary, out: &Path, args: &TrackArgs, report: &Report) -> Result<Ended, Error> {
    if args.answer.json {
        report::answer_json(&serde_json::to_value(summary).unwrap_or_default())?;
    } else {
        let heads = ["person", "frames", "seen by two", "tracked", "results"].map(str::to_owned);
        let row = |person: &sinew::results::people::PersonTracked| {
            let tracked = match (&person.failed, person.complete) {
                (Some(_), _) => "no",
                (None, true) => "yes",
                (None, false) => "in part",
            };
            let [first, end] = person.frames;
            let folder = out.join(&person.folder).display().to_string();
            vec![
                person.person.to_string(),
                format!("{first}..{end}"),
                person.seen_frames.to_string(),
                tracked.to_owned(),
                folder,
            ]
        };
        report::answer(&columns(&heads, &summary.people.iter().map(row).collect::<Vec<_>>()))?;
    }
    if !summary.complete {
        report.note(&format!("interrupted; what was done is written and marked incomplete; {RESUME}"));
        return Ok(Ended::Interrupted);
    }
    let mut doubtful = false;
    for person in &summary.people {
        doubtful |= person.failed.is_some() || !person.failed_diagnostics.is_empty();
        person
            .failed_diagnostics
            .iter()
            .for_each(|failed| report.failed(&format!("person {}: {failed}", person.person)));
    }
    Ok(if doubtful { Ended::Doubtful } else { Ended::Done })
}
