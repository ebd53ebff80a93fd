//! Learning of action primitives from recorded motion (Husz, Wallace & Green 2007, section 3).
//!
//! For each feature vector:
//!
//! 1. All windows of D + 1 feature vectors ([`crate::primitives::windows`]), by their principal components ([`crate::pca`]).
//! 2. A Gaussian mixture of C components in this space ([`crate::mixture_em`]); each window belongs to the component with the largest share in it. Components without windows are left out.
//! 3. Principal components of the first D feature vectors of all windows, the space of matching.
//! 4. Means and covariances by cluster: of the scores there, of the next feature vector, and of its difference from the one before.
//! 5. Shrinkage for small clusters: Σ ← (n Σ + n₀ Σ_pool) / (n + n₀), n₀ the dimension and Σ_pool the pooled covariance within clusters with a floor on its diagonal: a share of the mean variance for the scores, a thousandth of a step's
//!    standard deviation for coordinates.
//!
//! The paper leaves open the dimensions, the start, what happens to components that starve, hard membership and steps 3 and 5; they are our choices. Angles are to be continuous in time. The same motion, settings and seed give the same bytes
//! on any number of threads.

use crate::Error;
use crate::mixture_em::{self, Iteration};
use crate::pca::{self, Keep, mean_and_covariance};
use crate::primitives::model::{Cluster, Clustering, FeatureVector, Normal, PrimitiveModel, Primitives};
use crate::primitives::windows::{Windows, step_sd, windows};
use sinew_core::part::Part;
use sinew_core::random::Stage;

/// Settings of learning; the defaults are the paper's where it has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Feature vectors in an action primitive: D.
    pub length: usize,
    /// The clustering, C components.
    pub mixture: mixture_em::Config,
    /// Principal components of both spaces.
    pub keep: Keep,
    /// Standard deviation of a step over the root mean square of the recorded ones.
    pub noise_factor: f64,
    /// Standard deviation of a step at least (metres, radians).
    pub noise_floor: f64,
}

impl Default for Config {
    fn default() -> Self {
        let mixture = mixture_em::Config::default();
        Self { length: 3, mixture, keep: Keep::default(), noise_factor: 1.5, noise_floor: 1e-3 }
    }
}

/// Floor of pooled covariances of coordinates: this share of a step's standard deviation, squared.
const FLOOR: f64 = 1e-3;

/// Motion to learn from.
#[derive(Clone, Copy, Debug)]
pub struct TrainingMotion<'a> {
    /// What the coordinates are, for instance the name of a body.
    pub state: &'a str,
    /// Dimension of the state.
    pub dim: usize,
    /// Frames a second.
    pub frame_rate: f64,
    /// States, one after the other, a row a frame.
    pub sequences: &'a [Vec<f64>],
    /// Coordinates of the horizontal position, which share the standard deviation of their steps: the way in which the recorded motion went says nothing of another.
    pub horizontal: &'a [usize],
}

/// Standard deviations of a step of each coordinate ([`step_sd`]), the horizontal ones alike.
///
/// # Errors
/// As [`step_sd`].
pub fn noise_sd(motion: &TrainingMotion<'_>, config: &Config) -> Result<Vec<f64>, Error> {
    let mut sd = step_sd(motion.sequences, motion.dim, config.noise_factor, config.noise_floor)?;
    let squares = motion.horizontal.iter().filter_map(|&j| sd.get(j)).map(|sd| sd * sd).sum::<f64>();
    let shared = (squares / motion.horizontal.len() as f64).sqrt();
    for &j in motion.horizontal {
        let found = motion.dim;
        *sd.get_mut(j).ok_or(Error::Shape { name: "horizontal coordinates", found, expected: j + 1 })? = shared;
    }
    Ok(sd)
}

/// How far learning is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearningProgress<'a> {
    /// Name of the feature vector at work.
    pub feature: &'a str,
    /// Its number, from 0.
    pub index: usize,
    /// Number of feature vectors.
    pub count: usize,
    /// Iteration of its clustering, from 0.
    pub iteration: usize,
    /// Log likelihood there.
    pub log_likelihood: f64,
}

/// Reports the iterations of feature vector `index` of `count`, one after the other.
pub fn counted<'a>(
    feature: &'a str,
    index: usize,
    count: usize,
    progress: &'a mut dyn FnMut(&LearningProgress<'_>),
) -> impl FnMut(&Iteration) + 'a {
    let mut iteration = 0;
    move |found| {
        let log_likelihood = found.log_likelihood;
        progress(&LearningProgress { feature, index, count, iteration, log_likelihood });
        iteration += 1;
    }
}

/// Learns a model of all `features`; feature vector i uses round i of the stage.
///
/// # Errors
/// [`Error::Part`] for coordinates that do not exist or occur twice, [`Error::Duplicate`] for two feature vectors of one name, and as [`learn_feature`].
pub fn learn(
    motion: &TrainingMotion<'_>,
    features: &[FeatureVector],
    config: &Config,
    stage: Stage,
    progress: &mut dyn FnMut(&LearningProgress<'_>),
) -> Result<PrimitiveModel, Error> {
    let (name, value) = ("frame rate", motion.frame_rate);
    if !(value > 0.0 && value.is_finite()) {
        return Err(Error::OutOfRange { name, index: 0, value, expected: "must be positive and finite" });
    }
    let noise_sd = noise_sd(motion, config)?;
    let mut primitives: Vec<Primitives> = Vec::with_capacity(features.len());
    for (index, feature) in features.iter().enumerate() {
        if primitives.iter().any(|other| other.feature.name == feature.name) {
            return Err(Error::Duplicate { name: feature.name.clone() });
        }
        let mut report = counted(&feature.name, index, features.len(), progress);
        primitives.push(learn_feature(motion, feature, &noise_sd, config, stage.round(index), &mut report)?);
    }
    Ok(PrimitiveModel {
        state: motion.state.into(),
        dim: motion.dim,
        frame_rate: motion.frame_rate,
        length: config.length,
        noise_sd,
        primitives,
    })
}

/// Learns the action primitives of one feature vector; `noise_sd` has a standard deviation for each coordinate of the state.
///
/// # Errors
/// [`Error::Shape`] where there are too few windows or an action primitive has no feature vectors, [`Error::OutOfRange`] for numbers that are not finite and coordinates that never change, [`Error::Part`].
pub fn learn_feature(
    motion: &TrainingMotion<'_>,
    feature: &FeatureVector,
    noise_sd: &[f64],
    config: &Config,
    stage: Stage,
    progress: &mut dyn FnMut(&Iteration),
) -> Result<Primitives, Error> {
    Part::new(feature.coordinates.clone(), motion.dim)?;
    if config.length == 0 {
        return Err(Error::Shape { name: "action primitive", found: 0, expected: 1 });
    }
    if noise_sd.len() != motion.dim {
        return Err(Error::Shape { name: "noise", found: noise_sd.len(), expected: motion.dim });
    }
    let all = windows(motion.sequences, motion.dim, &feature.coordinates, config.length)?;
    let space = pca::fit(&all.rows, all.dim, config.keep)?;
    let scores: Vec<f64> = all.rows.chunks_exact(all.dim).flat_map(|row| space.project(row)).collect();
    let start = mixture_em::start(&scores, space.len(), &config.mixture, stage)?;
    let mixture = mixture_em::run(&scores, space.len(), start, &config.mixture, progress)?;
    let clustering = Clustering {
        requested: config.mixture.components,
        components: mixture.components.len(),
        reseeded: mixture.iterations.iter().map(|iteration| iteration.reseeded).sum(),
        iterations: mixture.iterations.len() - 1,
        converged: mixture.converged,
        log_likelihood: mixture.iterations.last().map_or(f64::NAN, |iteration| iteration.log_likelihood),
        dim: space.len(),
        share: space.share(),
    };
    let (labels, count) = renumbered(&mixture.nearest, mixture.components.len());
    let floor: Vec<f64> = feature.coordinates.iter().map(|&j| (FLOOR * noise_sd[j]).powi(2)).collect();
    let (pca, clusters) = clusters(&all, &labels, count, &floor, config)?;
    let transitions = transitions(&all.counts, &labels, count);
    Ok(Primitives { feature: feature.clone(), pca, clusters, transitions, clustering })
}

/// Labels without those that nothing has, in the order of the components, and their number.
fn renumbered(nearest: &[usize], components: usize) -> (Vec<usize>, usize) {
    let mut number = vec![None; components];
    nearest.iter().for_each(|&k| number[k] = Some(0));
    let mut count = 0;
    for slot in number.iter_mut().flatten() {
        *slot = count;
        count += 1;
    }
    (nearest.iter().filter_map(|&k| number[k]).collect(), count)
}

/// The space of matching, and the clusters.
fn clusters(
    all: &Windows,
    labels: &[usize],
    count: usize,
    floor: &[f64],
    config: &Config,
) -> Result<(pca::Pca, Vec<Cluster>), Error> {
    let features = floor.len();
    let past = all.dim - features;
    let rows = || all.rows.chunks_exact(all.dim);
    let first: Vec<f64> = rows().flat_map(|row| &row[..past]).copied().collect();
    let pca = pca::fit(&first, past, config.keep)?;
    let scores: Vec<f64> = first.chunks_exact(past).flat_map(|row| pca.project(row)).collect();
    let next: Vec<f64> = rows().flat_map(|row| &row[past..]).copied().collect();
    let step: Vec<f64> = rows().flat_map(|row| (past..all.dim).map(|j| row[j] - row[j - features])).collect();
    let q = pca.len();
    let ridge = config.mixture.ridge * pca.total / q as f64;
    let past = shrunk_normals(&scores, q, labels, count, &vec![ridge; q]);
    let next = shrunk_normals(&next, features, labels, count, floor);
    let step = shrunk_normals(&step, features, labels, count, floor);
    let mut members = vec![0; count];
    labels.iter().for_each(|&k| members[k] += 1);
    let parts = members.into_iter().zip(past).zip(next).zip(step);
    let clusters = parts.map(|(((members, past), next), step)| Cluster { members, past, next, step });
    Ok((pca, clusters.collect()))
}

/// Mean and shrunk covariance of the rows of each label; `floor` is added to the diagonal of the pooled covariance.
fn shrunk_normals(rows: &[f64], dim: usize, labels: &[usize], count: usize, floor: &[f64]) -> Vec<Normal> {
    let mut members = vec![Vec::new(); count];
    for (row, &k) in rows.chunks_exact(dim).zip(labels) {
        members[k].extend_from_slice(row);
    }
    let moments: Vec<(Vec<f64>, Vec<f64>)> = members.iter().map(|rows| mean_and_covariance(rows, dim)).collect();
    let mut pooled = vec![0.0; dim * dim];
    for (rows, (_, covariance)) in members.iter().zip(&moments) {
        let share = (rows.len() / dim) as f64 / labels.len() as f64;
        pooled.iter_mut().zip(covariance).for_each(|(sum, c)| *sum += share * c);
    }
    for (j, floor) in floor.iter().enumerate() {
        pooled[j * (dim + 1)] += floor;
    }
    let shrunk = |(rows, (mean, mut covariance)): (&Vec<f64>, (Vec<f64>, Vec<f64>))| {
        let (n, n0) = ((rows.len() / dim) as f64, dim as f64);
        covariance.iter_mut().zip(&pooled).for_each(|(c, pool)| *c = (n * *c + n0 * pool) / (n + n0));
        Normal { mean, covariance }
    };
    members.iter().zip(moments).map(shrunk).collect()
}

/// How often a window of cluster i is followed by one of cluster j in the same sequence, row after row.
fn transitions(counts: &[usize], labels: &[usize], clusters: usize) -> Vec<usize> {
    let mut table = vec![0; clusters * clusters];
    let mut rest = labels;
    for &count in counts {
        let (sequence, after) = rest.split_at(count);
        sequence.windows(2).for_each(|pair| table[pair[0] * clusters + pair[1]] += 1);
        rest = after;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two clusters about 0 and 10 with the deviations ±1 and ±3: pooled variance 1 · ½ + 9 · ½ = 5, and one more by the floor.
    #[test]
    fn small_clusters_lean_on_the_pooled_covariance() {
        let rows = [-1.0, 1.0, 7.0, 13.0];
        let found = shrunk_normals(&rows, 1, &[0, 0, 1, 1], 2, &[1.0]);
        let [a, b] = [&found[0], &found[1]];
        assert_eq!((&a.mean[..], &b.mean[..]), (&[0.0][..], &[10.0][..]));
        assert!((a.covariance[0] - (2.0 * 1.0 + 6.0) / 3.0).abs() < 1e-14);
        assert!((b.covariance[0] - (2.0 * 9.0 + 6.0) / 3.0).abs() < 1e-14);
    }

    #[test]
    fn transitions_are_counted_within_sequences() {
        assert_eq!(transitions(&[3, 0, 2], &[0, 1, 1, 0, 1], 2), [0, 2, 0, 1]);
        assert_eq!(renumbered(&[3, 1, 3, 1], 5), (vec![1, 0, 1, 0], 2));
    }
}
