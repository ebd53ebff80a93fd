//! Whether a motion model is one that could have been learned: sizes, ranges, covariances, counts.
//!
//! Sizes are compared before anything is computed from them. A covariance must be symmetric and have a Cholesky factor as it is, without anything added to its diagonal.

use crate::factor::cholesky;
use crate::pca::Pca;
use crate::primitives::model::{Cluster, Clustering, Normal, PrimitiveModel, Primitives};
use core::fmt;
use std::collections::HashSet;

/// Dimension of a state at most.
const MOST_COORDINATES: usize = 1000;
/// Feature vectors in an action primitive at most.
const LONGEST: usize = 1000;
/// Feature vectors of a model, and clusters of one, at most.
const MOST: usize = 10_000;
/// Windows of one feature vector at most.
const MOST_WINDOWS: usize = 1 << 32;
/// Numbers are at most this large; states are metres and radians.
const LARGEST: f64 = 1e9;
/// Standard deviations are at least this large.
const LEAST_SD: f64 = 1e-12;
/// Frames a second at most.
const FASTEST: f64 = 1e5;
/// Characters in a name at most.
const LONGEST_NAME: usize = 100;
/// How far components may be from orthonormal, covariances from symmetric (as a share), shares from 1.
const ROUNDING: f64 = 1e-6;

/// A value that no model has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misfit {
    /// Where, for instance a feature vector and the number of a cluster.
    pub place: String,
    /// What stands there.
    pub found: String,
    /// What should.
    pub expected: String,
}

impl fmt::Display for Misfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is {}; expected {}", self.place, self.found, self.expected)
    }
}

fn misfit(place: impl fmt::Display, found: impl fmt::Display, expected: impl fmt::Display) -> Misfit {
    Misfit { place: place.to_string(), found: found.to_string(), expected: expected.to_string() }
}

/// A number of things, within a range.
fn count(place: &str, found: usize, least: usize, most: usize) -> Result<(), Misfit> {
    if (least..=most).contains(&found) { Ok(()) } else { Err(misfit(place, found, format!("{least} to {most}"))) }
}

/// A list of that many finite numbers.
fn numbers(place: &str, found: &[f64], expected: usize) -> Result<(), Misfit> {
    if found.len() != expected {
        let found = format!("a list of {} numbers", found.len());
        return Err(misfit(place, found, expected));
    }
    match found.iter().position(|x| x.is_nan() || x.abs() > LARGEST) {
        Some(i) => Err(misfit(format!("{place}, number {i}"), found[i], format!("a number of at most {LARGEST:e}"))),
        None => Ok(()),
    }
}

fn between(place: &str, found: f64, least: f64, most: f64) -> Result<(), Misfit> {
    let is_within = found >= least && found <= most;
    if is_within { Ok(()) } else { Err(misfit(place, found, format!("a number from {least:e} to {most:e}"))) }
}

fn name(place: &str, found: &str) -> Result<(), Misfit> {
    if found.is_empty() || found.chars().count() > LONGEST_NAME || found.chars().any(char::is_control) {
        let shown: String = found.chars().take(40).collect();
        return Err(misfit(place, format!("{shown:?}"), format!("a name of 1 to {LONGEST_NAME} characters")));
    }
    Ok(())
}

/// Checks a model.
///
/// # Errors
/// The first place that does not fit; places are named from the top of the file.
pub fn check(model: &PrimitiveModel) -> Result<(), Misfit> {
    let PrimitiveModel { state, dim, frame_rate, length, noise_sd, primitives } = model;
    name("`state`", state)?;
    count("`dim`", *dim, 1, MOST_COORDINATES)?;
    between("`frame_rate`", *frame_rate, FASTEST.recip(), FASTEST)?;
    count("`length`", *length, 1, LONGEST)?;
    numbers("`noise_sd`", noise_sd, *dim)?;
    for (i, sd) in noise_sd.iter().enumerate() {
        between(&format!("`noise_sd` of coordinate {i}"), *sd, LEAST_SD, LARGEST)?;
    }
    count("number of feature vectors", primitives.len(), 1, MOST)?;
    let mut names = HashSet::new();
    for (number, primitives) in primitives.iter().enumerate() {
        let feature = &primitives.feature;
        name(&format!("name of feature vector {number}"), &feature.name)?;
        if !names.insert(&feature.name) {
            let place = format!("name of feature vector {number}");
            return Err(misfit(place, format!("\"{}\"", feature.name), "a name that no other has"));
        }
        check_feature(primitives, *dim, *length).map_err(|inner| Misfit {
            place: format!("feature vector \"{}\": {}", feature.name, inner.place),
            ..inner
        })?;
    }
    Ok(())
}

fn check_feature(primitives: &Primitives, dim: usize, length: usize) -> Result<(), Misfit> {
    let Primitives { feature, pca, clusters, transitions, clustering } = primitives;
    let coordinates = &feature.coordinates;
    count("number of coordinates", coordinates.len(), 1, dim)?;
    for (i, &coordinate) in coordinates.iter().enumerate() {
        if coordinate >= dim || coordinates[..i].contains(&coordinate) {
            let expected = format!("a number below {dim} that occurs once");
            return Err(misfit(format!("coordinate {i}"), coordinate, expected));
        }
    }
    let features = coordinates.len();
    check_pca(pca, length * features)?;
    count("number of clusters", clusters.len(), 1, MOST)?;
    for (number, cluster) in clusters.iter().enumerate() {
        check_cluster(cluster, pca.variances.len(), features)
            .map_err(|inner| Misfit { place: format!("cluster {number}: {}", inner.place), ..inner })?;
    }
    check_transitions(transitions, clusters)?;
    check_clustering(clustering, clusters.len(), (length + 1) * features)
}

fn check_pca(pca: &Pca, dim: usize) -> Result<(), Misfit> {
    let Pca { mean, components, variances, total } = pca;
    let q = variances.len();
    numbers("mean of the principal components", mean, dim)?;
    count("number of principal components", q, 1, dim)?;
    numbers("principal components", components, q * dim)?;
    numbers("variances of the principal components", variances, q)?;
    between("total variance", *total, LEAST_SD.powi(2), LARGEST)?;
    for (i, &variance) in variances.iter().enumerate() {
        if variance < 0.0 || i > 0 && variance > variances[i - 1] {
            let expected = "a variance that is not larger than the one before";
            return Err(misfit(format!("variance of principal component {i}"), variance, expected));
        }
    }
    let held: f64 = variances.iter().sum();
    if held > total * (1.0 + ROUNDING) {
        return Err(misfit("total variance", total, format!("at least {held}, what the components hold")));
    }
    for i in 0..q {
        for j in 0..=i {
            let [a, b] = [i, j].map(|k| &components[k * dim..][..dim]);
            let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
            let expected = if i == j { 1.0 } else { 0.0 };
            if (product - expected).abs() > ROUNDING {
                return Err(misfit(format!("product of the principal components {i} and {j}"), product, expected));
            }
        }
    }
    Ok(())
}

fn check_cluster(cluster: &Cluster, scores: usize, features: usize) -> Result<(), Misfit> {
    let Cluster { members, past, next, step } = cluster;
    count("`members`", *members, 1, MOST_WINDOWS)?;
    check_normal("past", past, scores)?;
    check_normal("next", next, features)?;
    check_normal("step", step, features)
}

fn check_normal(which: &str, normal: &Normal, dim: usize) -> Result<(), Misfit> {
    let Normal { mean, covariance } = normal;
    numbers(&format!("`{which}.mean`"), mean, dim)?;
    let place = format!("`{which}.covariance`");
    numbers(&place, covariance, dim * dim)?;
    for i in 0..dim {
        for j in 0..i {
            let [a, b] = [covariance[i * dim + j], covariance[j * dim + i]];
            if (a - b).abs() > ROUNDING * a.abs().max(b.abs()) {
                return Err(misfit(
                    format!("{place}, row {i}, column {j}"),
                    a,
                    format!("{b}, as in row {j}, column {i}"),
                ));
            }
        }
    }
    match cholesky("covariance", covariance, dim) {
        Ok(factor) if factor.jitter == 0.0 && (0..dim).all(|i| factor.lower[i * (dim + 1)] >= LEAST_SD) => Ok(()),
        Ok(_) => Err(misfit(place, "singular", "positive definite")),
        Err(error) => Err(misfit(place, format!("no covariance ({error})"), "positive definite")),
    }
}

/// A window is followed by one at most, and follows one at most.
fn check_transitions(transitions: &[usize], clusters: &[Cluster]) -> Result<(), Misfit> {
    let n = clusters.len();
    if transitions.len() != n * n {
        return Err(misfit("`transitions`", format!("a list of {} counts", transitions.len()), n * n));
    }
    for (k, cluster) in clusters.iter().enumerate() {
        let sum = |counts: &mut dyn Iterator<Item = usize>| counts.fold(0_usize, usize::saturating_add);
        let from = sum(&mut transitions[k * n..][..n].iter().copied());
        let to = sum(&mut transitions.iter().skip(k).step_by(n).copied());
        for (sum, way) in [(from, "from"), (to, "to")] {
            if sum > cluster.members {
                let expected = format!("at most {}, its members", cluster.members);
                return Err(misfit(format!("sum of the transitions {way} cluster {k}"), sum, expected));
            }
        }
    }
    Ok(())
}

fn check_clustering(clustering: &Clustering, clusters: usize, dim: usize) -> Result<(), Misfit> {
    let Clustering { requested, components, log_likelihood, share, .. } = clustering;
    count("components of the mixture", *components, clusters, MOST)?;
    count("components that were requested", *requested, *components, MOST)?;
    count("dimension of the clustering space", clustering.dim, 1, dim)?;
    if !(*share > 0.0 && *share <= 1.0 + ROUNDING) {
        return Err(misfit("share of the variance in the clustering space", share, "more than 0 and at most 1"));
    }
    if !log_likelihood.is_finite() {
        return Err(misfit("log likelihood of the clustering", log_likelihood, "a finite number"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::made_up::model;

    /// One change of a model, and a word of the place that is named.
    type Change = (&'static str, fn(&mut PrimitiveModel));

    const OF_THE_MODEL: [Change; 11] = [
        ("`state`", |m| m.state.clear()),
        ("`state`", |m| m.state = "a\nb".into()),
        ("`dim`", |m| m.dim = 0),
        ("`dim`", |m| m.dim = usize::MAX),
        ("`noise_sd`", |m| m.dim = 5),
        ("`frame_rate`", |m| m.frame_rate = f64::NAN),
        ("`length`", |m| m.length = usize::MAX),
        ("mean of the principal components", |m| m.length = 4),
        ("`noise_sd` of coordinate 2", |m| m.noise_sd[2] = 0.0),
        ("number of feature vectors", |m| m.primitives.clear()),
        ("name of feature vector 1", |m| m.primitives.push(m.primitives[0].clone())),
    ];

    const OF_A_FEATURE: [Change; 18] = [
        ("name of feature vector 0", |m| m.primitives[0].feature.name = "x".repeat(101)),
        ("number of coordinates", |m| m.primitives[0].feature.coordinates.clear()),
        ("coordinate 1", |m| m.primitives[0].feature.coordinates = vec![3, 3]),
        ("coordinate 0", |m| m.primitives[0].feature.coordinates[0] = 4),
        ("number of principal components", |m| m.primitives[0].pca.variances.clear()),
        ("principal components is", |m| m.primitives[0].pca.components.truncate(1)),
        ("product of the principal components 0 and 0", |m| m.primitives[0].pca.components[0] += 0.1),
        ("variance of principal component 1", |m| m.primitives[0].pca.variances[1] = 10.0),
        ("total variance", |m| m.primitives[0].pca.total = 1e-9),
        ("number of clusters", |m| m.primitives[0].clusters.clear()),
        ("`transitions`", |m| m.primitives[0].transitions.push(0)),
        ("sum of the transitions from cluster 0", |m| m.primitives[0].transitions[0] = usize::MAX),
        ("`transitions`", |m| m.primitives[0].clusters.truncate(1)),
        ("components of the mixture", |m| m.primitives[0].clustering.components = 0),
        ("components that were requested", |m| m.primitives[0].clustering.requested = 0),
        ("dimension of the clustering space", |m| m.primitives[0].clustering.dim = 9),
        ("share of the variance", |m| m.primitives[0].clustering.share = 1.1),
        ("log likelihood", |m| m.primitives[0].clustering.log_likelihood = f64::INFINITY),
    ];

    const OF_A_CLUSTER: [Change; 8] = [
        ("cluster 1: `members`", |m| m.primitives[0].clusters[1].members = 0),
        ("cluster 1: `past.mean`", |m| m.primitives[0].clusters[1].past.mean.push(0.0)),
        ("cluster 1: `next.mean`, number 0", |m| m.primitives[0].clusters[1].next.mean[0] = 1e10),
        ("cluster 1: `step.covariance`", |m| m.primitives[0].clusters[1].step.covariance.truncate(1)),
        ("cluster 1: `step.covariance`, row 1, column 0", |m| m.primitives[0].clusters[1].step.covariance[1] = 0.5),
        ("cluster 1: `next.covariance`, number 3", |m| m.primitives[0].clusters[1].next.covariance[3] = f64::NAN),
        ("cluster 1: `next.covariance`", |m| m.primitives[0].clusters[1].next.covariance = vec![1.0; 4]),
        ("cluster 1: `past.covariance`", |m| m.primitives[0].clusters[1].past.covariance[0] = -1.0),
    ];

    #[test]
    fn a_learned_model_is_one() {
        assert_eq!(check(&model()), Ok(()));
    }

    #[test]
    fn each_broken_field_is_refused_by_its_place() {
        for (place, change) in OF_THE_MODEL.into_iter().chain(OF_A_FEATURE).chain(OF_A_CLUSTER) {
            let mut broken = model();
            change(&mut broken);
            let message = check(&broken).expect_err(place).to_string();
            assert!(message.contains(place), "{place}: {message}");
        }
    }

    #[test]
    fn messages_name_place_found_and_expected() {
        let mut broken = model();
        broken.primitives[0].clusters[2].next.covariance = vec![1.0, 2.0, 2.0, 1.0];
        assert_eq!(
            check(&broken).unwrap_err().to_string(),
            "feature vector \"swing\": cluster 2: `next.covariance` is no covariance (covariance is indefinite: its smallest eigenvalue is -1); expected positive definite"
        );
    }
}
