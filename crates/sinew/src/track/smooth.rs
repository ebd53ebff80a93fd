//! The backward pass over a recording.
//!
//! Filtered moments go to a file as frames are tracked, and come back as trajectories that know the future.
//!
//! 1. Forward, [`Spool::append`] writes each frame's moments and diagnostics, a record of fixed size.
//! 2. Backward, a second file takes for each record the states of [`TRAJECTORIES`] trajectories drawn from the smoothing distribution of the moments ([`sinew_dynamics::smoother`]).
//! 3. Forward again, [`smooth`] reads the trajectories frame by frame and describes them; draw *i* of every frame belongs to trajectory *i*.
//!
//! Where tracking restarted the motion prior says nothing of the step, so the pass is cut there: the frame before counts as a last one.
//!
//! Exact for linear-Gaussian models; elsewhere each frame's posterior is taken for a Gaussian. Evidence, effective sample size and residuals stay the filter's. Memory does not grow with the number
//! of frames; the files take some 110 kB a frame and are removed at the end. The records stay as they are until then, so that the backward pass can be
//! done again by a run that resumes after a stop.

use super::error::TrackError;
use super::marginals::{Described, Marginals};
use super::pipeline::Pipeline;
use crate::Error;
use crate::results::estimate::{Draws, FrameEstimate, diagnostics};
use crate::results::{Claim, Disk, PartialFile, Place, Position, Storage};
use sinew_angles::AngleMarginals;
use sinew_angles::fixed_lag::half_window;
use sinew_angles::marginals::{AngleChange, LaterFrame};
use sinew_body::KinematicTree;
use sinew_core::lanes::{Block, LANES, get_lane, set_lane};
use sinew_core::random::Stage;
use sinew_core::transition::Moments;
use sinew_dynamics::smoother::Smoother;
use sinew_tracking::moved::{Moved, Rows};
use sinew_tracking::posterior::Posterior;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Trajectories drawn.
pub const TRAJECTORIES: usize = 128;

/// Name of the file of moments, but for `.partial`: it never gets another.
const MOMENTS: &str = "smooth";

/// Name of the file of trajectories.
const TRAJECTORY_FILE: &str = "trajectories.partial";

/// Moments and diagnostics of the frames tracked so far, in a file; a second one takes the trajectories.
pub struct Spool {
    moments: PartialFile,
    files: Files,
    dim: usize,
    cameras: usize,
    keypoints: usize,
    lasting_draws: usize,
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
    /// [`Error::Io`]; [`Error::Checkpoint`] for a file that is not as it was left.
    pub fn open(claim: &Claim, sizes: [usize; 4], written: Option<(u64, Position)>) -> Result<Self, Error> {
        Self::open_in(claim.storage(), claim.folder(), sizes, written)
    }

    /// An empty spool in a folder of its own, which is gone when the spool is dropped.
    ///
    /// # Errors
    /// [`Error::Io`].
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
        let place = Place { storage, folder, written: positions.as_ref() };
        let moments = place.file(MOMENTS, |_| Ok(()))?;
        let frames = written.map_or(0, |(frames, _)| frames);
        let files = Files {
            moments: folder.join(format!("{MOMENTS}.partial")),
            trajectories: folder.join(TRAJECTORY_FILE),
            own_folder: None,
        };
        Ok(Self { moments, files, dim, cameras, keypoints, lasting_draws, frames })
    }

    fn header(&self) -> usize {
        diagnostics::count(self.cameras) + 3 * self.cameras * self.keypoints
    }

    /// Numbers in a record: diagnostics, what was seen, filtered moments, moves of draws.
    fn record(&self) -> usize {
        self.header() + self.dim * (self.dim + 1 + self.lasting_draws)
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn append(&mut self, estimate: &FrameEstimate, moments: &Moments) -> Result<(), Error> {
        let mut record = diagnostics::numbers(estimate, self.cameras);
        record.extend(estimate.seen.as_flattened());
        record.resize(self.header(), f64::NAN);
        record.extend(&moments.mean);
        let missing = estimate.missing.iter().copied().chain(std::iter::repeat(0.0));
        record.extend(moments.covariance.iter().zip(missing).map(|(known, missing)| known + missing));
        record.extend(&estimate.moves);
        record.resize(self.record(), 0.0);
        self.moments.write(|out| record.iter().try_for_each(|number| out.write_all(&number.to_le_bytes())))?;
        self.frames += 1;
        Ok(())
    }

    /// Hands everything to the disk, and says how far it goes.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn keep(&mut self) -> Result<Position, Error> {
        Ok(self.moments.keep()?.1)
    }

    fn read(&self, file: &mut Numbers, frame: u64) -> Result<Record, Error> {
        let numbers = file.read(frame * self.record() as u64, self.record())?;
        let (header, moments) = numbers.split_at(self.header());
        let (mean, rest) = moments.split_at(self.dim);
        let (covariance, moves) = rest.split_at(self.dim * self.dim);
        let moments = Moments { mean: mean.to_vec(), covariance: covariance.to_vec() };
        Ok(Record { header: header.to_vec(), moments, moves: moves.to_vec() })
    }

    /// Whether tracking began again in a frame.
    fn is_restarted(&self, moments: &mut Numbers, frame: u64) -> Result<bool, Error> {
        let header = moments.read(frame * self.record() as u64, self.header())?;
        Ok(self.estimate(&header, 1.0).restarted)
    }

    /// Trajectories at the ends of a window of some frames on both sides of a frame, cut where tracking began again and at the ends of the recording; none where nothing is left of it.
    fn change(
        &self,
        moments: &mut Numbers,
        trajectories: &mut Numbers,
        frame: u64,
        window: usize,
        fps: f64,
    ) -> Result<Option<AngleChange>, Error> {
        let [mut first, mut last] = [frame; 2];
        while first > 0 && frame - first < window as u64 && !self.is_restarted(moments, first)? {
            first -= 1;
        }
        while last + 1 < self.frames && last - frame < window as u64 && !self.is_restarted(moments, last + 1)? {
            last += 1;
        }
        if first == last {
            return Ok(None);
        }
        let mut at = |frame: u64| {
            let mut numbers = trajectories.read(frame * numbers_of_frame(self) as u64, numbers_of_frame(self))?;
            let moves = numbers.split_off((1 + TRAJECTORIES) * self.dim);
            let states = &mut numbers[self.dim..];
            if self.lasting_draws > 0 {
                Rows::new(&moves, self.lasting_draws).add_columns(states);
            }
            let mut blocks = vec![Block::ZERO; TRAJECTORIES / LANES * self.dim];
            to_blocks(states, self.dim, &mut blocks);
            Ok::<_, Error>(blocks)
        };
        let (earlier, later) = (at(first)?, at(last)?);
        Ok(Some(AngleChange { earlier, later: LaterFrame::States(later), seconds: (last - first) as f64 / fps }))
    }

    fn estimate(&self, header: &[f64], fps: f64) -> FrameEstimate {
        let (row, seen) = header.split_at(diagnostics::count(self.cameras));
        FrameEstimate { seen: seen.as_chunks().0.to_vec(), ..diagnostics::estimate(row, fps).unwrap_or_default() }
    }
}

/// What a spool holds of a frame.
struct Record {
    header: Vec<f64>,
    moments: Moments,
    /// [`FrameEstimate::moves`].
    moves: Vec<f64>,
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
/// [`Error::Io`], a covariance that cannot be factored, and errors of `record` and `stopped`.
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

/// Numbers of a frame in the file of trajectories: the smoothed mean, the states, and the moves of the draws of what is constant.
const fn numbers_of_frame(spool: &Spool) -> usize {
    (1 + TRAJECTORIES + spool.lasting_draws) * spool.dim
}

/// States one after the other as blocks.
fn to_blocks(numbers: &[f64], dim: usize, states: &mut [Block]) {
    for (i, state) in numbers.chunks_exact(dim).enumerate() {
        set_lane(&mut states[i / LANES * dim..][..dim], i % LANES, state);
    }
}

/// The backward pass: smoothed means and drawn trajectories of all frames, from the last to the first.
fn backwards(
    spool: &Spool,
    pipeline: &Pipeline,
    moments: &mut Numbers,
    trajectories: &mut Numbers,
    stopped: impl Fn() -> Result<(), Error>,
) -> Result<(), Error> {
    let (d, settings) = (spool.dim, pipeline.settings());
    let smoother = Smoother::random_walk(pipeline.transition.sd());
    let mut states = vec![Block::ZERO; TRAJECTORIES / LANES * d];
    let mut next: Option<Moments> = None;
    let mut next_moves = vec![];
    for frame in (0..spool.frames).rev() {
        stopped()?;
        let Record { header, moments: filtered, moves } = spool.read(moments, frame)?;
        let filtered_frame = spool.estimate(&header, settings.fps);
        let rng = &mut Stage::new(settings.seed, "smooth").at_frame(frame as u32).whole();
        next_moves = match &next {
            Some(_) if spool.lasting_draws > 0 => {
                smoother.changes(&filtered, &moves, &next_moves).map_err(TrackError::Motion)?
            }
            _ => moves,
        };
        let smoothed = match &next {
            None => {
                smoother.sample_last(&filtered, &mut states, settings.isa, rng).map_err(TrackError::Motion)?;
                filtered
            }
            Some(next) => {
                smoother.sample(&filtered, &mut states, settings.isa, rng).map_err(TrackError::Motion)?;
                smoother.step(&filtered, next).map_err(TrackError::Motion)?
            }
        };
        let mut numbers = smoothed.mean.clone();
        numbers.resize((1 + TRAJECTORIES) * d, 0.0);
        for (i, state) in numbers[d..].chunks_exact_mut(d).enumerate() {
            get_lane(&states[i / LANES * d..][..d], i % LANES, state);
        }
        numbers.extend(&next_moves);
        trajectories.write(frame * numbers_of_frame(spool) as u64, &numbers)?;
        next = if filtered_frame.restarted { None } else { Some(smoothed) };
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
    let (d, settings) = (spool.dim, pipeline.settings());
    let weights = vec![1.0 / TRAJECTORIES as f64; TRAJECTORIES];
    let mut marginals = Marginals::new(tree, pipeline.detected_plan(), settings.isa, pipeline.size().cloned());
    let mut angles = AngleMarginals::new(pipeline.angles().clone(), pipeline.zero().cloned());
    let mut states = vec![Block::ZERO; TRAJECTORIES / LANES * d];
    for frame in 0..spool.frames {
        let mut numbers = trajectories.read(frame * numbers_of_frame(spool) as u64, numbers_of_frame(spool))?;
        let moves = numbers.split_off((1 + TRAJECTORIES) * d);
        let (mean_state, numbers) = numbers.split_at_mut(d);
        let lasting = pipeline.lasting().filter(|_| spool.lasting_draws > 0);
        let moved: Option<Moved> = lasting.map(|lasting| lasting.moved(mean_state, &moves));
        if let Some(moved) = &moved {
            moved.apply(numbers);
            mean_state.iter_mut().zip(moved.mean()).for_each(|(x, by)| *x += by);
        }
        to_blocks(numbers, d, &mut states);
        let posterior =
            Posterior { dim: d, states: &states, weights: &weights, effective: TRAJECTORIES as f64, chain_stats: &[] };
        let Described { points, keypoints, state } = marginals.of(&posterior, moved.as_ref());
        let change = spool.change(moments, trajectories, frame, half_window(settings.fps), settings.fps)?;
        let angles = angles.of(mean_state, &posterior, change.as_ref());
        let mut kept = numbers[..settings.draws.min(TRAJECTORIES) * d].to_vec();
        let size = marginals.size_draws(&mut kept, d);
        let written = lasting.zip(moved.as_ref()).map(|(lasting, moved)| lasting.written(moved, &kept));
        let [shape, detected] = written.unwrap_or_default();
        let draws = Draws { states: kept, shape, detected, size, ..Draws::default() };
        let header = spool.read(moments, frame)?.header;
        let estimate = FrameEstimate {
            mean_state: mean_state.to_vec(),
            points,
            keypoints,
            state,
            angles,
            draws,
            ..spool.estimate(&header, settings.fps)
        };
        if record(estimate)?.is_break() {
            break;
        }
    }
    Ok(())
}
