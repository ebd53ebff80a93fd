//! Silhouettes of the walk and what trackers make of them: the cells of the sweeps.
//!
//! Four cameras of 320 × 240 pixels, silhouettes with errors as usual, their contours as edges. A tracker starts around the fitted state of the first frame and follows the rest; its error is that of its weighted mean against
//! the joints that were recorded.

use super::walk::{RATE_HZ, Walks};
use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::body::hppf24;
use sinew::core::lanes::Isa;
use sinew::core::part::PartTree;
use sinew::core::random::Stage;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::observe::ObservationModel as _;
use sinew::observe::silhouettes::bit_image::BitImage;
use sinew::observe::silhouettes::contour_map::contour_map;
use sinew::observe::silhouettes::image_likelihood::{Cues, ImageLikelihood, ImageModel};
use sinew::observe::silhouettes::image_score::ImageScore;
use sinew::observe::silhouettes::solid_body::{SolidBody, part_tree};
use sinew::samplers::annealed_search;
use sinew::tracking::annealed::{self, Annealed};
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::partitioned::{self, Partitioned};
use sinew::tracking::posterior::Posterior;
use sinew::tracking::{self, Harness, StepInfo, Tracker};
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::ring::Ring;
use sinew_simulate::segmentation_noise::Level;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// Weighting functions: their names and the weight of the body's own pixels, if pixels are counted in both directions.
pub(super) const SCORES: [(&str, Option<f64>); 2] = [("one-sided", None), ("bidirectional", Some(0.5))];

/// Factor κ where nothing finds the exponent: that of the program.
const KAPPA: f64 = 100.0;

/// Who tracks.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Method {
    Annealed(annealed::Config),
    Bootstrap(usize),
    Partitioned(usize),
}

/// Sweeps that are run with the score of the first publication too; the rest with the bidirectional one alone.
const IN_BOTH: [&str; 2] = ["layers", "presets"];

/// A row of a table.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    /// The sweep it belongs to.
    pub(super) sweep: &'static str,
    pub(super) name: String,
    pub(super) method: Method,
}

/// Survival rates of the sweep.
pub(super) const SURVIVALS: [f64; 5] = [0.2, 0.35, 0.5, 0.65, 0.8];
/// Layers of the sweep and the particles that make 1000 evaluations of them.
pub(super) const LAYERS: [(usize, usize); 4] = [(1, 1000), (3, 333), (5, 200), (10, 100)];

impl Row {
    /// Whether the row is run with that score.
    pub(super) fn is_run_with(&self, score: &str) -> bool {
        score == SCORES[1].0 || IN_BOTH.contains(&self.sweep)
    }
}

/// Settings with a number of layers and particles at a survival rate.
pub(super) fn annealed(layers: usize, particles: usize, survival: f64) -> annealed::Config {
    let layers = annealed_search::Config { layers, survival, ..annealed_search::Config::default() };
    annealed::Config { particles, layers }
}

/// The sweeps. A setting that belongs to two of them is run once.
pub(super) fn rows() -> Vec<Row> {
    let row = |sweep, name: String, config| Row { sweep, name, method: Method::Annealed(config) };
    let mut rows: Vec<Row> = vec![];
    for survival in SURVIVALS {
        rows.push(row("survival rate", format!("α = {survival}"), annealed(10, 200, survival)));
    }
    for (layers, particles) in LAYERS {
        rows.push(row("layers", format!("{layers} × {particles}"), annealed(layers, particles, 0.5)));
    }
    let with = |adaptive: bool, crossover: f64| {
        let plain = annealed::Config::default();
        annealed::Config { layers: annealed_search::Config { adaptive, crossover, ..plain.layers }, ..plain }
    };
    for (name, config) in [
        ("plain", with(false, 0.0)),
        ("crossover", with(false, 0.5)),
        ("soft partitions", with(true, 0.0)),
        ("both", with(true, 0.5)),
    ] {
        rows.push(row("variants", name.into(), config));
    }
    for (name, config) in [
        ("Deutscher, Blake & Reid, 10 × 200", annealed::Config::default()),
        ("Deutscher & Reid, 10 × 200", annealed::Config::deutscher_reid()),
        ("Balan, Sigal & Black, 5 × 200", annealed::Config::balan()),
        ("Raskin, Rudzsky & Rivlin, 5 × 100", annealed::Config::raskin()),
    ] {
        rows.push(row("presets", name.into(), config));
    }
    rows.push(Row { sweep: "filters", name: "bootstrap, 2000".into(), method: Method::Bootstrap(2000) });
    rows.push(Row { sweep: "filters", name: "partitioned, 200".into(), method: Method::Partitioned(200) });
    rows
}

/// Cameras' masks, frame by frame.
type Masks = Vec<Vec<BitImage>>;

/// The film, one for each seed.
pub(super) struct Film<'a> {
    walks: &'a Walks,
    frames: usize,
    first_seed: u64,
    footage: Vec<OnceLock<(Vec<sinew::observe::Camera>, Masks)>>,
    body: Arc<SolidBody>,
    isa: Isa,
}

/// Shows a tracker the masks of a walk and keeps what each step says.
struct Screen<'a> {
    model: ImageModel,
    masks: &'a Masks,
    infos: Vec<StepInfo>,
}

impl Harness<ImageLikelihood> for Screen<'_> {
    type Bound = ImageLikelihood;
    type Noted = ();
    type Error = tracking::Error;

    fn observe(&mut self, frame: u32, _estimate: &[f64]) -> Result<ImageLikelihood, tracking::Error> {
        let cues =
            |mask: &BitImage| Some(Cues { silhouette: mask.clone(), edges: Some(contour_map(mask)), picture: None });
        Ok(self.model.bind(self.masks[frame as usize].iter().map(cues).collect()))
    }

    fn note(&mut self, _: u32, info: StepInfo) -> Result<(), tracking::Error> {
        self.infos.push(info);
        Ok(())
    }

    fn record(&mut self, (): (), _: Posterior<'_>) -> Result<(), tracking::Error> {
        Ok(())
    }
}

impl<'a> Film<'a> {
    /// The first frames of the walk.
    pub(super) fn new(walks: &'a Walks, frames: usize, seeds: usize, first_seed: u64, isa: Isa) -> Outcome<Self> {
        let Walks { test, .. } = walks;
        let body = Arc::new(SolidBody::new(&test.tree, &hppf24::flesh(test.scale))?);
        let frames = frames.min(test.states.len());
        Ok(Self { walks, frames, first_seed, footage: (0..seeds).map(|_| OnceLock::new()).collect(), body, isa })
    }

    /// Number of seeds.
    pub(super) fn seeds(&self) -> usize {
        self.footage.len()
    }

    /// Error of the fitted body over the frames that are tracked, as it is and from the pelvis, millimetres.
    pub(super) fn floor(&self) -> [f64; 2] {
        let states = &self.walks.test.states[1..self.frames];
        self.walks.test.errors(states, 1).map(|errors| errors.iter().sum::<f64>() / errors.len() as f64)
    }

    /// Seed of all random streams of a run.
    fn seed(&self, index: usize) -> u64 {
        self.first_seed.wrapping_add(index as u64)
    }

    fn seen(&self, index: usize) -> Outcome<&(Vec<sinew::observe::Camera>, Masks)> {
        let cell = &self.footage[index];
        if cell.get().is_none() {
            let motion = self.walks.test.motion.clone();
            let footage = SyntheticFootage::new(motion, RATE_HZ, &Ring::SMALL_PICTURES, self.seed(index))?;
            let frame_masks =
                |frame| (0..footage.cameras.len()).map(|camera| footage.mask(camera, frame, Level::Normal)).collect();
            let masks = (0..self.frames).map(frame_masks).collect();
            // Another thread may have been quicker; both made the same.
            let _ = cell.set((footage.cameras.clone(), masks));
        }
        Ok(cell.get().ok_or("no footage")?)
    }

    fn parts(&self) -> Outcome<PartTree> {
        let tree = &self.walks.test.tree;
        Ok(part_tree(tree, &hppf24::flesh(self.walks.test.scale))?)
    }

    /// Tracks the walk of a seed with a score and returns errors frame by frame.
    pub(super) fn cell(&self, method: &Method, bidirectional: Option<f64>, index: usize) -> Outcome<Value> {
        let centre = self.walks.test.states[0].clone();
        let walk = RandomWalk::new(&self.walks.sd, 1.0, Between::Mixture, self.isa)?;
        match method {
            Method::Annealed(config) => {
                let sd = self.walks.sd.clone();
                let mut tracker = Annealed::new(config.clone(), walk, sd, centre, self.isa)?;
                self.track(&mut tracker, 1.0, bidirectional, index)
            }
            Method::Bootstrap(particles) => {
                let config = bootstrap::Config { particles: *particles, ..bootstrap::Config::default() };
                self.track(&mut Bootstrap::new(config, walk, centre)?, KAPPA, bidirectional, index)
            }
            Method::Partitioned(particles) => {
                let config = partitioned::Config { particles: *particles, ..partitioned::Config::default() };
                let mut tracker = Partitioned::new(config, walk, self.parts()?, centre)?;
                self.track(&mut tracker, KAPPA, bidirectional, index)
            }
        }
    }

    fn track(
        &self,
        tracker: &mut impl Tracker<ImageLikelihood>,
        kappa: f64,
        bidirectional: Option<f64>,
        index: usize,
    ) -> Outcome<Value> {
        let (cameras, masks) = self.seen(index)?;
        let model = ImageModel {
            body: Arc::clone(&self.body),
            cameras: cameras.clone(),
            score: ImageScore::DeutscherReid { kappa, bidirectional },
            colours: Arc::default(),
            isa: self.isa,
        };
        let stage = |frame| Stage::new(self.seed(index), "annealing walk").at_frame(frame);
        let clock = Instant::now();
        let mut screen = Screen { model, masks, infos: vec![] };
        tracking::run(tracker, 1..self.frames as u32, stage, &mut screen)?;
        let infos = screen.infos;
        let means: Vec<Vec<f64>> = infos.iter().map(|info| info.mean.clone()).collect();
        let survivors: Vec<Vec<f64>> = infos.iter().map(|info| info.survivors.clone()).collect();
        let exponents: Vec<Vec<f64>> = infos.iter().map(|info| info.exponents.clone()).collect();
        let evaluations: usize = infos.iter().map(|info| info.likelihood_evaluations).sum();
        let parts: usize = infos.iter().map(|info| info.part_evaluations).sum();
        let frames = means.len() as f64;
        let seconds = clock.elapsed().as_secs_f64() / frames;
        let [absolute, relative] = self.walks.test.errors(&means, 1);
        let mean = |of: &[Vec<f64>]| -> Vec<f64> {
            let count = of.first().map_or(0, Vec::len);
            (0..count).map(|k| of.iter().map(|frame| frame[k]).sum::<f64>() / frames).collect()
        };
        Ok(json!({
            "absolute": absolute,
            "relative": relative,
            "evaluations": evaluations as f64 / frames,
            "part_evaluations": parts as f64 / frames,
            "seconds": seconds,
            "survivors": mean(&survivors),
            "exponents": mean(&exponents),
        }))
    }
}
