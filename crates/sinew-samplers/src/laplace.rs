//! Laplace approximation of a frame's posterior: its mode by Gauss–Newton steps, and a metric from around it.
//!
//! Damped Gauss–Newton steps lead from the middle of the prior to the mode. The metric is the Gauss–Newton matrix plus the prior's precision, averaged over eight draws from around the mode, since curvature at the mode alone makes
//! steps too long for the flanks.

use crate::Error;
use crate::metric::Dense;
use sinew_core::combinators::Sum;
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES, triangle};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::FramePrior;

/// N(mode, G⁻¹): where the posterior's mode lies, and the Gauss–Newton matrix there with the prior's precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Laplace {
    /// The mode.
    pub mode: Vec<f64>,
    /// Whitening of G.
    pub metric: Dense,
}

impl Laplace {
    /// Log density at the mode.
    pub(crate) fn log_peak(&self) -> f64 {
        let d = self.mode.len();
        let log_det: f64 = (0..d).map(|j| self.metric.columns[triangle(j, j)].ln()).sum();
        -0.5 * d as f64 * std::f64::consts::TAU.ln() - log_det
    }

    /// Draws eight states and returns their log densities.
    pub fn sample_block(&self, isa: Isa, out: &mut [Block], rng: &mut BlockRng) -> Block {
        let d = self.mode.len();
        let mut noise = vec![Block::ZERO; d];
        rng.fill_normal(isa, &mut noise);
        let mut log_density = Block::splat(self.log_peak());
        let mut row = &self.metric.rows[..];
        for (i, x) in out.iter_mut().enumerate() {
            let (entries, rest) = row.split_at(d - i);
            row = rest;
            for lane in 0..LANES {
                let move_by: f64 = entries.iter().zip(&noise[i..]).map(|(a, z)| a * z.0[lane]).sum();
                x.0[lane] = self.mode[i] + move_by;
                log_density.0[lane] -= 0.5 * noise[i].0[lane] * noise[i].0[lane];
            }
        }
        log_density
    }
}

/// Mean of `draws` draws of the prior.
fn middle<P: FramePrior>(prior: &P, draws: usize, stage: &Stage) -> Vec<f64> {
    let mut state = vec![Block::ZERO; prior.dim()];
    let mut sum = vec![0.0; prior.dim()];
    let blocks = draws.div_ceil(LANES).max(1);
    for block in 0..blocks {
        prior.sample_block(block, &mut state, &mut stage.block(block as u32));
        for (sum, x) in sum.iter_mut().zip(&state) {
            *sum += x.0.iter().sum::<f64>();
        }
    }
    sum.iter().map(|sum| sum / (blocks * LANES) as f64).collect()
}

/// Most Gauss–Newton steps towards the mode, and most halvings of one.
const STEPS: usize = 4;
const HALVINGS: usize = 4;
/// Gain in log density below which the mode counts as found.
const ENOUGH: f64 = 0.1;

/// Precision of the prior plus the mean of the lanes of a packed Gauss–Newton matrix; lanes with an entry that is not finite are left out.
fn posterior_precision(prior: &[f64], matrix: &[Block], d: usize) -> Vec<f64> {
    let finite: Vec<usize> = (0..LANES).filter(|&lane| matrix.iter().all(|m| m.0[lane].is_finite())).collect();
    let mut whole = prior.to_vec();
    for i in 0..d {
        for j in 0..=i {
            let sum: f64 = finite.iter().map(|&lane| matrix[triangle(i, j)].0[lane]).sum();
            let entry = sum / finite.len().max(1) as f64;
            whole[i * d + j] += entry;
            if i != j {
                whole[j * d + i] += entry;
            }
        }
    }
    whole
}

/// Factors by which the errors of the observations are broadened, one after the other, on the detour to the mode.
const BROADENINGS: [f64; 2] = [16.0, 4.0];

/// Where a climb has got to.
struct Place {
    state: Vec<f64>,
    log_density: f64,
    metric: Dense,
}

/// Scratch of a climb: gradient, packed matrix, workspace.
struct Scratch {
    gradient: Vec<Block>,
    matrix: Vec<Block>,
    ws: Vec<Block>,
}

impl Scratch {
    fn new(d: usize) -> Self {
        Self { gradient: vec![Block::ZERO; d], matrix: vec![Block::ZERO; triangle(d, 0)], ws: vec![] }
    }
}

/// The precision of the posterior at a block of states, as a metric.
fn metric_at<O: GaussNewton + ?Sized>(
    observed: &O,
    precision: &[f64],
    x: &[Block],
    scratch: &mut Scratch,
) -> Result<Dense, Error> {
    observed.gauss_newton_block(x, &mut scratch.matrix, &mut scratch.ws);
    posterior_metric(precision, &scratch.matrix, x.len())
}

/// The metric of the prior's precision and a block of Gauss–Newton matrices; where those are beyond all bounds, as of a point in front of a lens, that of the prior alone.
fn posterior_metric(prior: &[f64], matrix: &[Block], d: usize) -> Result<Dense, Error> {
    Dense::new(&posterior_precision(prior, matrix, d), d).or_else(|_| Dense::new(prior, d))
}

/// Damped Gauss–Newton steps towards a mode of `observed` · `prior`.
fn climb<O: GaussNewton + ?Sized, P: FramePrior>(
    observed: &O,
    prior: &P,
    precision: &[f64],
    start: &[f64],
    scratch: &mut Scratch,
) -> Result<Place, Error> {
    let target = Sum(observed, prior);
    scratch.ws.resize(target.workspace().max(observed.matrix_workspace()).max(scratch.ws.len()), Block::ZERO);
    let mut x: Vec<Block> = start.iter().map(|&x| Block::splat(x)).collect();
    let mut value = target.log_density_grad_block(&x, &mut scratch.gradient, &mut scratch.ws).0[0];
    let mut metric = metric_at(observed, precision, &x, scratch)?;
    for _ in 0..STEPS {
        let direction = metric.solve(&scratch.gradient.iter().map(|g| g.0[0]).collect::<Vec<_>>());
        let before = value;
        for halving in 0..HALVINGS {
            let length = 0.5_f64.powi(halving as i32);
            let next: Vec<Block> = x.iter().zip(&direction).map(|(x, v)| Block::splat(x.0[0] + length * v)).collect();
            let there = target.log_density_grad_block(&next, &mut scratch.gradient, &mut scratch.ws).0[0];
            if there > value {
                (x, value) = (next, there);
                break;
            }
        }
        let gain = value - before;
        if gain.is_nan() || gain <= ENOUGH {
            break;
        }
        metric = metric_at(observed, precision, &x, scratch)?;
    }
    Ok(Place { state: x.iter().map(|x| x.0[0]).collect(), log_density: value, metric })
}

/// The Laplace approximation of a frame's posterior, by damped Gauss–Newton steps from the mean of `draws` draws of the prior. Its matrix is the mean over eight draws from
/// around the mode, since curvature at the mode alone makes steps too long for the flanks.
///
/// A robust likelihood has modes that explain a fast limb as outliers. Where `observed` can be broadened, a second climb goes through its broadened versions first
/// (graduated optimisation; Blake & Zisserman 1987), and the higher of the two ends counts.
///
/// # Errors
/// [`Error::Metric`] where the matrix cannot be factored.
pub fn laplace<O: GaussNewton + ?Sized, P: FramePrior>(
    observed: &O,
    prior: &P,
    draws: usize,
    isa: Isa,
    stage: Stage,
) -> Result<Laplace, Error> {
    let [to_explore, to_average] = stage.split(["explore", "average"]);
    let start = middle(prior, draws, &to_explore);
    let d = start.len();
    let precision = prior.precision();
    let direct = || climb(observed, prior, &precision, &start, &mut Scratch::new(d));
    let detour = || -> Result<Option<Place>, Error> {
        let (mut from, scratch) = (None, &mut Scratch::new(d));
        for factor in BROADENINGS {
            if let Some(broad) = observed.broadened(factor) {
                from = Some(climb(&*broad, prior, &precision, from.as_deref().unwrap_or(&start), scratch)?.state);
            }
        }
        from.map(|from| climb(observed, prior, &precision, &from, scratch)).transpose()
    };
    let (direct, detour) = rayon::join(direct, detour);
    let mut place = direct?;
    if let Some(other) = detour?.filter(|other| other.log_density > place.log_density) {
        place = other;
    }
    let mut laplace = Laplace { mode: place.state, metric: place.metric };
    let mut around = vec![Block::ZERO; d];
    laplace.sample_block(isa, &mut around, &mut to_average.whole());
    let scratch = &mut Scratch::new(d);
    scratch.ws.resize(observed.matrix_workspace(), Block::ZERO);
    observed.weighted_gauss_newton_block(&around, &mut scratch.matrix, &mut scratch.ws);
    laplace.metric = posterior_metric(&precision, &scratch.matrix, d)?;
    Ok(laplace)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws that are made of their block, coordinate and lane.
    struct Numbered;
    impl LogDensity for Numbered {
        fn dim(&self) -> usize {
            2
        }
        fn log_density(&self, _x: &[f64]) -> f64 {
            0.0
        }
    }
    impl GradLogDensity for Numbered {
        fn log_density_grad(&self, _x: &[f64], _grad: &mut [f64]) -> f64 {
            0.0
        }
    }
    impl FramePrior for Numbered {
        fn sample_block(&self, block: usize, out: &mut [Block], _rng: &mut BlockRng) {
            for (j, x) in out.iter_mut().enumerate() {
                x.0 = std::array::from_fn(|lane| 100.0 * block as f64 + 10.0 * j as f64 + lane as f64);
            }
        }
        fn precision_diagonal(&self) -> &[f64] {
            &[1.0, 1.0]
        }
    }

    #[test]
    fn the_middle_is_the_mean_of_whole_blocks() {
        for (draws, blocks_mean) in [(0, 0.0), (8, 0.0), (9, 50.0), (24, 100.0)] {
            assert_eq!(middle(&Numbered, draws, &Stage::new(1, "middle")), [blocks_mean + 3.5, blocks_mean + 13.5]);
        }
    }
}
