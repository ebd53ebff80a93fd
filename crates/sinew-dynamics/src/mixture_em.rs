//! Expectation maximisation (EM) for Gaussian mixtures with full covariances (Dempster, Laird & Rubin 1977).
//!
//! 1. E: r_nk ∝ π_k N(x_n; m_k, S_k), in logarithms; the log likelihood is Σ_n log Σ_k π_k N(x_n; m_k, S_k).
//! 2. Stop where the log likelihood changed by less than a share of itself, and nothing else did.
//! 3. M: n_k = Σ_n r_nk, π_k = n_k / n, m_k = Σ_n r_nk x_n / n_k, S_k = Σ_n r_nk (x_n − m_k)(x_n − m_k)ᵀ / n_k + ridge · I, the ridge being a share of the mean variance of a coordinate of the data.
//! 4. A component with n_k < d + 1 starves: instead of step 3 it is seeded again at the point of lowest likelihood, with the covariance of the data. Each may be so a number of times; of those that starve after that the weaker half is
//!    removed, so that the others may take over their points.
//!
//! The start is k-means++ (Arthur & Vassilvitskii 2007): centres drawn with probability ∝ squared distance to the nearest one before, weights and means of the points nearest to each, the pooled covariance about these means.
//!
//! The log likelihood never falls but after step 4, and by what the ridge costs: without a ridge each iteration is exact. Every number is the same on any number of threads, since sums run over the points in their order.

use crate::Error;
use crate::gaussian::Gaussian;
use crate::pca::{count_rows, mean_and_covariance};
use rayon::prelude::*;
use sinew_core::density::{Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES, set_lane};
use sinew_core::random::Stage;

/// Settings of the algorithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Components to start from.
    pub components: usize,
    /// Iterations at most.
    pub max_iterations: usize,
    /// Change of the log likelihood, as a share of itself, below which it has converged.
    pub tolerance: f64,
    /// What is added to the diagonal of each covariance, as a share of the mean variance of a coordinate.
    pub ridge: f64,
    /// How often a component that starves is seeded again.
    pub max_reseeds: usize,
}

impl Default for Config {
    fn default() -> Self {
        Self { components: 80, max_iterations: 200, tolerance: 1e-6, ridge: 1e-6, max_reseeds: 10 }
    }
}

/// One Gaussian of the mixture.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Share of the mixture.
    pub weight: f64,
    /// Mean, length d.
    pub mean: Vec<f64>,
    /// Covariance, d × d, row after row.
    pub covariance: Vec<f64>,
}

/// What one iteration found and did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iteration {
    /// Log likelihood of all points under the components that the iteration began with.
    pub log_likelihood: f64,
    /// Components that it began with.
    pub components: usize,
    /// Components that it seeded again.
    pub reseeded: usize,
    /// Components that it removed.
    pub removed: usize,
}

/// The mixture with the points' shares in it.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedMixture {
    /// The components.
    pub components: Vec<Component>,
    /// Number of the component with the largest share in each point, the first of equal ones.
    pub nearest: Vec<usize>,
    /// One entry an iteration; the last has the log likelihood of the components above.
    pub iterations: Vec<Iteration>,
    /// Whether it ended by the tolerance and not by the number of iterations.
    pub converged: bool,
}

/// Points in blocks of eight, the last filled up with its last point.
struct Points {
    dim: usize,
    count: usize,
    blocks: Vec<Block>,
    covariance: Vec<f64>,
    ridge: f64,
}

impl Points {
    fn new(rows: &[f64], dim: usize, ridge: f64) -> Result<Self, Error> {
        let count = count_rows("points", rows, dim)?;
        if count <= dim {
            return Err(Error::Shape { name: "points", found: count, expected: dim + 1 });
        }
        if !(ridge >= 0.0 && ridge.is_finite()) {
            let expected = "must be finite and not negative";
            return Err(Error::OutOfRange { name: "ridge", index: 0, value: ridge, expected });
        }
        let mut blocks = vec![Block::ZERO; count.div_ceil(LANES) * dim];
        for n in 0..count.next_multiple_of(LANES) {
            set_lane(&mut blocks[n / LANES * dim..][..dim], n % LANES, &rows[n.min(count - 1) * dim..][..dim]);
        }
        let (_, covariance) = mean_and_covariance(rows, dim);
        let ridge = ridge * (0..dim).map(|j| covariance[j * (dim + 1)]).sum::<f64>() / dim as f64;
        Ok(Self { dim, count, blocks, covariance, ridge })
    }

    fn point(&self, n: usize) -> Vec<f64> {
        self.blocks[n / LANES * self.dim..][..self.dim].iter().map(|b| b.0[n % LANES]).collect()
    }

    /// A component of the points' weighted sums; `shares` has a block for each block of points.
    fn component(&self, shares: impl Iterator<Item = Block> + Clone) -> (f64, Component) {
        let d = self.dim;
        let weighted = || self.blocks.chunks_exact(d).zip(shares.clone()).filter(|(_, share)| *share != Block::ZERO);
        let mut sums = vec![Block::ZERO; 1 + d];
        for (x, share) in weighted() {
            add(&mut sums[0], share, Block::splat(1.0));
            sums[1..].iter_mut().zip(x).for_each(|(sum, x)| add(sum, share, *x));
        }
        let total = |sum: &Block| sum.0.iter().sum::<f64>();
        let count = total(&sums[0]);
        let mean: Vec<f64> = sums[1..].iter().map(|sum| total(sum) / count).collect();
        let (mut products, mut e) = (vec![Block::ZERO; d * d], vec![Block::ZERO; d]);
        for (x, share) in weighted() {
            for ((e, x), mean) in e.iter_mut().zip(x).zip(&mean) {
                *e = Block(x.0.map(|x| x - mean));
            }
            for (i, row) in products.chunks_exact_mut(d).enumerate() {
                let mut scaled = Block::ZERO;
                add(&mut scaled, share, e[i]);
                row[..=i].iter_mut().zip(&e).for_each(|(sum, e)| add(sum, scaled, *e));
            }
        }
        let entry = |i: usize, j: usize| {
            total(&products[i.max(j) * d + i.min(j)]) / count + if i == j { self.ridge } else { 0.0 }
        };
        let covariance = (0..d * d).map(|k| entry(k / d, k % d)).collect();
        (count, Component { weight: count / self.count as f64, mean, covariance })
    }
}

fn add(sum: &mut Block, a: Block, b: Block) {
    for ((sum, a), b) in sum.0.iter_mut().zip(a.0).zip(b.0) {
        *sum += a * b;
    }
}

/// What step 1 finds, point by point.
struct Expectation {
    /// Shares r: for each block of points one block a component; 0 beyond the last point.
    shares: Vec<Block>,
    log_likelihoods: Vec<f64>,
}

fn expectation(points: &Points, components: &[Component]) -> Result<Expectation, Error> {
    let gaussian = |c: &Component| {
        let leaf = Gaussian::new(c.mean.clone(), &c.covariance)?;
        Ok((c.weight.ln(), Lanes { leaf, isa: Isa::baseline() }))
    };
    let gaussians = components.iter().map(gaussian).collect::<Result<Vec<_>, Error>>()?;
    let one_block = |(x, shares): (&[Block], &mut [Block])| -> Block {
        let mut ws = vec![Block::ZERO; points.dim];
        let mut largest = Block::splat(f64::NEG_INFINITY);
        for (share, (log_weight, gaussian)) in shares.iter_mut().zip(&gaussians) {
            *share = Block(gaussian.log_density_block(x, &mut ws).0.map(|value| value + log_weight));
            largest.0.iter_mut().zip(share.0).for_each(|(a, b)| *a = a.max(b));
        }
        let mut sum = Block::ZERO;
        for share in shares.iter_mut() {
            share.0.iter_mut().zip(largest.0).for_each(|(share, largest)| *share = (*share - largest).exp());
            add(&mut sum, *share, Block::splat(1.0));
        }
        for share in shares.iter_mut() {
            share.0.iter_mut().zip(sum.0).for_each(|(share, sum)| *share /= sum);
        }
        Block(core::array::from_fn(|lane| largest.0[lane] + sum.0[lane].ln()))
    };
    let mut shares = vec![Block::ZERO; points.count.div_ceil(LANES) * components.len()];
    let blocks = points.blocks.par_chunks_exact(points.dim).zip(shares.par_chunks_exact_mut(components.len()));
    let values: Vec<Block> = blocks.map(one_block).collect();
    let beyond = values.len() * LANES - points.count;
    let last = shares.len() - components.len();
    shares[last..].iter_mut().for_each(|share| share.0[LANES - beyond..].fill(0.0));
    let log_likelihoods = values.iter().flat_map(|block| block.0).take(points.count).collect();
    Ok(Expectation { shares, log_likelihoods })
}

/// A component with how often it was seeded again.
#[derive(Clone)]
struct Slot {
    component: Component,
    reseeds: usize,
}

/// Steps 3 and 4. The numbers of components seeded again and removed are returned.
fn maximisation(points: &Points, found: &Expectation, slots: &mut Vec<Slot>, max_reseeds: usize) -> (usize, usize) {
    let width = slots.len();
    let least = points.dim as f64 + 1.0;
    let fitted: Vec<(f64, Component)> = (0..width)
        .into_par_iter()
        .map(|k| points.component(found.shares.iter().skip(k).step_by(width).copied()))
        .collect();
    let starves = |k: usize| fitted[k].0 < least;
    let mut exhausted: Vec<usize> = (0..width).filter(|&k| starves(k) && slots[k].reseeds >= max_reseeds).collect();
    exhausted.sort_by(|&a, &b| fitted[a].0.total_cmp(&fitted[b].0));
    exhausted.truncate(exhausted.len().div_ceil(2).min(width - 1));
    let mut worst: Vec<usize> = (0..points.count).collect();
    worst.sort_by(|&a, &b| found.log_likelihoods[a].total_cmp(&found.log_likelihoods[b]));
    let mut reseeded = 0;
    for (k, slot) in slots.iter_mut().enumerate() {
        if starves(k) && slot.reseeds < max_reseeds {
            let mean = points.point(worst[reseeded % worst.len()]);
            let mut covariance = points.covariance.clone();
            (0..points.dim).for_each(|j| covariance[j * (points.dim + 1)] += points.ridge);
            slot.component = Component { weight: 1.0 / width as f64, mean, covariance };
            slot.reseeds += 1;
            reseeded += 1;
        } else if !exhausted.contains(&k) && fitted[k].0 > 0.0 {
            slot.component = fitted[k].1.clone();
        }
    }
    let mut k = 0;
    slots.retain(|_| {
        k += 1;
        !exhausted.contains(&(k - 1))
    });
    if reseeded + exhausted.len() > 0 {
        let sum: f64 = slots.iter().map(|slot| slot.component.weight).sum();
        slots.iter_mut().for_each(|slot| slot.component.weight /= sum);
    }
    (reseeded, exhausted.len())
}

/// The start by k-means++ for rows of length `dim`, at most as many components as there are different rows.
///
/// # Errors
/// [`Error::Shape`] with fewer than d + 1 rows or without components, [`Error::OutOfRange`] for numbers that are not finite.
pub fn start(rows: &[f64], dim: usize, config: &Config, stage: Stage) -> Result<Vec<Component>, Error> {
    let points = Points::new(rows, dim, config.ridge)?;
    if config.components == 0 {
        return Err(Error::Shape { name: "components", found: 0, expected: 1 });
    }
    let mut uniform = vec![Block::ZERO; config.components.div_ceil(LANES)];
    stage.whole().fill_uniform(&mut uniform);
    let mut uniform = uniform.iter().flat_map(|block| block.0);
    let row = |n: usize| &rows[n * dim..][..dim];
    let square = |a: usize, b: usize| row(a).iter().zip(row(b)).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let first = ((uniform.next().unwrap_or(0.5) * points.count as f64) as usize).min(points.count - 1);
    let mut distances: Vec<f64> = (0..points.count).map(|n| square(n, first)).collect();
    let mut owner = vec![0; points.count];
    let mut centres = 1;
    for u in uniform.take(config.components - 1) {
        let total: f64 = distances.iter().sum();
        let mut rest = u * total;
        let drawn = distances.iter().position(|distance| {
            rest -= distance;
            rest < 0.0
        });
        // Rounding may leave a rest behind the last; without distances all rows are centres.
        let Some(centre) = drawn.or_else(|| distances.iter().rposition(|d| *d > 0.0)) else { break };
        for n in 0..points.count {
            let distance = square(n, centre);
            if distance < distances[n] {
                (distances[n], owner[n]) = (distance, centres);
            }
        }
        centres += 1;
    }
    let members = |k: usize| {
        let share = move |n: usize, owner: &[usize]| f64::from(u8::from(owner.get(n) == Some(&k)));
        let owner = &owner;
        (0..points.count.div_ceil(LANES)).map(move |b| Block(core::array::from_fn(|l| share(b * LANES + l, owner))))
    };
    let mut components: Vec<Component> = (0..centres).map(|k| points.component(members(k)).1).collect();
    let mut pooled = vec![0.0; dim * dim];
    for component in &components {
        pooled.iter_mut().zip(&component.covariance).for_each(|(sum, c)| *sum += component.weight * c);
    }
    components.iter_mut().for_each(|component| component.covariance.clone_from(&pooled));
    Ok(components)
}

/// Runs EM on rows of length `dim` from given components; `progress` sees every iteration.
///
/// # Errors
/// [`Error::Shape`] or [`Error::OutOfRange`] for rows and components that do not fit, [`Error::Indefinite`] or [`Error::Singular`] for a covariance without a factor.
pub fn run(
    rows: &[f64],
    dim: usize,
    start: Vec<Component>,
    config: &Config,
    progress: &mut dyn FnMut(&Iteration),
) -> Result<LearnedMixture, Error> {
    let points = Points::new(rows, dim, config.ridge)?;
    if start.is_empty() {
        return Err(Error::Shape { name: "components", found: 0, expected: 1 });
    }
    if let Some(odd) = start.iter().find(|component| component.mean.len() != dim) {
        return Err(Error::Shape { name: "mean of a component", found: odd.mean.len(), expected: dim });
    }
    if let Some(index) = start.iter().position(|component| !(component.weight > 0.0 && component.weight.is_finite())) {
        let (name, expected) = ("weight of a component", "must be positive and finite");
        return Err(Error::OutOfRange { name, index, value: start[index].weight, expected });
    }
    let mut slots: Vec<Slot> = start.into_iter().map(|component| Slot { component, reseeds: 0 }).collect();
    let mut iterations: Vec<Iteration> = Vec::new();
    loop {
        let components: Vec<Component> = slots.iter().map(|slot| slot.component.clone()).collect();
        let found = expectation(&points, &components)?;
        let log_likelihood: f64 = found.log_likelihoods.iter().sum();
        let before = iterations.last().filter(|before| before.reseeded + before.removed == 0);
        let change = before.map(|before| (log_likelihood - before.log_likelihood).abs());
        let converged = change.is_some_and(|change| change < config.tolerance * log_likelihood.abs());
        let ends = converged || iterations.len() >= config.max_iterations;
        let (reseeded, removed) =
            if ends { (0, 0) } else { maximisation(&points, &found, &mut slots, config.max_reseeds) };
        let iteration = Iteration { log_likelihood, components: components.len(), reseeded, removed };
        progress(&iteration);
        iterations.push(iteration);
        if ends {
            let nearest = nearest(&found, components.len());
            return Ok(LearnedMixture { components, nearest, iterations, converged });
        }
    }
}

/// The component with the largest share in each point.
fn nearest(found: &Expectation, width: usize) -> Vec<usize> {
    let largest = |n: usize| {
        let share = |k: usize| found.shares[n / LANES * width + k].0[n % LANES];
        (1..width).fold(0, |best, k| if share(k) > share(best) { k } else { best })
    };
    (0..found.log_likelihoods.len()).map(largest).collect()
}
