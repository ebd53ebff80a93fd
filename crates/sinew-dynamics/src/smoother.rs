//! Backward pass over the moments that a filter left, one frame at a time, last frame first.
//!
//! Rauch, Tung & Striebel (1965): with filtered moments (m_t, P_t) and the prediction m⁻ = A m_t, P⁻ = A P_t Aᵀ + Q,
//!
//! 1. G = P_t Aᵀ (P⁻)⁻¹
//! 2. m_t^s = m_t + G (m_{t+1}^s − m⁻)
//! 3. P_t^s = P_t + G (P_{t+1}^s − P⁻) Gᵀ
//!
//! and, for whole trajectories (Frühwirth-Schnatter 1994), x_t ~ N(m_t + G (x_{t+1} − m⁻), P_t − G P⁻ Gᵀ). Exact for linear-Gaussian models; elsewhere it takes each frame's posterior for a Gaussian. A random walk has A = I.
//! Only one frame is held, so moments can be streamed from disk.

use crate::Error;
use crate::factor::{cholesky, root};
use crate::lasting::rows;
use crate::linear_motion::{add_product, predict, symmetric, to_rows};
use faer::{Mat, MatRef};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::BlockRng;
use sinew_core::transition::Moments;

/// The motion that the backward pass undoes.
#[derive(Clone, Debug)]
pub struct Smoother {
    dim: usize,
    matrix: Vec<f64>,
    noise: Vec<f64>,
}

/// Gain G and prediction of one frame.
struct Gain {
    gain: Mat<f64>,
    predicted: Moments,
}

/// What takes draws of the next frame back to a frame: m, m⁻, G and the root of P − G P⁻ Gᵀ.
#[derive(Clone, Debug)]
pub struct BackwardStep {
    matrix: Vec<f64>,
    mean: Vec<f64>,
    predicted: Vec<f64>,
    gain: Vec<f64>,
    root: Vec<f64>,
}

impl BackwardStep {
    /// As [`Smoother::sample`].
    pub fn sample(&self, next: &mut [Block], isa: Isa, rng: &mut BlockRng) {
        for state in next.chunks_exact_mut(self.mean.len()) {
            let mut error = state.to_vec();
            for (e, m) in error.iter_mut().zip(&self.predicted) {
                e.0.iter_mut().for_each(|e| *e -= m);
            }
            draw_eight(state, &self.mean, Some((&self.gain, &error)), &self.root, isa, rng);
        }
    }

    /// The smoothed mean of the frame from that of the next, as [`Smoother::step`] has it.
    #[must_use]
    pub fn mean(&self, next: &[f64]) -> Vec<f64> {
        let d = self.mean.len();
        (0..d)
            .map(|i| self.mean[i] + (0..d).map(|j| self.gain[i * d + j] * (next[j] - self.predicted[j])).sum::<f64>())
            .collect()
    }

    /// As [`Smoother::changes`].
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`].
    pub fn changes(&self, own: &[f64], next: &[f64]) -> Result<Vec<f64>, Error> {
        let d = self.mean.len();
        let [a, gain] = [&self.matrix, &self.gain].map(|m| MatRef::from_row_major_slice(m, d, d));
        changes(a, gain, own, next)
    }
}

/// Δ + G (Δ_{t+1} − A Δ), for d × n changes, row after row.
fn changes(a: MatRef<'_, f64>, gain: MatRef<'_, f64>, own: &[f64], next: &[f64]) -> Result<Vec<f64>, Error> {
    let (d, n) = (a.nrows(), own.len() / a.nrows().max(1));
    let (own, next) = (rows("changes of the mean", own, d, n)?, rows("changes of the next mean", next, d, n)?);
    let ahead = next - a * &own;
    Ok(to_rows(&(own + gain * ahead)))
}

impl Smoother {
    /// A backward pass for s' = A s + N(0, Q), both d × d, row after row.
    ///
    /// # Errors
    /// [`Error::Shape`].
    pub fn new(dim: usize, matrix: Vec<f64>, noise: Vec<f64>) -> Result<Self, Error> {
        for (name, found) in [("A", matrix.len()), ("Q", noise.len())] {
            if found != dim * dim {
                return Err(Error::Shape { name, found, expected: dim * dim });
            }
        }
        Ok(Self { dim, matrix, noise })
    }

    /// A backward pass for a random walk with these standard deviations of one step.
    #[must_use]
    pub fn random_walk(sd: &[f64]) -> Self {
        let dim = sd.len();
        let diagonal = |entry: &dyn Fn(usize) -> f64| {
            (0..dim * dim).map(|k| if k / dim == k % dim { entry(k % dim) } else { 0.0 }).collect()
        };
        Self { dim, matrix: diagonal(&|_| 1.0), noise: diagonal(&|j| sd[j] * sd[j]) }
    }

    fn gain(&self, filtered: &Moments) -> Result<Gain, Error> {
        let d = self.dim;
        for (name, found, expected) in
            [("mean", filtered.mean.len(), d), ("covariance", filtered.covariance.len(), d * d)]
        {
            if found != expected {
                return Err(Error::Shape { name, found, expected });
            }
        }
        let predicted = predict(&self.matrix, &self.noise, filtered);
        let factor = cholesky("predicted covariance", &predicted.covariance, d)?;
        let lower = MatRef::from_row_major_slice(&factor.lower, d, d);
        let a = MatRef::from_row_major_slice(&self.matrix, d, d);
        // Gᵀ = (P⁻)⁻¹ A P_t by two triangular solves.
        let mut transposed = a * MatRef::from_row_major_slice(&filtered.covariance, d, d);
        lower.solve_lower_triangular_in_place(transposed.as_mut());
        lower.transpose().solve_upper_triangular_in_place(transposed.as_mut());
        Ok(Gain { gain: transposed.transpose().to_owned(), predicted })
    }

    /// Smoothed moments of a frame from its filtered ones and the smoothed ones of the next frame (the last frame's smoothed moments are its filtered ones).
    ///
    /// # Errors
    /// [`Error::Shape`], or as [`cholesky`].
    pub fn step(&self, filtered: &Moments, next: &Moments) -> Result<Moments, Error> {
        let d = self.dim;
        let Gain { gain, predicted } = self.gain(filtered)?;
        let mean = (0..d)
            .map(|i| filtered.mean[i] + (0..d).map(|j| gain[(i, j)] * (next.mean[j] - predicted.mean[j])).sum::<f64>())
            .collect();
        let change = MatRef::from_row_major_slice(&next.covariance, d, d)
            - MatRef::from_row_major_slice(&predicted.covariance, d, d);
        let covariance = MatRef::from_row_major_slice(&filtered.covariance, d, d) + &gain * change * gain.transpose();
        Ok(Moments { mean, covariance: to_rows(&symmetric(&covariance)) })
    }

    /// What changes of the filtered mean become once the frames after it are known, Δ + G (Δ_{t+1} − A Δ): `own` are the changes of the frame, `next` the smoothed ones of the next; d × n, row after row.
    ///
    /// # Errors
    /// As [`Smoother::step`].
    pub fn changes(&self, filtered: &Moments, own: &[f64], next: &[f64]) -> Result<Vec<f64>, Error> {
        let gain = self.gain(filtered)?.gain;
        changes(MatRef::from_row_major_slice(&self.matrix, self.dim, self.dim), gain.as_ref(), own, next)
    }

    /// Draws a frame's states of trajectories: `next` holds their states at the next frame, blocks of d, and is replaced.
    ///
    /// # Errors
    /// [`Error::Shape`], or as [`crate::factor`].
    pub fn sample(&self, filtered: &Moments, next: &mut [Block], isa: Isa, rng: &mut BlockRng) -> Result<(), Error> {
        self.backward(filtered)?.sample(next, isa, rng);
        Ok(())
    }

    /// The step back to a frame, for draws of more than one pass over it.
    ///
    /// # Errors
    /// [`Error::Shape`], or as [`crate::factor`].
    pub fn backward(&self, filtered: &Moments) -> Result<BackwardStep, Error> {
        let d = self.dim;
        let Gain { gain, predicted } = self.gain(filtered)?;
        let p = MatRef::from_row_major_slice(&filtered.covariance, d, d);
        let a = MatRef::from_row_major_slice(&self.matrix, d, d);
        let left = to_rows(&symmetric(&(p - &gain * a * p)));
        Ok(BackwardStep {
            matrix: self.matrix.clone(),
            mean: filtered.mean.clone(),
            predicted: predicted.mean,
            gain: to_rows(&gain),
            root: root("covariance given the next frame", &left, d)?,
        })
    }

    /// Draws the last frame's states, with which [`Smoother::sample`] begins.
    ///
    /// # Errors
    /// As [`root`].
    pub fn sample_last(
        &self,
        filtered: &Moments,
        last: &mut [Block],
        isa: Isa,
        rng: &mut BlockRng,
    ) -> Result<(), Error> {
        let root = root("covariance", &filtered.covariance, self.dim)?;
        for state in last.chunks_exact_mut(self.dim) {
            draw_eight(state, &filtered.mean, None, &root, isa, rng);
        }
        Ok(())
    }
}

/// mean + gain · error + root · z, for eight trajectories.
fn draw_eight(
    state: &mut [Block],
    mean: &[f64],
    pull: Option<(&[f64], &[Block])>,
    root: &[f64],
    isa: Isa,
    rng: &mut BlockRng,
) {
    let mut noise = vec![Block([0.0; LANES]); mean.len()];
    rng.fill_normal(isa, &mut noise);
    for (x, &m) in state.iter_mut().zip(mean) {
        *x = Block::splat(m);
    }
    if let Some((gain, error)) = pull {
        add_product(gain, error, state);
    }
    add_product(root, &noise, state);
}
