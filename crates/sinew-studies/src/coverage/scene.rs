//! One series: motion that is filmed, set up and tracked, its truth ranked among the draws.

use super::people::{Person, RATE_HZ, cut};
use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::body::Proportions;
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::config::settings::Settings;
use sinew::methods::BootstrapMethod;
use sinew::observe::Noise;
use sinew::setup::{self, Setup};
use sinew::track::Doubt;
use sinew::tracking::bootstrap;
use sinew_body::points::Trajectories;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation::{self, Filtered, Track, own_model, ranks};
use sinew_tests::simulated_source::source;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

/// How long a series is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Length {
    /// Frames that the set-up sees; shorter motions are taken whole.
    pub(super) seen: usize,
    /// Last frames of them that are tracked.
    pub(super) tracked: usize,
}

/// Many short series for intervals and ranks.
pub(super) const SHORT: Length = Length { seen: 60, tracked: 25 };
/// A few recordings for warnings.
pub(super) const LONG: Length = Length { seen: 120, tracked: 120 };

/// Last frames of these that are judged for coverage: the first ones depend on the pose that the set-up found.
pub(super) const JUDGED: usize = 15;
/// Frames of a series of the model's own.
const OWN: usize = 15;
/// Error per axis of a keypoint, pixels.
pub(super) const SIGMA_PX: f64 = 3.0;
/// Factor on the limbs that are wrong.
const LIMBS: f64 = 1.03;
/// Correlation of errors that persist.
const PERSISTENCE: f64 = 0.7;
/// Factor by which the noise is understated.
const UNDERSTATED: f64 = 1.5;
/// Constant biases and share of exchanged sides where all is wrong together.
pub(super) const BIAS_PX: f64 = 4.0;
const SWAPPED: f64 = 0.02;
/// Share of gross outliers and their distances, pixels.
const OUTLIER: f64 = 0.05;
const OUTLIER_PX: [f64; 2] = [40.0, 250.0];

/// A tracker with the setting that matters for its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tracker {
    /// With its defaults.
    Hmc,
    /// With a number of particles.
    Bootstrap(usize),
}

impl Tracker {
    pub(super) fn name(self) -> String {
        match self {
            Self::Hmc => "hmc".into(),
            Self::Bootstrap(particles) => format!("bootstrap {particles}"),
        }
    }

    pub(super) fn settings(self) -> Settings {
        match self {
            Self::Hmc => Settings::default(),
            Self::Bootstrap(particles) => {
                let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
                Settings { method: Arc::new(BootstrapMethod(config)), ..Settings::default() }
            }
        }
    }
}

/// Which body the tracker assumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sizes {
    /// The true one.
    Known,
    /// That of the set-up, the default.
    Fitted,
    /// The true one with all limbs longer.
    Limbs,
    /// Somebody else's.
    Other,
}

/// What about the keypoints differs from what the tracker assumes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wrong {
    /// Nothing.
    Right,
    /// A constant offset of each camera, of that standard deviation per axis, in all frames: the set-up estimates it.
    Offset(f64),
    /// The same since the set-up.
    Moved(f64),
    /// Gross outliers; the tracker assumes that share of them.
    Outliers(f64),
    /// Errors that persist from frame to frame.
    Persistent,
    /// Errors larger than assumed.
    Understated,
    /// Keypoints are the joints of the recording's own skeleton.
    Recorded,
    /// Cameras that differ from their calibration.
    Calibration,
    /// A constant bias of each keypoint in each camera, of that standard deviation per axis, pixels.
    Biased(f64),
    /// Left and right exchanged in that share of the frames of a camera.
    Swapped(f64),
    /// Recorded joints, cameras that differ from their calibration, biases, exchanged sides and errors that persist, all together.
    All,
}

/// What is simulated and how it is tracked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scene {
    /// Someone before a number of cameras.
    Person { cameras: usize, tracker: Tracker, sizes: Sizes, wrong: Wrong },
    /// Motion and keypoints drawn from the tracker's own model.
    OwnModel { tracker: Tracker },
}

impl Scene {
    pub(super) const fn tracker(&self) -> Tracker {
        match self {
            Self::Person { tracker, .. } | Self::OwnModel { tracker } => *tracker,
        }
    }

    /// Name of its cell.
    pub(super) fn key(&self) -> String {
        match self {
            Self::Person { cameras, tracker, sizes, wrong } => {
                format!("{}/{cameras}/{}/{}", tracker.name(), sizes.name(), wrong.name())
            }
            Self::OwnModel { tracker } => format!("{}/own model", tracker.name()),
        }
    }
}

impl Sizes {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Known => "known",
            Self::Fitted => "set-up",
            Self::Limbs => "limbs 3 % too long",
            Self::Other => "another person's",
        }
    }

    /// Sizes that replace a person's sizes from the set-up, `None` where they stay.
    fn of(self, person: &Person, people: &[Person]) -> Option<Proportions> {
        let own = person.proportions;
        match self {
            Self::Fitted => None,
            Self::Known => Some(own),
            Self::Limbs => Some(Proportions {
                upper_arm: own.upper_arm * LIMBS,
                forearm: own.forearm * LIMBS,
                thigh: own.thigh * LIMBS,
                shin: own.shin * LIMBS,
                ..own
            }),
            Self::Other => {
                let place = people.iter().position(|other| std::ptr::eq(other, person)).unwrap_or(0);
                let after = people.iter().cycle().skip(place + 1).take(people.len());
                after.into_iter().find(|other| other.subject != person.subject).map(|other| other.proportions)
            }
        }
    }
}

impl Wrong {
    pub(super) fn name(self) -> String {
        match self {
            Self::Right => "as assumed".into(),
            Self::Offset(px) => format!("camera offsets {px} px, seen by the set-up"),
            Self::Moved(px) => format!("camera offsets {px} px since the set-up"),
            Self::Outliers(0.0) => "5 % gross outliers, none assumed".into(),
            Self::Outliers(share) => format!("5 % gross outliers, {} % assumed", 100.0 * share),
            Self::Persistent => format!("errors correlated {PERSISTENCE} from frame to frame"),
            Self::Understated => format!("errors {UNDERSTATED} times as large"),
            Self::Recorded => "recorded joints, which the body does not reach".into(),
            Self::Calibration => "cameras 0.2°, 5 mm, 0.3 %, 0.15 frames off".into(),
            Self::Biased(px) => format!("keypoints {px} px aside in each camera"),
            Self::Swapped(share) => format!("sides exchanged in {} %", 100.0 * share),
            Self::All => "all together".into(),
        }
    }

    const fn calibration(self) -> CalibrationError {
        match self {
            Self::Calibration | Self::All => CalibrationError::USUAL,
            _ => CalibrationError::NONE,
        }
    }

    fn noise(self) -> DetectorNoise {
        let right = DetectorNoise::stated_gaussian(SIGMA_PX);
        match self {
            Self::Offset(offset_px) | Self::Moved(offset_px) => DetectorNoise { offset_px, ..right },
            Self::Outliers(_) => DetectorNoise { outlier: OUTLIER, outlier_px: OUTLIER_PX, ..right },
            Self::Persistent => DetectorNoise { persistence: PERSISTENCE, ..right },
            Self::Biased(bias_px) => DetectorNoise { bias_px, ..right },
            Self::Swapped(swapped) => DetectorNoise { swapped, ..right },
            Self::All => DetectorNoise { bias_px: BIAS_PX, swapped: SWAPPED, persistence: PERSISTENCE, ..right },
            Self::Right | Self::Understated | Self::Recorded | Self::Calibration => right,
        }
    }
}

/// What came of a series.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Series {
    /// Ranks of the last frame, joint by joint, axis by axis; of the own model also the ranks of the state.
    pub(super) ranks: Vec<u32>,
    pub(super) state_ranks: Vec<u32>,
    /// For each level and joint the share of covered coordinates in the judged frames.
    pub(super) covered: Vec<Vec<f64>>,
    /// The same of all joints by the 90 % intervals of the files.
    pub(super) in_files: f64,
    /// Mean half-width of these, metres.
    pub(super) half_width_m: f64,
    /// Mean distance from the truth, metres.
    pub(super) error_m: f64,
    /// Share of the judged frames whose split R-hat is above 1.05.
    pub(super) disagreeing: f64,
    /// Kinds of warnings.
    pub(super) doubts: Vec<String>,
}

impl Series {
    pub(super) fn to_json(&self) -> Value {
        json!({
            "ranks": self.ranks, "state_ranks": self.state_ranks, "covered": self.covered, "in_files": self.in_files,
            "half_width_m": self.half_width_m, "error_m": self.error_m, "disagreeing": self.disagreeing, "doubts": self.doubts,
        })
    }

    pub(super) fn from_json(value: &Value) -> Self {
        let ranks = |name: &str| crate::support::store::numbers(&value[name]).into_iter().map(|x| x as u32).collect();
        let number = |name: &str| value[name].as_f64().unwrap_or(f64::NAN);
        let doubts = value["doubts"].as_array().into_iter().flatten();
        Self {
            ranks: ranks("ranks"),
            state_ranks: ranks("state_ranks"),
            covered: crate::support::store::rows(&value["covered"]),
            in_files: number("in_files"),
            half_width_m: number("half_width_m"),
            error_m: number("error_m"),
            disagreeing: number("disagreeing"),
            doubts: doubts.filter_map(|doubt| doubt.as_str().map(String::from)).collect(),
        }
    }
}

/// The default of `bootstrap`, and what is feasible for hundreds of series.
pub(super) const PARTICLES: Tracker = Tracker::Bootstrap(10_000);
pub(super) const FEW: Tracker = Tracker::Bootstrap(2000);

/// Consecutive seeds that begin far from the seeds of other first seeds.
pub(super) fn seeds(numbers: Range<usize>, first: u64) -> Vec<u64> {
    let first = first.wrapping_mul(1_000_003);
    numbers.map(|i| first.wrapping_add(i as u64)).collect()
}

/// Simulates and tracks the series of a seed.
pub(super) fn series(scene: &Scene, people: &[Person], length: Length, seed: u64) -> Outcome<Series> {
    let settings = scene.tracker().settings();
    match *scene {
        Scene::OwnModel { .. } => own(&settings, seed),
        Scene::Person { cameras, sizes, wrong, .. } => {
            let settings = Settings { seed, fps: RATE_HZ, draws: ranks::DRAWS, ..settings };
            person(people, length, (cameras, sizes, wrong), settings)
        }
    }
}

/// A series of the model's own motion.
pub(super) fn own(settings: &Settings, seed: u64) -> Outcome<Series> {
    let settings = Settings { seed, fps: RATE_HZ, draws: ranks::DRAWS, ..settings.clone() };
    let found = own_model::ranked(OWN, SIGMA_PX, &settings, seed)?;
    let ranks: Vec<u32> = found.points.into_iter().flatten().collect();
    let covered = covered(std::slice::from_ref(&ranks));
    Ok(Series { state_ranks: found.state, covered, ranks, disagreeing: found.disagreeing, ..Series::default() })
}

/// For each level and joint the share of some frames' ranks that is covered.
fn covered(frames: &[Vec<u32>]) -> Vec<Vec<f64>> {
    let joints = frames.first().map_or(0, |frame| frame.len() / 3);
    let of = |level: f64, joint: usize| {
        let own: Vec<u32> = frames.iter().flat_map(|frame| frame[3 * joint..3 * joint + 3].to_vec()).collect();
        ranks::coverage(&own, ranks::DRAWS, level)
    };
    ranks::LEVELS.iter().map(|&level| (0..joints).map(|joint| of(level, joint)).collect()).collect()
}

fn person(
    people: &[Person],
    length: Length,
    (cameras, sizes, wrong): (usize, Sizes, Wrong),
    settings: Settings,
) -> Outcome<Series> {
    let seed = settings.seed;
    let person = &people[seed as usize % people.len()];
    let seen = person.states.len().min(length.seen);
    // Stretches of one motion begin everywhere in it.
    let first = (seed as usize).wrapping_mul(7919) % (person.states.len() - seen + 1);
    let truth = match (wrong, &person.recorded) {
        (Wrong::Recorded | Wrong::All, Some(recorded)) => recorded,
        (Wrong::Recorded | Wrong::All, None) => return Err("walkers have no recorded joints".into()),
        _ => &person.fitted,
    };
    let truth = cut(truth, first..first + seen);
    let states = person.states[first..first + seen].to_vec();
    let film = |noise: DetectorNoise| -> Outcome<SyntheticRecording> {
        let script = Script { noise, calibration: wrong.calibration(), rate_hz: RATE_HZ, ..Script::default() };
        let mut film =
            SyntheticRecording::from_motion(person.body.clone(), states.clone(), truth.clone(), &script, seed)?;
        film.cameras.truncate(cameras);
        film.keypoints.truncate(cameras);
        Ok(film)
    };
    let tracked = film(wrong.noise())?;
    let shown = if let Wrong::Moved(_) = wrong { film(Wrong::Right.noise())? } else { tracked.clone() };
    let settings = match wrong {
        Wrong::Outliers(share) => Settings { noise: Noise::OutlierFloor { outlier: share.max(1e-12) }, ..settings },
        _ => settings,
    };
    let change = |setup: &mut Setup| {
        if let Some(proportions) = sizes.of(person, people) {
            (setup.proportions, setup.size_sd) = (proportions, 0.0);
        }
        if wrong == Wrong::Understated {
            setup.camera.iter_mut().for_each(|camera| camera.sigma_px /= UNDERSTATED);
        }
    };
    let end = seen as u64;
    let mut setup = evaluation::set_up(&mut source(&shown), 0..end, &settings, change)?;
    setup::measure_lasting(&mut setup, &mut source(&shown), 0..end, settings.fps, seed)?;
    let found =
        evaluation::filter(&mut source(&tracked), &setup, end - length.tracked.min(seen) as u64..end, &settings)?;
    Ok(judged(&found, &truth))
}

/// What the last frames of a tracked stretch say of its truth.
fn judged(found: &Filtered, truth: &Trajectories) -> Series {
    let judged = &found.estimates[found.estimates.len() - JUDGED..];
    let flat = |frame: Vec<[u32; 3]>| frame.into_iter().flatten().collect::<Vec<u32>>();
    let ranked: Vec<Vec<u32>> =
        ranks::at_points(&found.tree, judged, truth, &EVALUATION_JOINTS).into_iter().map(flat).collect();
    let in_files = evaluation::covered(&found.tree, judged, truth, &EVALUATION_JOINTS);
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let target: Track = truth.select(&EVALUATION_JOINTS).frames[truth.frames.len() - JUDGED..]
        .iter()
        .map(|frame| frame.iter().map(|&point| Some(point)).collect())
        .collect();
    let track = evaluation::positions(&found.tree, judged, &EVALUATION_JOINTS);
    let doubts: BTreeSet<&str> = found.doubts.iter().map(Doubt::kind).collect();
    Series {
        covered: covered(&ranked),
        ranks: ranked.last().cloned().unwrap_or_default(),
        state_ranks: vec![],
        in_files: mean(&in_files.iter().map(|frame| mean(frame)).collect::<Vec<_>>()),
        half_width_m: evaluation::half_width_m(&found.tree, judged, &EVALUATION_JOINTS),
        error_m: evaluation::mean_distance(&track, &target, 0..JUDGED),
        disagreeing: judged.iter().filter(|e| e.r_hat.is_some_and(|r| r > 1.05)).count() as f64 / JUDGED as f64,
        doubts: doubts.into_iter().map(String::from).collect(),
    }
}
