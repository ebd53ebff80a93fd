//! The strongest opponents of hybrid Monte Carlo in single frames: samplers that see the gradient too, and annealed search.
//!
//! Frames, observations, references and the measure of error are taken from [`super::single`]. Each opponent has the knowledge that hybrid Monte Carlo with the dense metric has: the Laplace approximation of the frame, and the
//! step size and length that were tuned for that metric on the first frame of walking. Nothing is tuned for the opponents:
//!
//! - [`Opponent::Tempered`]: half of the particles survive each temperature, four updates at each, so that copies made by resampling part; the mean of all draws at β = 1
//! - [`Opponent::Laplace`]: Student t of 7 degrees of freedom about the mode, self-normalised weights
//! - [`Opponent::Search`]: ten layers, survival rate ½, the weight function is the likelihood, the first diffusion the prior. It estimates no posterior mean; the mean of its last layer is compared all the same, as what it is

use super::chains::{CURVATURE_DRAWS, Step, Variant};
use super::curves::{self, curve};
use super::figures;
use super::problem::{MODELS, Model, Problem};
use super::scene::Source;
use super::study::{Study, factor_key, frame_name, reference_key, step_of};
use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, numbers, run_all};
use serde_json::{Value, json};
use sinew::core::lanes::Block;
use sinew::core::random::Stage;
use sinew::samplers::annealed_search::{self, search};
use sinew::samplers::importance::{Tails, importance};
use sinew::samplers::laplace::laplace;
use sinew::samplers::metric::Metric;
use sinew::samplers::population::Population;
use sinew::samplers::tempered_smc;
use sinew_tests::evaluation::equal_variance::{At, Axis, Cell, Ratio, over_frames, ratio};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

/// Raised with every change of what a cell of this part computes.
const VERSION: u32 = 1;

/// Who is compared with hybrid Monte Carlo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Opponent {
    /// Tempered sequential Monte Carlo with Hamiltonian moves.
    Tempered,
    /// Importance sampling from the Laplace approximation: a particle filter whose proposal has seen the observation.
    Laplace,
    /// Annealed search.
    Search,
}

impl Opponent {
    pub(super) const ALL: [Self; 3] = [Self::Tempered, Self::Laplace, Self::Search];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Tempered => "tempered SMC",
            Self::Laplace => "pf, Laplace proposal",
            Self::Search => "annealed search",
        }
    }

    const fn kind(self) -> &'static str {
        match self {
            Self::Tempered | Self::Laplace => "sampler",
            Self::Search => "search",
        }
    }

    /// Numbers of particles.
    fn sizes(self, model: &Model) -> [usize; 4] {
        match self {
            Self::Tempered => [16, 64, 256, 1024],
            Self::Laplace if model.dim > 10 => [1024, 4096, 16_384, 65_536],
            Self::Laplace => [64, 256, 1024, 4096],
            Self::Search => [32, 128, 512, 2048],
        }
    }

    /// Rough work of a run, in likelihoods.
    fn work(self, size: usize, model: &Model, step: &Step) -> f64 {
        let n = size as f64;
        match self {
            Self::Tempered => 2.0 * n * model.dim as f64 * (1 + 4 * step.steps) as f64,
            Self::Laplace => n,
            Self::Search => 10.0 * n,
        }
    }
}

/// Everything that the cells of this part depend on beyond the study.
fn configuration() -> String {
    let sizes: Vec<_> = Opponent::ALL.iter().flat_map(|o| MODELS.map(|model| o.sizes(&model))).collect();
    format!(
        "opponents {VERSION}, {sizes:?}, {:?}, {:?}, {:?}",
        tempered_smc::Config::default(),
        Tails::default(),
        annealed_search::Config::default()
    )
}

/// One run: its mean and what it took.
struct Run {
    mean: Vec<f64>,
    likelihoods: usize,
    gradients: usize,
    effective: Option<f64>,
    acceptance: Option<f64>,
    layers: usize,
}

fn run_once(problem: &Problem, opponent: Opponent, size: usize, step: &Step, stage: Stage) -> Outcome<Run> {
    let (observed, prior, isa) = (&problem.likelihood, &problem.prior, problem.isa);
    let [to_approximate, to_sample] = stage.split(["laplace", "sample"]);
    Ok(match opponent {
        Opponent::Tempered => {
            let laplace = laplace(observed, prior, CURVATURE_DRAWS, isa, to_approximate)?;
            let config = tempered_smc::Config {
                particles: size,
                step_size: step.eta,
                leapfrog_steps: step.steps,
                jitter: Variant::Dense.jitter(),
                ..tempered_smc::Config::default()
            };
            let metric = Metric::Dense(laplace.metric);
            let sample = tempered_smc::temper(observed, prior, &metric, &config, isa, to_sample)?;
            let layers = sample.temperatures.len();
            Run {
                mean: sample.mean(),
                likelihoods: sample.likelihoods,
                gradients: sample.gradients + CURVATURE_DRAWS,
                effective: None,
                acceptance: Some(sample.temperatures.iter().map(|t| t.acceptance).sum::<f64>() / layers as f64),
                layers,
            }
        }
        Opponent::Laplace => {
            let laplace = laplace(observed, prior, CURVATURE_DRAWS, isa, to_approximate)?;
            let weighted = importance(&problem.target(), &laplace, Tails::default(), size, isa, &to_sample)?;
            Run {
                mean: weighted.mean(),
                likelihoods: size,
                gradients: CURVATURE_DRAWS,
                effective: Some(weighted.effective_sample_size()),
                acceptance: None,
                layers: 1,
            }
        }
        Opponent::Search => {
            let centre = |_: usize, states: &mut [Block]| {
                states.iter_mut().zip(&problem.previous).for_each(|(x, &centre)| *x = Block::splat(centre));
            };
            let start = Population::from_blocks(problem.previous.len(), size, centre)?;
            let config = annealed_search::Config::default();
            let found = search(observed, &start, problem.walk.sd(), &config, isa, to_sample)?;
            Run {
                mean: found.mean,
                likelihoods: size * config.layers,
                gradients: 0,
                effective: None,
                acceptance: None,
                layers: config.layers,
            }
        }
    })
}

/// Runs a cell. Costs are means over its runs: the number of temperatures is not the same in each.
fn cell(problem: &Problem, opponent: Opponent, size: usize, step: &Step, runs: usize, stage: &Stage) -> Outcome<Value> {
    let clock = Instant::now();
    let all: Vec<Run> =
        (0..runs).map(|run| run_once(problem, opponent, size, step, stage.round(run))).collect::<Outcome<_>>()?;
    let mean = |of: &dyn Fn(&Run) -> usize| all.iter().map(|run| of(run) as f64).sum::<f64>() / runs as f64;
    Ok(json!({
        "seconds": clock.elapsed().as_secs_f64() / runs as f64,
        "likelihoods": mean(&|run| run.likelihoods),
        "gradients": mean(&|run| run.gradients),
        "layers": mean(&|run| run.layers),
        "effective": all.iter().filter_map(|run| run.effective).collect::<Vec<_>>(),
        "acceptance": all.iter().filter_map(|run| run.acceptance).collect::<Vec<_>>(),
        "means": all.iter().map(|run| &run.mean).collect::<Vec<_>>(),
    }))
}

fn key(frame: usize, model: &Model, opponent: Opponent, size: usize) -> String {
    format!("opponents/{}/{}/{}, N = {size}", frame_name(frame), model.name(), opponent.name())
}

/// A curve of one contender in one frame.
struct Contender {
    name: &'static str,
    kind: &'static str,
    settings: Vec<usize>,
    cells: Vec<Cell>,
}

impl Contender {
    /// Adds its rows of a frame to a table; returns the error of its largest setting in posterior standard deviations.
    fn rows(&self, table: &mut String, (frame, dim): (usize, usize), log_variance: f64, stage: &Stage) -> f64 {
        let mut last = f64::NAN;
        for (setting, cell) in self.settings.iter().zip(&self.cells) {
            let (log, error) = (cell.log_mean(), cell.log_mean_error(stage));
            last = (0.5 * (log - log_variance)).exp();
            let _ = writeln!(
                table,
                "{},{dim},{},{},{setting},{:.1},{:.6e},{log:.5},{error:.5},{last:.5},{:.3},{:.4}",
                frame_name(frame),
                self.name.replace(',', ""),
                self.kind,
                cell.units,
                cell.seconds,
                cell.effective,
                cell.acceptance
            );
        }
        last
    }
}

/// Particle filter, hybrid Monte Carlo and the opponents in one frame; hybrid Monte Carlo with the dense metric comes last.
fn contenders(study: &Study, base: &Store, store: &Store, frame: usize, model: &Model) -> Outcome<Vec<Contender>> {
    let settings = |first: usize| study.size.doublings.iter().map(|doubling| first << doubling).collect::<Vec<_>>();
    let known = |of: Option<Variant>| {
        Ok::<_, Box<dyn std::error::Error + Send + Sync>>(Contender {
            name: of.map_or("particle filter", Variant::name),
            kind: "sampler",
            settings: settings(if of.is_some() { 8 } else { model.particles }),
            cells: curve(study, base, Source::Recorded, frame, model, of)?,
        })
    };
    let mut all = vec![known(None)?, known(Some(Variant::Paper))?];
    let reference = reference_key(Source::Recorded, frame, model);
    for opponent in Opponent::ALL {
        let keys = opponent.sizes(model).into_iter().map(|size| key(frame, model, opponent, size));
        all.push(Contender {
            name: opponent.name(),
            kind: opponent.kind(),
            settings: opponent.sizes(model).to_vec(),
            cells: curves::cells([base, store], [&reference, &factor_key(model)], keys)?,
        });
    }
    all.push(known(Some(Variant::Dense))?);
    Ok(all)
}

/// Mean logarithm of the posterior variances in a frame.
fn log_posterior_variance(base: &Store, frame: usize, model: &Model) -> Outcome<f64> {
    let reference = base.get(&reference_key(Source::Recorded, frame, model)).ok_or("a reference is missing")?;
    let (covariance, d) = (numbers(&reference["covariance"]), model.dim);
    Ok((0..d).map(|j| covariance[j * d + j].ln()).sum::<f64>() / d as f64)
}

/// Runs what is missing, writes `opponents.csv` and `opponents.svg`, and returns what goes into `results.json`.
pub(super) fn run(
    study: &Study,
    base: &Store,
    (folder, configuration_of_study): (&Path, &str),
    threads: usize,
) -> Outcome<Value> {
    let mut store = Store::open(folder, &format!("{configuration_of_study}, {}", configuration()))?;
    let mut tasks: Vec<Task<'_>> = vec![];
    for &frame in &study.size.frames {
        for model in MODELS {
            let step = step_of(base, &model, Variant::Dense)?;
            for opponent in Opponent::ALL {
                for size in opponent.sizes(&model) {
                    let task = move || {
                        let problem = study.problem(Source::Recorded, frame, model)?;
                        let stage = Stage::new(study.seed, "choo-fleet opponents").at_frame(frame as u32);
                        let [stage] = stage.split([format!("{} {size}", opponent.name()).as_str()]);
                        cell(&problem, opponent, size, &step, study.size.runs, &stage)
                    };
                    let work = opponent.work(size, &model, &step);
                    tasks.push((key(frame, &model, opponent, size), work, Box::new(task)));
                }
            }
        }
    }
    run_all(&mut store, "opponents", tasks, threads)?;
    report(study, base, &store, folder)
}

fn report(study: &Study, base: &Store, store: &Store, folder: &Path) -> Outcome<Value> {
    let stage = Stage::new(study.seed, "choo-fleet bootstrap");
    let mut table = String::from(
        "frame,dim,contender,kind,setting,units,seconds,log_gm_variance,log_gm_variance_se,error_in_posterior_sds,median_effective,acceptance\n",
    );
    let (mut panels, mut summary) = (vec![], vec![]);
    for model in &MODELS {
        let mut ratios: Vec<(&str, [Vec<Ratio>; 2])> = vec![];
        // Errors of the means in posterior standard deviations at each contender's largest setting.
        let mut errors: Vec<(&str, &str, Vec<f64>)> = vec![];
        for &frame in &study.size.frames {
            let all = contenders(study, base, store, frame, model)?;
            let posterior = log_posterior_variance(base, frame, model)?;
            let dense = &all[all.len() - 1];
            for (place, contender) in all.iter().enumerate() {
                let last = contender.rows(&mut table, (frame, model.dim), posterior, &stage);
                if place == errors.len() {
                    errors.push((contender.name, contender.kind, vec![]));
                    ratios.push((contender.name, [vec![], vec![]]));
                }
                errors[place].2.push(last.ln());
                for (axis, found) in [Axis::Units, Axis::Seconds].into_iter().zip(&mut ratios[place].1) {
                    found.push(ratio(&contender.cells, &dense.cells, axis, At::Extrapolated, &stage));
                }
            }
            let lines = all.into_iter().map(|c| (c.name, c.cells)).collect();
            panels.push((format!("{}-D, {}", model.dim, frame_name(frame)), lines));
        }
        for ((name, kind, logs), (_, [units, seconds])) in errors.into_iter().zip(ratios) {
            let error = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
            let sampler = kind == "sampler" && name != Variant::Dense.name();
            let of = |ratios: &[Ratio]| if sampler { json!(over_frames(ratios)) } else { Value::Null };
            summary.push(json!({
                "dim": model.dim,
                "contender": name,
                "kind": kind,
                "cost_over_dense_hmc": of(&units),
                "seconds_over_dense_hmc": of(&seconds),
                "extrapolated_frames": units.iter().filter(|r| r.extrapolated).count(),
                "error_in_posterior_sds": error,
            }));
        }
    }
    std::fs::write(folder.join("opponents.csv"), table)?;
    figures::opponents(&panels, study.size.frames.len(), &stage, &folder.join("opponents.svg"))?;
    for row in &summary {
        println!("{row}");
    }
    Ok(json!({ "configuration": store.config, "rows": summary }))
}
