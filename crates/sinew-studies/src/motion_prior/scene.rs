//! One series: a walk that is filmed, set up and tracked.

use super::people::{Models, Person, RATE_HZ};
use crate::support::outcome::Outcome;
use crate::support::processor_time::thread_seconds;
use crate::support::statistics::median;
use serde_json::{Value, json};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::config::settings::Settings;
use sinew::dynamics::random_walk::Between;
use sinew::setup::Setup;
use sinew_body::points::Trajectories;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation::{self, Filtered, Track, ranks};
use sinew_tests::simulated_source::source;

/// First frames that are not judged: they depend on the pose that the set-up found.
const FIRST_JUDGED: usize = 10;

/// Levels of the intervals.
pub(super) const LEVELS: [f64; 2] = [0.5, 0.9];

/// What is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scene {
    pub(super) cameras: usize,
    /// Probability that a keypoint is not found.
    pub(super) missing: f64,
}

/// Scenes of the study.
pub(super) const SCENES: [Scene; 4] = [
    Scene { cameras: 4, missing: USUALLY_MISSING },
    Scene { cameras: 2, missing: USUALLY_MISSING },
    Scene { cameras: 1, missing: USUALLY_MISSING },
    Scene { cameras: 4, missing: 1.0 / 3.0 },
];
const USUALLY_MISSING: f64 = DetectorNoise::DETECTOR_LIKE.missing;

impl Scene {
    pub(super) fn name(self) -> String {
        let cameras = if self.cameras == 1 { "1 camera".into() } else { format!("{} cameras", self.cameras) };
        if self.missing > USUALLY_MISSING { format!("{cameras}, a third missing") } else { cameras }
    }
}

/// What is known of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Known {
    /// Nothing: a random walk.
    Walk,
    /// Action primitives.
    Primitives,
    /// The latent space of a GPDM, in which a latent walks at random.
    Latent,
}

/// How a frame's posterior becomes the next one's prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contender {
    pub(super) known: Known,
    pub(super) between: Between,
}

/// The random walk under the mixture is what the learned mixture is compared with, the Gaussians with each other.
pub(super) const CONTENDERS: [Contender; 5] = [
    Contender { known: Known::Walk, between: Between::Mixture },
    Contender { known: Known::Primitives, between: Between::Mixture },
    Contender { known: Known::Walk, between: Between::Gaussian },
    Contender { known: Known::Primitives, between: Between::Gaussian },
    Contender { known: Known::Latent, between: Between::Gaussian },
];

impl Contender {
    pub(super) fn name(self) -> String {
        let motion = match self.known {
            Known::Walk => "walk",
            Known::Primitives => "learned",
            Known::Latent => "latent",
        };
        format!("{motion}, {}", format!("{:?}", self.between).to_lowercase())
    }

    /// Whether its prior has a component or more for every draw of the frame before.
    pub(super) fn is_mixture_of_draws(self) -> bool {
        self.known == Known::Primitives && self.between == Between::Mixture
    }

    /// The same prior of the random walk.
    pub(super) fn baseline(self) -> Self {
        Self { known: Known::Walk, ..self }
    }
}

/// What came of a series: a number for each judged frame, and means.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Series {
    /// Mean distance of the joints from the truth, millimetres.
    pub(super) error_mm: f64,
    /// Share of true coordinates in the intervals of each level.
    pub(super) covered: [f64; LEVELS.len()],
    /// Share of frames whose split R-hat is above 1.05.
    pub(super) disagreeing: f64,
    /// Median split R-hat.
    pub(super) r_hat: f64,
    /// Milliseconds of processor time a frame.
    pub(super) ms: f64,
    /// Whether the run has doubts about its own model.
    pub(super) is_doubted: bool,
}

impl Series {
    pub(super) fn to_json(&self) -> Value {
        let Self { error_mm, covered, disagreeing, r_hat, ms, is_doubted } = self;
        json!({ "error_mm": error_mm, "covered": covered, "disagreeing": disagreeing, "r_hat": r_hat, "ms": ms,
            "is_doubted": is_doubted })
    }

    pub(super) fn from_json(value: &Value) -> Self {
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        let covered = &value["covered"];
        Self {
            error_mm: number(&value["error_mm"]),
            covered: [number(&covered[0]), number(&covered[1])],
            disagreeing: number(&value["disagreeing"]),
            r_hat: number(&value["r_hat"]),
            ms: number(&value["ms"]),
            is_doubted: value["is_doubted"].as_bool().unwrap_or_default(),
        }
    }
}

/// Films and tracks a person. Sizes are known, so that the prior between frames is all that contenders differ in.
pub(super) fn series(
    person: &Person,
    models: &Models,
    scene: Scene,
    contender: Contender,
    seed: u64,
) -> Outcome<Series> {
    let noise = DetectorNoise { offset_px: 0.0, missing: scene.missing, ..DetectorNoise::DETECTOR_LIKE };
    let script = Script { noise, rate_hz: RATE_HZ, ..Script::default() };
    let Person { body, states, points, .. } = person;
    let mut film = SyntheticRecording::from_motion(body.clone(), states.clone(), points.clone(), &script, seed)?;
    film.cameras.truncate(scene.cameras);
    film.keypoints.truncate(scene.cameras);
    let settings = Settings {
        seed,
        fps: RATE_HZ,
        draws: ranks::DRAWS,
        between: contender.between,
        motion_model: (contender.known == Known::Primitives).then(|| models.primitives.clone()),
        latent_model: (contender.known == Known::Latent).then(|| models.latent.clone()),
        ..Settings::default()
    };
    let known = |setup: &mut Setup| (setup.proportions, setup.size_sd) = (person.proportions, 0.0);
    let frames = 0..states.len() as u64;
    let setup = evaluation::set_up(&mut source(&film), frames.clone(), &settings, known)?;
    let before = thread_seconds();
    let found = evaluation::filter(&mut source(&film), &setup, frames, &settings)?;
    let ms = 1e3 * (thread_seconds() - before) / states.len() as f64;
    Ok(judged(&found, points, ms))
}

fn judged(found: &Filtered, truth: &Trajectories, ms: f64) -> Series {
    let frames = FIRST_JUDGED.min(found.estimates.len())..found.estimates.len();
    let judged = &found.estimates[frames.clone()];
    let ranked = ranks::at_points(&found.tree, judged, truth, &EVALUATION_JOINTS);
    let ranked: Vec<u32> = ranked.into_iter().flatten().flatten().collect();
    let target: Track = truth.select(&EVALUATION_JOINTS).frames[frames]
        .iter()
        .map(|frame| frame.iter().map(|&point| Some(point)).collect())
        .collect();
    let track = evaluation::positions(&found.tree, judged, &EVALUATION_JOINTS);
    let r_hats: Vec<f64> = judged.iter().map(|estimate| estimate.r_hat.unwrap_or(f64::INFINITY)).collect();
    let disagreeing = r_hats.iter().filter(|r| **r > 1.05).count() as f64 / r_hats.len() as f64;
    Series {
        error_mm: 1e3 * evaluation::mean_distance(&track, &target, 0..judged.len()),
        covered: LEVELS.map(|level| ranks::coverage(&ranked, ranks::DRAWS, level)),
        disagreeing,
        r_hat: median(&r_hats),
        ms,
        is_doubted: !found.doubts.is_empty(),
    }
}
