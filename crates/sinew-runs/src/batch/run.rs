//! Runs the tasks of a shard that are not done: several trials beside each other, each on its own.
//!
//! A trial that fails, even by a bug, fails alone. An interrupt ends all at the frame at hand; what was not packed is continued by the next run.

use super::RESULTS;
use super::angle_draws::write_angle_draws;
use super::ledger::{EndedTask, Ledger, Packed, TaskEnd, ended};
use super::packed::Archive;
use super::plan::{StudyPlan, Task, read};
use super::pooled_setup::PooledSetups;
use super::shard::Shard;
use crate::listener::{Deaf, Listener};
use crate::resume::is_stopped;
use crate::threads::beside_each_other;
use crate::{CameTo, Error, Request, track};
use serde_json::Value;
use sinew::results::problem::Problem;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Mutex, PoisonError};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Tasks of a shard, counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShardEnd {
    /// Done before.
    pub before: usize,
    /// Done now.
    pub done: usize,
    /// Done now, and a diagnostic failed.
    pub doubtful: usize,
    /// Trials that failed, with why.
    pub failed: Vec<(String, String)>,
    /// Not begun or not ended, because of an interrupt.
    pub left: usize,
}

/// A study being run.
struct Study<'a> {
    folder: &'a Path,
    plan: StudyPlan,
    tasks: Vec<Task>,
    archive: Option<Archive>,
    setups: PooledSetups,
    listener: &'a dyn Listener,
    threads_a_trial: usize,
}

/// Runs what is missing of a shard, on `threads` threads.
///
/// # Errors
/// A study or a ledger that cannot be read or written; not the errors of trials.
pub fn run(folder: &Path, shard: Shard, threads: usize, listener: &dyn Listener) -> Result<ShardEnd, Error> {
    let (plan, tasks) = read(folder)?;
    let ledger = Ledger::open(folder, shard)?;
    let known = ended(folder)?;
    let archive = plan.packed.then(|| Archive::open(folder, shard, known.values())).transpose()?;
    let own = || (0..tasks.len()).filter(|&place| shard.holds(place));
    let is_done = |&place: &usize| {
        let task: &Task = &tasks[place];
        known.get(&task.trial).is_some_and(|line| line.hash == task.hash && line.is_there() && is_kept(folder, line))
    };
    let before = own().filter(is_done).count();
    let missing: Vec<usize> = own().filter(|place| !is_done(place)).collect();
    let workers = threads.min(missing.len()).max(1);
    let setups = PooledSetups::new(folder, shard);
    let study = Study { folder, plan, tasks, archive, setups, listener, threads_a_trial: (threads / workers).max(1) };
    let (ledger, counter) =
        (Mutex::new(ledger), Mutex::new((listener.counter("trials", "trials", missing.len() as u64), 0)));
    let one = |index: usize| -> Result<Option<EndedTask>, Error> {
        let Some(line) = study.one(&study.tasks[missing[index]]) else { return Ok(None) };
        ledger.lock().unwrap_or_else(PoisonError::into_inner).add(&line)?;
        let (counter, done) = &mut *counter.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        counter.at(*done);
        Ok(Some(line))
    };
    let outcomes = beside_each_other(missing.len(), workers, one, |outcome| !matches!(outcome, Ok(Some(_))));
    let mut end = ShardEnd { before, ..ShardEnd::default() };
    for outcome in outcomes {
        match outcome.transpose()?.flatten() {
            None => end.left += 1,
            Some(EndedTask { ended: TaskEnd::Done, .. }) => end.done += 1,
            Some(EndedTask { ended: TaskEnd::Doubtful, .. }) => end.doubtful += 1,
            Some(EndedTask { trial, why, .. }) => end.failed.push((trial, why)),
        }
    }
    Ok(end)
}

/// Whether the results of which a line speaks are still there.
fn is_kept(study: &Path, line: &EndedTask) -> bool {
    match &line.packed {
        Some(Packed { archive, offset, length }) => {
            fs::metadata(study.join(archive)).is_ok_and(|file| offset + length <= file.len())
        }
        None => study.join(RESULTS).join(&line.trial).join("summary.json").is_file(),
    }
}

/// What a trial came to.
struct Ending {
    ended: TaskEnd,
    code: u8,
    why: String,
    computing_s: f64,
    packed: Option<Packed>,
}

impl Study<'_> {
    /// Runs a task; `None` where it was interrupted.
    fn one(&self, task: &Task) -> Option<EndedTask> {
        if self.listener.stop().load(Ordering::Relaxed) {
            return None;
        }
        let started = Instant::now();
        let ending = match catch_unwind(AssertUnwindSafe(|| self.tracked(task))) {
            Ok(Ok(ending)) => ending?,
            Ok(Err(Error::Library(sinew::Error::Interrupted(_)))) => return None,
            Ok(Err(error)) => failed(error.exit_code(), with_causes(&error)),
            Err(_) => failed(1, "a bug: the program stopped in the middle of this trial".into()),
        };
        let Ending { ended, code, why, computing_s, packed } = ending;
        if ended == TaskEnd::Failed {
            self.listener.warning(&format!("{}: {why}", task.trial));
        }
        Some(EndedTask {
            trial: task.trial.clone(),
            hash: task.hash.clone(),
            ended,
            code,
            why,
            seconds: started.elapsed().as_secs_f64(),
            computing_s,
            at_unix_s: SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64(),
            packed,
        })
    }

    /// Tracks a trial into its folder, or into the archive.
    fn tracked(&self, task: &Task) -> Result<Option<Ending>, Error> {
        if let Some(problem) = &task.problem {
            return Ok(Some(failed(3, problem.clone())));
        }
        let Some(archive) = &self.archive else {
            return self.tracked_into(task, &self.folder.join(RESULTS).join(&task.trial));
        };
        let scratch = ScratchFolder::new(&task.hash)?;
        let ending = self.tracked_into(task, &scratch.0)?;
        let Some(mut ending) = ending else { return Ok(None) };
        ending.packed = Some(archive.append(&task.trial, &scratch.0)?);
        Ok(Some(ending))
    }

    fn tracked_into(&self, task: &Task, out: &Path) -> Result<Option<Ending>, Error> {
        // What is odd stands in the results of the trial.
        let quiet = Deaf::stopped_by(self.listener.stop());
        let mut given = vec![
            ("out", out.to_string_lossy().into_owned()),
            ("threads", self.threads_a_trial.to_string()),
            ("force", "true".to_owned()),
        ];
        if let Some(pool) = &task.pool {
            let setup = self.setups.of(&self.plan.root, pool, &self.tasks, &quiet)?;
            given.push(("setup", setup.to_string_lossy().into_owned()));
        }
        let resolved = task.as_trial().settings(&self.plan.root, &given)?;
        let request = |resume| Request { resume, scratch: self.archive.is_some(), ..Request::default() };
        let mut came_to = track(&resolved, &request(is_stopped(out)), &quiet);
        // Where what was stopped was something else, the trial is begun again.
        if let Err(Error::Library(sinew::Error::Checkpoint { problem, .. })) = &came_to
            && !matches!(**problem, Problem::Whom { .. })
        {
            came_to = track(&resolved, &request(false), &quiet);
        }
        Ok(match came_to? {
            CameTo::One(outcome) if !outcome.summary.complete => None,
            CameTo::Several(summary) if !summary.complete => None,
            CameTo::One(outcome) => {
                write_angle_draws(out, self.archive.is_some())?;
                Some(ending(&outcome.summary.failed_diagnostics, computing_s(out)))
            }
            CameTo::Complete(summary) => {
                write_angle_draws(out, self.archive.is_some())?;
                let failed = summary["failed_diagnostics"].as_array().into_iter().flatten();
                let failed: Vec<String> = failed.filter_map(Value::as_str).map(str::to_owned).collect();
                Some(ending(&failed, computing_s(out)))
            }
            CameTo::Several(summary) => {
                let doubts = summary.people.iter().flat_map(|person| {
                    let why = person.failed.iter().chain(&person.failed_diagnostics);
                    why.map(|why| format!("person {}: {why}", person.person))
                });
                let folders = || summary.people.iter().map(|person| out.join(&person.folder));
                folders()
                    .filter(|folder| folder.join("summary.json").is_file())
                    .try_for_each(|f| write_angle_draws(&f, self.archive.is_some()))?;
                Some(ending(&doubts.collect::<Vec<_>>(), folders().map(|folder| computing_s(&folder)).sum()))
            }
        })
    }
}

fn failed(code: u8, why: String) -> Ending {
    Ending { ended: TaskEnd::Failed, code, why, computing_s: 0.0, packed: None }
}

fn ending(doubts: &[String], computing_s: f64) -> Ending {
    let (ended, code) = if doubts.is_empty() { (TaskEnd::Done, 0) } else { (TaskEnd::Doubtful, 4) };
    Ending { ended, code, why: doubts.join("; "), computing_s, packed: None }
}

/// Seconds of set-up and tracking, as a run wrote them down.
fn computing_s(out: &Path) -> f64 {
    let text = fs::read_to_string(out.join("timings.json")).unwrap_or_default();
    let timings: Value = serde_json::from_str(&text).unwrap_or_default();
    ["set_up_s", "track_s"].iter().filter_map(|key| timings[key].as_f64()).sum()
}

/// An error with what caused it, in one line.
fn with_causes(error: &Error) -> String {
    let causes = std::iter::successors(std::error::Error::source(error), |cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}

/// A folder on the local disk for results that go into an archive.
struct ScratchFolder(PathBuf);

impl ScratchFolder {
    fn new(name: &str) -> Result<Self, Error> {
        let folder = std::env::temp_dir().join(format!("sinew-batch-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).map_err(sinew::Error::io("create", &folder))?;
        Ok(Self(folder))
    }
}

impl Drop for ScratchFolder {
    fn drop(&mut self) {
        // What stays is in the system's folder for such things.
        let _ = fs::remove_dir_all(&self.0);
    }
}
