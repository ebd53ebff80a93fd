//! The backward pass over a recording: filtered moments go to a file as frames are tracked, and come back as trajectories that know the future.
//!
//! 1. Forward, [`Spool::append`] writes each frame's moments and diagnostics, a record of fixed size.
//! 2. Backward, each record is replaced by the states of [`TRAJECTORIES`] trajectories drawn from the smoothing distribution of the moments ([`sinew_dynamics::smoother`]).
//! 3. Forward again, [`smooth`] reads the trajectories frame by frame and describes them; draw *i* of every frame belongs to trajectory *i*.
//!
//! Where tracking began anew the motion prior says nothing of the step, so the pass is cut there: the frame before counts as a last one.
//!
//! Exact for linear-Gaussian models; elsewhere each frame's posterior is taken for a Gaussian. Evidence, effective sample size and residuals stay those of the filter. Memory does not grow with the number
//! of frames; the file takes some 40 kB a frame and is removed at the end.

use super::marginals::Marginals;
use super::{Pipeline, numerical};
use crate::Error;
use crate::estimate::{Draws, FrameEstimate, Quality};
use sinew_body::KinematicTree;
use sinew_core::lanes::{Block, LANES, get_lane, set_lane};
use sinew_core::random::Stage;
use sinew_core::transition::Moments;
use sinew_dynamics::smoother::Smoother;
use sinew_tracking::posterior::Posterior;
use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Trajectories drawn.
pub const TRAJECTORIES: usize = 128;

const SCALARS: usize = 11;

/// Moments and diagnostics of the frames tracked so far, in a file.
pub struct Spool {
    file: File,
    path: PathBuf,
    dim: usize,
    cameras: usize,
    keypoints: usize,
    frames: u64,
}

fn option(x: f64) -> Option<f64> {
    Some(x).filter(|x| !x.is_nan())
}

impl Spool {
    /// An empty spool at `path`, which must not exist.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn create(path: &Path, dim: usize, cameras: usize, keypoints: usize) -> Result<Self, Error> {
        let file = File::options().read(true).write(true).create_new(true).open(path);
        let file = file.map_err(Error::io("create", path))?;
        Ok(Self { file, path: path.into(), dim, cameras, keypoints, frames: 0 })
    }

    fn header(&self) -> usize {
        SCALARS + self.cameras * (1 + 3 * self.keypoints)
    }

    /// Numbers in a record: diagnostics, then filtered moments, later the smoothed mean and trajectories.
    fn record(&self) -> usize {
        self.header() + self.dim * (self.dim + 1).max(1 + TRAJECTORIES)
    }

    fn write_at(&mut self, frame: u64, at: usize, numbers: &[f64]) -> Result<(), Error> {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        let offset = 8 * (frame * self.record() as u64 + at as u64);
        let written = self.file.seek(SeekFrom::Start(offset)).and_then(|_| self.file.write_all(&bytes));
        written.map_err(Error::io("write", &self.path))
    }

    fn read_at(&mut self, frame: u64, at: usize, count: usize) -> Result<Vec<f64>, Error> {
        let mut bytes = vec![0; 8 * count];
        let offset = 8 * (frame * self.record() as u64 + at as u64);
        let read = self.file.seek(SeekFrom::Start(offset)).and_then(|_| self.file.read_exact(&mut bytes));
        read.map_err(Error::io("read", &self.path))?;
        let (chunks, _) = bytes.as_chunks::<8>();
        Ok(chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect())
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn append(&mut self, estimate: &FrameEstimate, moments: &Moments) -> Result<(), Error> {
        let mut record = vec![
            estimate.number as f64,
            f64::from(u8::from(estimate.observed)),
            f64::from(estimate.quality as u8),
            estimate.ess,
            estimate.log_evidence.unwrap_or(f64::NAN),
            estimate.r_hat.unwrap_or(f64::NAN),
            estimate.acceptance.unwrap_or(f64::NAN),
            estimate.divergences as f64,
            estimate.trajectories as f64,
            estimate.energy_fraction.unwrap_or(f64::NAN),
            f64::from(u8::from(estimate.restarted)),
        ];
        record.extend((0..self.cameras).map(|c| estimate.residual_px.get(c).copied().flatten().unwrap_or(f64::NAN)));
        record.extend(estimate.seen.as_flattened());
        record.resize(self.header(), f64::NAN);
        record.extend(&moments.mean);
        record.extend(&moments.covariance);
        record.resize(self.record(), 0.0);
        self.write_at(self.frames, 0, &record)?;
        self.frames += 1;
        Ok(())
    }

    fn restarted(&mut self, frame: u64) -> Result<bool, Error> {
        Ok(self.read_at(frame, SCALARS - 1, 1)?[0] > 0.0)
    }

    fn moments(&mut self, frame: u64) -> Result<Moments, Error> {
        let (at, d) = (self.header(), self.dim);
        let numbers = self.read_at(frame, at, d * (d + 1))?;
        let (mean, covariance) = numbers.split_at(d);
        Ok(Moments { mean: mean.to_vec(), covariance: covariance.to_vec() })
    }

    fn estimate(&mut self, frame: u64, fps: f64) -> Result<FrameEstimate, Error> {
        let n = self.header();
        let h = self.read_at(frame, 0, n)?;
        Ok(FrameEstimate {
            number: h[0] as u64,
            time_s: h[0] / fps,
            observed: h[1] > 0.0,
            quality: match h[2] as u8 {
                0 => Quality::Predicted,
                1 => Quality::OneCamera,
                _ => Quality::Good,
            },
            ess: h[3],
            log_evidence: option(h[4]),
            r_hat: option(h[5]),
            acceptance: option(h[6]),
            divergences: h[7] as u64,
            trajectories: h[8] as u64,
            energy_fraction: option(h[9]),
            restarted: h[10] > 0.0,
            residual_px: h[SCALARS..][..self.cameras].iter().map(|&x| option(x)).collect(),
            seen: h[SCALARS + self.cameras..].as_chunks().0.to_vec(),
            ..FrameEstimate::default()
        })
    }
}

impl Drop for Spool {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// Smooths the frames of a spool and gives them in order to `record`.
///
/// # Errors
/// [`Error::Io`], a covariance that cannot be factored, and those of `record`.
pub fn smooth(
    spool: &mut Spool,
    pipeline: &Pipeline,
    tree: &KinematicTree,
    mut record: impl FnMut(FrameEstimate) -> Result<ControlFlow<()>, Error>,
) -> Result<(), Error> {
    let (d, at) = (spool.dim, spool.header());
    let (settings, size) = (&pipeline.settings, pipeline.marginals.size().cloned());
    let smoother = Smoother::random_walk(pipeline.transition.sd());
    let mut states = vec![Block::ZERO; TRAJECTORIES / LANES * d];
    let mut next: Option<Moments> = None;
    for frame in (0..spool.frames).rev() {
        let filtered = spool.moments(frame)?;
        let rng = &mut Stage::new(settings.seed, "smooth").at_frame(frame as u32).whole();
        let smoothed = match &next {
            None => {
                smoother.sample_last(&filtered, &mut states, settings.isa, rng).map_err(numerical)?;
                filtered
            }
            Some(next) => {
                smoother.sample(&filtered, &mut states, settings.isa, rng).map_err(numerical)?;
                smoother.step(&filtered, next).map_err(numerical)?
            }
        };
        let mut numbers = smoothed.mean.clone();
        numbers.resize((1 + TRAJECTORIES) * d, 0.0);
        for (i, state) in numbers[d..].chunks_exact_mut(d).enumerate() {
            get_lane(&states[i / LANES * d..][..d], i % LANES, state);
        }
        spool.write_at(frame, at, &numbers)?;
        next = if spool.restarted(frame)? { None } else { Some(smoothed) };
    }
    let weights = vec![1.0 / TRAJECTORIES as f64; TRAJECTORIES];
    let mut marginals = Marginals::new(tree, settings.isa, size);
    for frame in 0..spool.frames {
        let numbers = spool.read_at(frame, at, (1 + TRAJECTORIES) * d)?;
        let (mean_state, numbers) = numbers.split_at(d);
        for (i, state) in numbers.chunks_exact(d).enumerate() {
            set_lane(&mut states[i / LANES * d..][..d], i % LANES, state);
        }
        let posterior =
            Posterior { dim: d, states: &states, weights: &weights, effective: TRAJECTORIES as f64, chain_stats: &[] };
        let (points, state) = marginals.of(&posterior);
        let mut kept = numbers[..settings.draws.min(TRAJECTORIES) * d].to_vec();
        let size = marginals.size_draws(0..TRAJECTORIES, &mut kept, d);
        let draws = Draws { states: kept, size, ..Draws::default() };
        let estimate = FrameEstimate {
            mean_state: mean_state.to_vec(),
            points,
            state,
            draws,
            ..spool.estimate(frame, settings.fps)?
        };
        if record(estimate)?.is_break() {
            break;
        }
    }
    Ok(())
}
