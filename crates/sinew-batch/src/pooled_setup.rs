//! One set-up for all trials of a subject in a session, with cameras that its subjects share.
//!
//! Sizes, cameras, biases of the detector and noise are the same in all trials of a subject. The set-up is made from their frames, one trial after the other, by the first trial that needs it. In a session with several subjects it is made twice: once for what their frames say of the cameras, then with
//! draws of the cameras from what all say.
//! Within a process the other trials wait for that one; shards do not wait for each other, since whoever makes it makes the same bytes.

use super::plan::Task;
use super::shard::Shard;
use crate::Error;
use sinew::config::Resolved;
use sinew::config::common::SEED;
use sinew::files::read_bytes;
use sinew::formats::source_text::MAX_TEXT_BYTES;
use sinew::input::footage::Footage;
use sinew::input::one_after_another::OneAfterAnother;
use sinew::input::source::FrameSource as _;
use sinew::observe::association;
use sinew::run::listener::{Listener, watched};
use sinew::setup::KnownSetup;
use sinew::setup::shared_cameras::{CameraInformation, SharedCameras};
use sinew::track::job::{self, MadeSetup};
use sinew_input::flag::flag_with;
use sinew_results::{place, write_whole};
use std::collections::{BTreeSet, HashMap, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Folder of the set-ups in a study.
const POOLED: &str = "setups";

/// Trials from which a set-up is made: of more, an evenly spaced part. What is constant is known from these, and all are open at once.
const MOST_TRIALS: usize = 64;

/// Subjects of a session whose frames tell where its cameras are: of more, the first by name.
const MOST_POOLS: usize = 16;

/// Set-ups that a shard makes and uses.
pub(super) struct PooledSetups {
    folder: PathBuf,
    /// Where this shard writes before it renames.
    own: PathBuf,
    being_made: Mutex<HashMap<String, Arc<Mutex<()>>>>,
    /// The last that were read, the latest first: trials of a pool follow each other.
    read: Mutex<VecDeque<PooledSetup>>,
    most_read: usize,
    /// Sessions whose subjects do not agree about the cameras, by their first pool.
    disagreeing: Mutex<BTreeSet<String>>,
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
        Self {
            folder,
            own,
            being_made: Mutex::default(),
            read: Mutex::default(),
            most_read: workers,
            disagreeing: Mutex::default(),
        }
    }

    /// The set-up of a pool, made if it is not there.
    ///
    /// # Errors
    /// [`Error::UnlikeTrials`]; errors of the recordings and the set-up; an interrupt.
    pub(super) fn of(&self, study: &Shared<'_>, pool: &str, listener: &dyn Listener) -> Result<PooledSetup, Error> {
        let name = format!("{pool}.toml");
        let path = place(&self.folder, &name)?;
        let turn = self.turn(&name);
        let _turn = turn.lock().unwrap_or_else(PoisonError::into_inner);
        if !path.is_file() {
            let cameras = self.cameras(study, pool, listener)?;
            self.write(&name, made(study, pool, cameras, listener)?.toml.as_bytes())?;
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

    /// Draws of the cameras of a session with several pools.
    fn cameras(
        &self,
        study: &Shared<'_>,
        pool: &str,
        listener: &dyn Listener,
    ) -> Result<Option<Arc<SharedCameras>>, Error> {
        let pools = study.pools_of_session(pool);
        if pools.len() < 2 {
            return Ok(None);
        }
        let mut said: Vec<CameraInformation> = vec![];
        for pool in pools.iter().take(MOST_POOLS) {
            let found = self.said_by(study, pool, listener)?;
            said.extend(found.filter(|found| said.first().is_none_or(|first| found.is_of(first))));
        }
        let first = study.members(pools[0]);
        let seed = study.settings(first.first())?.map_or(0, |settings| settings.of(&SEED));
        let shared = SharedCameras::draw(&said.iter().collect::<Vec<_>>(), seed).map_err(sinew::Error::from)?;
        if shared.is_none() && said.len() > 1 {
            self.warn_of_disagreement(study, pools[0]);
        }
        Ok(shared.map(Arc::new))
    }

    /// Says once that the subjects of a session do not share its cameras, by the name of the first pool.
    fn warn_of_disagreement(&self, study: &Shared<'_>, first: &str) {
        if self.disagreeing.lock().unwrap_or_else(PoisonError::into_inner).insert(first.to_owned()) {
            let trial = study.members(first).first().map(|task| task.trial.clone()).unwrap_or_default();
            study.listener.warning(&format!(
                "the frames of different subjects in the session of {trial} do not agree about its cameras: each subject has a set-up of its own (were cameras moved? {} says so)",
                flag_with("share", "subject")
            ));
        }
    }

    /// What a pool says of the cameras; nothing where it cannot be set up.
    fn said_by(
        &self,
        study: &Shared<'_>,
        pool: &str,
        listener: &dyn Listener,
    ) -> Result<Option<CameraInformation>, Error> {
        let name = format!("{pool}.cameras.json");
        let path = place(&self.folder, &name)?;
        let turn = self.turn(&name);
        let _turn = turn.lock().unwrap_or_else(PoisonError::into_inner);
        if !path.is_file() {
            match made(study, pool, None, listener) {
                Ok(made) => self.write(&name, &serde_json::to_vec(&made.said_of_cameras).unwrap_or_default())?,
                Err(Error::Run(error @ sinew::Error::Interrupted(_))) => return Err(error.into()),
                Err(_) => return Ok(None),
            }
        }
        // Read also by who wrote it: all have the same numbers.
        let bytes = read_bytes(&path, MAX_TEXT_BYTES)?;
        let said: Option<CameraInformation> = serde_json::from_slice(&bytes).unwrap_or_default();
        Ok(said.filter(CameraInformation::is_whole))
    }

    /// Whose turn it is to make a file.
    fn turn(&self, name: &str) -> Arc<Mutex<()>> {
        let mut being_made = self.being_made.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(being_made.entry(name.to_owned()).or_default())
    }

    /// Writes a file that others see when it is whole.
    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        fs::create_dir_all(&self.own).map_err(sinew::Error::io("create", &self.own))?;
        let (own, path) = (place(&self.own, name)?, place(&self.folder, name)?);
        write_whole(&own, bytes)?;
        fs::rename(&own, &path).map_err(sinew::Error::io("write", &path))?;
        // Another may lie in it; then it stays.
        let _ = fs::remove_dir(&self.own);
        Ok(())
    }
}

/// What trials share.
pub(super) struct Shared<'a> {
    pub(super) root: &'a Path,
    pub(super) tasks: &'a [Task],
    /// Whether subjects of a session share its cameras.
    pub(super) cameras: bool,
    /// Who hears of sessions, and of trials that cannot be read.
    pub(super) listener: &'a dyn Listener,
}

impl Shared<'_> {
    /// Trials of a pool, in order.
    fn members(&self, pool: &str) -> Vec<&Task> {
        self.tasks.iter().filter(|task| task.pool.as_deref() == Some(pool)).collect()
    }

    fn settings(&self, task: Option<&&Task>) -> Result<Option<Resolved>, Error> {
        task.map(|task| task.as_trial().settings(self.root, &[])).transpose()
    }

    /// Pools of the session of a pool that share its cameras, in order.
    fn pools_of_session(&self, pool: &str) -> Vec<&str> {
        let session = self.tasks.iter().find(|task| task.pool.as_deref() == Some(pool)).map(|task| &task.session);
        let mut pools: Vec<&str> = vec![];
        let own = self.tasks.iter().filter(|task| self.cameras && Some(&task.session) == session);
        own.filter_map(|task| task.pool.as_deref()).for_each(|pool| {
            if !pools.contains(&pool) {
                pools.push(pool);
            }
        });
        pools
    }
}

/// The set-up of a pool, without trials whose files cannot be read: they fail alone.
fn made(
    study: &Shared<'_>,
    pool: &str,
    cameras: Option<Arc<SharedCameras>>,
    listener: &dyn Listener,
) -> Result<MadeSetup, Error> {
    let members = study.members(pool);
    let members: Vec<&Task> = members.iter().copied().step_by(members.len().div_ceil(MOST_TRIALS).max(1)).collect();
    let error = match made_from(study, pool, &members, cameras.clone(), listener) {
        Ok(made) => return Ok(made),
        Err(error @ Error::Run(sinew::Error::Interrupted(_))) => return Err(error),
        Err(error) => error,
    };
    let mut whole = vec![];
    for task in &members {
        match read_whole(study, task) {
            Ok(()) => whole.push(*task),
            Err(why) => {
                study.listener.warning(&format!("{pool}: set up without {}: {}", task.trial, sinew::with_causes(&why)));
            }
        }
    }
    if whole.is_empty() || whole.len() == members.len() {
        return Err(error);
    }
    made_from(study, pool, &whole, cameras, listener)
}

fn recording(study: &Shared<'_>, task: &Task) -> Result<Footage<'static>, Error> {
    let config = task.as_trial().settings(study.root, &[])?.track();
    Ok(config.footage(&sinew::run::calibration(&config)?)?)
}

/// Reads all frames of a trial once.
fn read_whole(study: &Shared<'_>, task: &Task) -> Result<(), Error> {
    let mut recording = recording(study, task)?;
    let mut frames = recording.frames();
    Ok(frames.try_for_each(|number| recording.people(number).map(drop)).map_err(sinew::Error::from)?)
}

/// The set-up of a pool from some of its trials.
fn made_from(
    study: &Shared<'_>,
    pool: &str,
    members: &[&Task],
    cameras: Option<Arc<SharedCameras>>,
    listener: &dyn Listener,
) -> Result<MadeSetup, Error> {
    let unlike = || Error::UnlikeTrials { pool: pool.to_owned() };
    let recordings = members.iter().map(|task| recording(study, task)).collect::<Result<Vec<_>, _>>()?;
    let mut first = study.settings(members.first())?.ok_or_else(unlike)?;
    first.shared_cameras = cameras;
    let fps = first.track().fps();
    // Long enough for a person to count as lost, and to be looked for anywhere.
    let gap = (association::Config::default().lost_frames as u64 + 1).max((0.5 * fps).ceil() as u64);
    let mut source = OneAfterAnother::new(recordings, gap).ok_or_else(unlike)?;
    let made = watched(listener, |watch| job::set_up(&mut source, &first, watch))?;
    made.warnings.iter().for_each(|warning| listener.warning(&format!("{pool}: {warning}")));
    Ok(made)
}
