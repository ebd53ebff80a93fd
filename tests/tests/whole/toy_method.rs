//! A method that the program does not have: what one file gives it.

use sinew::Error;
use sinew::config::idle::idle_beside;
use sinew::config::setting::{AnySetting, Origin, SettingKind, SettingValues, Typed, method_setting};
use sinew::config::settings::Settings;
use sinew::config::table::table;
use sinew::config::value::to_text;
use sinew::core::density::LogDensity as _;
use sinew::core::lanes::{Block, LANES};
use sinew::core::random::Stage;
use sinew::core::transition::Transition as _;
use sinew::dynamics::motion_prior::MotionPrior;
use sinew::input::source::FrameSource as _;
use sinew::methods::{About, FrameLikelihood, Gives, LatentUse, METHODS, Making, Method, Score, Steps};
use sinew::setup::{self, Setup, SetupRequest};
use sinew::track::Pipeline;
use sinew::tracking::posterior::Posterior;
use sinew::tracking::{Inferred, Resume, StepInfo, Tracker};
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::simulated_source::source;
use std::sync::Arc;

/// Takes a number of steps of the motion prior and keeps the likeliest.
#[derive(Clone, Debug)]
struct Greedy {
    tries: u32,
}

const TRIES: Typed<u64> =
    method_setting(("tries", SettingKind::Count(1, 1000), "N", || 4, "blocks of steps that are tried (greedy)"));
const SETTINGS: &[&dyn AnySetting] = &[&TRIES];

const ABOUT: About = About {
    name: "greedy",
    help: "the likeliest of some steps, a search",
    gives: Gives::Search,
    needs_gradients: false,
    needs_parts: false,
    latent: LatentUse::No,
    score: Score::Bidirectional,
    score_beside_keypoints: Score::Bidirectional,
    particles: None,
    settings: SETTINGS,
    configure: |values| Arc::new(Greedy { tries: values.of(&TRIES) as u32 }),
    mistake: |_| None,
};

impl Method for Greedy {
    fn about(&self) -> &'static About {
        const { &ABOUT }
    }
    fn weighted_draws(&self) -> Option<usize> {
        Some(1)
    }
    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error> {
        let (states, transition) = (start.iter().map(|&x| Block::splat(x)).collect(), making.transition.clone());
        Ok(Box::new(GreedyTracker { tries: self.tries, transition, best: start, states }))
    }
}

struct GreedyTracker {
    tries: u32,
    transition: MotionPrior,
    best: Vec<f64>,
    states: Vec<Block>,
}

impl Tracker<FrameLikelihood> for GreedyTracker {
    fn step(&mut self, observed: &FrameLikelihood, stage: Stage) -> Result<StepInfo, sinew::tracking::Error> {
        let previous = self.states.clone();
        let mut workspace = vec![Block::ZERO; observed.workspace()];
        let mut best = (f64::NEG_INFINITY, self.best.clone());
        for block in 0..self.tries {
            let mut next = previous.clone();
            self.transition.sample_block(&previous, &mut next, &mut stage.block(block));
            let values = observed.log_density_block(&next, &mut workspace);
            for (lane, value) in values.0.into_iter().enumerate() {
                if value > best.0 {
                    best = (value, next.iter().map(|x| x.0[lane]).collect());
                }
            }
        }
        self.best = best.1;
        self.states = self.best.iter().map(|&x| Block::splat(x)).collect();
        let likelihood_evaluations = LANES * self.tries as usize;
        Ok(StepInfo { mean: self.best.clone(), ess: 1.0, likelihood_evaluations, ..StepInfo::default() })
    }
}

impl Inferred for GreedyTracker {
    fn posterior(&self) -> Posterior<'_> {
        Posterior { dim: self.best.len(), states: &self.states, weights: &[1.0], effective: 1.0, chain_stats: &[] }
    }
    fn estimate(&self) -> &[f64] {
        &self.best
    }
}

impl Resume for GreedyTracker {
    fn save(&self) -> Vec<f64> {
        self.best.clone()
    }
    fn restore(&mut self, saved: &[f64]) -> Result<(), sinew::tracking::Error> {
        self.best = saved.to_vec();
        self.states = saved.iter().map(|&x| Block::splat(x)).collect();
        Ok(())
    }
}

fn scene() -> (SyntheticRecording, Setup) {
    let recording = SyntheticRecording::new(&Script { duration_s: 0.5, ..Script::default() }, 7).unwrap();
    let mut frames = source(&recording);
    let people = (0..15).map(|number| Ok::<_, Error>((number, frames.people(number)?)));
    let (found, _) = setup::set_up(&recording.cameras, &recording.layout, &SetupRequest::default(), people).unwrap();
    (recording, found)
}

#[test]
fn a_run_takes_it_like_any_other() {
    let (recording, setup) = scene();
    let tree = setup.tree();
    let settings = Settings { method: ABOUT.usual(), ..Settings::default() };
    let pipeline = || Pipeline::new(&setup, &tree, &recording.cameras, &recording.layout, settings.clone()).unwrap();
    let tracked = |pipeline: &mut Pipeline, frames| {
        let mut estimates = vec![];
        let record = |estimate, _: &Posterior<'_>| {
            estimates.push(estimate);
            Ok(())
        };
        pipeline.track(&mut source(&recording), frames, record).unwrap();
        estimates
    };
    let mut whole = pipeline();
    let estimates = tracked(&mut whole, 0..10);
    let distance = |estimate: &sinew_results::estimate::FrameEstimate| {
        let knee = tree.point_index("RKnee").unwrap();
        let truth = recording.truth.frames[estimate.number as usize][recording.truth.index("RKnee").unwrap()];
        let at = estimate.points[knee].mean;
        (0..3).map(|k| (at[k] - truth[k]).powi(2)).sum::<f64>().sqrt()
    };
    assert!(estimates.iter().all(|estimate| distance(estimate) < 0.2), "the likeliest steps follow a slow walk");
    assert!(whole.warnings().iter().any(|warning| warning.starts_with("`greedy` is a search")));
    assert!(!whole.carried().log_evidence && whole.carried().particles == Some(1));

    let mut first = pipeline();
    tracked(&mut first, 0..4);
    let mut second = pipeline();
    second.restore(&first.save()).unwrap();
    assert_eq!(tracked(&mut second, 4..10)[5].mean_state, estimates[9].mean_state);
}

#[test]
fn the_tables_of_settings_derive_from_the_list() {
    let methods: Vec<&'static About> = METHODS.into_iter().chain([const { &ABOUT }]).collect();
    let settings = table(&methods);
    let find = |key: &str| settings.iter().find(|setting| setting.key == key).unwrap();
    assert!(find("method").help.ends_with(" or greedy"), "{}", find("method").help);
    assert_eq!(find("tries").default.as_ref().map(to_text).as_deref(), Some("4"));
    let mut values = SettingValues::default();
    values.set(&TRIES, 9, Origin::Flag);
    assert!(format!("{:?}", (ABOUT.configure)(&values)).contains("tries: 9"));
    let beside = |chosen: &About| idle_beside("tries", chosen, &methods, &values);
    assert_eq!(beside(&ABOUT), None);
    assert_eq!(beside(METHODS[0]).as_deref(), Some("a method other than `greedy`"));
}
