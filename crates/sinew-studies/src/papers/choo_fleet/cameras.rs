//! What more cameras and better or worse images change.
//!
//! Particle filter against hybrid Monte Carlo with 1, 2 and 4 cameras and errors of 0.001, 0.003 and 0.01 focal lengths.
//!
//! Three frames of walking, 10 and 28 degrees of freedom. The cameras stand 4.8 m from the subject, at 0° (the paper's), 90°, 180° and 270° about the vertical. An observation's errors are the same normal deviates whatever
//! their size, and the first camera's are taken from the single-frame study. Step size and length are tuned on walking 60 for each number of cameras and each error; the reference is long chains everywhere, for no
//! affordable number of draws of the prior reaches the narrowest posteriors.

use super::chains::{self, Step, Variant};
use super::curves::{self, volumes_of};
use super::figures::{self, CameraPoint};
use super::problem::{MODELS, Model, Problem};
use super::scene::{self, Source};
use super::single::{self, Setting};
use super::study::{FRAMES, Study, frame_name, tuned_step};
use crate::support::outcome::Outcome;
use crate::support::statistics::median;
use crate::support::store::{Store, Task, run_all};
use serde_json::{Value, json};
use sinew::body::Plan;
use sinew::core::random::Stage;
use sinew::observe::ObservationModel as _;
use sinew_markers::MarkerViewsModel;
use sinew_tests::evaluation::equal_variance::{At, Axis, Cell, Ratio, over_frames, ratio};
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

/// Raised with every change of what a cell of this part computes.
const VERSION: u32 = 1;
/// Azimuths of the cameras for each number of them.
const CAMERAS: [&[f64]; 3] = [&[0.0], &[0.0, FRAC_PI_2], &[0.0, FRAC_PI_2, 2.0 * FRAC_PI_2, 3.0 * FRAC_PI_2]];
/// Standard deviations of an image coordinate, in focal lengths.
const SIGMAS: [f64; 3] = [0.001, 0.003, 0.01];
/// Of [`MODELS`].
const PARTS: [usize; 2] = [1, 2];
/// Of [`FRAMES`].
const WALKING: [usize; 3] = [0, 1, 2];
const VARIANTS: [Variant; 2] = [Variant::Best, Variant::Dense];
/// Doublings of the particles and of the updates of Table 1.
const PARTICLE_DOUBLINGS: [u32; 3] = [0, 3, 6];
const UPDATE_DOUBLINGS: [u32; 4] = [0, 2, 4, 6];
/// Updates of the references.
const REFERENCE_UPDATES: usize = 5000;

fn configuration() -> String {
    format!(
        "cameras {VERSION}, {CAMERAS:?}, {SIGMAS:?}, {PARTS:?}, {WALKING:?}, {VARIANTS:?}, {PARTICLE_DOUBLINGS:?}, {UPDATE_DOUBLINGS:?}, {REFERENCE_UPDATES}"
    )
}

/// How a frame is seen.
#[derive(Clone, Copy, Debug)]
struct View {
    /// Of [`CAMERAS`].
    cameras: usize,
    sigma: f64,
    model: Model,
}

impl View {
    fn all() -> Vec<Self> {
        let each = PARTS.into_iter().flat_map(|part| (0..CAMERAS.len()).map(move |cameras| (part, cameras)));
        each.flat_map(|(part, cameras)| SIGMAS.map(|sigma| Self { cameras, sigma, model: MODELS[part] })).collect()
    }

    fn count(&self) -> usize {
        CAMERAS[self.cameras].len()
    }

    fn name(&self) -> String {
        format!("cameras/{}/{}/{}", self.model.name(), self.count(), self.sigma)
    }

    fn tuning_key(&self, variant: Variant) -> String {
        format!("{}/tuning/{}", self.name(), variant.name())
    }

    /// What a gradient costs does not depend on the error.
    fn factor_key(&self) -> String {
        format!("cameras/{}/{}/factor", self.model.name(), self.count())
    }

    fn reference_key(&self, frame: usize) -> String {
        format!("{}/{}/reference", self.name(), frame_name(frame))
    }

    fn cell_key(&self, frame: usize, setting: &Setting) -> String {
        format!("{}/{}/{}", self.name(), frame_name(frame), setting.name())
    }

    fn problem(&self, study: &Study, frame: usize) -> Outcome<Problem> {
        let (name, number) = FRAMES[frame];
        let motion = &study.motions[name];
        let views = motion.views(number, CAMERAS[self.cameras]);
        let found = motion.frame(number, Source::Recorded)?;
        let seen: Vec<_> = (0..views.len())
            .map(|camera| {
                let stage = Stage::new(study.seed, "choo-fleet observation").at_frame(frame as u32);
                let stage = if camera == 0 { stage } else { stage.round(camera) };
                scene::seen_from(&views[camera], &found.markers, self.sigma, stage)
            })
            .collect();
        let plan = Arc::new(Plan::with_all_points(&motion.tree));
        let model = MarkerViewsModel { plan, views, sigma: self.sigma, isa: study.isa };
        Problem::new(self.model, &found, Box::new(model.bind(&seen)), study.isa)
    }

    fn settings(&self, of: Option<Variant>) -> Vec<Setting> {
        match of {
            None => PARTICLE_DOUBLINGS.map(|k| Setting::Particles(self.model.particles << k)).to_vec(),
            Some(variant) => UPDATE_DOUBLINGS.map(|k| Setting::Updates(variant, 8 << k)).to_vec(),
        }
    }

    fn step(&self, store: &Store, variant: Variant) -> Outcome<Step> {
        tuned_step(store, &self.tuning_key(variant))
    }

    /// The cells of a contender in a frame, by rising cost.
    fn curve(&self, store: &Store, frame: usize, of: Option<Variant>) -> Outcome<Vec<Cell>> {
        let settings = self.settings(of);
        let keys = settings.iter().map(|setting| self.cell_key(frame, setting));
        curves::cells([store; 2], [&self.reference_key(frame), &self.factor_key()], keys)
    }
}

fn stage(study: &Study, view: &View, purpose: &str) -> Stage {
    let [stage] = Stage::new(study.seed, "choo-fleet cameras").split([format!("{} {purpose}", view.name()).as_str()]);
    stage
}

/// Gradient factors, taken alone, and steps.
fn tune(study: &Study, store: &mut Store, threads: usize) -> Outcome<()> {
    let (mut factors, mut steps): (Vec<Task<'_>>, Vec<Task<'_>>) = (vec![], vec![]);
    for view in View::all() {
        if view.sigma == SIGMAS[0] {
            let task = move || Ok(json!(view.problem(study, 0)?.gradient_factor()));
            factors.push((view.factor_key(), 1.0, Box::new(task)));
        }
        for variant in VARIANTS {
            let task = move || {
                let stage = stage(study, &view, variant.name());
                let step = chains::tune(&view.problem(study, 0)?, variant, stage)?;
                Ok(json!({ "eta": step.eta, "steps": step.steps, "acceptance": step.acceptance }))
            };
            steps.push((view.tuning_key(variant), view.model.dim as f64, Box::new(task)));
        }
    }
    run_all(store, "gradient factors of cameras", factors, 1)?;
    run_all(store, "tuning for cameras", steps, threads)
}

/// Runs what is missing, writes `cameras.csv` and `cameras.svg`, and returns what goes into `results.json`.
pub(super) fn run(study: &Study, (folder, configuration_of_study): (&Path, &str), threads: usize) -> Outcome<Value> {
    let mut store = Store::open(folder, &format!("{configuration_of_study}, {}", configuration()))?;
    tune(study, &mut store, threads)?;
    let (mut references, mut cells): (Vec<Task<'_>>, Vec<Task<'_>>) = (vec![], vec![]);
    for view in View::all() {
        let cost = (1 + view.count()) as f64 * view.model.dim as f64;
        for frame in WALKING {
            let dense = view.step(&store, Variant::Dense)?;
            let task = move || {
                let stage = stage(study, &view, "reference").at_frame(frame as u32);
                single::reference_by_chains(&view.problem(study, frame)?, REFERENCE_UPDATES, &dense, stage)
            };
            references.push((view.reference_key(frame), cost * dense.steps as f64, Box::new(task)));
            for of in [None, Some(Variant::Best), Some(Variant::Dense)] {
                let step = of.map(|variant| view.step(&store, variant)).transpose()?;
                for setting in view.settings(of) {
                    let work = match (setting, &step) {
                        (Setting::Updates(_, updates), Some(step)) => 2 * 16 * updates * step.steps,
                        (Setting::Particles(count), _) => count,
                        _ => 0,
                    };
                    let task = move || {
                        let stage = stage(study, &view, &setting.name()).at_frame(frame as u32);
                        single::cell(&view.problem(study, frame)?, setting, step.as_ref(), study.size.runs, &stage)
                    };
                    cells.push((view.cell_key(frame, &setting), cost * work as f64, Box::new(task)));
                }
            }
        }
    }
    run_all(&mut store, "references of cameras", references, threads)?;
    run_all(&mut store, "cameras", cells, threads)?;
    report(study, &store, folder)
}

/// What the frames of a view have in common, beside the contenders.
struct Frames {
    /// Median effective number of the most particles.
    effective: f64,
    /// Mean base-ten logarithm of the volume ratio, by determinants.
    volume: f64,
    /// Largest split R̂ of the references.
    r_hat: f64,
}

impl Frames {
    fn for_view(study: &Study, store: &Store, view: &View) -> Outcome<Self> {
        let (mut effective, mut volume, mut r_hat) = (vec![], 0.0, f64::NAN);
        let sd = view.model.walk(study.isa)?;
        for frame in WALKING {
            let last = view.curve(store, frame, None)?.last().map_or(f64::NAN, |cell| cell.effective);
            effective.push(last);
            let reference = store.get(&view.reference_key(frame)).ok_or("a reference is missing")?;
            volume += volumes_of(reference, sd.sd())[1] / WALKING.len() as f64;
            r_hat = reference["r_hat"].as_f64().map_or(f64::NAN, |r| r.max(r_hat));
        }
        Ok(Self { effective: median(&effective), volume, r_hat })
    }
}

/// The ratios of a view and variant on an axis, frame by frame.
fn ratios(study: &Study, store: &Store, view: &View, variant: Variant, axis: Axis) -> Outcome<Vec<Ratio>> {
    let bootstrap = Stage::new(study.seed, "choo-fleet bootstrap");
    let each = |&frame: &usize| {
        let (pf, hmc) = (view.curve(store, frame, None)?, view.curve(store, frame, Some(variant))?);
        Ok(ratio(&pf, &hmc, axis, At::Extrapolated, &bootstrap))
    };
    WALKING.iter().map(each).collect()
}

fn report(study: &Study, store: &Store, folder: &Path) -> Outcome<Value> {
    let mut table = String::from(
        "dim,cameras,sigma,contender,eta,steps,pf_over_hmc,low,high,pf_over_hmc_seconds,low_seconds,high_seconds,extrapolated_frames,median_effective,log10_volume_det,largest_r_hat\n",
    );
    let mut points = vec![];
    for view in View::all() {
        let Frames { effective, volume, r_hat } = Frames::for_view(study, store, &view)?;
        for variant in VARIANTS {
            let step = view.step(store, variant)?;
            let [units, seconds] = [Axis::Units, Axis::Seconds].map(|axis| ratios(study, store, &view, variant, axis));
            let (units, seconds) = (units?, seconds?);
            let extrapolated = units.iter().filter(|r| r.extrapolated).count();
            let ([a, b, c], [d, e, f]) = (over_frames(&units), over_frames(&seconds));
            let _ = writeln!(
                table,
                "{},{},{},{},{:.4},{},{a:.4e},{b:.4e},{c:.4e},{d:.4e},{e:.4e},{f:.4e},{extrapolated},{effective:.2},{volume:.3},{r_hat:.4}",
                view.model.dim,
                view.count(),
                view.sigma,
                variant.name().replace(',', ""),
                step.eta,
                step.steps
            );
            let (dim, cameras, sigma) = (view.model.dim, view.count(), view.sigma);
            points.push(CameraPoint { dim, cameras, sigma, variant, ratio: [a, b, c] });
        }
    }
    println!("{table}");
    std::fs::write(folder.join("cameras.csv"), table)?;
    figures::cameras(&points, &folder.join("cameras.svg"))?;
    let factors: Vec<Value> = View::all()
        .iter()
        .filter(|view| view.sigma == SIGMAS[0])
        .map(|view| json!({ "dim": view.model.dim, "cameras": view.count(), "gradient_factor": store.get(&view.factor_key()) }))
        .collect();
    Ok(json!({ "configuration": store.config, "gradient_factors": factors }))
}

#[cfg(test)]
mod tests {
    use super::super::study::Size;
    use super::*;
    use sinew::core::density::LogDensity as _;
    use sinew::core::lanes::Isa;
    use sinew_tests::data::{folder, shared};
    use std::collections::BTreeMap;

    #[test]
    fn one_camera_with_the_papers_error_is_the_single_frame_study() {
        if shared("cmu_amc").is_none() {
            return;
        }
        let data = folder();
        let motions = BTreeMap::from([("07_01", scene::motion(&data, "07_01").unwrap())]);
        let study = Study { isa: Isa::best(), seed: 3, size: Size::quick(), motions };
        let view = View { cameras: 0, sigma: scene::SIGMA, model: MODELS[1] };
        let (here, there) = (view.problem(&study, 1).unwrap(), study.problem(Source::Recorded, 1, view.model).unwrap());
        for state in [&here.truth, &here.previous] {
            let (a, b) = (here.likelihood.log_density(state), there.likelihood.log_density(state));
            assert!((a - b).abs() < 1e-9 * b.abs(), "{a} {b}");
        }
        // More cameras determine more: the truth gains on the state before.
        let gain = |cameras: usize| {
            let problem = View { cameras, ..view }.problem(&study, 1).unwrap();
            problem.likelihood.log_density(&problem.truth) - problem.likelihood.log_density(&problem.previous)
        };
        assert!(gain(0) < gain(1) && gain(1) < gain(2));
    }
}
