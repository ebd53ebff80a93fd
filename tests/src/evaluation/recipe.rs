//! The usual recipe that a tracker is compared with.
//!
//! Points triangulated one by one, gaps filled linearly, a Butterworth low-pass.

use sinew::formats::Layout;
use sinew::observe::Camera;
use sinew::observe::association::Person;
use sinew::observe::cameras::triangulate::{Config, Seen, triangulate};
use std::f64::consts::PI;

/// Positions of some points, frame by frame; `None` is missing.
pub type Track = Vec<Vec<Option<[f64; 3]>>>;

/// Named points one by one from the keypoints of each frame (cameras, points of the layout) by the reference recipe.
#[must_use]
pub fn triangulated(cameras: &[Camera], layout: &Layout, frames: &[Vec<Person>], names: &[&str]) -> Track {
    let config = Config::reference_recipe();
    let point = |views: &Vec<Person>, name: &str| {
        let k = layout.index(name)?;
        let seen: Vec<Seen<'_>> = cameras
            .iter()
            .zip(views)
            .filter_map(|(camera, person)| {
                let d = person.get(k).copied().flatten()?;
                Some(Seen { camera, pixel: d.pixel, confidence: d.confidence })
            })
            .collect();
        Some(triangulate(&seen, &config)?.point)
    };
    frames.iter().map(|views| names.iter().map(|name| point(views, name)).collect()).collect()
}

/// Fills gaps linearly; before the first and after the last sighting a point stays where it was seen.
#[must_use]
pub fn filled(track: &Track) -> Track {
    let mut out = track.clone();
    for k in 0..track.first().map_or(0, Vec::len) {
        let known: Vec<(usize, [f64; 3])> =
            track.iter().enumerate().filter_map(|(f, frame)| Some((f, frame[k]?))).collect();
        for (f, frame) in out.iter_mut().enumerate() {
            let after = known.partition_point(|(g, _)| *g < f);
            frame[k] = match (after.checked_sub(1).map(|i| known[i]), known.get(after)) {
                (_, Some(&(g, p))) if g == f => Some(p),
                (Some((g, p)), Some(&(h, q))) => {
                    let part = (f - g) as f64 / (h - g) as f64;
                    Some(std::array::from_fn(|a| p[a] + part * (q[a] - p[a])))
                }
                (Some((_, p)), None) | (None, Some(&(_, p))) => Some(p),
                (None, None) => None,
            };
        }
    }
    out
}

/// Butterworth low-pass as sections of second order by the bilinear transform, `y = b0 x + b1 x' + b2 x'' − a1 y' − a2 y''`, each given by its damping, twice the
/// negative cosine of the angle of its poles.
fn low_pass(series: &[f64], rate_hz: f64, cutoff_hz: f64, dampings: &[f64]) -> Vec<f64> {
    let Some(&first) = series.first() else { return vec![] };
    let w = (PI * cutoff_hz / rate_hz).tan();
    let mut out = series.to_vec();
    for damping in dampings {
        let norm = 1.0 + damping * w + w * w;
        let (b, a1, a2) = (w * w / norm, 2.0 * (w * w - 1.0) / norm, (1.0 - damping * w + w * w) / norm);
        // Begins as if the first value had always been.
        let (mut x1, mut x2, mut y1, mut y2) = (first, first, first, first);
        for value in &mut out {
            let x = *value;
            *value = b * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
            (x2, x1, y2, y1) = (x1, x, y1, *value);
        }
    }
    out
}

/// Dampings of the Butterworth filter of second order.
const SECOND_ORDER: [f64; 1] = [std::f64::consts::SQRT_2];
/// Dampings of the Butterworth filter of fourth order, `2 cos(π/8)` and `2 cos(3π/8)`.
const FOURTH_ORDER: [f64; 2] = [1.847_759_065_022_573_5, 0.765_366_864_730_179_6];

/// Forward and backward, ends continued by reflection through the end point.
fn low_pass_both_ways(series: &[f64], rate_hz: f64, cutoff_hz: f64) -> Vec<f64> {
    let n = series.len();
    let pad = 9.min(n.saturating_sub(1));
    let before = (1..=pad).rev().map(|i| 2.0 * series[0] - series[i]);
    let after = (1..=pad).map(|i| 2.0 * series[n - 1] - series[n - 1 - i]);
    let extended: Vec<f64> = before.chain(series.iter().copied()).chain(after).collect();
    let mut once = low_pass(&extended, rate_hz, cutoff_hz, &SECOND_ORDER);
    once.reverse();
    let mut twice = low_pass(&once, rate_hz, cutoff_hz, &SECOND_ORDER);
    twice.reverse();
    twice[pad..pad + n].to_vec()
}

fn each_coordinate(track: &Track, filter: impl Fn(&[f64]) -> Vec<f64>) -> Track {
    let mut out = filled(track);
    for k in 0..out.first().map_or(0, Vec::len) {
        for a in 0..3 {
            let series: Option<Vec<f64>> = out.iter().map(|frame| Some(frame[k]?[a])).collect();
            let Some(series) = series else { continue };
            for (frame, value) in out.iter_mut().zip(filter(&series)) {
                if let Some(point) = &mut frame[k] {
                    point[a] = value;
                }
            }
        }
    }
    out
}

/// A Butterworth low-pass of fourth order, forward only.
#[must_use]
pub fn causal(track: &Track, rate_hz: f64, cutoff_hz: f64) -> Track {
    each_coordinate(track, |series| low_pass(series, rate_hz, cutoff_hz, &FOURTH_ORDER))
}

/// A Butterworth low-pass of second order forward and backward: fourth order without delay, from the whole recording.
#[must_use]
pub fn zero_phase(track: &Track, rate_hz: f64, cutoff_hz: f64) -> Track {
    each_coordinate(track, |series| low_pass_both_ways(series, rate_hz, cutoff_hz))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(hz: f64, n: usize) -> Vec<f64> {
        (0..n).map(|t| (2.0 * PI * hz * t as f64 / 60.0).sin()).collect()
    }

    /// Amplitude of a wave of whole periods.
    fn amplitude(series: &[f64]) -> f64 {
        (2.0 * series.iter().map(|x| x * x).sum::<f64>() / series.len() as f64).sqrt()
    }

    #[test]
    fn the_low_pass_has_half_the_power_at_its_cutoff_and_keeps_constants() {
        for order in [&SECOND_ORDER[..], &FOURTH_ORDER] {
            let once = low_pass(&wave(6.0, 600), 60.0, 6.0, order);
            assert!((amplitude(&once[300..]) - 0.5_f64.sqrt()).abs() < 1e-6, "{}", amplitude(&once[300..]));
            // Beyond the cutoff the power falls with the frequency to twice the order, which the bilinear transform counts as tan(π f / rate).
            let ratio = (PI * 0.2).tan() / (PI * 0.1).tan();
            let expected = (1.0 + ratio.powi(4 * order.len() as i32)).sqrt().recip();
            let beyond = amplitude(&low_pass(&wave(12.0, 600), 60.0, 6.0, order)[300..]);
            assert!((beyond / expected - 1.0).abs() < 1e-6, "{beyond} {expected}");
            assert!(low_pass(&[3.0; 50], 60.0, 6.0, order).iter().all(|y| (y - 3.0).abs() < 1e-12));
        }
        let twice = low_pass_both_ways(&wave(6.0, 600), 60.0, 6.0);
        assert!((amplitude(&twice[200..400]) - 0.5).abs() < 1e-6);
    }

    #[test]
    fn only_the_causal_filter_lags() {
        let x = wave(1.0, 240);
        let lag = |y: &[f64]| (60..180).map(|t| (y[t] - x[t]).abs()).fold(0.0, f64::max);
        assert!(lag(&low_pass_both_ways(&x, 60.0, 6.0)) < 0.01);
        assert!(lag(&low_pass(&x, 60.0, 6.0, &SECOND_ORDER)) > 0.1);
    }

    #[test]
    fn gaps_are_filled_linearly_and_ends_held() {
        let at = |x: f64| Some([x, 0.0, 2.0 * x]);
        let track = vec![vec![None], vec![at(1.0)], vec![None], vec![None], vec![at(4.0)], vec![None]];
        let filled: Vec<f64> = filled(&track).iter().map(|frame| frame[0].unwrap()[2]).collect();
        assert_eq!(filled, [2.0, 2.0, 4.0, 6.0, 8.0, 8.0]);
        assert_eq!(super::filled(&vec![vec![None]; 3]), vec![vec![None]; 3]);
    }
}
