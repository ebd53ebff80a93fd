//! Metrics of Hamiltonian Monte Carlo: in which units a trajectory moves.
//!
//! With a metric G (a state-independent guess of the posterior's precision) the momentum is N(0, G) and a trajectory's step η has no unit. In whitened form, with
//! G = L Lᵀ and A = L⁻ᵀ, the momentum is N(0, I) and
//!
//! ```text
//! p ← p + η/2 Aᵀ ∇ log π(x)        x ← x + η A p
//! ```
//!
//! [`Metric::Diagonal`] is Choo & Fleet's component steps (eq. 17): A = diag(1/√h). [`Metric::Dense`] is the full Gauss–Newton matrix plus the prior's precision, at the posterior's
//! mode as found by a few Gauss–Newton steps from the middle of the prior: where coordinates are strongly correlated, as the angles of one limb are, its trajectories
//! need a few steps where the diagonal one needs a hundred. Both are made before the chains start and frozen: a metric that changed with a chain's state would destroy reversibility.

use crate::Error;
use crate::moments;
use faer::{MatRef, Side};
use sinew_core::combinators::Sum;
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES, triangle};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::{FramePrior, Moments};

/// Which metric a frame's chains use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Geometry {
    /// The paper's: a curvature for each coordinate.
    #[default]
    Diagonal,
    /// The full Gauss–Newton matrix.
    Dense,
}

/// A metric.
#[derive(Clone, Debug, PartialEq)]
pub enum Metric {
    /// Curvature h of each coordinate.
    Diagonal(Vec<f64>),
    /// A whole matrix.
    Dense(Dense),
}

/// The upper triangular matrix A = L⁻ᵀ of a metric G = L Lᵀ.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    /// A by columns: those entries that are not zero.
    pub(crate) columns: Vec<f64>,
    /// A by rows.
    pub(crate) rows: Vec<f64>,
    dim: usize,
}

impl Dense {
    /// The whitening of a positive definite matrix, d × d, row after row.
    ///
    /// # Errors
    /// [`Error::Metric`] where it is not positive definite.
    pub fn new(matrix: &[f64], dim: usize) -> Result<Self, Error> {
        if matrix.len() != dim * dim || matrix.iter().any(|x| !x.is_finite()) {
            return Err(Error::Metric);
        }
        let factor = MatRef::from_row_major_slice(matrix, dim, dim).llt(Side::Lower).map_err(|_| Error::Metric)?;
        let mut inverse = faer::Mat::<f64>::identity(dim, dim);
        factor.L().solve_lower_triangular_in_place(inverse.as_mut());
        // A_ij = (L⁻¹)_ji, for i ≤ j.
        let columns = (0..dim).flat_map(|j| (0..=j).map(move |i| (j, i))).map(|(j, i)| inverse[(j, i)]).collect();
        let rows = (0..dim).flat_map(|i| (i..dim).map(move |j| (j, i))).map(|(j, i)| inverse[(j, i)]).collect();
        Ok(Self { columns, rows, dim })
    }

    /// `G⁻¹ b = A Aᵀ b`.
    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let whitened: Vec<f64> = (0..self.dim)
            .map(|j| self.columns[triangle(j, 0)..][..=j].iter().zip(b).map(|(a, b)| a * b).sum())
            .collect();
        let mut row = &self.rows[..];
        (0..self.dim)
            .map(|i| {
                let (entries, rest) = row.split_at(self.dim - i);
                row = rest;
                entries.iter().zip(&whitened[i..]).map(|(a, w)| a * w).sum()
            })
            .collect()
    }

    /// A, whole.
    fn whitening(&self) -> faer::Mat<f64> {
        faer::Mat::from_fn(self.dim, self.dim, |i, j| if i > j { 0.0 } else { self.columns[triangle(j, i)] })
    }

    /// The matrix G itself, row after row: with A = L⁻ᵀ, `G = A⁻ᵀ A⁻¹`.
    pub(crate) fn matrix(&self) -> Vec<f64> {
        let d = self.dim;
        let whitening = self.whitening();
        let mut inverse = faer::Mat::<f64>::identity(d, d);
        whitening.solve_upper_triangular_in_place(inverse.as_mut());
        let product = inverse.transpose() * &inverse;
        (0..d * d).map(|k| product[(k / d, k % d)]).collect()
    }

    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.columns.iter_mut().chain(&mut self.rows).for_each(|a| *a *= factor);
        self
    }

    pub(crate) const fn dim(&self) -> usize {
        self.dim
    }
}

impl Metric {
    /// Shrinks the covariance C of `effective` independent draws towards what it is where the metric's own axes do not covary, and returns λ: with the whitening A,
    ///
    /// ```text
    /// C ← (1 − λ) C + λ A diag(A⁻¹ C A⁻ᵀ) Aᵀ
    /// ```
    ///
    /// A diagonal metric shrinks towards the diagonal ([`moments::shrink`]). A dense one keeps the correlations that it knows: those of a direction that no observation tells come from many coordinates, and without them its variance would
    /// be lost a part in every frame.
    pub fn shrink(&self, moments: &mut Moments, effective: f64) -> f64 {
        let Self::Dense(dense) = self else { return moments::shrink(moments, effective) };
        let d = dense.dim;
        let whitening = dense.whitening();
        let mut whitened = MatRef::from_row_major_slice(&moments.covariance, d, d).to_owned();
        for _ in 0..2 {
            whitening.solve_upper_triangular_in_place(whitened.as_mut());
            whitened = whitened.transpose().to_owned();
        }
        let mut inner =
            Moments { mean: vec![0.0; d], covariance: (0..d * d).map(|k| whitened[(k / d, k % d)]).collect() };
        let lambda = moments::shrink(&mut inner, effective);
        let shrunk = &whitening * MatRef::from_row_major_slice(&inner.covariance, d, d) * whitening.transpose();
        for (k, entry) in moments.covariance.iter_mut().enumerate() {
            // Rounding must not make it asymmetric.
            *entry = 0.5 * (shrunk[(k / d, k % d)] + shrunk[(k % d, k / d)]);
        }
        lambda
    }
}

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

    /// Draws that tell their block, coordinate and lane.
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

    #[test]
    fn a_metric_keeps_the_correlations_that_it_knows() {
        // Precision of x + y is large and that of x − y is 1: draws whose covariance is the metric's inverse are left as they are, whatever their number.
        let precision = [50.5, 49.5, 49.5, 50.5];
        let covariance = [0.505, -0.495, -0.495, 0.505];
        let start = || Moments { mean: vec![0.0; 2], covariance: covariance.to_vec() };
        let metric = Metric::Dense(Dense::new(&precision, 2).expect("positive definite"));
        for effective in [0.0, 2.0, 1e6] {
            let mut known = start();
            assert_eq!(metric.shrink(&mut known, effective), 2.0 / (effective + 2.0));
            assert!(known.covariance.iter().zip(covariance).all(|(a, b)| (a - b).abs() < 1e-12), "{known:?}");
        }
        let (mut plain, mut diagonal, mut unit) = (start(), start(), start());
        moments::shrink(&mut plain, 2.0);
        Metric::Diagonal(vec![3.0, 1.0]).shrink(&mut diagonal, 2.0);
        Metric::Dense(Dense::new(&[4.0, 0.0, 0.0, 0.25], 2).expect("positive definite")).shrink(&mut unit, 2.0);
        assert_eq!(plain, diagonal);
        assert!(plain.covariance.iter().zip(&unit.covariance).all(|(a, b)| (a - b).abs() < 1e-12), "{unit:?}");
        // Of three coordinates, too: the inverse of a metric is kept.
        let dense = Dense::new(&[4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0], 3).expect("positive definite");
        let inverse: Vec<f64> =
            (0..3).flat_map(|i| dense.solve(&[0, 1, 2].map(|j| f64::from(u8::from(i == j))))).collect();
        let mut three = Moments { mean: vec![0.0; 3], covariance: inverse.clone() };
        Metric::Dense(dense).shrink(&mut three, 3.0);
        assert!(three.covariance.iter().zip(inverse).all(|(a, b)| (a - b).abs() < 1e-13), "{three:?}");
        // A covariance that the metric does not know, by the formula: A = L⁻ᵀ with L L ᵀ = G.
        let mut other = Moments { mean: vec![0.0; 2], covariance: vec![4.0, 1.0, 1.0, 1.0] };
        metric.shrink(&mut other, 2.0);
        let l = [50.5_f64.sqrt(), 49.5 / 50.5_f64.sqrt(), (50.5 - 49.5 * 49.5 / 50.5_f64).sqrt()];
        let a = [1.0 / l[0], -l[1] / (l[0] * l[2]), 1.0 / l[2]];
        let w = [4.0 * l[0] * l[0] + 2.0 * l[0] * l[1] + l[1] * l[1], l[2] * l[2]];
        let towards = [a[0] * a[0] * w[0] + a[1] * a[1] * w[1], a[1] * a[2] * w[1], a[2] * a[2] * w[1]];
        for (k, t, c) in [(0, 0, 4.0), (1, 1, 1.0), (2, 1, 1.0), (3, 2, 1.0)] {
            assert!((other.covariance[k] - 0.5 * (c + towards[t])).abs() < 1e-11, "{other:?}");
        }
    }

    #[test]
    fn whitening_undoes_the_metric() {
        let g = [4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0];
        let dense = Dense::new(&g, 3).expect("positive definite");
        let mut a = [[0.0; 3]; 3];
        for j in 0..3 {
            for (i, row) in a.iter_mut().enumerate().take(j + 1) {
                row[j] = dense.columns[triangle(j, i)];
            }
        }
        let mut rows = dense.rows.iter();
        for (i, row) in a.iter().enumerate() {
            assert!(row[i..].iter().eq(rows.by_ref().take(3 - i)));
        }
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| (0..3).map(|l| a[k][i] * g[3 * k + l] * a[l][j]).sum::<f64>()).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        let solved = dense.solve(&[1.0, 2.0, 3.0]);
        for (row, expected) in g.chunks(3).zip([1.0, 2.0, 3.0]) {
            assert!((row.iter().zip(&solved).map(|(g, x)| g * x).sum::<f64>() - expected).abs() < 1e-13);
        }
        assert!(dense.matrix().iter().zip(g).all(|(found, g)| (found - g).abs() < 1e-13));
        assert!(Dense::new(&[1.0, 2.0, 2.0, 1.0], 2).is_err());
        assert!(Dense::new(&[f64::NAN], 1).is_err());
    }
}
