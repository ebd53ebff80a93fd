//! What is learned of a body's motion: for each feature vector the clusters of its action primitives.
//!
//! Plain values, as they are written to a file ([`crate::primitives::file`]). Matrices are row after row.

use crate::pca::Pca;
use serde::{Deserialize, Serialize};

/// Some coordinates of a state that move together, as the four angles of a limb do.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FeatureVector {
    /// Name, unique in a model.
    pub name: String,
    /// Coordinates of the state, each once.
    pub coordinates: Vec<usize>,
}

/// A normal distribution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Normal {
    /// Mean, length d.
    pub mean: Vec<f64>,
    /// Covariance, d × d.
    pub covariance: Vec<f64>,
}

/// What the windows of one cluster have in common.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cluster {
    /// Windows in it.
    pub members: usize,
    /// Scores of the action primitives, for matching: M_k, Σ_k.
    pub past: Normal,
    /// The next feature vector: M_NBFV, Σ_NBFV.
    pub next: Normal,
    /// Its difference from the last one of the action primitive: M*_NBFV, Σ*_NBFV.
    pub step: Normal,
}

/// How the clustering went.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Clustering {
    /// Components that were requested.
    pub requested: usize,
    /// Components that the mixture has.
    pub components: usize,
    /// Components that were seeded again on the way.
    pub reseeded: usize,
    /// Iterations.
    pub iterations: usize,
    /// Whether it ended by the tolerance.
    pub converged: bool,
    /// Log likelihood of all windows in the clustering space.
    pub log_likelihood: f64,
    /// Dimension of the clustering space.
    pub dim: usize,
    /// Share of the windows' variance that this space holds.
    pub share: f64,
}

/// The action primitives of one feature vector.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Primitives {
    /// Whose they are; F coordinates.
    pub feature: FeatureVector,
    /// Principal components of the action primitives, D F numbers each: the space of matching.
    pub pca: Pca,
    /// The clusters that have members.
    pub clusters: Vec<Cluster>,
    /// How often a window of cluster i is followed by one of cluster j, i after i.
    pub transitions: Vec<usize>,
    /// How the clustering went.
    pub clustering: Clustering,
}

impl Primitives {
    /// The mean window of a cluster, D + 1 feature vectors: its action primitive as far as the scores say, and the next.
    #[must_use]
    pub fn mean_window(&self, cluster: usize) -> Vec<f64> {
        let Cluster { past, next, .. } = &self.clusters[cluster];
        [self.pca.reconstruct(&past.mean), next.mean.clone()].concat()
    }

    /// Number of windows that they were learned from.
    #[must_use]
    pub fn windows(&self) -> usize {
        self.clusters.iter().map(|cluster| cluster.members).sum()
    }
}

/// A motion model of action primitives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrimitiveModel {
    /// What the coordinates are, in words of whoever learned it, for instance the name of a body.
    pub state: String,
    /// Dimension of the state.
    pub dim: usize,
    /// Frames a second.
    pub frame_rate: f64,
    /// Feature vectors in an action primitive: D.
    pub length: usize,
    /// Standard deviations B of a step of each coordinate.
    pub noise_sd: Vec<f64>,
    /// One entry a feature vector.
    pub primitives: Vec<Primitives>,
}

impl PrimitiveModel {
    /// The action primitives of a feature vector.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Primitives> {
        self.primitives.iter().find(|primitives| primitives.feature.name == name)
    }
}
