//! How well action primitives predict motion that they were not learned from, beside two simple predictions.
//!
//! All errors are root mean squares over steps and coordinates, in the units of the coordinates (radians for angles). Each step is predicted from the D true feature vectors before it.

use crate::Error;
use crate::primitives::matching::Matcher;
use crate::primitives::model::Primitives;
use crate::primitives::windows::windows;
use core::fmt;
use sinew_core::lanes::{Block, Isa};

/// Errors of one-step predictions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictionErrors {
    /// Steps that were predicted.
    pub steps: usize,
    /// Mean of model (6): what follows in the cluster.
    pub next: f64,
    /// Mean of model (7): the step that follows in the cluster.
    pub step: f64,
    /// Mean of the three models in equal parts, the expectation of the switching model.
    pub switching: f64,
    /// No change, the mean of a random walk.
    pub no_change: f64,
    /// The last change again; none where an action primitive has one feature vector.
    pub constant_velocity: Option<f64>,
    /// What the principal components of matching lose of an action primitive.
    pub reconstruction: f64,
}

/// What learning made of one feature vector.
#[derive(Clone, Debug, PartialEq)]
pub struct PrimitiveSummary {
    /// Name of the feature vector.
    pub feature: String,
    /// Its coordinates.
    pub coordinates: usize,
    /// Windows that it was learned from.
    pub windows: usize,
    /// Clusters that were requested.
    pub requested: usize,
    /// Clusters that have windows.
    pub clusters: usize,
    /// Clusters with at least ten windows.
    pub well_filled: usize,
    /// Share of the variance of the windows in the clustering space.
    pub share: f64,
    /// Errors on motion that was held out, in the order of [`PredictionErrors`].
    pub held_out: Option<PredictionErrors>,
}

/// Windows from which on a cluster counts as well filled.
const WELL_FILLED: usize = 10;

/// Predicts every step of some sequences, rows of length `dim`; none where no sequence is longer than an action primitive.
///
/// # Errors
/// [`Error::Shape`] or [`Error::OutOfRange`] for rows that are none, and as [`Matcher::new`].
pub fn prediction_errors(
    primitives: &Primitives,
    sequences: &[Vec<f64>],
    dim: usize,
) -> Result<Option<PredictionErrors>, Error> {
    let features = primitives.feature.coordinates.len();
    let matcher = Matcher::new(primitives, Isa::baseline())?;
    let past = matcher.older_len() + features;
    let found = windows(sequences, dim, &primitives.feature.coordinates, past / features)?;
    if found.is_empty() {
        return Ok(None);
    }
    let mut squares = [0.0; 6];
    for row in found.rows.chunks_exact(found.dim) {
        let (action, truth) = row.split_at(past);
        let (older, own) = action.split_at(past - features);
        let block: Vec<Block> = own.iter().map(|&x| Block::splat(x)).collect();
        let cluster = &primitives.clusters[matcher.nearest_block(older, &block)[0]];
        for (j, truth) in truth.iter().enumerate() {
            let (next, step) = (cluster.next.mean[j], own[j] + cluster.step.mean[j]);
            let before = older.len().checked_sub(features).map_or(own[j], |last| older[last + j]);
            let guesses = [next, step, (next + step + own[j]) / 3.0, own[j], 2.0 * own[j] - before];
            squares.iter_mut().zip(guesses).for_each(|(sum, guess)| *sum += (guess - truth).powi(2));
        }
        let back = primitives.pca.reconstruct(&primitives.pca.project(action));
        squares[5] +=
            action.iter().zip(back).map(|(a, b)| (a - b).powi(2)).sum::<f64>() * features as f64 / past as f64;
    }
    let steps = found.len();
    let [next, step, switching, no_change, velocity, reconstruction] =
        squares.map(|square| (square / (steps * features) as f64).sqrt());
    let constant_velocity = (past > features).then_some(velocity);
    Ok(Some(PredictionErrors { steps, next, step, switching, no_change, constant_velocity, reconstruction }))
}

/// Summary of one feature vector, with its errors on sequences that were held out, rows of length `dim`.
///
/// # Errors
/// As [`prediction_errors`].
pub fn summary(primitives: &Primitives, held_out: &[Vec<f64>], dim: usize) -> Result<PrimitiveSummary, Error> {
    let filled = primitives.clusters.iter().filter(|cluster| cluster.members >= WELL_FILLED);
    Ok(PrimitiveSummary {
        feature: primitives.feature.name.clone(),
        coordinates: primitives.feature.coordinates.len(),
        windows: primitives.windows(),
        requested: primitives.clustering.requested,
        clusters: primitives.clusters.len(),
        well_filled: filled.count(),
        share: primitives.clustering.share,
        held_out: prediction_errors(primitives, held_out, dim)?,
    })
}

impl fmt::Display for PrimitiveSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { feature, coordinates, windows, requested, clusters, well_filled, share, held_out } = self;
        write!(
            f,
            "{feature}: {coordinates} coordinates, {windows} windows, {clusters} of {requested} clusters \
             ({well_filled} with {WELL_FILLED} windows or more), {:.1} % of the variance",
            100.0 * share
        )?;
        let Some(errors) = held_out else { return Ok(()) };
        let PredictionErrors { steps, next, step, switching, no_change, constant_velocity, reconstruction } = errors;
        write!(
            f,
            "; {steps} held-out steps: next {next:.4}, step {step:.4}, all three models {switching:.4}, \
             no change {no_change:.4}"
        )?;
        if let Some(velocity) = constant_velocity {
            write!(f, ", constant velocity {velocity:.4}")?;
        }
        write!(f, ", reconstruction {reconstruction:.4}")
    }
}
