//! Runs the tasks of a shard that are not done: several trials beside each other, each on its own.
//!
//! A trial that fails, even by a bug, fails alone. An interrupt ends all at the frame at hand; what was not packed is continued by the next run.

use super::angle_draws::write_angle_draws;
use super::keeping::{Ended, Keeping};
use super::ledger::{EndedTask, Ledger, RESULTS, TaskEnd, ended, results_name};
use super::packed::Archive;
use super::plan::{Share, StudyPlan, Task, read};
use super::pooled_setup::{PooledSetups, Shared};
use super::scratch::Scratch;
use super::shard::Shard;
use crate::{Error, ExitCode};
use rayon::ThreadPool;
use serde_json::Value;
use sinew::config::common::{FORCE, OUT, SETUP, THREADS};
use sinew::formats::source_text::MAX_TEXT_BYTES;
use sinew::run::listener::{Deaf, Listener};
use sinew::run::resume::is_stopped;
use sinew::run::threads::{beside_each_other, pool};
use sinew::run::{CameTo, Request, track};
use sinew_results::problem::Problem;
use sinew_results::{Storage, UnsyncedDisk, place, read_stored};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::sync::mpsc::sync_channel;
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
    setups: PooledSetups,
    listener: &'a dyn Listener,
    exit_code: ExitCode,
    threads_a_trial: usize,
    run: u64,
}

/// Runs what is missing of a shard, on `threads` threads; `exit_code` is what the ledger keeps of an error.
///
/// # Errors
/// A study or a ledger that cannot be read or written; not the errors of trials.
pub fn run(
    folder: &Path,
    shard: Shard,
    threads: usize,
    listener: &dyn Listener,
    exit_code: ExitCode,
) -> Result<ShardEnd, Error> {
    let (plan, tasks) = read(folder)?;
    let ledger = Ledger::open(folder, shard)?;
    let known = ended(folder)?;
    let kept = || known.values().filter(|line| line.is_there() && line.is_kept(folder));
    let archive = plan.packed.then(|| Archive::open(folder, shard, kept())).transpose()?;
    let own = || (0..tasks.len()).filter(|&place| shard.holds(place));
    let is_done = |&place: &usize| {
        let task: &Task = &tasks[place];
        known.get(&task.trial).is_some_and(|line| line.hash == task.hash && line.is_there() && line.is_kept(folder))
    };
    let (done, missing): (Vec<usize>, Vec<usize>) = own().partition(is_done);
    let before = done.len();
    let workers = threads.min(missing.len()).max(1);
    let setups = PooledSetups::new(folder, shard, workers);
    let run = 1 + known.values().map(|line| line.run).max().unwrap_or(0);
    let study =
        Study { folder, plan, tasks, setups, listener, exit_code, threads_a_trial: (threads / workers).max(1), run };
    drop(known);
    let (sender, receiver) = sync_channel(workers);
    let (study, missing) = (&study, &missing);
    // Threads stay the same from trial to trial: what each has freed is used again.
    let pools: Vec<ThreadPool> = (0..workers).map(|_| pool(study.threads_a_trial)).collect::<Result<_, _>>()?;
    let pools = Mutex::new(pools);
    let idle = || pools.lock().unwrap_or_else(PoisonError::into_inner);
    let idle = &idle;
    // Gone with its sender when all are begun and ended: then nothing is left to keep.
    let one = move |place: usize| {
        let Some(pool) = idle().pop() else { return false };
        let ended = pool.install(|| study.one(&study.tasks[missing[place]], place));
        idle().push(pool);
        ended.is_some_and(|ended| sender.send(ended).is_ok())
    };
    let mut end = ShardEnd { before, left: missing.len(), ..ShardEnd::default() };
    let mut failed: Vec<(usize, String, String)> = vec![];
    std::thread::scope(|scope| {
        let keeping = scope.spawn(|| {
            let mut counter = listener.counter("trials", "trials", missing.len() as u64);
            let mut keeping = Keeping { study: folder, archive, ledger, exit_code };
            keeping.keep(receiver, |Ended { place, line, .. }| {
                match line.ended {
                    TaskEnd::Done => end.done += 1,
                    TaskEnd::Doubtful => end.doubtful += 1,
                    TaskEnd::Failed => failed.push((*place, line.trial.clone(), line.why.clone())),
                }
                end.left -= 1;
                counter.at((missing.len() - end.left) as u64);
            })
        });
        beside_each_other(missing.len(), workers, one, |sent| !sent);
        keeping.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })?;
    // In the order of the plan, whichever ended first.
    failed.sort();
    end.failed = failed.into_iter().map(|(_, trial, why)| (trial, why)).collect();
    Ok(end)
}

/// What a trial came to.
struct Ending {
    ended: TaskEnd,
    code: u8,
    why: String,
    computing_s: f64,
}

impl Study<'_> {
    /// Runs a task, at a place among the missing ones; `None` where it was interrupted.
    fn one(&self, task: &Task, place: usize) -> Option<Ended> {
        if self.listener.stop().load(Ordering::Relaxed) {
            return None;
        }
        let started = Instant::now();
        let (ending, scratch) = match catch_unwind(AssertUnwindSafe(|| self.tracked(task))) {
            Ok(Ok(tracked)) => tracked?,
            Ok(Err(Error::Run(sinew::Error::Interrupted(_)))) => return None,
            Ok(Err(error)) => (failed((self.exit_code)(&error), sinew::with_causes(&error)), None),
            Err(_) => (failed(1, "a bug: the program stopped in the middle of this trial".into()), None),
        };
        let Ending { ended, code, why, computing_s } = ending;
        if ended == TaskEnd::Failed {
            self.listener.warning(&format!("{}: {why}", task.trial));
        }
        let line = EndedTask {
            trial: task.trial.clone(),
            hash: task.hash.clone(),
            ended,
            code,
            why,
            seconds: started.elapsed().as_secs_f64(),
            computing_s,
            run: self.run,
            at_unix_s: SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64(),
            packed: None,
        };
        Some(Ended { place, line, scratch })
    }

    /// Tracks a trial into its folder, or into a place whose content is to be packed.
    fn tracked(&self, task: &Task) -> Result<Option<(Ending, Option<Scratch>)>, Error> {
        if let Some(problem) = &task.problem {
            return Ok(Some((failed(3, problem.clone()), None)));
        }
        if !self.plan.packed {
            let folder = place(&self.folder.join(RESULTS), results_name(&task.trial))?;
            let ending = self.tracked_into(task, &folder, Arc::new(UnsyncedDisk))?;
            return Ok(ending.map(|ending| (ending, None)));
        }
        let scratch = Scratch::new()?;
        let storage = Arc::clone(scratch.storage());
        let ending = self.tracked_into(task, scratch.folder(), storage)?;
        Ok(ending.map(|ending| (ending, Some(scratch))))
    }

    fn tracked_into(&self, task: &Task, out: &Path, storage: Arc<dyn Storage>) -> Result<Option<Ending>, Error> {
        // What is odd stands in the results of the trial.
        let quiet = Deaf::stopped_by(self.listener.stop());
        let mut given = vec![
            (OUT.key, out.to_string_lossy().into_owned()),
            (THREADS.key, self.threads_a_trial.to_string()),
            (FORCE.key, "true".to_owned()),
        ];
        // A set-up that another trial makes is waited for: that is set-up, too.
        let started = Instant::now();
        let pool = task.pool.as_ref();
        let cameras = self.plan.share == Share::Session;
        let study = Shared { root: &self.plan.root, tasks: &self.tasks, cameras, listener: self.listener };
        let shared = pool.map(|pool| self.setups.of(&study, pool, &quiet)).transpose()?;
        let waited_s = started.elapsed().as_secs_f64();
        given.extend(shared.iter().map(|shared| (SETUP.key, shared.path.to_string_lossy().into_owned())));
        let mut resolved = task.as_trial().settings(&self.plan.root, &given)?;
        resolved.known_setup = shared.map(|shared| shared.known);
        let request = |resume| Request { resume, storage: Some(Arc::clone(&storage)), ..Request::default() };
        let mut came_to = track(&resolved, &request(is_stopped(out)), &quiet);
        // Where what was stopped was something else, the trial is begun again.
        if let Err(sinew::Error::Results(sinew_results::Error::Checkpoint { problem, .. })) = &came_to
            && !matches!(**problem, Problem::Whom { .. })
        {
            came_to = track(&resolved, &request(false), &quiet);
        }
        let shared_body = resolved.known_setup.as_ref().map(|known| known.setup.tree());
        let ending = |doubts: &[String], computing_s: f64| Some(ending(doubts, waited_s + computing_s));
        Ok(match came_to? {
            CameTo::One(outcome) if !outcome.summary.complete => None,
            CameTo::Several(summary) if !summary.complete => None,
            CameTo::One(outcome) => {
                write_angle_draws(&storage, out, Some(&outcome.body))?;
                ending(&outcome.summary.failed_diagnostics, computing_s(&*storage, out))
            }
            CameTo::Complete(summary) => {
                write_angle_draws(&storage, out, shared_body.as_ref())?;
                let failed = summary["failed_diagnostics"].as_array().into_iter().flatten();
                let failed: Vec<String> = failed.filter_map(Value::as_str).map(str::to_owned).collect();
                ending(&failed, computing_s(&*storage, out))
            }
            CameTo::Several(summary) => {
                let doubts = summary.people.iter().flat_map(|person| {
                    let why = person.failed.iter().chain(&person.failed_diagnostics);
                    why.map(|why| format!("person {}: {why}", person.person))
                });
                let folders = || summary.people.iter().map(|person| out.join(&person.folder));
                folders()
                    .filter(|folder| storage.exists(&folder.join("summary.json")))
                    .try_for_each(|folder| write_angle_draws(&storage, &folder, shared_body.as_ref()))?;
                ending(&doubts.collect::<Vec<_>>(), folders().map(|folder| computing_s(&*storage, &folder)).sum())
            }
        })
    }
}

fn failed(code: u8, why: String) -> Ending {
    Ending { ended: TaskEnd::Failed, code, why, computing_s: 0.0 }
}

fn ending(doubts: &[String], computing_s: f64) -> Ending {
    let (ended, code) = if doubts.is_empty() { (TaskEnd::Done, 0) } else { (TaskEnd::Doubtful, 4) };
    Ending { ended, code, why: doubts.join("; "), computing_s }
}

/// Seconds of set-up and tracking, as a run wrote them down.
fn computing_s(storage: &dyn Storage, out: &Path) -> f64 {
    let bytes = read_stored(storage, &out.join("timings.json"), MAX_TEXT_BYTES).unwrap_or_default();
    let timings: Value = serde_json::from_slice(&bytes).unwrap_or_default();
    ["set_up_s", "track_s"].iter().filter_map(|key| timings[key].as_f64()).sum()
}
