//! Mean and covariance of what action primitives predict: the Gaussian in place of their mixture.
//!
//! The mixture ([`crate::primitives::density`]) has 3 M components N(μ_ib, Σ_ib), of M states i and the three models b. Its moments are
//!
//! - m = 1/(3M) Σ μ_ib,
//! - C = 1/(3M) Σ [Σ_ib + (μ_ib − m) (μ_ib − m)ᵀ].
//!
//! N(m, C) is the Gaussian nearest to the mixture (of least Kullback–Leibler divergence from it). It has one mode, and is as wide as the models disagree.

use crate::primitives::density::Places;
use crate::primitives::switching::{Branch, Factored, Switching};
use sinew_core::transition::Moments;

const BRANCHES: [Branch; 3] = [Branch::Next, Branch::Step, Branch::Walk];

/// Moments after some states of known clusters; at least one.
pub(crate) fn moments(switching: &Switching, places: &Places, origins: &[(usize, Vec<f64>)]) -> Moments {
    let d = places.sd.len();
    let components = || origins.iter().flat_map(|origin| BRANCHES.map(|branch| (origin, branch)));
    let share = 1.0 / (3 * origins.len()) as f64;
    let mut mean = vec![0.0; d];
    for (origin, branch) in components() {
        let centre = component(switching, places, origin, branch);
        mean.iter_mut().zip(centre).for_each(|(mean, x)| *mean += share * x);
    }
    let mut covariance = within(switching, places, origins);
    for (origin, branch) in components() {
        let centre = component(switching, places, origin, branch);
        let away: Vec<f64> = centre.iter().zip(&mean).map(|(x, mean)| x - mean).collect();
        for (row, x) in covariance.chunks_exact_mut(d).zip(&away) {
            row.iter_mut().zip(&away).for_each(|(entry, y)| *entry += share * x * y);
        }
    }
    Moments { mean, covariance }
}

/// Mean of the component of a state and a model.
fn component(switching: &Switching, places: &Places, origin: &(usize, Vec<f64>), branch: Branch) -> Vec<f64> {
    let (cluster, state) = origin;
    let mut mean = state.clone();
    for (i, &j) in places.covered.iter().enumerate() {
        match branch {
            Branch::Next => mean[j] = switching.next[*cluster].mean[i],
            Branch::Step => mean[j] += switching.step[*cluster].mean[i],
            Branch::Walk => {}
        }
    }
    mean
}

/// Mean covariance of the components.
fn within(switching: &Switching, places: &Places, origins: &[(usize, Vec<f64>)]) -> Vec<f64> {
    let d = places.sd.len();
    let mut covariance = vec![0.0; d * d];
    for &j in &places.rest {
        covariance[j * (d + 1)] = places.sd[j] * places.sd[j];
    }
    for &j in &places.covered {
        covariance[j * (d + 1)] = places.sd[j] * places.sd[j] / 3.0;
    }
    for cluster in 0..switching.next.len() {
        let members = origins.iter().filter(|(own, _)| *own == cluster).count();
        let share = members as f64 / (3 * origins.len()) as f64;
        if members > 0 {
            for factored in [&switching.next[cluster], &switching.step[cluster]] {
                add_covariance(factored, share, &places.covered, &mut covariance, d);
            }
        }
    }
    covariance
}

/// Adds share · L Lᵀ at some coordinates.
fn add_covariance(factored: &Factored, share: f64, places: &[usize], covariance: &mut [f64], d: usize) {
    let f = places.len();
    let row = |i: usize| &factored.lower[i * f..(i + 1) * f];
    for (a, &i) in places.iter().enumerate() {
        for (b, &j) in places.iter().enumerate() {
            let entry: f64 = row(a).iter().zip(row(b)).map(|(x, y)| x * y).sum();
            covariance[i * d + j] += share * entry;
        }
    }
}
