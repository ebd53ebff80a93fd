//! The backward pass over a recording.
//!
//! Filtered moments go to a file as frames are tracked, and come back as trajectories that know the future.
//!
//! 1. Forward, [`Spool::append`] writes each frame's moments and diagnostics, a record of fixed size.
//! 2. Backward, a second file takes for each record the states of trajectories drawn from the smoothing distribution of the moments ([`sinew_dynamics::backward_pass`]).
//! 3. Forward again, [`smooth`] reads the trajectories frame by frame and describes them; draw *i* of every frame belongs to trajectory *i*.
//!
//! Exact for linear-Gaussian models; elsewhere each frame's posterior is taken for a Gaussian. Evidence, effective sample size and residuals stay the filter's. Memory does not grow with the number
//! of frames; the files take some 110 kB a frame and are removed at the end. The records stay as they are until then, so that the backward pass can be
//! done again by a run that resumes after a stop.

use super::error::TrackError;
use super::pipeline::Pipeline;
use super::record::{Record, RecordShape};
use super::trajectories::TrajectoryDescriber;
use crate::Error;
use sinew_angles::fixed_lag::half_window;
use sinew_angles::marginals::AngleChange;
use sinew_angles::trajectory_change::{change_between, window_around};
use sinew_body::KinematicTree;
use sinew_dynamics::backward_pass::{BackwardPass, FrameNumbers, numbers_of_frame};
use sinew_dynamics::smoother::Smoother;
use sinew_results::estimate::FrameEstimate;
use sinew_results::{Claim, Disk, FilePlace, PartialFile, Position, Storage, UnsyncedDisk};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the file of moments, but for `.partial`: it never gets another.
const MOMENTS: &str = "smooth";

/// Name of the file of trajectories.
const TRAJECTORY_FILE: &str = "trajectories.partial";

/// Moments and diagnostics of the frames tracked so far, in a file; a second one takes the trajectories.
pub struct Spool {
    moments: PartialFile,
    files: Files,
    shape: RecordShape,
    frames: u64,
}

/// Where the files are.
struct Files {
    moments: PathBuf,
    trajectories: PathBuf,
    own_folder: Option<PathBuf>,
}

impl Drop for Files {
    fn drop(&mut self) {
        if let Some(folder) = &self.own_folder {
            let _ = fs::remove_dir_all(folder);
        }
    }
}

impl Spool {
    /// A spool in a claimed folder: an empty one, or what a stopped run had `written`.
    ///
    /// # Errors
    /// A file that cannot be read or written; [`sinew_results::Error::Checkpoint`] for a file that is not as it was left.
    pub fn open(claim: &Claim, sizes: [usize; 4], written: Option<(u64, Position)>) -> Result<Self, Error> {
        // It is read at places, and larger than what is kept in memory.
        let unsynced = || Arc::new(UnsyncedDisk) as Arc<dyn Storage>;
        let storage = if claim.storage().is_temporary() { unsynced() } else { Arc::clone(claim.storage()) };
        Self::open_in(&storage, claim.folder(), sizes, written)
    }

    /// An empty spool in a folder of its own, which is gone when the spool is dropped.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn temporary(folder: &Path, sizes: [usize; 4]) -> Result<Self, Error> {
        fs::create_dir_all(folder).map_err(Error::io("create", folder))?;
        let storage: Arc<dyn Storage> = Arc::new(Disk);
        let mut spool = Self::open_in(&storage, folder, sizes, None)?;
        spool.files.own_folder = Some(folder.to_owned());
        Ok(spool)
    }

    fn open_in(
        storage: &Arc<dyn Storage>,
        folder: &Path,
        [dim, cameras, keypoints, lasting_draws]: [usize; 4],
        written: Option<(u64, Position)>,
    ) -> Result<Self, Error> {
        let positions = written.map(|(_, position)| BTreeMap::from([(MOMENTS.to_owned(), position)]));
        let place = FilePlace { storage, folder, written: positions.as_ref() };
        let moments = place.file(MOMENTS, |_| Ok(()))?;
        let frames = written.map_or(0, |(frames, _)| frames);
        let files = Files {
            moments: folder.join(format!("{MOMENTS}.partial")),
            trajectories: folder.join(TRAJECTORY_FILE),
            own_folder: None,
        };
        let shape = RecordShape { dim, cameras, keypoints, lasting_draws };
        Ok(Self { moments, files, shape, frames })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn append(&mut self, estimate: &FrameEstimate) -> Result<(), Error> {
        let record = self.shape.row(estimate);
        self.moments.write(|out| record.iter().try_for_each(|number| out.write_all(&number.to_le_bytes())))?;
        self.frames += 1;
        Ok(())
    }

    /// Hands everything to the disk, and says how far it goes.
    ///
    /// # Errors
    /// A file that cannot be read or written.
    pub fn keep(&mut self) -> Result<Position, Error> {
        Ok(self.moments.keep()?.1)
    }

    fn read(&self, file: &mut Numbers, frame: u64, fps: f64) -> Result<Record, Error> {
        let count = self.shape.numbers();
        Ok(self.shape.record(&file.read(frame * count as u64, count)?, fps))
    }

    /// The diagnostics of a frame.
    fn diagnostics(&self, moments: &mut Numbers, frame: u64, fps: f64) -> Result<FrameEstimate, Error> {
        let header = moments.read(frame * self.shape.numbers() as u64, self.shape.header())?;
        Ok(self.shape.estimate(&header, fps))
    }

    /// The trajectories in a frame.
    fn trajectories(&self, trajectories: &mut Numbers, frame: u64) -> Result<FrameNumbers, Error> {
        let count = numbers_of_frame(self.shape.dim, self.shape.lasting_draws);
        trajectories.read(frame * count as u64, count)
    }

    /// How angles change over a window of some frames on both sides of a frame; none where nothing is left of it.
    fn change(
        &self,
        moments: &mut Numbers,
        trajectories: &mut Numbers,
        frame: u64,
        fps: f64,
    ) -> Result<Option<AngleChange>, Error> {
        let is_restarted = |frame| Ok::<_, Error>(self.diagnostics(moments, frame, fps)?.restarted);
        let [first, last] = window_around(frame, half_window(fps) as u64, &(0..self.frames), is_restarted)?;
        if first == last {
            return Ok(None);
        }
        let [earlier, later] = [self.trajectories(trajectories, first)?, self.trajectories(trajectories, last)?];
        let RecordShape { dim, lasting_draws, .. } = self.shape;
        Ok(Some(change_between([&earlier, &later], dim, lasting_draws, (last - first) as f64 / fps)))
    }
}

/// A file of numbers at places.
struct Numbers {
    file: File,
    path: PathBuf,
}

impl Numbers {
    fn read(&mut self, at: u64, count: usize) -> Result<Vec<f64>, Error> {
        let mut bytes = vec![0; 8 * count];
        let read = self.file.seek(SeekFrom::Start(8 * at)).and_then(|_| self.file.read_exact(&mut bytes));
        read.map_err(Error::io("read", &self.path))?;
        Ok(bytes.as_chunks().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect())
    }

    fn write(&mut self, at: u64, numbers: &[f64]) -> Result<(), Error> {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        let written = self.file.seek(SeekFrom::Start(8 * at)).and_then(|_| self.file.write_all(&bytes));
        written.map_err(Error::io("write", &self.path))
    }
}

/// A file that is gone when it is dropped.
struct Scratch(Numbers);

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0.path);
    }
}

/// Smooths the frames of a spool and gives them in order to `record`. The spool stays as it is. `stopped` is asked before each frame of the backward pass.
///
/// # Errors
/// A file that cannot be read or written, a covariance that cannot be factored, and errors of `record` and `stopped`.
pub fn smooth(
    spool: &mut Spool,
    pipeline: &Pipeline,
    tree: &KinematicTree,
    stopped: impl Fn() -> Result<(), Error>,
    record: impl FnMut(FrameEstimate) -> Result<ControlFlow<()>, Error>,
) -> Result<(), Error> {
    spool.moments.sync()?;
    let open = |path: &Path| File::open(path).map_err(Error::io("read", path));
    let mut moments = Numbers { file: open(&spool.files.moments)?, path: spool.files.moments.clone() };
    let file = File::options().read(true).write(true).create(true).truncate(true).open(&spool.files.trajectories);
    let file = file.map_err(Error::io("create", &spool.files.trajectories))?;
    let Scratch(trajectories) = &mut Scratch(Numbers { file, path: spool.files.trajectories.clone() });
    backwards(spool, pipeline, &mut moments, trajectories, stopped)?;
    forwards(spool, pipeline, tree, &mut moments, trajectories, record)
}

/// The backward pass: smoothed means and drawn trajectories of all frames, from the last to the first.
fn backwards(
    spool: &Spool,
    pipeline: &Pipeline,
    moments: &mut Numbers,
    trajectories: &mut Numbers,
    stopped: impl Fn() -> Result<(), Error>,
) -> Result<(), Error> {
    let settings = pipeline.settings();
    let smoother = Smoother::random_walk(pipeline.transition.sd());
    let mut pass = BackwardPass::new(spool.shape.dim, settings.seed, settings.isa);
    for frame in (0..spool.frames).rev() {
        stopped()?;
        let record = spool.read(moments, frame, settings.fps)?;
        let step = smoother.backward(&record.moments).map_err(TrackError::Motion)?;
        let numbers = pass.go_to(frame, record.filtered(&step), &smoother).map_err(TrackError::Motion)?;
        trajectories.write(frame * numbers.len() as u64, &numbers)?;
    }
    Ok(())
}

/// Marginals and draws of the smoothed frames, in order.
fn forwards(
    spool: &Spool,
    pipeline: &Pipeline,
    tree: &KinematicTree,
    moments: &mut Numbers,
    trajectories: &mut Numbers,
    mut record: impl FnMut(FrameEstimate) -> Result<ControlFlow<()>, Error>,
) -> Result<(), Error> {
    let fps = pipeline.settings().fps;
    let mut describer = TrajectoryDescriber::new(pipeline, tree);
    for frame in 0..spool.frames {
        let numbers = spool.trajectories(trajectories, frame)?;
        let change = spool.change(moments, trajectories, frame, fps)?;
        let diagnostics = spool.diagnostics(moments, frame, fps)?;
        if record(describer.describe(numbers, change.as_ref(), diagnostics))?.is_break() {
            break;
        }
    }
    Ok(())
}
