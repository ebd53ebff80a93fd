//! Latent models fill in missing columns.
//!
//! They learn from every few rows of the training sequences; latents of the new sequence are found row by row or together.

use super::task::{COLUMNS, Outcome, Row, Task};
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew_latent::covariance::Covariance;
use sinew_latent::gplvm;
use sinew_latent::inference::{self, Prediction};
use sinew_latent::latent_density::{LatentDensity, LatentPrior};
use sinew_latent::mapping::Mapping;
use sinew_latent::model::{LatentModel, RootPrior};
use sinew_latent::motion::{LatentMotion, StepNoise};
use sinew_latent::outputs::Preparation;
use sinew_latent::sequence;
use sinew_latent::sequence_density::{SequenceDensity, SequenceLink};
use sinew_latent::training::{self, Training};
use std::sync::Arc;

/// What is learned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Coordinates of a latent.
    pub dim: usize,
    /// Whether each column has its own scale W.
    pub weights: bool,
    /// Whether latents have dynamics with λ = D/q; else they are N(0, I).
    pub dynamics: bool,
    /// Whether latents are a smooth function of the rows; then its ridge.
    pub back: Option<f64>,
    /// Rows from one to the next that is learned from.
    pub every: usize,
    /// Steps of learning.
    pub steps: usize,
}

/// How latents of a sequence are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rows {
    /// Row by row, the mode with its Laplace approximation.
    Mode,
    /// Row by row, the posterior by importance sampling.
    Posterior,
    /// Together, steps from row to row as large as in training, this much heavier.
    Walk(f64),
    /// Together, with the dynamics of the model and this λ: rows as far apart as in learning are a sequence by themselves.
    Dynamics(f64),
}

/// Steps and draws for a sequence.
const SEQUENCE: sequence::Config = sequence::Config { steps: 60, draws: 16 };
/// Starts, steps and draws for a row.
const ROW: inference::Config = inference::Config { starts: 3, steps: 40, draws: 200 };

/// A learned model.
pub struct Learned {
    model: LatentModel,
    mapping: Arc<Mapping>,
    prior: LatentPrior,
    every: usize,
}

/// A model of the sequences.
///
/// # Errors
/// Rows or covariances that do not allow it.
pub fn learn(training: &[&[Row]], config: &Config) -> Outcome<Learned> {
    let rows: Row = training.iter().flat_map(|rows| rows.iter().step_by(config.every)).flatten().copied().collect();
    let small = (-2.0_f64).exp();
    let covariance = Covariance { variance: 1.0, inverse_width: 1.0, linear: 0.0, bias: small, white: small };
    let dynamics = Covariance { variance: 0.1, inverse_width: 1.0, linear: 0.9, bias: 0.0, white: 0.1 };
    let balance = COLUMNS as f64 / config.dim as f64;
    let prior = match config.dynamics {
        true => RootPrior::Dynamics { covariance: dynamics, learned: dynamics.present(), balance },
        false => RootPrior::Normal,
    };
    let start =
        gplvm::Config { dim: config.dim, preparation: Preparation::Standardised, covariance, prior, back: config.back };
    let mut model = gplvm::model(&rows, COLUMNS, &start)?;
    model.sequences = training.iter().map(|rows| rows.len().div_ceil(config.every)).collect();
    if config.weights {
        // v is in W.
        model.kappa = Some(1000.0);
        model.nodes[0].learned[0] = false;
    }
    let steps = training::Config { steps: config.steps, ..Default::default() };
    let mut learning = Training::new(model, steps, Isa::best())?;
    learning.run(|_| true);
    let model = learning.into_model();
    let (mapping, prior) = (Arc::new(Mapping::new(&model, 0)?), LatentPrior::of(&model, 0));
    Ok(Learned { model, mapping, prior, every: config.every })
}

impl Learned {
    /// Precisions of the steps of latents from row to row, from those in training.
    fn step_precisions(&self) -> Vec<f64> {
        let (node, mut squares, mut start, mut count) =
            (&self.model.nodes[0], vec![0.0; self.prior.mean.len()], 0, 0.0);
        for &length in &self.model.sequences {
            for row in start + 1..start + length {
                let steps = node.latent(row).iter().zip(node.latent(row - 1));
                squares.iter_mut().zip(steps).for_each(|(sum, (a, b))| *sum += (a - b).powi(2));
                count += 1.0;
            }
            start += length;
        }
        squares.into_iter().map(|sum| (self.every as f64).powi(2) * count / sum).collect()
    }

    /// What is said of every column of rows from `from` on, one in `every`.
    fn together(&self, task: &Task<'_>, link: SequenceLink, balance: f64, from: usize, every: usize) -> Outcome<Said> {
        let places: Vec<usize> = (from..task.sequence.len()).step_by(every).collect();
        let seen = |t: usize, j: usize| t < task.first || !task.missing.contains(&j);
        let row = |&t: &usize| (0..COLUMNS).filter(|&j| seen(t, j)).map(|j| (j, task.sequence[t][j])).collect();
        let observed: Vec<Vec<(usize, f64)>> = places.iter().map(row).collect();
        let (mapping, prior, isa) = (self.mapping.clone(), self.prior.clone(), Isa::best());
        let density = SequenceDensity::new(mapping, prior, link, balance, &observed, isa)?;
        let found = sequence::infer(&density, &SEQUENCE, Stage::new(1, "missing limbs, sequence"))?;
        Ok(places.into_iter().zip(sequence::predict(&density, &found)).filter(|(t, _)| *t >= task.first).collect())
    }

    /// One row's posterior by importance sampling.
    fn alone(&self, task: &Task<'_>, t: usize) -> Outcome<Vec<Prediction>> {
        let observed = task.observed().into_iter().map(|j| (j, task.sequence[t][j])).collect();
        let density = LatentDensity::given(self.mapping.clone(), self.prior.clone(), observed)?;
        let stage = Stage::new(t as u64, "missing limbs, row");
        let posterior = inference::infer(&density, &ROW, stage)?;
        Ok(inference::predict(&density, &posterior))
    }

    /// What is said of every column of the judged rows.
    ///
    /// # Errors
    /// Posteriors that are not finite, dynamics of a model without any.
    pub fn fill(&self, task: &Task<'_>, rows: Rows) -> Outcome<Vec<Vec<Prediction>>> {
        let mut said: Said = match rows {
            Rows::Mode => self.together(task, SequenceLink::None, 1.0, task.first, 1)?,
            Rows::Posterior => {
                let judged = task.first..task.sequence.len();
                judged.map(|t| Ok((t, self.alone(task, t)?))).collect::<Outcome<_>>()?
            }
            Rows::Walk(balance) => self.together(task, SequenceLink::Walk(self.step_precisions()), balance, 0, 1)?,
            Rows::Dynamics(balance) => {
                let motion = LatentMotion::new(&self.model, 0, StepNoise::Predicted, Isa::best())?;
                let link = || SequenceLink::Dynamics(motion.clone());
                let parts = (0..self.every).map(|from| self.together(task, link(), balance, from, self.every));
                parts.collect::<Outcome<Vec<_>>>()?.concat()
            }
        };
        said.sort_by_key(|(t, _)| *t);
        Ok(said.into_iter().map(|(_, predictions)| predictions).collect())
    }
}

/// Rows by their place in the sequence, and what is said of their columns.
type Said = Vec<(usize, Vec<Prediction>)>;

/// Rows of means.
#[must_use]
pub fn means(said: &[Vec<Prediction>]) -> Vec<Row> {
    said.iter().map(|row| row.iter().map(|prediction| prediction.mean).collect()).collect()
}

/// Half widths of the intervals below in standard deviations of a normal distribution.
pub const INTERVALS: [(f64, f64); 4] = [(50.0, 0.674_49), (80.0, 1.281_55), (90.0, 1.644_85), (95.0, 1.959_96)];

/// Shares of the missing numbers that lie within the intervals of [`INTERVALS`].
#[must_use]
pub fn covered(task: &Task<'_>, said: &[Vec<Prediction>]) -> [f64; 4] {
    let rows = task.judged().iter().zip(said);
    let away = rows.flat_map(|(truth, said)| {
        let of = |j: usize| (truth[j] - said[j].mean).abs() / (said[j].variance + said[j].noise).sqrt();
        task.missing.clone().map(of)
    });
    let away: Vec<f64> = away.collect();
    INTERVALS.map(|(_, width)| away.iter().filter(|z| **z < width).count() as f64 / away.len() as f64)
}
