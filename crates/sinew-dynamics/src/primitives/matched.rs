//! Mean and covariance of what action primitives predict: the Gaussian in place of their mixture.
//!
//! The mixture ([`crate::primitives::density`]) has 3 M components N(μ_ib, Σ_ib), of M states i and the three models b. Its moments are
//!
//! - m = 1/(3M) Σ μ_ib,
//! - C = 1/(3M) Σ [Σ_ib + (μ_ib − m) (μ_ib − m)ᵀ].
//!
//! N(m, C) is the Gaussian nearest to the mixture (of least Kullback–Leibler divergence from it). It has one mode, and is as wide as the models disagree.

use crate::Error;
use crate::gaussian::Gaussian;
use crate::primitives::places::Places;
use crate::primitives::switching::{Branch, Factored, Switching};
use sinew_core::transition::Moments;

const BRANCHES: [Branch; 3] = [Branch::Next, Branch::Step, Branch::Walk];

/// N(m, C) after some states of known clusters; at least one.
pub(crate) fn gaussian(
    switching: &Switching,
    places: &Places,
    origins: &[(usize, Vec<f64>)],
) -> Result<Gaussian, Error> {
    let Moments { mean, covariance } = moments(switching, places, origins);
    Gaussian::new(mean, &covariance)
}

fn moments(switching: &Switching, places: &Places, origins: &[(usize, Vec<f64>)]) -> Moments {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::made_up::{model, sequences};
    use crate::primitives::motion::PrimitiveMotion;
    use crate::prior::Prior;
    use crate::random_walk::Between;
    use sinew_core::density::{GradLogDensity, LogDensity};
    use sinew_core::lanes::{Block, Isa, LANES, get_lane};
    use sinew_core::random::Stage;
    use sinew_core::transition::{Cloud, FramePrior, MotionModel, Predict};

    const DIM: usize = 4;
    /// States of the cloud.
    const COUNT: usize = 21;

    /// Motion that has seen some frames of a swing, and the state that follows them.
    fn following(frames: usize) -> (PrimitiveMotion, Vec<f64>) {
        let mut motion = PrimitiveMotion::new(&model(), "swing", 0.05, Isa::best()).expect("valid");
        let swing = sequences(60).swap_remove(0);
        let estimates: Vec<&[f64]> = swing.chunks_exact(DIM).skip(20).take(frames + 1).collect();
        estimates[..frames].iter().for_each(|estimate| motion.follow(None, estimate));
        (motion, estimates[frames].to_vec())
    }

    /// Draws around a state, wide enough for several clusters.
    fn draws(centre: &[f64]) -> Vec<Block> {
        let mut states = vec![Block::ZERO; DIM * COUNT.div_ceil(LANES)];
        Stage::new(5, "cloud").whole().fill_normal(Isa::baseline(), &mut states);
        for (k, block) in states.iter_mut().enumerate() {
            block.0.iter_mut().for_each(|x| *x = centre[k % DIM] + 0.2 * *x);
        }
        states
    }

    fn prior(motion: &PrimitiveMotion, last: &[Block], between: Between) -> Prior {
        let diagonal = |k: usize| if k.is_multiple_of(DIM + 1) { 0.3 } else { 0.0 };
        let moments = Moments { mean: vec![0.1; DIM], covariance: (0..DIM * DIM).map(diagonal).collect() };
        let motion = motion.clone().with_between(between);
        motion.predict(Cloud { last, count: COUNT, moments: &moments }).expect("valid")
    }

    /// Sums of the coordinates and of their products over draws of a prior, each with the squares of its terms.
    fn sums(prior: &Prior, blocks: usize) -> Vec<[f64; 2]> {
        let (mut block, mut x) = (vec![Block::ZERO; DIM], vec![0.0; DIM]);
        let mut sums = vec![[0.0; 2]; DIM + DIM * DIM];
        let stage = Stage::new(7, "moments");
        for b in 0..blocks {
            prior.sample_block(b, &mut block, &mut stage.block(b as u32));
            for lane in 0..LANES {
                get_lane(&block, lane, &mut x);
                let term = |k: usize| k.checked_sub(DIM).map_or_else(|| x[k], |k| x[k / DIM] * x[k % DIM]);
                sums.iter_mut().enumerate().for_each(|(k, sum)| *sum = [sum[0] + term(k), sum[1] + term(k) * term(k)]);
            }
        }
        sums
    }

    #[test]
    fn draws_of_the_mixture_and_of_the_gaussian_have_the_same_moments() {
        let (motion, centre) = following(3);
        let last = draws(&centre);
        let [mixture, gaussian] = [Between::Mixture, Between::Gaussian].map(|between| prior(&motion, &last, between));
        assert!(matches!(gaussian, Prior::Gaussian(_)) && matches!(mixture, Prior::Switching(_)));
        let blocks = 125 * COUNT;
        let n = (blocks * LANES) as f64;
        for (k, (a, b)) in sums(&mixture, blocks).into_iter().zip(sums(&gaussian, blocks)).enumerate() {
            let variance = |[sum, squares]: [f64; 2]| squares / n - (sum / n).powi(2);
            let z = (a[0] - b[0]) / (n * (variance(a) + variance(b))).sqrt();
            assert!(z.abs() < 4.5, "moment {k}: z = {z}, bound 4.5, seed 7");
        }
    }

    #[test]
    fn its_gradient_matches_differences() {
        let (motion, centre) = following(3);
        let gaussian = prior(&motion, &draws(&centre), Between::Gaussian);
        let x: Vec<f64> = centre.iter().enumerate().map(|(j, x)| x + 0.1 * (j as f64 - 1.5)).collect();
        let mut grad = vec![0.0; DIM];
        gaussian.log_density_grad(&x, &mut grad);
        for j in 0..DIM {
            let at = |h: f64| {
                let mut x = x.clone();
                x[j] += h;
                gaussian.log_density(&x)
            };
            let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((difference - grad[j]).abs() < 1e-6 * grad[j].abs().max(1.0), "{j}: {difference} for {}", grad[j]);
        }
    }

    #[test]
    fn until_action_primitives_are_matched_it_is_the_random_walks() {
        let (motion, centre) = following(2);
        let gaussian = prior(&motion, &draws(&centre), Between::Gaussian);
        let exact: f64 = (0..DIM)
            .map(|j| {
                let variance = 0.3 + motion.sd()[j].powi(2);
                -0.5 * ((centre[j] - 0.1).powi(2) / variance + (core::f64::consts::TAU * variance).ln())
            })
            .sum();
        assert!((gaussian.log_density(&centre) - exact).abs() < 1e-12 * exact.abs().max(1.0));
    }
}
