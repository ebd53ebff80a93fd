//! Places of the keypoints of left and right joints, which lie alike.
//!
//! A detector learns from images and from their mirror images: as far as it sees one hip beside its joint, it sees the other, mirrored. So two parts of the places L and R of a pair, along each axis, are independent beforehand, with σ = −1 along x, which goes across the body, and 1 along y and z:
//!
//! ```text
//! | shared |   1  | 1   σ | | L |
//! |        | = ── |       | |   |        shared ~ N(0, s² (1 + ρ)),   apart ~ N(0, s² (1 − ρ))
//! | apart  |   √2 | σ  −1 | | R |
//! ```
//!
//! L and R have the standard deviation s each, and the correlation σ ρ. The matrix is its own inverse. Apart is, of hips along y, a turn of the pelvis that the detector makes up. ρ is a judgement: limbs of one person and views of a recording are not quite alike.

use super::lasting_prior::stands_for_no_joint;
use sinew_dynamics::lasting_scales::{LastingData, LastingPrior};
use sinew_observe::lasting::lasting_errors::LastingErrors;
use std::f64::consts::FRAC_1_SQRT_2;

/// √(1 + ρ) and √(1 − ρ) for ρ = 0.8.
const PART_SDS: [f64; 2] = [1.341_640_786_499_874, 0.447_213_595_499_958];

/// Two numbers of g that lie alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirroredPair {
    /// Place in g of the left one; in the parts, of what both share.
    pub left: usize,
    /// Place in g of the right one; in the parts, of what is apart.
    pub right: usize,
    sign: f64,
}

impl MirroredPair {
    /// From numbers to parts, and back.
    fn exchanged(&self, [left, right]: [f64; 2]) -> [f64; 2] {
        [left + self.sign * right, self.sign * left - right].map(|x| FRAC_1_SQRT_2 * x)
    }
}

/// The pairs of places of some keypoints; points of head and feet stand for no joint.
#[must_use]
pub fn pairs(errors: &LastingErrors, points: &[String]) -> Vec<MirroredPair> {
    let of = |(left, name): (usize, &String)| {
        let other = format!("R{}", name.strip_prefix('L')?);
        let right = points.iter().position(|point| *point == other && !stands_for_no_joint(point))?;
        let places = errors.place(left).zip(errors.place(right)).zip([-1.0, 1.0, 1.0]);
        Some(places.map(|((left, right), sign)| MirroredPair { left, right, sign }))
    };
    points.iter().enumerate().filter_map(of).flatten().collect()
}

/// A prior of numbers, in which those of a pair stand in one cluster with one unit, as that of their parts.
#[must_use]
pub fn prior_of_parts(pairs: &[MirroredPair], mut prior: LastingPrior) -> LastingPrior {
    for pair in pairs {
        for cluster in &mut prior.clusters {
            let at = |place: usize| cluster.numbers.iter().position(|number| number.0 == place);
            let Some((left, right)) = at(pair.left).zip(at(pair.right)) else { continue };
            let means = pair.exchanged([cluster.numbers[left].1, cluster.numbers[right].1]);
            for ((number, mean), sd) in [left, right].into_iter().zip(means).zip(PART_SDS) {
                let (_, own, unit) = &mut cluster.numbers[number];
                (*own, *unit) = (mean, sd * *unit);
            }
        }
    }
    prior
}

/// Puts parts in place of the numbers of pairs, or numbers in place of parts.
pub fn exchange(pairs: &[MirroredPair], g: &mut [f64]) {
    for pair in pairs {
        [g[pair.left], g[pair.right]] = pair.exchanged([g[pair.left], g[pair.right]]);
    }
}

/// The same of mean and standard deviation of each number's prior.
pub(super) fn exchange_prior(pairs: &[MirroredPair], prior: &mut [[f64; 2]]) {
    for pair in pairs {
        let [[left, left_sd], [right, right_sd]] = [prior[pair.left], prior[pair.right]];
        let sd = FRAC_1_SQRT_2 * left_sd.hypot(right_sd);
        let [left, right] = pair.exchanged([left, right]);
        (prior[pair.left], prior[pair.right]) = ([left, sd], [right, sd]);
    }
}

/// What the data say of the parts.
pub(super) fn in_parts(pairs: &[MirroredPair], mut data: LastingData) -> LastingData {
    let p = data.pull.len();
    data.information.chunks_exact_mut(p).for_each(|row| exchange(pairs, row));
    for pair in pairs {
        for column in 0..p {
            let [left, right] = [pair.left * p + column, pair.right * p + column];
            let parts = pair.exchanged([data.information[left], data.information[right]]);
            [data.information[left], data.information[right]] = parts;
        }
    }
    exchange(pairs, &mut data.pull);
    data
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lasting_prior::prior;
    use sinew_body::Proportions;

    const NAMES: [&str; 6] = ["LHip", "RKnee", "RHip", "LHeel", "RHeel", "MidHip"];

    fn names() -> Vec<String> {
        NAMES.map(str::to_owned).to_vec()
    }

    const ERRORS: LastingErrors = LastingErrors { cameras: 0, lengths: 9, points: NAMES.len() };

    #[test]
    fn joints_with_both_sides_are_pairs() {
        let pairs = pairs(&ERRORS, &names());
        let [left, right] = [0, 2].map(|point| ERRORS.place(point));
        let expected: Vec<MirroredPair> = [(0, -1.0), (1, 1.0), (2, 1.0)]
            .map(|(axis, sign)| MirroredPair { left: left.start + axis, right: right.start + axis, sign })
            .to_vec();
        assert_eq!(pairs, expected);
    }

    /// What the prior says of two hips, from its parts: covariance of H diag(shared, apart) Hᵀ, entry by entry.
    #[test]
    fn hips_lie_alike_and_each_as_far_as_its_scale_says() {
        let pairs = pairs(&ERRORS, &names());
        let places = [[0.01, 0.0, 0.0], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]];
        let prior = prior_of_parts(&pairs, prior(&ERRORS, &names(), &Proportions::default(), &places, 0, 0.02));
        let number = |place: usize| {
            let mut all = prior.clusters.iter().flat_map(|cluster| &cluster.numbers);
            *all.find(|(own, ..)| *own == place).unwrap()
        };
        // The left hip is expected 1 cm aside.
        let [(_, shared, _), (_, apart, _)] = [pairs[0].left, pairs[0].right].map(number);
        assert!((shared - 0.01 / 2.0_f64.sqrt()).abs() < 1e-12 && (apart + 0.01 / 2.0_f64.sqrt()).abs() < 1e-12);
        for pair in &pairs {
            let parts = [pair.left, pair.right].map(|place| number(place).2.powi(2));
            let rows = [[1.0, 0.0], [0.0, 1.0]].map(|number| pair.exchanged(number));
            let covariance = |i: usize, j: usize| (0..2).map(|k| rows[i][k] * parts[k] * rows[j][k]).sum::<f64>();
            assert!((covariance(0, 0) - 1.0).abs() < 1e-12 && (covariance(1, 1) - 1.0).abs() < 1e-12);
            assert!((covariance(0, 1) - 0.8 * pair.sign).abs() < 1e-12, "{}", covariance(0, 1));
        }
    }

    #[test]
    fn data_say_the_same_of_parts() {
        let p = ERRORS.count();
        let wave = |i: usize| (1.7 * i as f64).sin();
        let information = (0..p * p).map(|k| wave((k / p).min(k % p) * p + (k / p).max(k % p))).collect();
        let data = LastingData { information, pull: (0..p).map(|i| wave(3 * i + 1)).collect() };
        let g: Vec<f64> = (0..p).map(|i| wave(5 * i + 2)).collect();
        let log_density = |data: &LastingData, g: &[f64]| {
            let row = |i: usize| data.information[i * p..][..p].iter().zip(g).map(|(a, g)| a * g).sum::<f64>();
            (0..p).map(|i| g[i] * (data.pull[i] - 0.5 * row(i))).sum::<f64>()
        };
        let pairs = pairs(&ERRORS, &names());
        let mut parts = g.clone();
        exchange(&pairs, &mut parts);
        assert!(parts != g);
        let expected = log_density(&data, &g);
        assert!((log_density(&in_parts(&pairs, data), &parts) - expected).abs() < 1e-9);
        exchange(&pairs, &mut parts);
        assert!(parts.iter().zip(&g).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    /// Of numbers of known means and spreads, what is kept beside them stays so.
    #[test]
    fn priors_of_numbers_follow_from_those_of_parts() {
        let pairs = pairs(&ERRORS, &names());
        let mut kept = vec![[0.0, 0.0]; ERRORS.count()];
        let mut means = vec![0.0; ERRORS.count()];
        (means[pairs[0].left], means[pairs[0].right]) = (0.003, -0.001);
        let expected = means.clone();
        exchange(&pairs, &mut means);
        kept.iter_mut().zip(means).for_each(|(kept, mean)| kept[0] = mean);
        for pair in &pairs {
            [kept[pair.left][1], kept[pair.right][1]] = PART_SDS.map(|sd| 0.02 * sd);
        }
        exchange_prior(&pairs, &mut kept);
        for pair in &pairs {
            for place in [pair.left, pair.right] {
                assert!((kept[place][0] - expected[place]).abs() < 1e-15 && (kept[place][1] - 0.02).abs() < 1e-15);
            }
        }
    }
}
