//! Draws of what lasts, g, whose prior has scales that are themselves unknown.
//!
//! The data say −½ gᵀ Λ g + λᵀ g of the p numbers of g ([`crate::lasting`]). The prior comes in clusters: each number i of a cluster is
//!
//! ```text
//! g_i ~ N(m_i, (u_i s / √w)²),   ln s ~ N(ln s₀, σ²) shared by the clusters of that scale,   w ~ Gamma(2, 2) for a cluster with heavy tails, else 1
//! ```
//!
//! with u_i in the units of g. With heavy tails the numbers of a cluster are Student's t with four degrees of freedom together: one camera that was moved is off by more than the others. Scales are integrated, never set to an estimate: few numbers tell them.
//!
//! Gibbs sampling, one sweep:
//!
//! 1. g | s, w: normal
//! 2. w | g, s ~ Gamma(2 + n/2, 2 + ½ Σ ((g_i − m_i)/(u_i s))²)
//! 3. ln s | g, w on a grid, at a random place within the cell
//! 4. ln s | (g − m)/s, w on the same grid: all deviations of that scale grow with it (Papaspiliopoulos, Roberts & Sköld 2007; Yu & Meng 2011). Without it a scale of which the data say nothing would hardly move.
//! 5. ln s and all w of that scale, where sizes s/√w stay, on the same grid (a generalised Gibbs step, Liu & Sabatti 2000): a larger scale with larger weights says the same of g.

use crate::Error;
use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, MatRef, Side};
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use std::ops::Range;

/// Prior of a scale: ln s ~ N(ln `median`, `log_sd`²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalePrior {
    /// Median.
    pub median: f64,
    /// Standard deviation of the logarithm.
    pub log_sd: f64,
}

/// Numbers of g whose prior has one size.
#[derive(Clone, Debug, PartialEq)]
pub struct PriorCluster {
    /// Place in g, mean m and unit u of each number.
    pub numbers: Vec<(usize, f64, f64)>,
    /// Which scale multiplies the units; `None` where they are the standard deviations.
    pub scale: Option<usize>,
    /// Whether the cluster may be far off as a whole.
    pub heavy_tails: bool,
    /// How many of its numbers are equal to another one by definition, which the data say: they tell nothing more of the scale.
    pub tied: usize,
}

/// The prior of g.
#[derive(Clone, Debug, PartialEq)]
pub struct LastingPrior {
    /// Every number of g is in one cluster.
    pub clusters: Vec<PriorCluster>,
    /// The scales.
    pub scales: Vec<ScalePrior>,
}

/// What the data say of g.
#[derive(Clone, Debug, PartialEq)]
pub struct LastingData {
    /// Λ, p × p, row after row.
    pub information: Vec<f64>,
    /// λ, length p.
    pub pull: Vec<f64>,
}

/// How to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SweepSchedule {
    /// Draws.
    pub draws: usize,
    /// Sweeps before the first.
    pub burn_in: usize,
    /// Sweeps from each draw to the next.
    pub apart: usize,
}

impl Default for SweepSchedule {
    fn default() -> Self {
        Self { draws: 128, burn_in: 40, apart: 4 }
    }
}

/// Draws of g and of the scales.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LastingDraws {
    /// Mean of g: of its conditional means, over all sweeps after the first.
    pub mean: Vec<f64>,
    /// Draws of g.
    pub errors: Vec<Vec<f64>>,
    /// Scales of each draw.
    pub scales: Vec<Vec<f64>>,
}

/// Cells of the grid of ln s, and how far it reaches from the middle in standard deviations of the prior.
const CELLS: usize = 240;
const REACH: f64 = 5.0;
/// Shape and rate of the prior of a cluster's weight.
const HEAVY: f64 = 2.0;
/// Random normals and uniforms that a number of a cluster may need.
const LUCK: usize = 4;

/// Precision with which a number is held, over that of its unit.
const HOLD: f64 = 1e12;

/// Numbers of g of which the draws are known from elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldDraws {
    /// Their places.
    pub places: Range<usize>,
    /// Their values in each draw.
    pub draws: Vec<Vec<f64>>,
}

impl HeldDraws {
    /// Their means.
    #[must_use]
    pub fn mean(&self) -> Vec<f64> {
        let mean = |place: usize| self.draws.iter().map(|draw| draw[place]).sum::<f64>() / self.draws.len() as f64;
        (0..self.places.len()).map(mean).collect()
    }
}

/// Sums over j of `row[j] x_j` for each row, in the order of the (j, x_j): several rows at once, whose sums do not wait for each other.
fn products(rows: &[&[f64]], x: impl Iterator<Item = (usize, f64)> + Clone) -> Vec<f64> {
    let mut found = Vec::with_capacity(rows.len());
    let mut chunks = rows.chunks_exact(8);
    for rows in &mut chunks {
        let rows: [&[f64]; 8] = std::array::from_fn(|i| rows[i]);
        let mut sums = [0.0; 8];
        for (j, x) in x.clone() {
            sums.iter_mut().zip(rows).for_each(|(sum, row)| *sum += row[j] * x);
        }
        found.extend(sums);
    }
    found.extend(chunks.remainder().iter().map(|row| x.clone().map(|(j, x)| row[j] * x).sum::<f64>()));
    found
}

/// State of the sampler.
struct Sweep<'a> {
    prior: &'a LastingPrior,
    /// Numbers that stay where they are, by place.
    held: Vec<Option<f64>>,
    data: &'a LastingData,
    information: MatRef<'a, f64>,
    g: Vec<f64>,
    log_scales: Vec<f64>,
    weights: Vec<f64>,
}

/// Random numbers, one after the other.
struct Luck(std::vec::IntoIter<f64>);

impl Luck {
    fn take(&mut self) -> f64 {
        self.0.next().unwrap_or(0.5)
    }
}

fn lucks(stage: &Stage, sweep: usize, count: usize) -> [Luck; 2] {
    let mut rng = stage.round(sweep).whole();
    let mut blocks = vec![Block::ZERO; count.div_ceil(8)];
    rng.fill_normal(Isa::baseline(), &mut blocks);
    let normal: Vec<f64> = blocks.iter().flat_map(|block| block.0).collect();
    rng.fill_uniform(&mut blocks);
    let uniform: Vec<f64> = blocks.iter().flat_map(|block| block.0).collect();
    [Luck(normal.into_iter()), Luck(uniform.into_iter())]
}

/// Draws g and its scales.
///
/// # Errors
/// [`Error::Shape`] for a matrix of another size or a prior that does not have every number once, [`Error::OutOfRange`] for one that is not positive, [`Error::Indefinite`] where Λ is not a covariance's inverse.
pub fn draws(
    data: &LastingData,
    prior: &LastingPrior,
    schedule: SweepSchedule,
    stage: Stage,
) -> Result<LastingDraws, Error> {
    draws_given(data, prior, schedule, stage, None)
}

/// Draws of the other numbers of g, where draw i of some is known: draw i belongs to it, in turn where there are fewer.
///
/// # Errors
/// As [`draws`].
pub fn draws_given(
    data: &LastingData,
    prior: &LastingPrior,
    schedule: SweepSchedule,
    stage: Stage,
    held: Option<&HeldDraws>,
) -> Result<LastingDraws, Error> {
    let p = data.pull.len();
    let mut sweep = Sweep::new(data, prior)?;
    let mut found = LastingDraws { mean: vec![0.0; p], ..LastingDraws::default() };
    let after = schedule.draws * schedule.apart.max(1);
    for round in 0..schedule.burn_in + after {
        let since = round.checked_sub(schedule.burn_in);
        if let Some(held) = held {
            // From one draw to the next all sweeps are at the values of the next.
            let draw = since.unwrap_or(0).div_ceil(schedule.apart.max(1));
            held.draws.get(draw % held.draws.len().max(1)).into_iter().for_each(|g| sweep.hold(&held.places, g));
        }
        let [mut normal, mut uniform] = lucks(&stage, round, LUCK * (p + 8) + 8 * prior.scales.len());
        let mean = sweep.draw_errors(&mut normal)?;
        sweep.draw_weights(&mut normal, &mut uniform);
        (0..prior.scales.len()).for_each(|scale| sweep.draw_scale(scale, &mut uniform));
        if let Some(since) = since {
            found.mean.iter_mut().zip(&mean).for_each(|(sum, mean)| *sum += mean / after as f64);
            if since % schedule.apart.max(1) == 0 {
                found.errors.push(sweep.g.clone());
                found.scales.push(sweep.log_scales.iter().map(|log| log.exp()).collect());
            }
        }
    }
    Ok(found)
}

/// Mean of g where its scales are these, no cluster is far off, and numbers that are held are at their means. Unlike the mean over draws it is not moved by the few in which a scale of which the data say little is large.
///
/// # Errors
/// As [`draws`].
pub fn mean_at(
    data: &LastingData,
    prior: &LastingPrior,
    scales: &[f64],
    held: Option<&HeldDraws>,
) -> Result<Vec<f64>, Error> {
    let mut sweep = Sweep::new(data, prior)?;
    held.into_iter().for_each(|held| sweep.hold(&held.places, &held.mean()));
    sweep.log_scales = scales.iter().map(|scale| scale.ln()).collect();
    Ok(sweep.conditional()?.0)
}

fn check(data: &LastingData, prior: &LastingPrior, p: usize) -> Result<(), Error> {
    let wrong = |name, found, expected| Err(Error::Shape { name, found, expected });
    if data.information.len() != p * p {
        return wrong("information of what lasts", data.information.len(), p * p);
    }
    let mut known = vec![0; p];
    for (place, _, unit) in prior.clusters.iter().flat_map(|cluster| &cluster.numbers) {
        if *unit <= 0.0 || !unit.is_finite() {
            let (name, index, value) = ("unit of what lasts", *place, *unit);
            return Err(Error::OutOfRange { name, index, value, expected: "must be positive" });
        }
        known.get_mut(*place).into_iter().for_each(|count| *count += 1);
    }
    match known.iter().position(|count| *count != 1) {
        Some(place) => wrong("clusters of a number of what lasts", known[place], 1),
        None => Ok(()),
    }
}

impl<'a> Sweep<'a> {
    /// A sampler that stands at g = 0 and the medians of the scales.
    fn new(data: &'a LastingData, prior: &'a LastingPrior) -> Result<Self, Error> {
        let p = data.pull.len();
        check(data, prior, p)?;
        Ok(Self {
            prior,
            data,
            // Symmetric: the order of its entries does not matter.
            information: MatRef::from_column_major_slice(&data.information, p, p),
            held: vec![None; p],
            g: vec![0.0; p],
            log_scales: prior.scales.iter().map(|scale| scale.median.ln()).collect(),
            weights: vec![1.0; prior.clusters.len()],
        })
    }

    /// Holds numbers at their values.
    fn hold(&mut self, places: &Range<usize>, values: &[f64]) {
        places.clone().zip(values).for_each(|(place, value)| self.held[place] = Some(*value));
    }

    /// Standard deviation of a cluster's numbers over their units.
    fn size(&self, cluster: usize) -> f64 {
        let log_scale = self.prior.clusters[cluster].scale.map_or(0.0, |scale| self.log_scales[scale]);
        log_scale.exp() / self.weights[cluster].sqrt()
    }

    /// Mean of g at the scales and weights, and the factor of its precision.
    fn conditional(&self) -> Result<(Vec<f64>, Llt<f64>), Error> {
        let p = self.g.len();
        let mut matrix = self.information.to_owned();
        let mut right = Mat::from_fn(p, 1, |i, _| self.data.pull[i]);
        for (index, cluster) in self.prior.clusters.iter().enumerate() {
            let size = self.size(index);
            for &(place, mean, unit) in &cluster.numbers {
                let precision = (unit * size).powi(-2);
                matrix[(place, place)] += precision;
                right[(place, 0)] += precision * mean;
                if let Some(value) = self.held[place] {
                    matrix[(place, place)] += HOLD * unit.powi(-2);
                    right[(place, 0)] += HOLD * unit.powi(-2) * value;
                }
            }
        }
        let Ok(factor) = matrix.llt(Side::Lower) else {
            return Err(Error::Indefinite { name: "information of what lasts", smallest: f64::NAN });
        };
        let mean = factor.solve(&right);
        Ok(((0..p).map(|i| mean[(i, 0)]).collect(), factor))
    }

    /// Draws g, and gives its conditional mean.
    fn draw_errors(&mut self, normal: &mut Luck) -> Result<Vec<f64>, Error> {
        let (mean, factor) = self.conditional()?;
        let mut away = Mat::from_fn(mean.len(), 1, |_, _| normal.take());
        factor.L().transpose().solve_upper_triangular_in_place(away.as_mut());
        let drawn = |(i, mean): (usize, &f64)| self.held[i].unwrap_or(mean + away[(i, 0)]);
        self.g = mean.iter().enumerate().map(drawn).collect();
        Ok(mean)
    }

    /// Sum of the squared deviations of a cluster over their units.
    fn squares(&self, cluster: &PriorCluster) -> f64 {
        cluster.numbers.iter().map(|&(place, mean, unit)| ((self.g[place] - mean) / unit).powi(2)).sum()
    }

    /// Row of Λ.
    fn row(&self, place: usize) -> &[f64] {
        let p = self.g.len();
        &self.data.information[place * p..][..p]
    }

    fn draw_weights(&mut self, normal: &mut Luck, uniform: &mut Luck) {
        for (index, cluster) in self.prior.clusters.iter().enumerate().filter(|(_, cluster)| cluster.heavy_tails) {
            let log_scale = cluster.scale.map_or(0.0, |scale| self.log_scales[scale]);
            let rate = HEAVY + 0.5 * self.squares(cluster) * (-2.0 * log_scale).exp();
            // Gamma(2 + n/2): two exponentials and half of n squared normals.
            let exponentials: f64 = (0..2).map(|_| -(1.0 - uniform.take()).ln()).sum();
            let halves: f64 = cluster.numbers.iter().map(|_| 0.5 * normal.take().powi(2)).sum();
            self.weights[index] = (exponentials + halves) / rate;
        }
    }

    fn draw_scale(&mut self, scale: usize, uniform: &mut Luck) {
        let prior = self.prior.scales[scale];
        let (middle, sd) = (prior.median.ln(), prior.log_sd);
        let mut draw = |log_density: &dyn Fn(f64) -> f64| {
            let place = |cell: f64| middle + REACH * sd * (2.0 * cell / CELLS as f64 - 1.0);
            let log = |cell: usize| {
                let x = place(cell as f64 + 0.5);
                log_density(x) - 0.5 * ((x - middle) / sd).powi(2)
            };
            let logs: [f64; CELLS] = std::array::from_fn(log);
            let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let shares = logs.map(|log| (log - largest).exp());
            let mut left = uniform.take() * shares.iter().sum::<f64>();
            let cell = shares.iter().position(|share| {
                left -= share;
                left <= 0.0
            });
            place(cell.unwrap_or(CELLS - 1) as f64 + uniform.take())
        };
        let own = |(_, cluster): &(usize, &PriorCluster)| cluster.scale == Some(scale);
        let clusters = || self.prior.clusters.iter().enumerate().filter(own);
        let tied: f64 = clusters().map(|(_, cluster)| cluster.tied as f64).sum();
        let count: f64 = clusters().map(|(_, cluster)| cluster.numbers.len() as f64).sum::<f64>() - tied;
        let squares: f64 = clusters().map(|(index, cluster)| self.weights[index] * self.squares(cluster)).sum();
        let now = draw(&|x| -count * x - 0.5 * squares * (-2.0 * x).exp());
        // g = rest + k v, with v the deviations of this scale and k = s' / s.
        let mut deviations: Vec<(usize, f64, f64)> = vec![];
        for (_, cluster) in clusters() {
            deviations.extend(cluster.numbers.iter().map(|&(place, mean, _)| (place, mean, self.g[place] - mean)));
        }
        if deviations.iter().any(|&(place, ..)| self.held[place].is_some()) {
            // Known values do not grow with their scale.
            self.log_scales[scale] = now;
            return;
        }
        let rows: Vec<&[f64]> = deviations.iter().map(|&(place, ..)| self.row(place)).collect();
        let own_deviations = || deviations.iter().map(|&(place, _, deviation)| (place, deviation));
        let against = products(&rows, own_deviations());
        let all = products(&rows, self.g.iter().copied().enumerate());
        let (mut curvature, mut slope) = (0.0, 0.0);
        for (i, (place, deviation)) in own_deviations().enumerate() {
            curvature += deviation * against[i];
            slope += deviation * (self.data.pull[place] - all[i] + against[i]);
        }
        let next = draw(&|x| {
            let k = (x - now).exp();
            tied * x + slope * k - 0.5 * curvature * k * k
        });
        let grown = (next - now).exp();
        for (place, mean, deviation) in deviations {
            self.g[place] = mean + grown * deviation;
        }
        self.log_scales[scale] = next;
        if clusters().all(|(_, cluster)| cluster.heavy_tails) {
            let own: Vec<usize> = clusters().map(|(index, _)| index).collect();
            let (count, sum) = (own.len() as f64, own.iter().map(|&index| self.weights[index]).sum::<f64>());
            // Density of ln w, where w ~ Gamma(2, 2) grows with s².
            let last = draw(&|x| HEAVY * (2.0 * count * x - sum * (2.0 * (x - next)).exp()));
            own.iter().for_each(|&index| self.weights[index] *= (2.0 * (last - next)).exp());
            self.log_scales[scale] = last;
        }
    }
}

/// Numbers of g that stand one after the other, with mean 0 and one unit.
#[must_use]
pub fn alike(places: Range<usize>, unit: f64) -> Vec<(usize, f64, f64)> {
    places.map(|place| (place, 0.0, unit)).collect()
}
