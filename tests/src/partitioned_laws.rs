//! Weighted resampling and the partitioned filter against closed forms: unbiased weighted resampling (R6), the filter against Kalman (A7), the same without its weights (A8), survival over parts (A9), `partitioned-exact`.
//!
//! For any number of particles Ẑ is an unbiased estimate of the evidence Z, and Ẑ Σ W_i f(s_i) of Z E[f | z] (Del Moral 2004, theorem 7.4.2), whatever the importance functions: scores are of means of
//! Ẑ / Z and Ẑ / Z Σ W_i f(s_i) over independent runs. The mean of a run alone is biased by the order of 1 / N, as that of every particle filter.

use crate::finding::{Finding, mean_and_error};
use crate::linear_series::{Series, Sight, dot, product};
use crate::size::Size;
use serde_json::Value;
use sinew::core::density::{LogDensity, PartLogDensity};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::part::{Part, PartTree, Partition};
use sinew::core::random::{BlockRng, Stage};
use sinew::core::transition::{MotionModel, PartTransition, Transition};
use sinew::samplers::diffusion::diffuse;
use sinew::samplers::particles::{Particles, aggregate, evaluate, resample, reweight, take, temper};
use sinew::samplers::parts::{evaluate_part, start_part};
use sinew::samplers::resample::Scheme;
use sinew::samplers::weighted_resampling::weighted_resample;
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::partitioned::{self, Partitioned};
use std::f64::consts::TAU;

/// Linear motion, part after part: x_k ← (rows of k) x + N(0, sd²), where x is as the parts before k have left it.
#[derive(Clone, Debug)]
pub struct Motion {
    parts: Vec<Part>,
    rows: Vec<Vec<f64>>,
    sd: Vec<f64>,
}

impl Motion {
    /// A · and Q of the whole step.
    fn whole(&self) -> [Vec<f64>; 2] {
        let d = self.sd.len();
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        let (mut a, mut q) = ((0..d * d).map(|e| unit(e / d, e % d)).collect::<Vec<f64>>(), vec![0.0; d * d]);
        for part in &self.parts {
            let moves = |i: usize| part.indices().contains(&i);
            let step: Vec<f64> =
                (0..d * d).map(|e| if moves(e / d) { self.rows[e / d][e % d] } else { unit(e / d, e % d) }).collect();
            let back: Vec<f64> = (0..d * d).map(|e| step[e % d * d + e / d]).collect();
            a = product(&step, &a, d);
            q = product(&product(&step, &q, d), &back, d);
            part.indices().iter().for_each(|&i| q[i * (d + 1)] += self.sd[i] * self.sd[i]);
        }
        [a, q]
    }

    fn means(&self, part: &Part, x: &[f64]) -> Vec<f64> {
        part.indices().iter().map(|&i| dot(&self.rows[i], x)).collect()
    }
}

impl MotionModel for Motion {
    fn dim(&self) -> usize {
        self.sd.len()
    }
}

impl Transition for Motion {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        next.copy_from_slice(previous);
        self.parts.iter().for_each(|part| self.sample_part_block(part, next, rng));
    }
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        let mut x = previous.to_vec();
        let mut value = 0.0;
        for part in &self.parts {
            for (&i, mean) in part.indices().iter().zip(self.means(part, &x)) {
                value -= 0.5 * ((next[i] - mean) / self.sd[i]).powi(2) + (self.sd[i] * TAU.sqrt()).ln();
            }
            part.indices().iter().for_each(|&i| x[i] = next[i]);
        }
        value
    }
}

impl PartTransition for Motion {
    fn sample_part_block(&self, part: &Part, next: &mut [Block], rng: &mut BlockRng) {
        let mut noise = vec![Block::ZERO; part.indices().len()];
        rng.fill_normal(Isa::best(), &mut noise);
        for lane in 0..LANES {
            let x: Vec<f64> = next.iter().map(|b| b.0[lane]).collect();
            for ((&i, mean), z) in part.indices().iter().zip(self.means(part, &x)).zip(&noise) {
                next[i].0[lane] = mean + self.sd[i] * z.0[lane];
            }
        }
    }
}

/// How the filter gets the factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Importance {
    /// The likelihood is their product: the last factor is what is left.
    Product,
    /// They are importance functions, and the likelihood is evaluated as a whole.
    Right,
    /// As before, but of the root of each factor, for another observation.
    Wrong,
    /// Intermediate densities: the whole likelihood of states whose later parts have not moved yet, to the power of the share of parts that have.
    Whole,
}

/// One observation: a factor z_k = c_k · x + N(0, r_k) a part.
struct Seen {
    whole: Sight,
    c: Vec<Vec<f64>>,
    z: Vec<f64>,
    r: Vec<f64>,
    importance: Importance,
}

impl LogDensity for Seen {
    fn dim(&self) -> usize {
        self.whole.dim()
    }
    fn workspace(&self) -> usize {
        self.whole.workspace()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.whole.log_density(x)
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.whole.log_density_block(x, ws)
    }
}

impl PartLogDensity for Seen {
    fn parts(&self) -> usize {
        self.z.len()
    }
    fn is_product(&self) -> bool {
        self.importance == Importance::Product
    }
    fn has_intermediates(&self) -> bool {
        self.importance == Importance::Whole
    }
    fn log_intermediate_block(&self, part: usize, x: &[Block], ws: &mut [Block]) -> Block {
        let power = (part + 1) as f64 / self.parts() as f64;
        Block(self.log_density_block(x, ws).0.map(|value| power * value))
    }
    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        for (&k, out) in parts.iter().zip(out) {
            let (power, shift) = if self.importance == Importance::Wrong { (0.5, 0.4) } else { (1.0, 0.0) };
            let value = |lane: usize| {
                let seen: f64 = self.c[k].iter().zip(x).map(|(c, x)| c * x.0[lane]).sum();
                power * (-0.5 * (self.z[k] + shift - seen).powi(2) / self.r[k] - 0.5 * (TAU * self.r[k]).ln())
            };
            *out = Block(core::array::from_fn(value));
        }
    }
}

const DIM: usize = 6;

/// Three parts of two coordinates.
fn tree() -> PartTree {
    let parts = [[0, 3], [1, 4], [2, 5]].map(|part| Part::new(part.to_vec(), DIM).expect("valid")).to_vec();
    PartTree::new(Partition::new(parts, DIM).expect("covers"), vec![None, Some(0), Some(1)]).expect("parents first")
}

/// A motion whose parts move alone, or each with what those before it have become and those after it were; a factor looks at its own part, or also at those before it.
fn problem(coupled: bool, frames: usize) -> (Motion, Series) {
    let parts = tree().partition().parts().to_vec();
    let place = |i: usize| parts.iter().position(|part| part.indices().contains(&i)).expect("covered");
    let coefficient = |i: usize, j: usize| match (i == j, place(i) == place(j)) {
        (true, _) => 0.9,
        (_, true) => 0.2,
        _ if coupled => 0.15 * (1.0 + i as f64 - 0.5 * j as f64),
        _ => 0.0,
    };
    let rows: Vec<Vec<f64>> = (0..DIM).map(|i| (0..DIM).map(|j| coefficient(i, j)).collect()).collect();
    let motion = Motion { parts: parts.clone(), rows, sd: vec![0.5, 0.4, 0.6, 0.3, 0.5, 0.4] };
    let [a, q] = motion.whole();
    let seen = |k: usize, j: usize| match place(j) {
        p if p == k => 1.0 - 0.1 * j as f64,
        p if p < k && coupled => 0.5,
        _ => 0.0,
    };
    let c: Vec<Vec<f64>> = (0..3).map(|k| (0..DIM).map(|j| seen(k, j)).collect()).collect();
    let r: Vec<Vec<f64>> = (0..3).map(|k| (0..3).map(|l| if k == l { 0.25 } else { 0.0 }).collect()).collect();
    let z = (0..frames).map(|frame| (0..3).map(|k| 0.8 * (1.3 * frame as f64 + k as f64).sin()).collect()).collect();
    let (m0, p0) = (vec![0.0; DIM], q.clone());
    (motion, Series { dim: DIM, m0, p0, a, q, c, r, z, truth: vec![], stored: Value::Null })
}

fn observed(series: &Series, frame: usize, importance: Importance) -> Seen {
    let r = (0..3).map(|k| series.r[k][k]).collect();
    Seen { whole: series.sight(frame), c: series.c.clone(), z: series.z[frame].clone(), r, importance }
}

/// Ẑ / Z, and times the mean and square of each coordinate, against 1 and their exact values: a score each.
fn scores(what: &str, series: &Series, runs: &[(f64, Particles)], bound: f64, seed: u64) -> Vec<Finding> {
    let exact = series.kalman();
    let log_z: f64 = exact.iter().map(|frame| frame.log_likelihood).sum();
    let last = &exact[exact.len() - 1].filtered;
    let score = |name: &str, truth: f64, value: &dyn Fn(&Particles) -> f64| {
        let values: Vec<f64> = runs.iter().map(|(log, particles)| (log - log_z).exp() * value(particles)).collect();
        let [mean, error] = mean_and_error(&values);
        let detail = format!("{mean:.4} ± {error:.4} for {truth:.4}, {} runs, seed {seed}", runs.len());
        Finding::score(format!("{what}: {name}"), (mean - truth) / error, bound, detail)
    };
    let mut findings = vec![score("evidence", 1.0, &|_| 1.0)];
    for j in 0..DIM {
        findings.push(score(&format!("mean {j}"), last.mean[j], &|particles| aggregate(particles)[j]));
        let square = last.covariance[j * (DIM + 1)] + last.mean[j] * last.mean[j];
        let weighted = |particles: &Particles| -> f64 {
            particles.weights().iter().enumerate().map(|(i, w)| w * particles.state(i)[j].powi(2)).sum()
        };
        findings.push(score(&format!("square {j}"), square, &weighted));
    }
    findings
}

/// The filter on a linear-Gaussian series of `frames`, whatever its importance functions. 13 scores: |z| < 4.5 in one frame (A7), and < 4 over several (`partitioned-exact`).
///
/// # Panics
/// When the filter fails, which would be a defect.
#[must_use]
pub fn agreement(coupled: bool, importance: Importance, frames: usize, size: Size, seed: u64) -> Vec<Finding> {
    let (motion, series) = problem(coupled, frames);
    let run = |run: usize| {
        let config = partitioned::Config { particles: 300, ..partitioned::Config::default() };
        let mut filter = Partitioned::new(config, motion.clone(), tree(), series.m0.clone()).expect("valid");
        let step = |frame: usize| {
            let stage = Stage::new(seed, "partitioned").round(run).at_frame(frame as u32);
            let info = filter.step(&observed(&series, frame, importance), stage).expect("weights");
            info.log_evidence.expect("a filter has one")
        };
        let log_evidence = (0..frames).map(step).sum();
        (log_evidence, filter.particles().clone())
    };
    let runs: Vec<_> = (0..size.pick(1000, 10_000)).map(run).collect();
    let motion = if coupled { "coupled" } else { "apart" };
    let bound = if frames == 1 { 4.5 } else { 4.0 };
    scores(&format!("partitioned filter, parts {motion}, {importance:?}, {frames} frames"), &series, &runs, bound, seed)
}

/// Negative control (A8): one frame from the verbs themselves, with weighted resampling and with the weights π / ρ left out. The largest |z| of the 13 scores, with and without.
///
/// # Panics
/// When all weights are zero, which would be a defect.
#[must_use]
pub fn without_correction(importance: Importance, size: Size, seed: u64) -> [f64; 2] {
    let (motion, series) = problem(true, 1);
    let seen = observed(&series, 0, importance);
    let frame = |run: usize, corrected: bool| {
        let [to_move, to_select] = Stage::new(seed, "corrected").round(run).split(["move", "select"]);
        let mut particles = Particles::new(&series.m0, 300).expect("not empty");
        let mut log_evidence = 0.0;
        for (k, part) in tree().partition().parts().iter().enumerate() {
            start_part(&mut particles, &motion, part, &series.m0, to_move.round(k));
            if k == 2 {
                break;
            }
            evaluate_part(&mut particles, &seen, k);
            let (values, stage) = (particles.values(), to_select.round(k));
            if corrected {
                let chosen = weighted_resample(&mut particles, &values, Scheme::Multinomial, stage);
                log_evidence += chosen.expect("weights").log_sum;
            } else {
                temper(&mut particles, 1.0).expect("weights");
                let ancestors = resample(&particles, Scheme::Multinomial, stage);
                take(&mut particles, ancestors);
            }
        }
        log_evidence += reweight(&mut particles, &seen).expect("weights");
        (log_evidence, particles)
    };
    [true, false].map(|corrected| {
        let runs: Vec<_> = (0..size.pick(1000, 10_000)).map(|run| frame(run, corrected)).collect();
        scores("verbs", &series, &runs, 4.5, seed).iter().map(|finding| finding.statistic.abs()).fold(0.0, f64::max)
    })
}

/// Weighted resampling is unbiased (R6): sums of π / ρ f over what weighted resampling leaves, for f = 1, x, x², an importance within a factor of 20 and every scheme. 12 scores at |z| < 4.5.
///
/// # Panics
/// Never: no weight is zero.
#[must_use]
pub fn represents_the_same(seed: u64, size: Size) -> Vec<Finding> {
    struct Slope(f64);
    impl LogDensity for Slope {
        fn dim(&self) -> usize {
            1
        }
        fn log_density(&self, x: &[f64]) -> f64 {
            (self.0 * x[0]).sin()
        }
    }
    let [to_draw, to_select] = Stage::new(seed, "R6").split(["draw", "select"]);
    let mut before = Particles::new(&[0.5], 31).expect("not empty");
    diffuse(&mut before, None, &[1.0], Isa::best(), to_draw);
    reweight(&mut before, &Slope(1.0)).expect("weights");
    evaluate(&mut before, &Slope(2.3));
    let log_importance: Vec<f64> = before.values().iter().map(|v| 0.5 * 20_f64.ln() * v).collect();
    let sum = |particles: &Particles, power: i32| -> f64 {
        (0..31).map(|i| particles.weights()[i] * particles.state(i)[0].powi(power)).sum()
    };
    let mut findings = vec![];
    for scheme in [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic] {
        let replicates: Vec<[f64; 3]> = (0..size.pick(20_000, 200_000))
            .map(|replicate| {
                let mut after = before.clone();
                let chosen = weighted_resample(&mut after, &log_importance, scheme, to_select.round(replicate));
                let total = chosen.expect("weights").log_sum.exp();
                [0, 1, 2].map(|power| total * sum(&after, power))
            })
            .collect();
        for power in 0..3 {
            let [mean, error] = mean_and_error(&replicates.iter().map(|r| r[power]).collect::<Vec<_>>());
            let exact = sum(&before, power as i32);
            let detail = format!("{mean:.5} ± {error:.5} for {exact:.5}, {} replicates, seed {seed}", replicates.len());
            let name = format!("weighted resampling, {scheme:?}: sum of π / ρ x^{power}");
            findings.push(Finding::score(name, (mean - exact) / error, 4.5, detail));
        }
    }
    findings
}

/// Growth with the number of parts (A9): particles needed for D = 50, as their number of parts grows, for parts of survival rate α: all at once they grow as α^(−d), part by part not at all. Slopes of log N over d, in units of −log α.
///
/// # Panics
/// When all weights are zero, which would be a defect.
#[must_use]
pub fn particles_needed(seed: u64, size: Size) -> Vec<Finding> {
    const DEVIATION: f64 = 0.3;
    // Prior N(0, 1) and posterior N(0, DEVIATION²): α = [∫ p'² / p]⁻¹.
    let alpha: f64 = DEVIATION * (2.0 - DEVIATION * DEVIATION).sqrt();
    let variance = 1.0 / (1.0 / (DEVIATION * DEVIATION) - 1.0);
    let (particles, runs, dims) = (20_000, size.pick(10, 100), 1..=5_usize);
    let mut needed = [vec![], vec![]];
    for d in dims.clone() {
        let unit: Vec<Vec<f64>> = (0..d).map(|i| (0..d).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        let parts: Vec<Part> = (0..d).map(|j| Part::new(vec![j], d).expect("valid")).collect();
        let motion = Motion { parts: parts.clone(), rows: unit.clone(), sd: vec![1.0; d] };
        let parents = (0..d).map(|k| k.checked_sub(1)).collect();
        let tree = PartTree::new(Partition::new(parts, d).expect("covers"), parents).expect("parents first");
        let r = unit.iter().map(|row| row.iter().map(|x| variance * x).collect()).collect();
        let [a, q] = motion.whole();
        let (p0, m0) = (q.clone(), vec![0.0; d]);
        let series =
            Series { dim: d, m0, p0, a, q, c: unit, r, z: vec![vec![0.0; d]], truth: vec![], stored: Value::Null };
        let seen = Seen {
            whole: series.sight(0),
            c: series.c.clone(),
            z: vec![0.0; d],
            r: vec![variance; d],
            importance: Importance::Product,
        };
        let (mut at_once, mut apart) = (0.0, vec![0.0; d]);
        for run in 0..runs {
            let stage = || Stage::new(seed, "A9").round(d).round(run);
            let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
            let mut plain = Bootstrap::new(config, motion.clone(), vec![0.0; d]).expect("valid");
            at_once += plain.step(&seen, stage()).expect("weights").ess / runs as f64;
            let config = partitioned::Config { particles, ..partitioned::Config::default() };
            let mut filter = Partitioned::new(config, motion.clone(), tree.clone(), vec![0.0; d]).expect("valid");
            filter.step(&seen, stage()).expect("weights");
            apart.iter_mut().zip(filter.survivors()).for_each(|(sum, survivors)| *sum += survivors / runs as f64);
        }
        let worst = apart.iter().copied().fold(f64::INFINITY, f64::min);
        needed[0].push(50.0 * particles as f64 / at_once);
        needed[1].push(50.0 * particles as f64 / worst);
    }
    let slope = |needed: &[f64]| {
        let n = needed.len() as f64;
        let centred: Vec<f64> = dims.clone().map(|d| d as f64 - 0.5 * (n + 1.0)).collect();
        let top: f64 = centred.iter().zip(needed).map(|(d, needed)| d * needed.ln()).sum();
        top / centred.iter().map(|d| d * d).sum::<f64>() / -alpha.ln()
    };
    let detail = |needed: &[f64]| format!("{needed:.0?} particles, α = {alpha:.3}, {runs} runs, seed {seed}");
    let [at_once, apart] = &needed;
    vec![
        Finding::between("slope of particles needed at once", slope(at_once), [0.9, 1.1], detail(at_once)),
        Finding::between("slope of particles needed part by part", slope(apart), [-0.1, 0.1], detail(apart)),
    ]
}
