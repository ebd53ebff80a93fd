//! `sinew track` of everybody: who is there, then a run a person, each into a folder of its own.
//!
//! A person is tracked as though they were alone, with the same seed: results of one depend on others only where it is decided who is who.
//! People are tracked beside each other where there are threads for it.

use super::former_results::refuse_people;
use super::listener::{Counter, Listener};
use super::one_person::tracked;
use super::pieces::opened;
use super::refined_calibration;
use super::request::{OneCameTo, Run};
use super::resume::{Start, stopped_or_begun};
use super::threads::{beside_each_other, wanted};
use crate::Error;
use crate::config::TrackConfig;
use crate::input::roll::Roll;
use crate::input::source::FrameSource as _;
use crate::track::job::{RunPhase, Watch};
use sinew_results::people::{FILES, PeopleSummary, forget_people, is_of_several, person_folder};
use sinew_results::{Claim, ResultFolder, Summary, claim_in, claim_to_resume, is_incomplete, place};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Folder of the tracked person whom two cameras saw in most frames: their set-up knows most of the cameras.
fn most_seen(out: &Path, roll: &Roll) -> PathBuf {
    let is_tracked = |person: &usize| out.join(person_folder(*person)).join("setup.toml").is_file();
    let most = (0..roll.people.len())
        .filter(is_tracked)
        .max_by_key(|&person| (roll.people[person].seen, std::cmp::Reverse(person)));
    out.join(person_folder(most.unwrap_or_default()))
}

/// Tracks everybody.
pub(crate) fn track(run: Run<'_>, roll: &Roll, claim: Option<Claim>) -> Result<PeopleSummary, Error> {
    let Run { resolved, request, calibration, read_from, listener } = run;
    let config = resolved.track();
    let claim = claim.map_or_else(|| claim_to_resume(&config.out, read_from), Ok)?;
    // Whole results of a run before speak for the folder until there are new ones.
    let is_over_whole = !request.resume && config.out.join("summary.json").exists() && !is_incomplete(&config.out);
    if !request.resume {
        PeopleSummary::refuse_others(&claim)?;
        refuse_people(&config, read_from, ResultFolder::refuse_others)?;
    }
    let cameras = config.footage(calibration)?;
    let cameras = cameras.cameras().iter().map(|camera| camera.name.clone()).collect();
    let mut summary = PeopleSummary::begun(cameras, config.fps(), &roll.people);
    if !is_over_whole {
        summary.write(&claim)?;
    }
    listener.note(&format!("{} people, each tracked into a folder of {}", roll.people.len(), config.out.display()));
    let refused = everybody(run, roll, &config, &mut summary)?;
    let interrupted = !summary.complete;
    let is_anybody_whole = summary.people.iter().any(|person| person.complete);
    // Where results of people were replaced, the table that was there is no longer true.
    if !is_over_whole || (is_anybody_whole && (summary.complete || is_of_several(&config.out))) {
        summary.write(&claim)?;
    }
    if summary.complete && is_anybody_whole {
        claim.replace_results(&FILES)?;
        forget_people(&config.out, summary.people.len())?;
    }
    if let Some(path) = request.write_calibration.as_ref().filter(|_| !interrupted) {
        let config = resolved.into_folder(&most_seen(&config.out, roll)).track();
        refined_calibration::write(path, &config, calibration, listener)?;
    }
    match refused.filter(|_| summary.people.iter().all(|person| person.failed.is_some())) {
        Some(error) => Err(error),
        None => Ok(summary),
    }
}

/// Tracks people beside each other, as many as there are threads; the first error that only concerns one of them.
fn everybody(
    run: Run<'_>,
    roll: &Roll,
    config: &TrackConfig,
    summary: &mut PeopleSummary,
) -> Result<Option<Error>, Error> {
    let (people, threads) = (roll.people.len(), wanted(config));
    let workers = threads.min(people);
    let progress = PeopleCounter::start(run.listener, roll, config.smooth);
    let track = |person| one(run, (roll, person), threads / workers, &progress);
    let ends = |outcome: &Result<Tracked, Error>| match outcome {
        Ok(tracked) => !tracked.complete,
        Err(error) => !is_refusal(error),
    };
    let outcomes = beside_each_other(people, workers, track, ends);
    drop(progress);
    let mut refused = None;
    let mut interrupted = false;
    let mut said = WarningsOfAll::default();
    for (tracked, outcome) in summary.people.iter_mut().zip(outcomes) {
        match outcome {
            Some(Ok(Tracked { complete, failed_diagnostics, warnings, about_recording })) => {
                said.add(tracked.person, &warnings, &about_recording);
                tracked.trusted = complete && failed_diagnostics.is_empty();
                tracked.failed_diagnostics = failed_diagnostics;
                tracked.complete = complete;
                interrupted |= !complete;
            }
            Some(Err(error)) if is_refusal(&error) => {
                said.add(tracked.person, &[format!("not tracked: {error}")], &[]);
                tracked.failed = Some(error.to_string());
                refused = refused.or(Some(error));
            }
            Some(Err(Error::Interrupted(_))) | None => interrupted = true,
            Some(Err(error)) => return Err(error),
        }
    }
    run.listener.warnings(&said.words());
    summary.complete = !interrupted;
    Ok(refused)
}

/// Warnings of the runs of all people: each text once, with the numbers of the people that it concerns; none for a warning about the recording itself.
#[derive(Default)]
struct WarningsOfAll(Vec<(String, Vec<usize>)>);

impl WarningsOfAll {
    fn add(&mut self, person: usize, warnings: &[String], about_recording: &[String]) {
        for text in warnings {
            let known = self.0.iter().position(|(known, _)| known == text);
            let place = known.unwrap_or_else(|| {
                self.0.push((text.clone(), vec![]));
                self.0.len() - 1
            });
            if !about_recording.contains(text) {
                self.0[place].1.push(person);
            }
        }
    }

    fn words(&self) -> Vec<String> {
        let words = |(text, people): &(String, Vec<usize>)| {
            let people: Vec<String> = people.iter().map(usize::to_string).collect();
            match people.len() {
                0 => text.clone(),
                1 => format!("person {}: {text}", people[0]),
                _ => format!("people {}: {text}", people.join(", ")),
            }
        };
        self.0.iter().map(words).collect()
    }
}

/// Whether the error concerns this person alone, so that others may still be tracked.
const fn is_refusal(error: &Error) -> bool {
    error.file().is_none() && matches!(error, Error::Results(sinew_results::Error::Setup(_)) | Error::Tracking(_))
}

/// A counter of all, and the frames of each person that were tracked and smoothed.
type Shown<'a> = (Box<dyn Counter + 'a>, Vec<[u64; 2]>);

/// Progress over everybody's frames.
struct PeopleCounter<'a> {
    shown: Mutex<Shown<'a>>,
}

impl<'a> PeopleCounter<'a> {
    fn start(listener: &'a dyn Listener, roll: &Roll, smooth: bool) -> Self {
        let people = &roll.people;
        let frames: u64 = people.iter().map(|person| person.frames.end - person.frames.start).sum();
        let total = if smooth { 2 * frames } else { frames };
        let progress = listener.counter("tracking", "frames of all people", total);
        Self { shown: Mutex::new((progress, vec![[0; 2]; people.len()])) }
    }

    /// All frames of a person are done.
    fn done(&self, person: usize, frames: u64, smooth: bool) {
        self.at(person, RunPhase::Track, frames);
        if smooth {
            self.at(person, RunPhase::Smooth, frames);
        }
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

/// How the run of a person ended.
struct Tracked {
    complete: bool,
    failed_diagnostics: Vec<String>,
    warnings: Vec<String>,
    /// Those of the warnings that are about the recording itself.
    about_recording: Vec<String>,
}

/// One person, from the beginning or from where their run was stopped.
fn one(
    run: Run<'_>,
    (roll, person): (&Roll, usize),
    threads: usize,
    progress: &PeopleCounter<'_>,
) -> Result<Tracked, Error> {
    let out = place(&run.resolved.track().out, person_folder(person))?;
    let resolved = run.resolved.for_person(person + 1, &out);
    let config = resolved.track();
    let (mut recording, frames) = opened(&config, run.calibration, Some((roll, person)))?;
    let is_begun = run.request.resume && out.is_dir();
    let stopped = if is_begun { stopped_or_begun(&config, run.read_from, run.listener)? } else { None };
    let start = match stopped {
        Some(stopped) => stopped,
        None => Start::New(claim_in(run.request.storage(), &out, run.read_from, config.force)?),
    };
    let mut at = |pass, done, _| progress.at(person, pass, done);
    let mut watch = Watch { progress: &mut at, stop: &run.listener.stop() };
    match tracked(&mut recording, frames, &resolved, start, threads, &mut watch)? {
        OneCameTo::Tracked(outcome) => {
            let Summary { complete, failed_diagnostics, warnings, .. } = outcome.summary;
            Ok(Tracked { complete, failed_diagnostics, warnings, about_recording: recording.warnings() })
        }
        OneCameTo::Complete(summary) => {
            let seen = &roll.people[person].frames;
            progress.done(person, seen.end - seen.start, config.smooth);
            let failed_diagnostics = texts(&summary, "failed_diagnostics");
            Ok(Tracked { complete: true, failed_diagnostics, warnings: vec![], about_recording: vec![] })
        }
    }
}

fn texts(summary: &serde_json::Value, key: &str) -> Vec<String> {
    let all = summary[key].as_array().into_iter().flatten();
    all.filter_map(|text| text.as_str()).map(str::to_owned).collect()
}
