//! The posterior of a latent, given some columns of a new row, and what it says of the others.
//!
//! 1. [`LatentDensity`] at all latents that were learned from; from the likeliest, some way apart, L-BFGS to modes
//! 2. a Laplace approximation at each mode (curvature by differences of the gradient): a mixture of normal distributions, shares by their masses
//! 3. draws from that mixture, from one around the known latents by how likely they are (for posteriors that bend along them), and from the prior of latents (for what is far from all of them), with importance weights: the
//!    posterior itself, as long as the effective number of draws is large
//!
//! What is missing is then a mixture of the processes' predictions over the draws: means and variances have the uncertainty of the latent and that of the map in them.

use crate::Error;
use crate::back_constraint::squared_distance;
use crate::inverse::Ascent;
use crate::latent_density::LatentDensity;
use faer::linalg::solvers::SelfAdjointEigen;
use faer::{Mat, Side};
use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::lbfgs::Lbfgs;
use sinew_core::random::Stage;
use sinew_dynamics::factor::cholesky;

/// Degrees of freedom of the Student's t distributions that are drawn from: wider than a normal distribution, so that importance weights stay small.
const FREEDOM: usize = 5;

/// Distance of two starts at least, in units of the spread of all known latents.
const APART: f64 = 0.3;

/// How the posterior is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Latents to climb from.
    pub starts: usize,
    /// Steps of each climb at most.
    pub steps: usize,
    /// Draws.
    pub draws: usize,
}

impl Default for Config {
    fn default() -> Self {
        Self { starts: 8, steps: 60, draws: 400 }
    }
}

/// A mode of the posterior, with its Laplace approximation.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// The latent.
    pub latent: Vec<f64>,
    /// Log density there, without constants.
    pub log_density: f64,
    /// Covariance, q × q, row after row.
    pub covariance: Vec<f64>,
    /// Share of the mass of all modes.
    pub share: f64,
    /// L of covariance = L Lᵀ, row after row.
    root: Vec<f64>,
}

/// The posterior of a latent.
#[derive(Clone, Debug, PartialEq)]
pub struct LatentPosterior {
    /// Modes, the largest share first.
    pub modes: Vec<Mode>,
    /// Draws, rows of q.
    pub draws: Vec<f64>,
    /// Their weights, which sum to 1.
    pub weights: Vec<f64>,
    /// 1 / Σ weights².
    pub effective: f64,
}

/// Mean and variance of an output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Mean, in the output's unit.
    pub mean: f64,
    /// Variance with the uncertainty of the latent and of the map, without white noise, in the square of the output's unit.
    pub variance: f64,
    /// Variance of the white noise, in the same unit.
    pub noise: f64,
}

/// The posterior of a latent under a density.
///
/// # Errors
/// [`Error::NotFinite`] where the density has no finite value at any latent that was learned from, [`Error::Shape`] for no draws.
pub fn infer(density: &LatentDensity, config: &Config, stage: Stage) -> Result<LatentPosterior, Error> {
    if config.draws == 0 {
        return Err(Error::Shape { name: "draws", found: 0, expected: 1 });
    }
    let lanes = Lanes { leaf: density.clone(), isa: Isa::baseline() };
    let known = likelihoods(&lanes);
    let modes = modes(&lanes, &known, config)?;
    let (draws, log_weights) = draw(&lanes, &components(&lanes.leaf, &modes, &known), config.draws, stage);
    let largest = log_weights.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
    let mut weights: Vec<f64> = log_weights.iter().map(|w| (w - largest).exp()).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    let effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
    Ok(LatentPosterior { modes, draws, weights, effective })
}

/// What a posterior says of every output.
#[must_use]
pub fn predict(density: &LatentDensity, posterior: &LatentPosterior) -> Vec<Prediction> {
    let mapping = &density.mapping;
    let outputs = mapping.outputs();
    let (mut mean, mut square, mut variance) = (vec![0.0; outputs], vec![0.0; outputs], 0.0);
    for (x, weight) in posterior.draws.chunks_exact(mapping.dim()).zip(&posterior.weights) {
        variance += weight * mapping.variance_at(x);
        for (d, mu) in mapping.mean_at(x).iter().enumerate() {
            mean[d] += weight * mu;
            square[d] += weight * mu * mu;
        }
    }
    let outputs = mean.iter().zip(&square).zip(mapping.scale());
    let predictions = outputs.map(|((&mean, square), scale)| Prediction {
        mean,
        variance: (square - mean * mean).max(0.0) + variance * scale * scale,
        noise: mapping.noise() * scale * scale,
    });
    predictions.collect()
}

/// Root mean square distance of latents from their mean.
fn spread(latents: &[f64], dim: usize) -> f64 {
    let count = (latents.len() / dim) as f64;
    let coordinate = |j: usize| latents.iter().skip(j).step_by(dim);
    let square = |j: usize| {
        let mean = coordinate(j).sum::<f64>() / count;
        coordinate(j).map(|x| (x - mean).powi(2)).sum::<f64>() / count
    };
    (0..dim).map(square).sum::<f64>().sqrt()
}

/// Log density at every known latent.
fn likelihoods(density: &Lanes<LatentDensity>) -> Vec<f64> {
    let mapping = &density.leaf.mapping;
    mapping.latents().chunks_exact(mapping.dim()).map(|x| density.log_density(x)).collect()
}

/// The modes that are found, with their shares.
fn modes(density: &Lanes<LatentDensity>, known: &[f64], config: &Config) -> Result<Vec<Mode>, Error> {
    let (dim, mapping) = (density.leaf.mapping.dim(), &density.leaf.mapping);
    let mut starts: Vec<(f64, &[f64])> = known.iter().copied().zip(mapping.latents().chunks_exact(dim)).collect();
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let apart = (APART * spread(mapping.latents(), dim)).powi(2);
    let mut ascent = Ascent(density.clone());
    let (mut taken, mut modes): (Vec<&[f64]>, Vec<Mode>) = (vec![], vec![]);
    for (_, start) in starts.into_iter().filter(|(value, _)| value.is_finite()) {
        if taken.len() == config.starts {
            break;
        }
        if taken.iter().any(|other| squared_distance(start, other) < apart) {
            continue;
        }
        taken.push(start);
        let mut search = Lbfgs::new(&mut ascent, start.to_vec());
        while search.iterations < config.steps && search.steepness() > 1e-6 && search.step(&mut ascent) {}
        let mode = laplace(density, &search.x, -search.value)?;
        let is_new = |other: &Mode| {
            let squares = other.latent.iter().zip(&mode.latent).enumerate();
            squares.map(|(j, (a, b))| (a - b).powi(2) / mode.covariance[j * (dim + 1)]).sum::<f64>() > 0.01
        };
        if modes.iter().all(is_new) {
            modes.push(mode);
        }
    }
    let log_mass = |mode: &Mode| mode.log_density + (0..dim).map(|j| mode.root[j * (dim + 1)].ln()).sum::<f64>();
    let largest = modes.iter().map(log_mass).fold(f64::NEG_INFINITY, f64::max);
    if !largest.is_finite() {
        return Err(Error::NotFinite);
    }
    let masses: Vec<f64> = modes.iter().map(|mode| (log_mass(mode) - largest).exp()).collect();
    let sum: f64 = masses.iter().sum();
    modes.iter_mut().zip(masses).for_each(|(mode, mass)| mode.share = mass / sum);
    modes.sort_by(|a, b| b.share.total_cmp(&a.share));
    Ok(modes)
}

/// The Laplace approximation at a mode: its precision by central differences of the gradient, eigenvalues at least a hundredth of the largest of the prior's precision.
fn laplace(density: &Lanes<LatentDensity>, x: &[f64], log_density: f64) -> Result<Mode, Error> {
    let dim = x.len();
    let prior = &density.leaf.prior.precision;
    let (mut hessian, mut moved) = (Mat::<f64>::zeros(dim, dim), x.to_vec());
    let (mut above, mut below) = (vec![0.0; dim], vec![0.0; dim]);
    for j in 0..dim {
        let step = 1e-4 / prior[j].sqrt();
        moved[j] = x[j] + step;
        density.log_density_grad(&moved, &mut above);
        moved[j] = x[j] - step;
        density.log_density_grad(&moved, &mut below);
        moved[j] = x[j];
        for i in 0..dim {
            let slope = (below[i] - above[i]) / (4.0 * step);
            hessian[(i, j)] += slope;
            hessian[(j, i)] += slope;
        }
    }
    let least = 0.01 * prior.iter().fold(0.0, |most: f64, p| most.max(*p));
    let eigen: Option<SelfAdjointEigen<f64>> = hessian.self_adjoint_eigen(Side::Lower).ok();
    let entry = |i: usize, j: usize| match &eigen {
        Some(eigen) => {
            let (values, vectors) = (eigen.S().column_vector(), eigen.U());
            (0..dim).map(|k| vectors[(i, k)] * vectors[(j, k)] / values[k].max(least)).sum()
        }
        None => f64::from(u8::from(i == j)) / prior[i],
    };
    let covariance: Vec<f64> = (0..dim * dim).map(|k| entry((k / dim).max(k % dim), (k / dim).min(k % dim))).collect();
    let root = cholesky("covariance of a mode", &covariance, dim)?.lower;
    Ok(Mode { latent: x.to_vec(), log_density, covariance, share: 0.0, root })
}

/// A Student's t distribution that is drawn from.
struct Component {
    centre: Vec<f64>,
    /// L of its scale matrix L Lᵀ, row after row.
    root: Vec<f64>,
    share: f64,
}

/// Shares of the modes, of the known latents and of the prior.
const SHARES: [f64; 3] = [0.4, 0.4, 0.2];
/// Power of the likelihood that weighs the known latents: below 1, so that the less likely are tried, too.
const TEMPER: f64 = 0.7;
/// Known latents with a smaller share are left out.
const LEAST_SHARE: f64 = 1e-5;

fn components(density: &LatentDensity, modes: &[Mode], known: &[f64]) -> Vec<Component> {
    let (dim, latents) = (density.mapping.dim(), density.mapping.latents());
    let from_mode =
        |mode: &Mode| Component { centre: mode.latent.clone(), root: mode.root.clone(), share: SHARES[0] * mode.share };
    let mut components: Vec<Component> = modes.iter().map(from_mode).collect();
    let diagonal = |sd: &dyn Fn(usize) -> f64| {
        (0..dim * dim).map(|k| if k % (dim + 1) == 0 { sd(k / dim) } else { 0.0 }).collect()
    };
    let largest = known.iter().copied().filter(|log| log.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = known.iter().map(|log| (TEMPER * (log - largest)).exp()).collect();
    let sum: f64 = weights.iter().filter(|weight| weight.is_finite()).sum();
    let width = spacing(latents, dim);
    for (centre, weight) in latents.chunks_exact(dim).zip(weights) {
        if weight / sum > LEAST_SHARE {
            components.push(Component {
                centre: centre.to_vec(),
                root: diagonal(&|_| width),
                share: SHARES[1] * weight / sum,
            });
        }
    }
    let prior = &density.prior;
    let root = diagonal(&|j| prior.precision[j].powf(-0.5));
    components.push(Component { centre: prior.mean.clone(), root, share: SHARES[2] });
    let total: f64 = components.iter().map(|component| component.share).sum();
    components.iter_mut().for_each(|component| component.share /= total);
    components
}

/// Root mean square distance of known latents to the nearest other one.
fn spacing(latents: &[f64], dim: usize) -> f64 {
    let rows: Vec<&[f64]> = latents.chunks_exact(dim).collect();
    let nearest = |(n, a): (usize, &&[f64])| {
        let others = rows.iter().enumerate().filter(|(m, _)| *m != n);
        others.map(|(_, b)| squared_distance(a, b)).fold(f64::INFINITY, f64::min)
    };
    let sum: f64 = rows.iter().enumerate().map(nearest).filter(|square| square.is_finite()).sum();
    (sum / rows.len() as f64).sqrt().max(1e-9)
}

/// Draws from the mixture of Student's t distributions, in turn by their shares, with the logarithms of their importance weights.
fn draw(density: &Lanes<LatentDensity>, mixture: &[Component], count: usize, stage: Stage) -> (Vec<f64>, Vec<f64>) {
    let dim = density.leaf.mapping.dim();
    let mut normals = vec![Block::ZERO; (count * (dim + FREEDOM)).div_ceil(LANES)];
    stage.whole().fill_normal(Isa::baseline(), &mut normals);
    let normals: Vec<f64> = normals.iter().flat_map(|block| block.0).collect();
    let (mut draws, mut log_weights) = (Vec::with_capacity(count * dim), Vec::with_capacity(count));
    for (i, normals) in normals.chunks_exact(dim + FREEDOM).take(count).enumerate() {
        let mut place = (i as f64 + 0.5) / count as f64;
        let chosen = mixture.iter().find(|component| {
            place -= component.share;
            place < 0.0
        });
        let component = chosen.unwrap_or(&mixture[0]);
        let square: f64 = normals[dim..].iter().map(|z| z * z).sum();
        let wide = (FREEDOM as f64 / square).sqrt();
        let x: Vec<f64> = (0..dim)
            .map(|r| {
                component.centre[r] + wide * (0..=r).map(|c| component.root[r * dim + c] * normals[c]).sum::<f64>()
            })
            .collect();
        log_weights.push(density.log_density(&x) - log_proposal(mixture, &x));
        draws.extend(x);
    }
    (draws, log_weights)
}

/// Log density of the mixture, without a constant.
fn log_proposal(mixture: &[Component], x: &[f64]) -> f64 {
    let dim = x.len();
    let sum: f64 = mixture
        .iter()
        .map(|component| {
            let mut solved = vec![0.0; dim];
            for r in 0..dim {
                let below: f64 = (0..r).map(|c| component.root[r * dim + c] * solved[c]).sum();
                solved[r] = (x[r] - component.centre[r] - below) / component.root[r * dim + r];
            }
            let square: f64 = solved.iter().map(|z| z * z).sum();
            let volume: f64 = (0..dim).map(|r| component.root[r * dim + r]).product();
            component.share / volume * (1.0 + square / FREEDOM as f64).powf(-0.5 * (FREEDOM + dim) as f64)
        })
        .sum();
    sum.ln()
}
