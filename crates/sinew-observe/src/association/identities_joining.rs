//! Who was away and is back: stays of the same person, over a whole recording.
//!
//! A stay is what was seen of somebody without a break. Of stays i and j, j begun after the end of i, the log odds that they are of the same person are a sum of two likelihood ratios against "somebody new":
//!
//! 1. **Lengths of segments.** The medians of the log lengths in the two stays differ by d. If it is the same person, d ~ N(0, V), V the variances of both medians (scatter over the frames, and `LASTING`, which does not average out) and an error of scale that all have in common (`SCALE`). If they are another adult, stature and the shares of the segments differ besides (`STATURE`, `SEGMENT`). Both are a diagonal and a rank one.
//! 2. **The way.** Nobody goes faster than `FASTEST_M_S`. Whoever is back at once is near where they left, N(0, (0.5 m + 1 m/s t)²); the longer they are away, the more likely they come from anywhere, as somebody new does: evenly over `AREA_M2`.
//!
//! All stays are joined at once so that the sum of the log odds is greatest ([`least_cost`]). How sure a join is follows from what the sum loses without it, whoever both may be then: **log odds of the best joint explanation with it to the best one without it**. Below `LEAST_LOG_ODDS` they are somebody new, since a wrong name is worse than a new one. Of two people of one size who left together, only the way can say who is back; if it does not, both are new.
//!
//! Cost: cubic in the stays for the assignment, times the joins.

use crate::association::assignment::least_cost;
use sinew_core::estimators::median;
use std::f64::consts::TAU;

/// Standard deviation of the stature of adults, as a share (National Health Survey 1960–62, Vital and Health Statistics 11(8), table 2).
const STATURE: f64 = 0.057;
/// The same of a segment for a stature: by how much its share of the body differs.
const SEGMENT: f64 = 0.03;
/// Error of a segment's length in a stay that more frames do not lessen, as a share.
const LASTING: f64 = 0.015;
/// The same that all segments have in common.
const SCALE: f64 = 0.01;
/// Seconds over which errors of successive frames are about the same.
const CORRELATED_S: f64 = 0.1;
/// Fastest that somebody goes who is away, metres a second, and what they may be off besides, metres.
const FASTEST_M_S: f64 = 4.0;
const SLACK_M: f64 = 0.5;
/// How far somebody is from where they left, at once, metres, and with each second.
const NEAR_M: f64 = 0.5;
const NEAR_M_S: f64 = 1.0;
/// Seconds after which they come from anywhere with the probability 1 − 1/e.
const ANYWHERE_S: f64 = 4.0;
/// Ground over which newcomers are spread, square metres.
const AREA_M2: f64 = 25.0;
/// Seconds that a stay has at least to be joined, and frames.
const LEAST_S: f64 = 0.25;
const LEAST_FRAMES: f64 = 5.0;
/// Log odds from which a name is given again, some 9 to 2. Chosen on simulated crowds 1 to 60 (`cargo xtask study people`).
pub const LEAST_LOG_ODDS: f64 = 1.5;

/// What was seen of somebody without a break.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stay {
    /// First and last frame in which two views agreed on them.
    pub frames: [u64; 2],
    /// Middle of their points then, metres.
    pub places: [[f64; 3]; 2],
    /// Log lengths of each segment, one a frame in which it was seen, of metres.
    pub log_lengths: Vec<Vec<f64>>,
}

/// Who came to stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Naming {
    /// Number of the person, from 0 in the order of coming.
    pub person: usize,
    /// Whom they were taken for, or could be.
    pub likeness: Option<Likeness>,
}

/// Somebody who was there before and could be back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Likeness {
    /// Their number. They have their name again if [`Naming::person`] is the same.
    pub person: usize,
    /// Log odds that it is that person, at least 0. They are to the best explanation of all stays in which it is not.
    pub log_odds: f64,
}

impl Likeness {
    /// Probability that it is that person.
    #[must_use]
    pub fn probability(&self) -> f64 {
        1.0 / (1.0 + (-self.log_odds).exp())
    }
}

/// Median log length of a segment, and the variance of its error.
type Length = Option<(f64, f64)>;

/// Who each stay is of; stays are in the order of coming.
#[must_use]
pub fn joined(stays: &[Stay], fps: f64) -> Vec<Naming> {
    let lengths: Vec<Vec<Length>> = stays.iter().map(|stay| lengths(stay, fps)).collect();
    let least = (LEAST_S * fps).max(LEAST_FRAMES);
    let is_long = |stay: &Stay| stay.log_lengths.iter().any(|lengths| lengths.len() as f64 >= least);
    let cost = |back: usize, left: usize| {
        let way = way_log_odds(&stays[left], &stays[back], fps).filter(|_| left < back && is_long(&stays[left]))?;
        let log_odds = way + length_log_odds(&lengths[left], &lengths[back]);
        // Whoever is more likely new costs more than nobody, and is in no best assignment.
        (log_odds > 0.0).then_some(-log_odds)
    };
    let row = |back: usize| -> Vec<f64> {
        let cost = |left| if is_long(&stays[back]) { cost(back, left) } else { None };
        (0..stays.len()).map(|left| cost(left).unwrap_or(f64::INFINITY)).collect()
    };
    let mut costs: Vec<Vec<f64>> = (0..stays.len()).map(row).collect();
    let found = least_cost(&costs, 0.0);
    let least = total(&costs, &found);
    let mut named: Vec<Naming> = vec![];
    let mut people = 0;
    for (back, left) in found.iter().enumerate() {
        let likeness = left.map(|left| {
            let own = std::mem::replace(&mut costs[back][left], f64::INFINITY);
            let log_odds = total(&costs, &least_cost(&costs, 0.0)) - least;
            costs[back][left] = own;
            Likeness { person: named[left].person, log_odds }
        });
        let known = likeness.filter(|likeness| likeness.log_odds >= LEAST_LOG_ODDS);
        named.push(Naming { person: known.map_or(people, |known| known.person), likeness });
        people += usize::from(known.is_none());
    }
    named
}

fn total(costs: &[Vec<f64>], found: &[Option<usize>]) -> f64 {
    costs.iter().zip(found).filter_map(|(row, left)| Some(row[(*left)?])).sum()
}

/// Lengths of the segments in a stay.
fn lengths(stay: &Stay, fps: f64) -> Vec<Length> {
    let length = |all: &Vec<f64>| {
        let middle = median(&mut all.clone());
        let spread = 1.4826 * median(&mut all.iter().map(|x| (x - middle).abs()).collect::<Vec<_>>());
        let independent = all.len() as f64 / (CORRELATED_S * fps).max(1.0);
        // The median of Gaussian errors has π/2 times the variance of their mean.
        let variance = 0.25 * TAU * spread * spread / independent;
        (!all.is_empty()).then_some((middle, variance + LASTING * LASTING))
    };
    stay.log_lengths.iter().map(length).collect()
}

/// Log likelihood ratio of one person to two, from the lengths that two stays both have.
fn length_log_odds(left: &[Length], back: &[Length]) -> f64 {
    let both: Vec<(f64, f64)> = left
        .iter()
        .zip(back)
        .filter_map(|(left, back)| {
            let ((a, a_variance), (b, b_variance)) = ((*left)?, (*back)?);
            Some((a - b, a_variance + b_variance))
        })
        .collect();
    let other: Vec<(f64, f64)> = both.iter().map(|(d, variance)| (*d, variance + 2.0 * SEGMENT * SEGMENT)).collect();
    log_density(&both, 2.0 * SCALE * SCALE) - log_density(&other, 2.0 * (SCALE * SCALE + STATURE * STATURE))
}

/// Log density of Gaussian numbers, up to a constant. Each has a variance of its own, and all a part of the variance `common`.
fn log_density(numbers: &[(f64, f64)], common: f64) -> f64 {
    let sum = |value: &dyn Fn(f64, f64) -> f64| numbers.iter().map(|(x, variance)| value(*x, *variance)).sum::<f64>();
    let grown = 1.0 + common * sum(&|_, variance| 1.0 / variance);
    let square = sum(&|x, variance| x * x / variance) - common * sum(&|x, variance| x / variance).powi(2) / grown;
    -0.5 * (sum(&|_, variance| variance.ln()) + grown.ln() + square)
}

/// Log likelihood ratio of where somebody comes; `None` where they cannot have gone.
fn way_log_odds(left: &Stay, back: &Stay, fps: f64) -> Option<f64> {
    let frames = back.frames[0].checked_sub(left.frames[1]).filter(|frames| *frames > 0)?;
    let (seconds, [from, to]) = (frames as f64 / fps, [left.places[1], back.places[0]]);
    let square = (0..3).map(|axis| (to[axis] - from[axis]).powi(2)).sum::<f64>();
    if square.sqrt() > SLACK_M + FASTEST_M_S * seconds {
        return None;
    }
    let variance = (NEAR_M + NEAR_M_S * seconds).powi(2);
    let near = (-seconds / ANYWHERE_S).exp();
    let density = (-0.5 * square / variance).exp() / (TAU * variance);
    Some((near * AREA_M2 * density + 1.0 - near).ln())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FPS: f64 = 30.0;

    /// Thirty frames of somebody with five segments, who stands in one place.
    fn stay(first: u64, x: f64, lengths: [f64; 5]) -> Stay {
        let noisy = |length: f64| (0..30).map(|k| length.ln() + 0.05 * f64::from(k % 3 - 1)).collect();
        Stay { frames: [first, first + 29], places: [[x, 0.0, 1.0]; 2], log_lengths: lengths.map(noisy).to_vec() }
    }

    fn people(stays: &[Stay]) -> Vec<usize> {
        joined(stays, FPS).iter().map(|naming| naming.person).collect()
    }

    const SHORT: [f64; 5] = [0.36, 0.36, 0.25, 0.23, 0.46];
    const TALL: [f64; 5] = [0.45, 0.44, 0.31, 0.28, 0.58];

    #[test]
    fn people_of_different_sizes_are_known_again_whoever_comes_first() {
        let left = [stay(0, 0.0, SHORT), stay(0, 1.0, TALL)];
        for (first, second) in [(SHORT, TALL), (TALL, SHORT)] {
            let back = [stay(60, 0.5, first), stay(60, 0.6, second)];
            let expected = if first == SHORT { [0, 1, 0, 1] } else { [0, 1, 1, 0] };
            assert_eq!(people(&[left.clone(), back].concat()), expected);
        }
    }

    #[test]
    fn two_people_of_one_size_who_come_back_between_where_they_left_are_both_new() {
        let stays = [stay(0, 0.0, SHORT), stay(0, 1.0, SHORT), stay(90, 0.5, SHORT), stay(90, 0.5, SHORT)];
        assert_eq!(people(&stays), [0, 1, 2, 3]);
        let doubtful = joined(&stays, FPS)[2].likeness.expect("could be either");
        assert!(doubtful.log_odds < 1e-9 && (doubtful.probability() - 0.5).abs() < 1e-9, "{doubtful:?}");
        // The way alone can tell them apart.
        let stays = [stay(0, 0.0, SHORT), stay(0, 6.0, SHORT), stay(50, 6.1, SHORT), stay(50, 0.1, SHORT)];
        assert_eq!(people(&stays), [0, 1, 1, 0]);
    }

    #[test]
    fn all_are_joined_at_once_and_not_the_likeliest_first() {
        let between = [0, 1, 2, 3, 4].map(|k: usize| (SHORT[k] * TALL[k]).sqrt());
        let nearer = |a: [f64; 5], b: [f64; 5], part: f64| {
            [0, 1, 2, 3, 4].map(|k: usize| a[k].powf(1.0 - part) * b[k].powf(part))
        };
        // The second is a little more like the first who left, but the first is so only.
        let stays = [
            stay(0, 0.0, between),
            stay(0, 0.0, nearer(between, TALL, 0.3)),
            stay(60, 0.0, nearer(between, TALL, 0.1)),
            stay(60, 0.0, nearer(between, SHORT, 0.3)),
        ];
        let costs: Vec<f64> =
            (0..2).map(|left| length_log_odds(&lengths(&stays[left], FPS), &lengths(&stays[2], FPS))).collect();
        assert!(costs[0] > costs[1], "{costs:?}");
        let likeness: Vec<usize> = joined(&stays, FPS)[2..].iter().map(|n| n.likeness.unwrap().person).collect();
        assert_eq!(likeness, [1, 0]);
    }

    #[test]
    fn nobody_is_known_by_a_moment_nor_where_he_cannot_have_gone_nor_while_he_is_there() {
        let moment = Stay { log_lengths: SHORT.map(|length| vec![length.ln(); 4]).to_vec(), ..stay(60, 0.0, SHORT) };
        assert_eq!(people(&[stay(0, 0.0, SHORT), moment]), [0, 1]);
        for (far_m, expected) in [(70.0, [0, 0]), (100.0, [0, 1])] {
            assert_eq!(people(&[stay(0, 0.0, SHORT), stay(600, far_m, SHORT)]), expected, "{far_m} m in 19 s");
        }
        assert_eq!(people(&[stay(0, 0.0, SHORT), stay(29, 0.0, SHORT)]), [0, 1]);
        assert_eq!(people(&[stay(0, 0.0, SHORT), stay(60, 0.0, SHORT), stay(120, 0.0, SHORT)]), [0, 0, 0]);
        assert_eq!(joined(&[], FPS), []);
    }

    #[test]
    fn densities_with_a_common_part_integrate_to_one() {
        for common in [0.0, 0.003, 0.01] {
            let (step, mut mass) = (0.005, 0.0);
            for x in -150..=150 {
                for y in -150..=150 {
                    let numbers = [(f64::from(x) * step, 0.001), (f64::from(y) * step, 0.004)];
                    mass += log_density(&numbers, common).exp() * step * step / TAU;
                }
            }
            assert!((mass - 1.0).abs() < 1e-6, "{mass} with {common}");
        }
    }
}
