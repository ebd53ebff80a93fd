//! Action primitives: learning, the density of their motion against sampling and quadrature, prediction.

use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES, get_lane};
use sinew_core::random::Stage;
use sinew_core::transition::{Cloud, FramePrior, GradTransition, Moments, MotionModel, Predict, Transition};
use sinew_dynamics::Error;
use sinew_dynamics::gaussian::Gaussian;
use sinew_dynamics::pca::Keep;
use sinew_dynamics::primitives::learning::{Config, TrainingMotion, learn};
use sinew_dynamics::primitives::model::{FeatureVector, PrimitiveModel};
use sinew_dynamics::primitives::motion::PrimitiveMotion;
use sinew_dynamics::primitives::summary::{prediction_errors, summary};
use sinew_dynamics::prior::Prior;
use sinew_dynamics::random_walk::{Between, RandomWalk};

const DT: f64 = 0.05;

fn feature(name: &str, coordinates: &[usize]) -> FeatureVector {
    FeatureVector { name: name.into(), coordinates: coordinates.to_vec() }
}

/// Sequences of `dim` coordinates: the first walks at random, the others swing at their own paces, with some noise.
fn swinging(dim: usize, frames: usize, noise: f64) -> Vec<Vec<f64>> {
    let sequence = |number: usize| {
        let mut z = vec![Block::ZERO; frames * dim];
        Stage::new(number as u64, "swinging").whole().fill_normal(Isa::baseline(), &mut z);
        let mut walked = 0.0;
        let mut value = |t: usize, j: usize| {
            let z = z[t * dim + j].0[0];
            if j == 0 && dim > 1 {
                walked += 0.05 * z;
                return walked;
            }
            ((0.31 + 0.02 * j as f64) * t as f64 + 1.7 * (j * number) as f64).sin() / (1.0 + j as f64) + noise * z
        };
        (0..frames * dim).map(|i| value(i / dim, i % dim)).collect()
    };
    (1..=2).map(sequence).collect()
}

fn learned(dim: usize, features: &[FeatureVector], clusters: usize, length: usize) -> PrimitiveModel {
    let sequences = swinging(dim, 160, 0.03);
    let motion = TrainingMotion { state: "swings", dim, frame_rate: 1.0 / DT, sequences: &sequences, horizontal: &[] };
    let mut config = Config { length, ..Config::default() };
    config.mixture.components = clusters;
    learn(&motion, features, &config, Stage::new(9, "learn"), &mut |_| {}).expect("valid")
}

/// Motion that has seen `length` frames of a swing.
fn following(model: &PrimitiveModel, isa: Isa) -> PrimitiveMotion {
    let mut motion = PrimitiveMotion::new(model, "swing", DT, isa).expect("valid");
    let frames = &swinging(model.dim, 60, 0.03)[0];
    let mut before = None;
    for estimate in frames.chunks_exact(model.dim).skip(40).take(model.length) {
        assert!(!motion.is_matching());
        motion.follow(before, estimate);
        before = Some(estimate);
    }
    assert!(motion.is_matching());
    motion
}

/// States near frame 40 + D of the same swing, eight of them.
fn states(dim: usize, spread: f64) -> Vec<Block> {
    let frames = &swinging(dim, 60, 0.03)[0];
    let mut z = vec![Block::ZERO; dim];
    Stage::new(4, "states").whole().fill_normal(Isa::baseline(), &mut z);
    (0..dim).map(|j| Block(z[j].0.map(|z| frames[43 * dim + j] + spread * z))).collect()
}

fn lane(block: &[Block], lane: usize) -> Vec<f64> {
    let mut state = vec![0.0; block.len()];
    get_lane(block, lane, &mut state);
    state
}

#[test]
fn learning_is_the_same_bytes_on_any_number_of_threads_and_shows_progress() {
    let sequences = swinging(3, 160, 0.03);
    let motion = TrainingMotion { state: "swings", dim: 3, frame_rate: 20.0, sequences: &sequences, horizontal: &[] };
    let mut config = Config::default();
    config.mixture.components = 12;
    let features = [feature("both", &[1, 2]), feature("one", &[2])];
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let mut reports = Vec::new();
            let model = learn(&motion, &features, &config, Stage::new(2, "threads"), &mut |report| {
                reports.push((report.index, report.iteration, report.feature.to_owned()));
                assert_eq!(report.count, 2);
            });
            (model.expect("valid"), reports)
        })
    };
    let (model, reports) = on(1);
    assert_eq!((&model, &reports), (&on(2).0, &on(3).1));
    let last = |index: usize| reports.iter().rfind(|report| report.0 == index).expect("reports");
    for (index, primitives) in model.primitives.iter().enumerate() {
        assert_eq!(last(index), &(index, primitives.clustering.iterations, primitives.feature.name.clone()));
    }
    assert!(reports.is_sorted());
}

#[test]
fn clusters_and_their_transitions_count_every_window() {
    let model = learned(4, &[feature("swing", &[3, 1])], 12, 3);
    let primitives = &model.primitives[0];
    assert_eq!(primitives.windows(), 2 * (160 - 3));
    assert!(primitives.clusters.iter().all(|cluster| cluster.members > 0));
    assert_eq!(primitives.transitions.iter().sum::<usize>(), primitives.windows() - 2);
    let count = primitives.clusters.len();
    for (k, cluster) in primitives.clusters.iter().enumerate() {
        let leaving: usize = primitives.transitions[k * count..][..count].iter().sum();
        assert!((cluster.members - 2..=cluster.members).contains(&leaving));
    }
    assert_eq!(primitives.mean_window(0).len(), 4 * 2);
    assert_eq!(primitives.mean_window(0)[6..], primitives.clusters[0].next.mean);
    let text = summary(primitives, &swinging(4, 50, 0.0), 4).expect("valid").to_string();
    assert!(text.starts_with("swing: 2 coordinates, 314 windows, ") && text.contains("94 held-out steps"), "{text}");
}

/// In every cluster the mean step leads from the last feature vector of the mean action primitive to the mean of the next, where all principal components are kept.
#[test]
fn steps_lead_from_the_last_feature_vector_to_the_next() {
    let sequences = swinging(4, 160, 0.03);
    let motion = TrainingMotion { state: "swings", dim: 4, frame_rate: 20.0, sequences: &sequences, horizontal: &[] };
    let mut config = Config { keep: Keep { share: 1.0, most: 6 }, ..Config::default() };
    config.mixture.components = 8;
    let model = learn(&motion, &[feature("swing", &[3, 1])], &config, Stage::new(9, "steps"), &mut |_| {});
    let primitives = &model.expect("valid").primitives[0];
    let mut longest = 0.0_f64;
    for (k, cluster) in primitives.clusters.iter().enumerate() {
        let window = primitives.mean_window(k);
        for (j, step) in cluster.step.mean.iter().enumerate() {
            assert!((window[4 + j] + step - window[6 + j]).abs() < 1e-9, "cluster {k}: {step} in {window:?}");
            longest = longest.max(step.abs());
        }
    }
    assert!(longest > 0.05, "{longest}");
}

/// A ramp of slope 2 is what constant velocity predicts, and no change misses by 2.
#[test]
fn simple_predictions_miss_what_they_should() {
    let model = learned(2, &[feature("swing", &[1])], 5, 3);
    let ramp: Vec<f64> = (0..20).flat_map(|t| [7.0, 2.0 * f64::from(t)]).collect();
    let errors = prediction_errors(&model.primitives[0], &[ramp], 2).expect("valid").expect("long enough");
    assert!((errors.no_change - 2.0).abs() < 1e-12 && errors.constant_velocity.expect("three values") < 1e-12);
    assert_eq!(prediction_errors(&model.primitives[0], &[vec![0.0; 6]], 2), Ok(None));
    let short = learned(2, &[feature("swing", &[1])], 5, 1);
    let errors = prediction_errors(&short.primitives[0], &[vec![0.0; 6]], 2).expect("valid").expect("long enough");
    assert_eq!((errors.constant_velocity, errors.no_change), (None, 0.0));
}

#[test]
fn until_there_are_enough_estimates_the_state_walks_at_random() {
    let model = learned(4, &[feature("swing", &[3, 1])], 12, 3);
    let mut motion = PrimitiveMotion::new(&model, "swing", DT, Isa::best()).expect("valid");
    let walk = RandomWalk::new(&model.noise_sd, 1.0, Between::Mixture, Isa::best()).expect("valid");
    let (from, to) = ([0.1, 0.2, 0.3, 0.4], [0.15, 0.1, 0.32, 0.5]);
    for seen in 0..3 {
        assert_eq!(motion.is_matching(), seen > 2);
        let (mut a, mut b) = ([0.0; 4], [0.0; 4]);
        let exact = walk.log_density_grad(&from, &to, &mut a);
        assert!((motion.log_density(&from, &to) - exact).abs() < 1e-12);
        assert!((motion.log_density_grad(&from, &to, &mut b) - exact).abs() < 1e-12);
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12 * a.abs()));
        motion.follow(None, &from);
    }
    assert!((motion.log_density(&from, &to) - walk.log_density(&from, &to)).abs() > 1e-3);
}

/// The density of a step is the sum of three that are written out with another Gaussian, times the random walk of the others.
#[test]
fn the_density_of_a_step_sums_the_three_models() {
    let model = learned(5, &[feature("swing", &[3, 1, 4])], 10, 3);
    let (motion, block) = (following(&model, Isa::best()), states(5, 0.1));
    let covered = [3, 1, 4];
    let clusters = &model.primitives[0].clusters;
    let mut seen = std::collections::BTreeSet::new();
    for round in 0..LANES {
        let previous = lane(&block, round);
        let next = lane(&states(5, 0.3), (round + 3) % LANES);
        let choices = motion.sample_with_choices(
            &previous.iter().map(|&x| Block::splat(x)).collect::<Vec<_>>(),
            &mut [Block::ZERO; 5],
            &mut Stage::new(1, "choices").whole(),
        );
        let cluster = &clusters[choices.expect("is matching")[0].cluster];
        seen.insert(choices.expect("is matching")[0].cluster);
        let a: Vec<f64> = covered.iter().map(|&j| next[j]).collect();
        let normal = |mean: Vec<f64>, covariance: &[f64]| {
            let leaf = Gaussian::new(mean, covariance).expect("valid");
            sinew_core::density::Lanes { leaf, isa: Isa::baseline() }.log_density(&a)
        };
        let moved = cluster.step.mean.iter().zip(covered).map(|(step, j)| previous[j] + step).collect();
        let diagonal = |j: usize| model.noise_sd[covered[j]].powi(2);
        let walked: Vec<f64> = (0..9).map(|k| if k % 4 == 0 { diagonal(k / 3) } else { 0.0 }).collect();
        let branches = [
            normal(cluster.next.mean.clone(), &cluster.next.covariance),
            normal(moved, &cluster.step.covariance),
            normal(covered.iter().map(|&j| previous[j]).collect(), &walked),
        ];
        let rest: f64 = [0, 2]
            .map(|j: usize| {
                let sd = model.noise_sd[j];
                -0.5 * ((next[j] - previous[j]) / sd).powi(2) - (std::f64::consts::TAU.sqrt() * sd).ln()
            })
            .iter()
            .sum();
        let exact = rest + (branches.iter().map(|branch| branch.exp()).sum::<f64>() / 3.0).ln();
        let found = motion.log_density(&previous, &next);
        assert!((found - exact).abs() < 1e-9 * exact.abs().max(1.0), "{found} for {exact}");
    }
    assert!(seen.len() > 1, "all states are in cluster {seen:?}");
}

/// Prior of a cloud of eight states, `count` of them counted.
fn prior(motion: &PrimitiveMotion, last: &[Block], count: usize) -> Prior {
    let d = motion.dim();
    let moments = Moments { mean: vec![0.0; d], covariance: vec![0.0; d * d] };
    motion.predict(Cloud { last, count, moments: &moments }).expect("valid")
}

/// The prior of a frame is the mean of the steps from the cloud's states; its gradient and the step's agree with central differences; blocks and instruction sets agree.
#[test]
fn priors_are_means_of_steps_and_gradients_match_differences() {
    let model = learned(5, &[feature("swing", &[3, 1, 4])], 10, 3);
    let last = states(5, 0.1);
    for isa in Isa::available() {
        let motion = following(&model, isa);
        let prior = prior(&motion, &last, 7);
        for scale in [0.05, 0.3, 2.0] {
            let points = states(5, scale);
            let mut ws = vec![Block::ZERO; prior.workspace()];
            let mut grads = vec![Block::splat(f64::NAN); 5];
            let values = prior.log_density_grad_block(&points, &mut grads, &mut ws);
            assert_eq!(prior.log_density_block(&points, &mut ws), values);
            for number in 0..LANES {
                let x = lane(&points, number);
                let steps: Vec<f64> = (0..7).map(|i| motion.log_density(&lane(&last, i), &x)).collect();
                let most = steps.iter().copied().fold(f64::MIN, f64::max);
                let exact = most + (steps.iter().map(|step| (step - most).exp()).sum::<f64>() / 7.0).ln();
                let bound = 1e-11 * exact.abs().max(1.0);
                assert!((prior.log_density(&x) - exact).abs() < bound && (values.0[number] - exact).abs() < bound);
                let (mut grad, mut own) = (vec![f64::NAN; 5], vec![f64::NAN; 5]);
                prior.log_density_grad(&x, &mut grad);
                let from = lane(&last, 0);
                motion.log_density_grad(&from, &x, &mut own);
                let size = grad.iter().chain(&own).fold(1.0_f64, |a, g| a.max(g.abs()));
                for j in 0..5 {
                    let difference = |density: &dyn Fn(&[f64]) -> f64| {
                        let at = |h: f64| {
                            let mut x = x.clone();
                            x[j] += h;
                            density(&x)
                        };
                        (at(1e-6) - at(-1e-6)) / 2e-6
                    };
                    let numeric = difference(&|x| prior.log_density(x));
                    assert!((numeric - grad[j]).abs() < 1e-6 * size, "{j}: {numeric} against {}", grad[j]);
                    assert!((grads[j].0[number] - grad[j]).abs() < 1e-9 * size);
                    let numeric = difference(&|x| motion.log_density(&from, x));
                    assert!((numeric - own[j]).abs() < 1e-6 * size, "step, {j}: {numeric} against {}", own[j]);
                }
            }
        }
    }
}

/// In every direction the curvature of −log p is at most that of the bound, here at 24 states in 40 directions each.
#[test]
fn no_curvature_exceeds_the_bound() {
    let model = learned(5, &[feature("swing", &[3, 1, 4])], 10, 3);
    let motion = following(&model, Isa::best());
    let (last, all) = (states(5, 0.1), 8);
    let prior = prior(&motion, &last, all);
    let bound = prior.precision_diagonal().to_vec();
    let moments = Moments { mean: vec![0.0; 5], covariance: vec![0.0; 25] };
    let gaussian = motion.clone().with_between(Between::Gaussian);
    let gaussian = gaussian.predict(Cloud { last: &last, count: all, moments: &moments }).expect("valid");
    assert_eq!(prior.precision(), gaussian.precision(), "the metric is of the Gaussian with the same moments");
    let mut largest = 0.0_f64;
    for scale in [0.01, 0.1, 0.5] {
        let points = states(5, scale);
        for number in 0..LANES {
            let x = lane(&points, number);
            for direction in 0..40 {
                let v: Vec<f64> = (0..5).map(|j| ((direction * 5 + j) as f64 * 2.39).sin() / bound[j].sqrt()).collect();
                let slope = |h: f64| {
                    let moved: Vec<f64> = x.iter().zip(&v).map(|(x, v)| x + h * v).collect();
                    let mut grad = vec![0.0; 5];
                    prior.log_density_grad(&moved, &mut grad);
                    grad.iter().zip(&v).map(|(g, v)| g * v).sum::<f64>()
                };
                let curvature = -(slope(1e-5) - slope(-1e-5)) / 2e-5;
                let most: f64 = v.iter().zip(&bound).map(|(v, b)| v * v * b).sum();
                assert!(curvature <= most * (1.0 + 1e-6), "{curvature} above {most}");
                largest = largest.max(curvature / most);
            }
        }
    }
    assert!(largest > 0.1, "the bound is ten times too large: {largest}");
}

/// The distribution function of a density of one coordinate by Simpson's rule on 8001 points of (−4, 4).
fn distribution(log_density: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let (n, h) = (4000, 0.002);
    let p = |i: usize| log_density(-4.0 + h * 0.5 * i as f64).exp();
    let mut sum = 0.0;
    let mut out = vec![(-4.0, 0.0)];
    for i in 0..n {
        sum += h / 6.0 * (p(2 * i) + 4.0 * p(2 * i + 1) + p(2 * i + 2));
        out.push((-4.0 + h * (i + 1) as f64, sum));
    }
    out
}

/// Kolmogorov's distance of draws from a distribution function.
fn distance(mut draws: Vec<f64>, exact: &[(f64, f64)]) -> f64 {
    draws.sort_by(f64::total_cmp);
    let n = draws.len() as f64;
    let share = |x: f64| draws.partition_point(|draw| *draw <= x) as f64 / n;
    exact.iter().map(|(x, below)| (share(*x) - below).abs()).fold(0.0, f64::max)
}

/// One coordinate: the density of a step and of a prior have mass 1 by quadrature, and 40 000 draws follow them (Kolmogorov's distance, exceeded once in a million times; seed 3).
#[test]
fn draws_follow_the_density_by_quadrature() {
    let model = learned(1, &[feature("swing", &[0])], 8, 3);
    let motion = following(&model, Isa::best());
    let last = states(1, 0.2);
    let bound = 2.7 / f64::sqrt(40_000.0);
    let mut rng = Stage::new(3, "quadrature").whole();
    for number in [0, 3] {
        let from = lane(&last, number);
        let exact = distribution(|x| motion.log_density(&from, &[x]));
        assert!((exact.last().expect("points").1 - 1.0).abs() < 1e-9, "{:?}", exact.last());
        let mut draws = Vec::new();
        let mut next = [Block::ZERO];
        for _ in 0..5000 {
            motion.sample_block(&[Block::splat(from[0])], &mut next, &mut rng);
            draws.extend(next[0].0);
        }
        let found = distance(draws, &exact);
        assert!(found < bound, "step: distance {found}, bound {bound}, seed 3");
    }
    let prior = prior(&motion, &last, 5);
    let exact = distribution(|x| prior.log_density(&[x]));
    assert!((exact.last().expect("points").1 - 1.0).abs() < 1e-9);
    let (mut draws, mut next) = (Vec::new(), [Block::ZERO]);
    for block in 0..5000 {
        prior.sample_block(block, &mut next, &mut rng);
        draws.extend(next[0].0);
    }
    let found = distance(draws, &exact);
    assert!(found < bound, "prior: distance {found}, bound {bound}, seed 3");
}

/// Mean and second moments of 80 000 steps of a whole state against the moments of the three models: 5 + 15 statistics at |z| < 4.5, the standard errors from the draws, seed 6.
#[test]
fn steps_of_a_whole_state_have_the_moments_of_the_three_models() {
    let model = learned(5, &[feature("swing", &[3, 1, 4])], 10, 3);
    let motion = following(&model, Isa::best());
    let previous = lane(&states(5, 0.1), 0);
    let block: Vec<Block> = previous.iter().map(|&x| Block::splat(x)).collect();
    let (mut rng, mut next) = (Stage::new(6, "moments").whole(), vec![Block::ZERO; 5]);
    let mut cluster = 0;
    let mut sums = vec![[0.0; 2]; 30];
    let n = 80_000.0;
    for _ in 0..10_000 {
        cluster = motion.sample_with_choices(&block, &mut next, &mut rng).expect("is matching")[0].cluster;
        for number in 0..LANES {
            let e: Vec<f64> = (0..5).map(|j| next[j].0[number] - previous[j]).collect();
            for (k, sums) in sums.iter_mut().enumerate() {
                let value = if k < 5 { e[k] } else { e[(k - 5) / 5] * e[(k - 5) % 5] };
                sums[0] += value / n;
                sums[1] += value * value / n;
            }
        }
    }
    let cluster = &model.primitives[0].clusters[cluster];
    let place = |j: usize| [3, 1, 4].iter().position(|&c| c == j);
    let means = |branch: usize, j: usize| match (branch, place(j)) {
        (0, Some(a)) => cluster.next.mean[a] - previous[j],
        (1, Some(a)) => cluster.step.mean[a],
        _ => 0.0,
    };
    let covariance = |branch: usize, i: usize, j: usize| match (branch, place(i), place(j)) {
        (0, Some(a), Some(b)) => cluster.next.covariance[3 * a + b],
        (1, Some(a), Some(b)) => cluster.step.covariance[3 * a + b],
        _ if i == j => model.noise_sd[i].powi(2),
        _ => 0.0,
    };
    for (k, [mean, square]) in sums.into_iter().enumerate() {
        let exact = |branch: usize| match k.checked_sub(5) {
            None => means(branch, k),
            Some(k) => means(branch, k / 5) * means(branch, k % 5) + covariance(branch, k / 5, k % 5),
        };
        let z = (mean - (0..3).map(exact).sum::<f64>() / 3.0) / ((square - mean * mean) / n).sqrt();
        assert!(z.abs() < 4.5, "moment {k}: z = {z}, bound 4.5, seed 6");
    }
}

/// The law `memory_resumes`.
#[test]
fn memory_resumes() {
    let model = learned(4, &[feature("swing", &[3, 1])], 12, 3);
    let frames = &swinging(4, 60, 0.03)[1];
    let mut motion = PrimitiveMotion::new(&model, "swing", DT, Isa::best()).expect("valid");
    let length = motion.memory().len();
    let from = states(4, 0.1);
    for estimate in frames.chunks_exact(4).take(9) {
        let mut other = PrimitiveMotion::new(&model, "swing", DT, Isa::best()).expect("valid");
        assert_eq!(motion.memory().len(), length);
        other.recall(&motion.memory());
        let step = |motion: &PrimitiveMotion| {
            let mut next = vec![Block::ZERO; 4];
            motion.sample_block(&from, &mut next, &mut Stage::new(1, "resume").whole());
            next
        };
        assert_eq!((step(&motion), motion.memory()), (step(&other), other.memory()));
        motion.follow(None, estimate);
    }
}

#[test]
fn the_first_frame_is_as_wide_as_stated() {
    let model = learned(4, &[feature("swing", &[3, 1])], 12, 3);
    let motion = following(&model, Isa::best()).with_initial_sd(vec![1.0, 2.0, 3.0, 4.0]).expect("valid");
    let walk = RandomWalk::new(&[1.0, 2.0, 3.0, 4.0], 1.0, Between::Mixture, Isa::best()).expect("valid");
    let (centre, x) = ([0.5; 4], [1.0, -1.0, 0.0, 2.0]);
    let [a, b] = [motion.initial(&centre), walk.initial(&centre)].map(|p| p.expect("valid").log_density(&x));
    assert_eq!(a, b);
    let (mut a, mut b) = ([Block::ZERO; 4], [Block::ZERO; 4]);
    motion.sample_initial_block(&centre, &mut a, &mut Stage::new(1, "first").whole());
    walk.sample_initial_block(&centre, &mut b, &mut Stage::new(1, "first").whole());
    assert!(a.iter().zip(b).all(|(a, b)| a.0.iter().zip(b.0).all(|(a, b)| (a - b).abs() < 1e-14)));
}

#[test]
fn extreme_states_have_no_density_and_never_a_value_that_is_none() {
    let model = learned(4, &[feature("swing", &[3, 1])], 12, 3);
    let motion = following(&model, Isa::best());
    let from = lane(&states(4, 0.1), 2);
    for place in 0..4 {
        let mut x = from.clone();
        x[place] = 1e200;
        assert_eq!(motion.log_density(&from, &x), f64::NEG_INFINITY, "{place}");
        x[place] = 1e6;
        let value = motion.log_density(&from, &x);
        assert!(value.is_finite() && value < -1e6);
    }
    let mut far = from.clone();
    far[3] = f64::NAN;
    assert_eq!(motion.log_density(&far, &from), f64::NEG_INFINITY);
}

#[test]
fn features_and_rates_that_do_not_fit_are_refused() {
    let model = learned(4, &[feature("swing", &[3, 1])], 5, 3);
    let new = |name: &str, dt: f64| PrimitiveMotion::new(&model, name, dt, Isa::best()).map(|_| ());
    let error = new("limb", DT).expect_err("there is none");
    assert_eq!(error.to_string(), "no feature vector is called \"limb\"; there are: swing");
    for dt in [1.0 / 30.0, 0.0, f64::NAN] {
        assert!(matches!(new("swing", dt), Err(Error::OutOfRange { name: "time step", .. })));
    }
    let motion = PrimitiveMotion::new(&model, "swing", 0.0502, Isa::best()).expect("within a percent");
    assert!(motion.clone().with_initial_sd(vec![1.0; 3]).is_err() && motion.with_initial_sd(vec![0.0; 4]).is_err());
    let sequences = swinging(2, 30, 0.03);
    let learn_from = |sequences: &[Vec<f64>], features: &[FeatureVector], length: usize, rate: f64| {
        let motion = TrainingMotion { state: "bad", dim: 2, frame_rate: rate, sequences, horizontal: &[] };
        let mut config = Config { length, ..Config::default() };
        config.mixture.components = 2;
        learn(&motion, features, &config, Stage::new(1, "bad"), &mut |_| {})
    };
    let one = [feature("a", &[1])];
    assert!(learn_from(&sequences, &one, 3, 20.0).is_ok());
    assert!(matches!(learn_from(&sequences, &[feature("a", &[1, 1])], 3, 20.0), Err(Error::Part(_))));
    assert!(matches!(learn_from(&sequences, &[feature("a", &[2])], 3, 20.0), Err(Error::Part(_))));
    let twice = [feature("a", &[0]), feature("a", &[1])];
    assert_eq!(learn_from(&sequences, &twice, 3, 20.0), Err(Error::Duplicate { name: "a".into() }));
    assert!(learn_from(&sequences, &one, 0, 20.0).is_err() && learn_from(&sequences, &one, 30, 20.0).is_err());
    assert!(learn_from(&sequences, &one, 3, 0.0).is_err() && learn_from(&[], &one, 3, 20.0).is_err());
    assert!(learn_from(&[vec![1.0; 60]], &one, 3, 20.0).is_err(), "nothing moves");
}
