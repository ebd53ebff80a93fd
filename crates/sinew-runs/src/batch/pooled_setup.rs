//! One set-up for all trials of a subject in a session.
//!
//! Sizes, cameras, biases of the detector and noise are the same in all of them. It is made from the trials' frames, one trial after the other, by the first who needs it.
//! Within a process others wait for him; shards do not wait for each other, since whoever makes it makes the same bytes.

use super::plan::Task;
use super::shard::Shard;
use crate::Error;
use crate::listener::{Listener, PassCounter};
use crate::settings::reading;
use sinew::input::footage::Footage;
use sinew::input::one_after_another::OneAfterAnother;
use sinew::observe::association;
use sinew::results::write_whole;
use sinew::setup::KnownSetup;
use sinew::track::job::{self, Watch};
use std::collections::{HashMap, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Folder of the set-ups in a study.
const POOLED: &str = "setups";

/// Trials from which a set-up is made: of more, an evenly spaced part. What is constant is known from these, and all are open at once.
const MOST_TRIALS: usize = 64;

/// Set-ups that a shard makes and uses.
pub(super) struct PooledSetups {
    folder: PathBuf,
    /// Where this shard writes before it renames.
    own: PathBuf,
    being_made: Mutex<HashMap<String, Arc<Mutex<()>>>>,
    /// The last that were read, the latest first: trials of a pool follow each other.
    read: Mutex<VecDeque<PooledSetup>>,
    most_read: usize,
}

/// The set-up of a pool.
#[derive(Clone)]
pub(super) struct PooledSetup {
    pub(super) path: PathBuf,
    pub(super) known: Arc<KnownSetup>,
}

impl PooledSetups {
    /// Set-ups of a study, for a shard of it that some workers run.
    pub(super) fn new(study: &Path, shard: Shard, workers: usize) -> Self {
        let folder = study.join(POOLED);
        let own = folder.join(format!("{}-of-{}", shard.index, shard.count));
        Self { folder, own, being_made: Mutex::default(), read: Mutex::default(), most_read: workers }
    }

    /// The set-up of a pool, made if it is not there.
    ///
    /// # Errors
    /// [`Error::UnlikeTrials`]; errors of the recordings and the set-up; an interrupt.
    pub(super) fn of(
        &self,
        root: &Path,
        pool: &str,
        tasks: &[Task],
        listener: &dyn Listener,
    ) -> Result<PooledSetup, Error> {
        let name = format!("{pool}.toml");
        let path = self.folder.join(&name);
        let turn =
            Arc::clone(self.being_made.lock().unwrap_or_else(PoisonError::into_inner).entry(name.clone()).or_default());
        let _turn = turn.lock().unwrap_or_else(PoisonError::into_inner);
        if !path.is_file() {
            let members: Vec<&Task> = tasks.iter().filter(|task| task.pool.as_deref() == Some(pool)).collect();
            let stride = members.len().div_ceil(MOST_TRIALS).max(1);
            let members: Vec<&Task> = members.into_iter().step_by(stride).collect();
            let setup = made(root, pool, &members, listener)?;
            fs::create_dir_all(&self.own).map_err(sinew::Error::io("create", &self.own))?;
            let own = self.own.join(&name);
            write_whole(&own, setup.as_bytes())?;
            fs::rename(&own, &path).map_err(sinew::Error::io("write", &path))?;
            // Another may lie in it; then it stays.
            let _ = fs::remove_dir(&self.own);
        }
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = read.iter().find(|known| known.path == path) {
            return Ok(known.clone());
        }
        let known = PooledSetup { known: Arc::new(job::read_setup(&path)?), path };
        read.push_front(known.clone());
        read.truncate(self.most_read);
        Ok(known)
    }
}

/// The set-up of a pool, as `setup.toml` has it.
fn made(root: &Path, pool: &str, members: &[&Task], listener: &dyn Listener) -> Result<String, Error> {
    let settings = |task: &&Task| task.as_trial().settings(root, &[]);
    let mut recordings = vec![];
    for task in members {
        let config = settings(task)?.track();
        recordings.push(Footage::open(&config.files(&crate::calibration(&config)?), &reading(&config))?);
    }
    let unlike = || Error::UnlikeTrials { pool: pool.to_owned() };
    let first = settings(members.first().ok_or_else(unlike)?)?;
    let fps = first.track().settings()?.fps;
    // Long enough for a person to count as lost, and to be looked for anywhere.
    let gap = (association::Config::default().lost_frames as u64 + 1).max((0.5 * fps).ceil() as u64);
    let mut source = OneAfterAnother::new(recordings, gap).ok_or_else(unlike)?;
    let mut counter = PassCounter::new(listener);
    let stop = listener.stop();
    let mut at = |pass, done, total| counter.at(pass, done, total);
    let (setup, warnings) = job::set_up(&mut source, &first, &mut Watch { progress: &mut at, stop: &stop })?;
    warnings.iter().for_each(|warning| listener.warning(&format!("{pool}: {warning}")));
    Ok(setup)
}
