//! One cell: a contender over all frames with one seed and one level of noise.
//!
//! A seed dresses another person, draws other errors of segmentation and other particles. Masks and silhouettes are drawn once for a seed and level; contenders of one seed see the same ones.
//!
//! Two estimates a frame are measured: the *second* is what the method reports (X̂; a weighted mean; the true pose), the *first* its coarse stage X_c or, of other methods, the particle of the largest weight.

use super::contender::{Contender, EQ3, LAYERS, Method, Person};
use super::girth::Thickness;
use super::scene::{CAMERA, HEADING, RATE_HZ, Range, Scene};
use crate::papers::worth::rounded;
use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::body::flesh::Flesh;
use sinew::body::hppf24;
use sinew::core::density::{LogDensity as _, PartLogDensity as _};
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::Stage;
use sinew::dynamics::first_order::FirstOrder;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::observe::ObservationModel as _;
use sinew::observe::silhouettes::bit_image::{BitImage, overlap};
use sinew::observe::silhouettes::contour_map::contour_map;
use sinew::observe::silhouettes::image_likelihood::{Cues, ImageLikelihood, ImageModel};
use sinew::observe::silhouettes::image_score::{ImageScore, precision_and_recall};
use sinew::observe::silhouettes::own_contours::{self, OwnContours};
use sinew::observe::silhouettes::solid_body::{SolidBody, part_tree};
use sinew::samplers::annealed_search;
use sinew::samplers::grid::GridAxis;
use sinew::tracking::coarse_to_fine::{self, CoarseToFine};
use sinew::tracking::{StepInfo, Tracker, annealed, bootstrap, partitioned};
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::ring::Ring;
use sinew_simulate::segmentation_noise::{Level, segmented};
use sinew_tests::evaluation::smoothness::second_differences;
use std::sync::Arc;
use std::time::Instant;

/// Decimals that are stored.
const DECIMALS: i32 = 4;

/// The part A of the last change of the estimate by which particles move on (eq. 2).
const DRIFT: f64 = 0.2;

/// What a camera saw of a person, frame by frame, and the tracker's body before it.
pub(super) struct Seen {
    clean: Vec<BitImage>,
    masks: Vec<BitImage>,
    model: ImageModel,
    flesh: Flesh,
}

impl Seen {
    /// Draws a person and the errors of a level.
    pub(super) fn new(
        scene: &Scene,
        (person, thickness): (Person, Thickness),
        level: Level,
        seed: u64,
        isa: Isa,
    ) -> Outcome<Self> {
        let footage = SyntheticFootage::new(scene.motion.clone(), RATE_HZ, &Ring::SMALL_PICTURES, seed)?;
        let flesh = scene.girths.of(thickness).applied(&hppf24::cylinders(scene.scale));
        let body = Arc::new(SolidBody::new(&scene.tree, &flesh)?);
        let cameras = vec![footage.cameras[CAMERA].clone()];
        let model = ImageModel { body, cameras, score: EQ3, colours: Arc::default(), isa };
        let frames = 0..scene.truth.len();
        let clean: Vec<BitImage> = match person {
            Person::Other => frames.clone().map(|frame| footage.silhouette(CAMERA, frame)).collect(),
            Person::Own => scene.truth.iter().map(|state| model.silhouettes(state).swap_remove(0)).collect(),
        };
        let mask = |frame: usize| match person {
            Person::Other => footage.mask(CAMERA, frame, level),
            Person::Own => {
                let stage = Stage::new(seed, "own body").at_frame(frame as u32);
                segmented(&clean[frame], None, level, stage)
            }
        };
        Ok(Self { masks: frames.map(mask).collect(), clean, model, flesh })
    }

    fn bind(&self, score: ImageScore, cues: Cues) -> ImageLikelihood {
        ImageModel { score, ..self.model.clone() }.bind(vec![Some(cues)])
    }
}

/// A method at work.
enum Running {
    CoarseToFine(Box<CoarseToFine>),
    /// With models of the solids alone.
    OwnContours(Box<CoarseToFine>, Vec<ImageModel>),
    Other(Box<dyn Tracker<ImageLikelihood>>),
    /// Nothing is searched: the pose, and how many of its coordinates follow the true pose.
    Still(Vec<f64>, usize),
}

impl Running {
    fn new(contender: &Contender, scene: &Scene, seen: &Seen, isa: Isa) -> Outcome<Self> {
        let start = scene.truth[0].clone();
        let axes: Vec<GridAxis> = scene.ranges.iter().map(|range| range.axis).collect();
        let sd: Vec<f64> = scene.ranges.iter().map(|range| range.width).collect();
        let walk = RandomWalk::new(&sd, 1.0, Between::Mixture, isa)?;
        Ok(match contender.method {
            Method::CoarseToFine { coarse, fine, judging, snapped } => {
                let config = coarse_to_fine::Config { coarse, fine, drift: DRIFT, snapped, judging };
                Self::CoarseToFine(Box::new(CoarseToFine::new(
                    config,
                    axes,
                    part_tree(&scene.tree, &seen.flesh)?,
                    start,
                    isa,
                )?))
            }
            Method::OwnContours { coarse, fine, judging } => {
                let config = coarse_to_fine::Config { coarse, fine, drift: DRIFT, snapped: true, judging };
                let tracker = CoarseToFine::new(config, axes, part_tree(&scene.tree, &seen.flesh)?, start, isa)?;
                let models = own_contours::alone(&seen.model, &scene.tree, &seen.flesh)?;
                Self::OwnContours(Box::new(tracker), models)
            }
            // With the motion of the coarse-to-fine tracker (eq. 2), without its grid.
            Method::Condensation(particles) => {
                let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
                Self::Other(Box::new(bootstrap::Bootstrap::new(config, FirstOrder::new(walk, DRIFT)?, start)?))
            }
            Method::Annealed(particles) => {
                let layers = annealed_search::Config { layers: LAYERS, ..annealed_search::Config::default() };
                let config = annealed::Config { particles, layers };
                Self::Other(Box::new(annealed::Annealed::new(config, walk, sd, start, isa)?))
            }
            Method::Partitioned(particles) => {
                let config = partitioned::Config { particles, ..partitioned::Config::default() };
                Self::Other(Box::new(partitioned::Partitioned::new(
                    config,
                    walk,
                    part_tree(&scene.tree, &seen.flesh)?,
                    start,
                )?))
            }
            Method::Truth => Self::Still(start, scene.tree.dof()),
            Method::Frozen => Self::Still(start, 0),
            Method::MeanPose => Self::Still(scene.mean_pose.clone(), HEADING + 1),
        })
    }

    fn step(&mut self, observed: &ImageLikelihood, cues: &Cues, stage: Stage) -> Outcome<StepInfo> {
        Ok(match self {
            Self::CoarseToFine(tracker) => tracker.step(observed, stage)?,
            Self::OwnContours(tracker, models) => tracker.step(&OwnContours::new(observed, models, cues), stage)?,
            Self::Other(tracker) => tracker.step(observed, stage)?,
            Self::Still(..) => StepInfo::default(),
        })
    }

    /// The first and the second estimate of the last frame.
    fn estimates(&self, truth: &[f64]) -> [Vec<f64>; 2] {
        match self {
            Self::CoarseToFine(tracker) | Self::OwnContours(tracker, _) => {
                [tracker.coarse().state.clone(), tracker.fine().state.clone()]
            }
            Self::Other(tracker) => [tracker.posterior().heaviest(), tracker.estimate().to_vec()],
            Self::Still(pose, true_ones) => {
                let pose = [&truth[..*true_ones], &pose[*true_ones..]].concat();
                [pose.clone(), pose]
            }
        }
    }

    /// Whether every coarse particle stands on centres of its coordinates; none for methods without a grid.
    fn on_centres(&self, ranges: &[Range]) -> Option<bool> {
        let Self::CoarseToFine(tracker) = self else { return None };
        let particles = tracker.particles();
        let stands = |index| particles.state(index).iter().zip(ranges).all(|(x, range)| is_centre(*x, range));
        Some((0..particles.count()).all(stands))
    }
}

/// Whether a number is the centre of one of ⌈(θ_H − θ_L)/δ⌉ equal partitions, to rounding.
fn is_centre(x: f64, range: &Range) -> bool {
    let count = ((range.high - range.low) / range.width).ceil();
    let place = (x - range.low) / (range.high - range.low) * count - 0.5;
    (place - place.round()).abs() < 1e-6 && place > -0.5 && place < count - 0.5
}

/// What estimates are worth, frame by frame.
#[derive(Default)]
struct Worth {
    states: Vec<Vec<f64>>,
    /// Precision and recall against the mask, then against the silhouette without errors, percent.
    shares: [Vec<f64>; 4],
    log_likelihood: Vec<f64>,
    /// Sum of the log likelihoods of the parts, each in its place.
    parts: Vec<f64>,
}

impl Worth {
    fn add(&mut self, seen: &Seen, frame: usize, judge: &ImageLikelihood, state: Vec<f64>) {
        let body = seen.model.silhouettes(&state).swap_remove(0);
        let [mask, clean] = [&seen.masks[frame], &seen.clean[frame]]
            .map(|image| precision_and_recall(overlap(image, &body, 0..image.width())));
        for (all, share) in self.shares.iter_mut().zip([mask, clean].concat()) {
            all.push(100.0 * share);
        }
        self.log_likelihood.push(judge.log_density(&state));
        let block: Vec<Block> = state.iter().map(|&x| Block::splat(x)).collect();
        let mut parts = vec![Block::ZERO; judge.parts()];
        let all: Vec<usize> = (0..judge.parts()).collect();
        judge.log_density_parts_block(&all, &block, &mut parts, &mut vec![Block::ZERO; judge.workspace()]);
        self.parts.push(parts.iter().map(|part| part.0[0]).sum());
        self.states.push(state);
    }

    fn value(&self, scene: &Scene) -> Value {
        let error = scene.relative_error_mm(&self.states);
        let [precision, recall, clean_precision, clean_recall] = self.shares.each_ref().map(|v| rounded(v, DECIMALS));
        // The heading differs the short way round.
        let difference = |j: usize, a: f64, b: f64| scene.ranges[j].axis.difference(a, b);
        json!({
            "precision": precision,
            "recall": recall,
            "clean_precision": clean_precision,
            "clean_recall": clean_recall,
            "log_likelihood": rounded(&self.log_likelihood, DECIMALS),
            "parts": rounded(&self.parts, DECIMALS),
            "error_mm": rounded(&error, DECIMALS),
            "second_difference": second_differences(&self.states, difference),
        })
    }
}

/// Runs a contender.
pub(super) fn cell(scene: &Scene, seen: &Seen, contender: &Contender, seed: u64, isa: Isa) -> Outcome<Value> {
    let mut running = Running::new(contender, scene, seen, isa)?;
    let mut worth = [Worth::default(), Worth::default()];
    let (mut evaluations, mut seconds, mut on_centres) = (0.0, 0.0, None);
    let purpose = format!("coarse-to-fine {}", contender.name());
    for (frame, truth) in scene.truth.iter().enumerate() {
        let silhouette = seen.masks[frame].clone();
        let cues = Cues { edges: Some(contour_map(&silhouette)), silhouette, picture: None };
        let judge = seen.bind(EQ3, cues.clone());
        let other = (contender.score != EQ3).then(|| seen.bind(contender.score, cues.clone()));
        let clock = Instant::now();
        let stage = Stage::new(seed, &purpose).at_frame(frame as u32);
        let info = running.step(other.as_ref().unwrap_or(&judge), &cues, stage)?;
        seconds += clock.elapsed().as_secs_f64();
        let parts = scene.tree.links().len() - 1;
        evaluations += info.likelihood_evaluations as f64 + info.part_evaluations as f64 / parts as f64;
        if let Some(all) = running.on_centres(&scene.ranges) {
            on_centres = Some(on_centres.unwrap_or(true) && all);
        }
        for (worth, state) in worth.iter_mut().zip(running.estimates(truth)) {
            worth.add(seen, frame, &judge, state);
        }
    }
    let frames = scene.truth.len() as f64;
    Ok(json!({
        "first": worth[0].value(scene),
        "second": worth[1].value(scene),
        "evaluations": evaluations / frames,
        "ms": 1e3 * seconds / frames,
        "on_centres": on_centres,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_differ_from_other_numbers() {
        let axis = GridAxis::new(-1.0, 1.0, 0.3, false).unwrap();
        let range = Range { low: -1.0, high: 1.0, width: 0.3, axis };
        for x in [-0.95, -0.3, 0.0, 0.21, 0.99] {
            assert!(is_centre(axis.snap(x), &range) && !is_centre(axis.snap(x) + 0.1, &range));
        }
        assert!(!is_centre(axis.centre(6) + 2.0 / 7.0, &range), "beyond the last");
    }
}
