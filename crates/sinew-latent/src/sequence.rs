//! The posterior of the latents of a sequence, given some columns of its rows.
//!
//! 1. Start: among the latents that were learned from, the likeliest path (Viterbi 1967) with the link between rows as transition
//! 2. L-BFGS on [`SequenceDensity`] to the mode
//! 3. a Laplace approximation there: the precision couples consecutive rows only, so that differences of the gradient along 3 q directions give all of it
//! 4. draws from that normal distribution; predictions are means and variances of the processes over the draws
//!
//! One mode is followed: a sequence whose rows fit two places of the latent space equally well gets too little variance. The likelihood takes residuals of columns and rows as independent; where they are not, the posterior is too narrow (the coverage
//! on recordings of sequences left out is on the page of evidence).

use crate::Error;
use crate::inference::Prediction;
use crate::sequence_density::{SequenceDensity, SequenceLink};
use faer::linalg::solvers::Llt;
use faer::linalg::triangular_solve::solve_upper_triangular_in_place;
use faer::{Mat, Par, Side};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::lbfgs::Lbfgs;
use sinew_core::random::Stage;

/// How the posterior is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Steps of the climb at most.
    pub steps: usize,
    /// Draws.
    pub draws: usize,
}

impl Default for Config {
    fn default() -> Self {
        Self { steps: 200, draws: 64 }
    }
}

/// The posterior of the latents of a sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct SequencePosterior {
    /// The mode, rows of q.
    pub mode: Vec<f64>,
    /// Log density there, without constants.
    pub log_density: f64,
    /// Draws, each as long as the mode.
    pub draws: Vec<Vec<f64>>,
}

/// The likeliest path among the latents that were learned from.
#[must_use]
pub fn likeliest_known(density: &SequenceDensity) -> Vec<f64> {
    let (dim, known) = (density.dim(), density.mapping.latents());
    let count = known.len() / dim;
    let latent = |n: usize| &known[n * dim..][..dim];
    let fits = density.known_fits();
    let expected: Vec<(Vec<f64>, Vec<f64>, f64)> = (0..count).map(|n| density.step_from(latent(n))).collect();
    let mut scores = fits[0].clone();
    let mut from: Vec<Vec<usize>> = vec![];
    for fit in &fits[1..] {
        let best = |m: usize| {
            let arrive = |n: usize| {
                let (mean, precision, constant) = &expected[n];
                let step = latent(m).iter().zip(mean).zip(precision);
                scores[n] + constant - 0.5 * step.map(|((x, mean), p)| p * (x - mean) * (x - mean)).sum::<f64>()
            };
            match density.link {
                // Nothing links rows: any predecessor will do.
                SequenceLink::None => (0.0, 0),
                _ => (0..count).map(|n| (arrive(n), n)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default(),
            }
        };
        let arrivals: Vec<(f64, usize)> = (0..count).map(best).collect();
        scores = arrivals.iter().zip(fit).map(|((score, _), fit)| score + fit).collect();
        from.push(arrivals.into_iter().map(|(_, n)| n).collect());
    }
    let best = |scores: &[f64]| (0..count).max_by(|&a, &b| scores[a].total_cmp(&scores[b])).unwrap_or_default();
    let mut place = best(&scores);
    let mut path = vec![place];
    for t in (0..from.len()).rev() {
        place = if matches!(density.link, SequenceLink::None) { best(&fits[t]) } else { from[t][place] };
        path.push(place);
    }
    path.into_iter().rev().flat_map(|n| latent(n).to_vec()).collect()
}

/// The mode that is climbed to from a path of latents.
#[must_use]
pub fn climb(density: &SequenceDensity, start: Vec<f64>, steps: usize) -> (Vec<f64>, f64) {
    let mut ascent = density.clone();
    let mut search = Lbfgs::new(&mut ascent, start);
    while search.iterations < steps && search.steepness() > 1e-5 && search.step(&mut ascent) {}
    (search.x, -search.value)
}

/// The posterior of the latents of a sequence.
///
/// # Errors
/// [`Error::NotFinite`] where the density has no finite value at the known latents, [`Error::Singular`] where the curvature at the mode has no factor.
pub fn infer(density: &SequenceDensity, config: &Config, stage: Stage) -> Result<SequencePosterior, Error> {
    let (mode, log_density) = climb(density, likeliest_known(density), config.steps);
    if !log_density.is_finite() {
        return Err(Error::NotFinite);
    }
    let factor = precision_factor(density, &mode)?;
    let length = mode.len();
    let mut normals = vec![Block::ZERO; (config.draws * length).div_ceil(LANES)];
    stage.whole().fill_normal(Isa::baseline(), &mut normals);
    let normals: Vec<f64> = normals.iter().flat_map(|block| block.0).collect();
    let mut moved = Mat::from_fn(length, config.draws, |i, k| normals[k * length + i]);
    // H = L Lᵀ: L⁻ᵀ z has the covariance H⁻¹.
    solve_upper_triangular_in_place(factor.L().transpose(), moved.as_mut(), Par::Seq);
    let draw = |k: usize| mode.iter().enumerate().map(|(i, x)| x + moved[(i, k)]).collect();
    Ok(SequencePosterior { draws: (0..config.draws).map(draw).collect(), mode, log_density })
}

/// Cholesky factor of the precision of the Laplace approximation. Where the curvature is not positive, the jitter ladder adds to its diagonal.
fn precision_factor(density: &SequenceDensity, mode: &[f64]) -> Result<Llt<f64>, Error> {
    let (dim, rows, length) = (density.dim(), density.rows(), mode.len());
    let mut hessian = Mat::<f64>::zeros(length, length);
    let (mut above, mut below) = (vec![0.0; length], vec![0.0; length]);
    for colour in 0..3.min(rows) {
        for j in 0..dim {
            let step = 1e-4 / density.prior.precision[j].sqrt();
            let moved = |sign: f64| {
                let mut x = mode.to_vec();
                (colour..rows).step_by(3).for_each(|t| x[t * dim + j] += sign * step);
                x
            };
            let _ = density.log_density_grad(&moved(1.0), &mut above);
            let _ = density.log_density_grad(&moved(-1.0), &mut below);
            for t in (colour..rows).step_by(3) {
                let (first, last) = (t.saturating_sub(1), (t + 2).min(rows));
                for i in first * dim..last * dim {
                    let slope = (below[i] - above[i]) / (4.0 * step);
                    hessian[(i, t * dim + j)] += slope;
                    hessian[(t * dim + j, i)] += slope;
                }
            }
        }
    }
    let mean = (0..length).map(|i| hessian[(i, i)].abs()).sum::<f64>() / length as f64;
    let mut jitter = 0.0;
    for attempt in 0..8 {
        if let Ok(factor) = hessian.llt(Side::Lower) {
            return Ok(factor);
        }
        let more = 1e-6 * mean * 10.0_f64.powi(attempt) - jitter;
        (0..length).for_each(|i| hessian[(i, i)] += more);
        jitter += more;
    }
    Err(Error::Singular { rows: length, jitter })
}

/// What a posterior says of every output, row by row.
#[must_use]
pub fn predict(density: &SequenceDensity, posterior: &SequencePosterior) -> Vec<Vec<Prediction>> {
    let (mapping, dim, rows) = (&density.mapping, density.dim(), density.rows());
    let outputs = mapping.outputs();
    let share = 1.0 / posterior.draws.len() as f64;
    let (mut mean, mut square) = (vec![0.0; rows * outputs], vec![0.0; rows * outputs]);
    let mut variance = vec![0.0; rows];
    let mut ws = vec![Block::ZERO; mapping.workspace()];
    let mut out = vec![Block::ZERO; outputs];
    for draw in &posterior.draws {
        for first in (0..rows).step_by(LANES) {
            let row = |lane: usize| (first + lane).min(rows - 1);
            let x: Vec<Block> = (0..dim).map(|j| Block(std::array::from_fn(|l| draw[row(l) * dim + j]))).collect();
            mapping.mean_block(&x, Isa::baseline(), &mut out, &mut ws);
            let spread = mapping.variance_block(&x, Isa::baseline(), &mut ws);
            for t in first..rows.min(first + LANES) {
                variance[t] += share * spread.0[t - first];
                for (d, mu) in out.iter().map(|block| block.0[t - first]).enumerate() {
                    mean[t * outputs + d] += share * mu;
                    square[t * outputs + d] += share * mu * mu;
                }
            }
        }
    }
    let prediction = |t: usize, d: usize| {
        let (mean, square, scale) = (mean[t * outputs + d], square[t * outputs + d], mapping.scale()[d]);
        Prediction {
            mean,
            variance: (square - mean * mean).max(0.0) + variance[t] * scale * scale,
            noise: mapping.noise() * scale * scale,
        }
    };
    (0..rows).map(|t| (0..outputs).map(|d| prediction(t, d)).collect()).collect()
}
