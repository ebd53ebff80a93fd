//! How good a tracker is: whole runs in memory, what it is compared with, and the statistics of the comparison.
//!
//! | function | what |
//! |---|---|
//! | [`run`] | set-up from some frames, then filter and smoother over others |
//! | [`triangulated`], [`filled`], [`causal`], [`zero_phase`] | the usual recipe: points one by one, gaps filled, a Butterworth low-pass |
//! | [`mean_distance`] | of tracks to a reference |
//! | [`pixel_errors`] | distance to the keypoints of a camera that was left out |
//! | [`covered`], [`block_bootstrap`] | share of true coordinates inside the 90 % intervals, and its standard error |

use crate::Error;
use crate::body::standard::EVALUATION_JOINTS;
use crate::body::{KinematicTree, Proportions};
use crate::core::lanes::Block;
use crate::core::random::Stage;
use crate::estimate::FrameEstimate;
use crate::formats::Layout;
use crate::observe::association::Person;
use crate::observe::triangulate::{Config, Seen, triangulate};
use crate::observe::{Camera, offsets};
use crate::pipeline::{self, FrameSource, Method, Pipeline, Settings, Spool};
use crate::setup::{self, Request, Setup};
use crate::synthetic::points::{Trajectories, of_states};
use std::f64::consts::PI;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicU64, Ordering};

/// Joints that are compared with a reference: those of the limbs.
pub const LIMB_JOINTS: [&str; 12] = *EVALUATION_JOINTS.split_at(2).1.first_chunk().expect("fifteen joints");

/// Positions of some points, frame by frame; `None` is missing.
pub type Track = Vec<Vec<Option<[f64; 3]>>>;

/// What came of a recording.
pub struct Run {
    /// The set-up.
    pub setup: Setup,
    /// The body.
    pub tree: KinematicTree,
    /// Estimates from the frames up to each.
    pub filtered: Vec<FrameEstimate>,
    /// Estimates from all frames.
    pub smoothed: Vec<FrameEstimate>,
}

/// Sets up from `setup_frames`, motion noise and step size included, and tracks `frames`. Known proportions replace those of the set-up.
///
/// # Errors
/// Those of the source, the set-up and the tracker.
pub fn run(
    source: &mut dyn FrameSource,
    setup_frames: Range<u64>,
    frames: Range<u64>,
    settings: &Settings,
    known: Option<&Proportions>,
) -> Result<Run, Error> {
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let people: Vec<_> = setup_frames.clone().map(|number| Ok((number, source.people(number)?))).collect();
    let (mut setup, _) = setup::set_up(&cameras, &layout, &Request::default(), people)?;
    if let Some(known) = known {
        setup.proportions = *known;
    }
    let tree = setup.tree();
    setup.motion_sd = Some(pipeline::measure_motion(&setup, &tree, source, setup_frames, settings.fps)?);
    if settings.method == Method::Hmc {
        let start = setup.start_frame;
        pipeline::tune(&mut setup, &tree, source, start, settings)?;
    }
    let mut pipeline = Pipeline::new(&setup, &tree, &cameras, &layout, settings.clone())?;
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let name = format!("sinew-evaluation-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let mut spool =
        Spool::temporary(&std::env::temp_dir().join(name), [tree.dof(), cameras.len(), pipeline.keypoints().len()])?;
    let (mut filtered, mut smoothed) = (vec![], vec![]);
    pipeline.track(source, frames, |estimate, posterior| {
        spool.append(&estimate, &pipeline::moments(posterior, settings.isa))?;
        filtered.push(estimate);
        Ok(ControlFlow::Continue(()))
    })?;
    pipeline::smooth(
        &mut spool,
        &pipeline,
        &tree,
        || Ok(()),
        |estimate| {
            smoothed.push(estimate);
            Ok(ControlFlow::Continue(()))
        },
    )?;
    Ok(Run { setup, tree, filtered, smoothed })
}

/// Positions of named points in the pose of the mean state.
#[must_use]
pub fn positions(tree: &KinematicTree, estimates: &[FrameEstimate], names: &[&str]) -> Track {
    let states: Vec<Vec<f64>> = estimates.iter().map(|estimate| estimate.mean_state.clone()).collect();
    let points = of_states(tree, &states);
    let columns: Vec<Option<usize>> = names.iter().map(|name| points.index(name)).collect();
    points.frames.iter().map(|frame| columns.iter().map(|k| k.map(|k| frame[k])).collect()).collect()
}

/// Mean over frames and named points of the spread in space, the root of the summed variances of x, y and z, metres: what [`mean_distance`] should be near to.
#[must_use]
pub fn mean_spread(tree: &KinematicTree, estimates: &[FrameEstimate], names: &[&str]) -> f64 {
    let columns = || names.iter().filter_map(|name| tree.point_index(name));
    let spread = |sd: [f64; 3]| sd.iter().map(|sd| sd * sd).sum::<f64>().sqrt();
    let all = estimates.iter().flat_map(|e| columns().map(move |k| spread(e.points[k].sd)));
    let (sum, count) = all.fold((0.0, 0.0), |(sum, count), spread| (sum + spread, count + 1.0));
    sum / count
}

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

/// Mean distance over the given frames and all points that both have, metres.
#[must_use]
pub fn mean_distance(a: &Track, b: &Track, frames: Range<usize>) -> f64 {
    let pairs = frames.filter_map(|f| Some(a.get(f)?.iter().zip(b.get(f)?))).flatten();
    let distance = |(p, q): (&Option<[f64; 3]>, &Option<[f64; 3]>)| {
        let (p, q) = ((*p)?, (*q)?);
        Some((0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt())
    };
    let (sum, count) = pairs.filter_map(distance).fold((0.0, 0.0), |(sum, count), d| (sum + d, count + 1.0));
    sum / count
}

/// Distances in a camera, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelErrors {
    /// Median.
    pub median: f64,
    /// 90th percentile.
    pub p90: f64,
    /// Number of keypoints.
    pub count: usize,
}

/// A camera and what it saw of the person, frame by frame (points of the layout).
pub struct LeftOut<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// Keypoints of each frame.
    pub keypoints: Vec<&'a Person>,
    /// Detections of lower confidence do not count.
    pub least_confidence: f64,
}

/// Compares the projections of a track with the keypoints of a camera that had no part in it. The camera's constant offset is the median of observed − projected over the frames
/// `offset`; distances are those of the frames `judged`.
#[must_use]
pub fn pixel_errors(
    left_out: &LeftOut<'_>,
    layout: &Layout,
    track: &Track,
    names: &[&str],
    offset: Range<usize>,
    judged: Range<usize>,
) -> PixelErrors {
    let columns: Vec<Option<usize>> = names.iter().map(|name| layout.index(name)).collect();
    let differences = |frames: Range<usize>| -> Vec<[f64; 2]> {
        let mut out = vec![];
        for f in frames {
            let (Some(points), Some(person)) = (track.get(f), left_out.keypoints.get(f)) else { continue };
            for (point, k) in points.iter().zip(&columns) {
                let seen = k.and_then(|k| person.get(k).copied().flatten());
                let (Some(point), Some(d)) = (point, seen) else { continue };
                if d.confidence < left_out.least_confidence {
                    continue;
                }
                if let Some([u, v]) = left_out.camera.project(*point).pixel() {
                    out.push([d.pixel[0] - u, d.pixel[1] - v]);
                }
            }
        }
        out
    };
    let known = differences(offset);
    let shift = [0, 1].map(|a: usize| offsets::median(&mut known.iter().map(|d| d[a]).collect::<Vec<_>>()));
    let mut distances: Vec<f64> =
        differences(judged).iter().map(|d| (d[0] - shift[0]).hypot(d[1] - shift[1])).collect();
    distances.sort_by(f64::total_cmp);
    let at = |p: f64| distances.get((p * distances.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    PixelErrors { median: at(0.5), p90: at(0.9), count: distances.len() }
}

/// For each frame and named point the share of its three true coordinates inside the 90 % intervals; NaN for points that the truth or the body lacks.
#[must_use]
pub fn covered(
    tree: &KinematicTree,
    estimates: &[FrameEstimate],
    truth: &Trajectories,
    names: &[&str],
) -> Vec<Vec<f64>> {
    let columns: Vec<_> = names.iter().map(|name| Some((tree.point_index(name)?, truth.index(name)?))).collect();
    let share = |estimate: &FrameEstimate, (k, m): (usize, usize)| {
        let (marginal, point) = (&estimate.points[k], truth.frames[estimate.number as usize][m]);
        let inside = |a: &usize| (marginal.q05[*a]..=marginal.q95[*a]).contains(&point[*a]);
        (0..3).filter(inside).count() as f64 / 3.0
    };
    estimates.iter().map(|e| columns.iter().map(|c| c.map_or(f64::NAN, |c| share(e, c))).collect()).collect()
}

/// Standard error of the mean of some time series, by a block bootstrap (Künsch 1989): as many blocks of `block` consecutive values as make up each series are drawn anew from it, with replacement,
/// and the mean over all series is taken; `replicates` times.
#[must_use]
pub fn block_bootstrap(series: &[Vec<f64>], block: usize, replicates: usize, seed: u64) -> f64 {
    let block = block.max(1);
    let mut rng = Stage::new(seed, "block bootstrap").whole();
    let mut buffer = [Block::ZERO; 8];
    let mut left: Vec<f64> = vec![];
    let mut uniform = || {
        if left.is_empty() {
            rng.fill_uniform(&mut buffer);
            left.extend(buffer.iter().flat_map(|block| block.0));
        }
        left.pop().unwrap_or(0.5)
    };
    let mut mean = || {
        let (mut sum, mut count) = (0.0, 0.0);
        for values in series.iter().filter(|values| !values.is_empty()) {
            let size = block.min(values.len());
            for _ in 0..values.len().div_ceil(size) {
                let first = (uniform() * (values.len() - size + 1) as f64) as usize;
                sum += values[first..first + size].iter().sum::<f64>();
                count += size as f64;
            }
        }
        sum / count
    };
    let means: Vec<f64> = (0..replicates).map(|_| mean()).collect();
    let centre = means.iter().sum::<f64>() / means.len() as f64;
    (means.iter().map(|m| (m - centre).powi(2)).sum::<f64>() / (means.len() as f64 - 1.0)).sqrt()
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

    #[test]
    fn distances_count_what_both_have() {
        let a = vec![vec![Some([0.0; 3]), None], vec![Some([3.0, 4.0, 0.0]), Some([1.0; 3])]];
        let b = vec![vec![Some([1.0, 0.0, 0.0]), Some([9.0; 3])], vec![Some([0.0; 3]), Some([1.0; 3])]];
        assert_eq!(mean_distance(&a, &b, 0..2), 2.0);
        assert_eq!(mean_distance(&a, &b, 1..9), 2.5);
    }

    #[test]
    fn the_bootstrap_finds_the_standard_error_of_independent_and_of_sticky_values() {
        let mut normal = vec![Block::ZERO; 100];
        Stage::new(3, "test").whole().fill_normal(crate::core::lanes::Isa::baseline(), &mut normal);
        let values: Vec<f64> = normal.iter().flat_map(|block| block.0).collect();
        let se = block_bootstrap(std::slice::from_ref(&values), 1, 400, 1);
        assert!((se * 800.0_f64.sqrt() - 1.0).abs() < 0.15, "{se}");
        let sticky: Vec<f64> = values.iter().flat_map(|x| [*x; 10]).collect();
        let se = block_bootstrap(&[sticky], 40, 400, 1);
        assert!((se * 800.0_f64.sqrt() - 1.0).abs() < 0.25, "{se}");
    }
}
