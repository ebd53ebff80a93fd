//! How good a tracker is.
//!
//! Whole runs in memory, what it is compared with, and the statistics of the comparison.
//!
//! | function | what |
//! |---|---|
//! | [`run`] | set-up from some frames, then filter and smoother over others |
//! | [`set_up`], [`filter`] | the same in two halves, the set-up changed in between, without the smoother |
//! | [`triangulated`], [`filled`], [`causal`], [`zero_phase`] | the usual recipe: points one by one, gaps filled, a Butterworth low-pass |
//! | [`mean_distance`] | of tracks to a reference |
//! | [`pixel_errors`] | distance to the keypoints of a camera that was left out |
//! | [`covered`], [`half_width_m`], [`block_bootstrap`], [`grouped_block_bootstrap`] | share of true coordinates inside the 90 % intervals, their half-width, and standard errors |
//! | [`ranks`], [`weighted_places`] | where the truth falls among draws, and among weighted draws: coverage at any level, rank histograms |
//! | [`joint_errors`], [`smoothness`] | of states against a motion, and of states alone |
//! | [`equal_variance`], [`volumes`] | what estimators cost at equal variance, and how far a posterior is from its prior |
//! | [`own_model`] | the tracker on truths that its own model drew |

mod coverage;
pub mod equal_variance;
pub mod joint_errors;
pub mod own_model;
pub mod ranks;
pub mod ray_association;
mod recipe;
pub mod returns;
pub mod several_people;
pub mod smoothness;
pub mod volumes;
pub mod weighted_places;

pub use coverage::{block_bootstrap, covered, grouped_block_bootstrap, half_width_m};
pub use recipe::{Track, causal, filled, triangulated, zero_phase};

use sinew::Error;
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::body::{KinematicTree, Proportions};
use sinew::config::settings::Settings;
use sinew::core::estimators::median;
use sinew::formats::Layout;
use sinew::input::source::FrameSource;
use sinew::observe::Camera;
use sinew::observe::association::Person;
use sinew::setup::{self, Setup, SetupRequest};
use sinew::track::{self, Doubt, Pipeline, Spool};
use sinew::tracking::posterior::Posterior;
use sinew_body::points::points_of_states;
use sinew_results::estimate::FrameEstimate;
use sinew_setup::silhouette_overlap::SilhouetteOverlap;
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicU64, Ordering};

/// Joints that are compared with a reference: the joints of the limbs.
pub const LIMB_JOINTS: [&str; 12] = *EVALUATION_JOINTS.split_at(2).1.first_chunk().expect("fifteen joints");

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

/// Sets up from `setup_frames`, motion noise and step size included, and tracks `frames`. Known proportions replace the set-up's.
///
/// # Errors
/// Errors of the source, the set-up and the tracker.
pub fn run(
    source: &mut dyn FrameSource,
    setup_frames: Range<u64>,
    frames: Range<u64>,
    settings: &Settings,
    known: Option<&Proportions>,
) -> Result<Run, Error> {
    let setup = set_up(source, setup_frames, settings, |setup| {
        if let Some(known) = known {
            setup.proportions = *known;
        }
    })?;
    let tree = setup.tree();
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let mut pipeline = Pipeline::new(&setup, &tree, &cameras, &layout, settings.clone())?;
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let name = format!("sinew-evaluation-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let mut spool = Spool::temporary(
        &std::env::temp_dir().join(name),
        [tree.dof(), cameras.len(), pipeline.keypoints().len(), pipeline.lasting_draws()],
    )?;
    let (mut filtered, mut smoothed) = (vec![], vec![]);
    pipeline.track(source, frames, |estimate: FrameEstimate, _: &Posterior<'_>| {
        spool.append(&estimate)?;
        filtered.push(estimate);
        Ok(())
    })?;
    track::smooth(
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

/// The set-up from some frames, without what is constant ([`setup::measure_lasting`]): tracking given that calibration and sizes are right. `change` may replace what it found; motion noise and step size follow from what is left.
///
/// # Errors
/// Errors of the source and the set-up.
pub fn set_up(
    source: &mut dyn FrameSource,
    frames: Range<u64>,
    settings: &Settings,
    change: impl FnOnce(&mut Setup),
) -> Result<Setup, Error> {
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let people: Vec<_> = frames.clone().map(|number| Ok::<_, Error>((number, source.people(number)?))).collect();
    let (mut setup, _) = setup::set_up(&cameras, &layout, &SetupRequest::default(), people)?;
    setup::measure_look(&mut setup, source, frames.clone(), settings.fps, settings.compares_colours())?;
    change(&mut setup);
    let tree = setup.tree();
    setup.motion_sd = Some(setup::measure_motion(&setup, &tree, source, frames, settings.fps)?);
    let start = setup.start_frame;
    track::tune(&mut setup, &tree, source, start, settings)?;
    Ok(setup)
}

/// What the filter says.
pub struct Filtered {
    /// The body.
    pub tree: KinematicTree,
    /// Estimates from the frames up to each.
    pub estimates: Vec<FrameEstimate>,
    /// What does not look as the model says.
    pub doubts: Vec<Doubt>,
    /// How well the body covers the silhouettes, camera by camera; empty without silhouettes.
    pub coverage: Vec<SilhouetteOverlap>,
}

/// Filters some frames with a set-up, on keypoints, silhouettes or both, as the source has them.
///
/// # Errors
/// Errors of the source and the tracker.
pub fn filter(
    source: &mut dyn FrameSource,
    setup: &Setup,
    frames: Range<u64>,
    settings: &Settings,
) -> Result<Filtered, Error> {
    let tree = setup.tree();
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let image_cameras = source.image_cameras();
    let image_cameras = image_cameras.as_deref();
    let mut pipeline = Pipeline::with_images(setup, &tree, &cameras, &layout, settings.clone(), image_cameras)?;
    let mut estimates = vec![];
    pipeline.track(source, frames, |estimate, _: &Posterior<'_>| {
        estimates.push(estimate);
        Ok(())
    })?;
    Ok(Filtered { doubts: pipeline.doubts(), coverage: pipeline.coverage().to_vec(), tree, estimates })
}

/// Positions of named points in the pose of the mean state.
#[must_use]
pub fn positions(tree: &KinematicTree, estimates: &[FrameEstimate], names: &[&str]) -> Track {
    let states: Vec<Vec<f64>> = estimates.iter().map(|estimate| estimate.mean_state.clone()).collect();
    let points = points_of_states(tree, &states);
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
/// `offset`; distances are taken over the frames `judged`.
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
    let shift = [0, 1].map(|a: usize| median(&mut known.iter().map(|d| d[a]).collect::<Vec<_>>()));
    let mut distances: Vec<f64> =
        differences(judged).iter().map(|d| (d[0] - shift[0]).hypot(d[1] - shift[1])).collect();
    distances.sort_by(f64::total_cmp);
    let at = |p: f64| distances.get((p * distances.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    PixelErrors { median: at(0.5), p90: at(0.9), count: distances.len() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_count_what_both_have() {
        let a = vec![vec![Some([0.0; 3]), None], vec![Some([3.0, 4.0, 0.0]), Some([1.0; 3])]];
        let b = vec![vec![Some([1.0, 0.0, 0.0]), Some([9.0; 3])], vec![Some([0.0; 3]), Some([1.0; 3])]];
        assert_eq!(mean_distance(&a, &b, 0..2), 2.0);
        assert_eq!(mean_distance(&a, &b, 1..9), 2.5);
    }
}
