//! Laws of weights, resampling and the integrator, for every input that the types let in.

use proptest::prelude::*;
use sinew_core::density::PartLogDensity;
use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::part::{Part, PartTree, Partition};
use sinew_core::random::Stage;
use sinew_samplers::Error;
use sinew_samplers::crossover::cross;
use sinew_samplers::diffusion::{diffuse, spread};
use sinew_samplers::grid::GridAxis;
use sinew_samplers::hmc::Hmc;
use sinew_samplers::integrator::PhasePoint;
use sinew_samplers::particles::{Particles, evaluate, resample, reweight, select, temper};
use sinew_samplers::parts::{choose, choose_chained, choose_whole, evaluate_part, log_likelihoods};
use sinew_samplers::quantised::{evaluate_distinct, walk};
use sinew_samplers::resample::{Scheme, keep_once_refill, shuffle, truncate_then_systematic};
use sinew_samplers::weighted_resampling::weighted_resample;
use sinew_samplers::weights::{effective_number, normalise};

/// Weights with zeros, denormals and one that is nearly all.
fn weights() -> impl Strategy<Value = Vec<f64>> {
    let weight = prop_oneof![
        4 => 0.0..1.0f64,
        1 => Just(0.0),
        1 => Just(-0.0),
        1 => Just(5e-324),
        1 => Just(1e-300),
        1 => Just(1.0 - 1e-16),
        1 => Just(1e300),
    ];
    prop::collection::vec(weight, 1..60).prop_filter("not all zero", |w| w.iter().any(|w| *w > 0.0))
}

fn log_weight() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -1e5..1e4f64,
        1 => Just(f64::NEG_INFINITY),
        1 => Just(-0.0),
        1 => Just(-1e308),
    ]
}

/// −½ |x|² − a |x|⁴ on any dimension: smooth, not quadratic.
struct Quartic(usize, f64);
impl LogDensity for Quartic {
    fn dim(&self) -> usize {
        self.0
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        let square: f64 = x.iter().map(|x| x * x).sum();
        -0.5 * square - self.1 * square * square
    }
}
impl GradLogDensity for Quartic {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let square: f64 = x.iter().map(|x| x * x).sum();
        for (g, x) in grad.iter_mut().zip(x) {
            *g = -x - 4.0 * self.1 * square * x;
        }
        self.log_density(x)
    }
}

/// −½ Σ (x_j − j)², of which each coordinate is a part; the first is no longer known below −2.
struct Ladder(usize);
impl LogDensity for Ladder {
    fn dim(&self) -> usize {
        self.0
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        x.iter().enumerate().map(|(j, x)| rung(j, *x)).sum()
    }
}
impl PartLogDensity for Ladder {
    fn parts(&self) -> usize {
        self.0
    }
    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        for (&k, out) in parts.iter().zip(out) {
            *out = Block(x[k].0.map(|x| rung(k, x)));
        }
    }
}
fn rung(j: usize, x: f64) -> f64 {
    if j == 0 && x < -2.0 { f64::NEG_INFINITY } else { -0.5 * (x - j as f64).powi(2) }
}

/// Particles in some places with some weights.
fn cloud(dim: usize, count: usize, seed: u64) -> Particles {
    let mut particles = Particles::new(&vec![0.3; dim], count).expect("not empty");
    diffuse(&mut particles, None, &vec![0.5; dim], Isa::best(), Stage::new(seed, "cloud"));
    reweight(&mut particles, &Ladder(dim)).expect("within reach");
    particles
}

fn chain(dim: usize) -> PartTree {
    let parts = (0..dim).map(|j| Part::new(vec![j], dim).expect("valid")).collect();
    let parents = (0..dim).map(|j: usize| j.checked_sub(1)).collect();
    PartTree::new(Partition::new(parts, dim).expect("covers"), parents).expect("parents first")
}

proptest! {
    /// Every new state is an old one; its weight, times its importance, is the old weight, but for one factor.
    #[test]
    fn weighted_resampling_keeps_weight_over_importance(
        dim in 1..4usize, count in 1..60usize, slope in -3.0..3.0f64, seed: u64,
        scheme in prop::sample::select(vec![Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic]),
    ) {
        let before = cloud(dim, count, seed);
        let log_importance: Vec<f64> = (0..count).map(|i| slope * before.state(i)[0]).collect();
        let mut after = before.clone();
        let chosen = weighted_resample(&mut after, &log_importance, scheme, Stage::new(seed, "weighted")).expect("weights");
        prop_assert!((after.weights().iter().sum::<f64>() - 1.0).abs() < 1e-12);
        prop_assert!(chosen.survivors >= 1.0 - 1e-9 && chosen.survivors <= count as f64 * (1.0 + 1e-9));
        let mut total = vec![];
        let log_total = normalise(&log_importance, &mut total).expect("finite");
        for i in 0..count {
            let a = after.ancestor(i);
            prop_assert_eq!(after.state(i), before.state(a));
            let expected = before.log_weights()[a] - (log_importance[a] - log_total) - (count as f64).ln();
            prop_assert!((after.log_weights()[i] + chosen.log_sum - expected).abs() < 1e-10);
        }
        let mut refused = before.clone();
        let none = vec![f64::NEG_INFINITY; count];
        prop_assert!(weighted_resample(&mut refused, &none, scheme, Stage::new(seed, "weighted")).is_err());
        prop_assert!(select(&mut refused, (0..count).collect(), &none).is_err());
        prop_assert_eq!((refused.states(), refused.weights()), (before.states(), before.weights()));
    }

    /// Tempering by two exponents one after the other is tempering by their sum, and what has no likelihood has no weight, with any exponent.
    #[test]
    fn exponents_add(count in 1..60usize, a in 0.0..2.0f64, b in 0.0..2.0f64, seed: u64) {
        let before = cloud(2, count, seed);
        let mut once = before.clone();
        evaluate(&mut once, &Ladder(2));
        let mut twice = once.clone();
        let sums = [temper(&mut twice, a), temper(&mut twice, b)].map(|sum| sum.expect("weights"));
        let sum = temper(&mut once, a + b).expect("weights");
        prop_assert!((sums[0] + sums[1] - sum).abs() < 1e-10);
        for i in 0..count {
            prop_assert!((once.weights()[i] - twice.weights()[i]).abs() < 1e-12);
            prop_assert!(once.state(i)[0] >= -2.0 || once.weights()[i] == 0.0);
        }
    }

    #[test]
    fn crossed_coordinates_come_from_the_set_in_their_places(
        dim in 1..6usize, count in 1..40usize, probability in 0.0..=1.0f64, seed: u64,
    ) {
        let before = cloud(dim, count, seed);
        let ancestors = resample(&before, Scheme::Multinomial, Stage::new(seed, "ancestors"));
        let mut after = before.clone();
        cross(&mut after, ancestors.clone(), probability, Stage::new(seed, "cross"));
        for (i, &ancestor) in ancestors.iter().enumerate() {
            let (child, parent) = (after.state(i), before.state(ancestor));
            let same = (0..count).any(|b| (0..dim).all(|j| [parent[j], before.state(b)[j]].contains(&child[j])));
            prop_assert!(same, "two parents at most");
            prop_assert!(probability > 0.0 || child == parent);
        }
        let mut order: Vec<usize> = (0..count).collect();
        shuffle(&mut order, &mut Stage::new(seed, "shuffle").whole());
        order.sort_unstable();
        prop_assert!(order.into_iter().eq(0..count));
    }

    #[test]
    fn a_spread_is_zero_of_one_and_never_larger_than_the_range(dim in 1..4usize, count in 1..40usize, seed: u64) {
        let particles = cloud(dim, count, seed);
        prop_assert!(spread(&particles, &[count - 1; 5]).iter().all(|sd| *sd < 1e-12));
        let all: Vec<usize> = (0..count).collect();
        for (j, sd) in spread(&particles, &all).into_iter().enumerate() {
            let values = || (0..count).map(|i| particles.state(i)[j]);
            let range = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
            prop_assert!(sd <= 0.5 * range + 1e-12);
        }
    }

    /// Choice of parts (coarse to fine, A12): each chosen part is the largest of its column; of parts that do not see each other the chain and the whole choose the same.
    #[test]
    fn chosen_parts_are_the_largest(dim in 1..5usize, count in 1..50usize, seed: u64) {
        let mut particles = cloud(dim, count, seed);
        let values = log_likelihoods(&particles, &Ladder(dim), &(0..dim).collect::<Vec<_>>());
        let state = choose(&particles, &Ladder(dim), &chain(dim)).expect("explained");
        for (j, column) in values.iter().enumerate() {
            let largest = column.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            prop_assert_eq!(rung(j, state[j]), largest);
            prop_assert!((0..count).any(|i| particles.state(i)[j] == state[j]));
            evaluate_part(&mut particles, &Ladder(dim), j);
            prop_assert_eq!(&particles.values(), column);
        }
        let whole = choose_whole(&particles, &Ladder(dim), &chain(dim), &vec![0.0; dim]).expect("explained");
        for (j, x) in whole.iter().enumerate() {
            prop_assert_eq!(rung(j, *x), rung(j, state[j]));
        }
        prop_assert_eq!(choose_chained(&particles, &Ladder(dim), &chain(dim)).expect("explained"), state);
    }

    #[test]
    fn walks_on_a_grid_end_on_centres(
        count in 1..50usize, width in 0.01..3.0f64, wraps: bool, drift in -9.0..9.0f64, seed: u64,
    ) {
        let axis = GridAxis::new(-2.0, 1.5, width, wraps).expect("valid");
        let mut particles = cloud(1, count, seed);
        walk(&mut particles, vec![0; count], &[drift], &[axis], true, Isa::best(), Stage::new(seed, "walk"));
        let centres: Vec<f64> = (0..axis.count()).map(|i| axis.centre(i)).collect();
        prop_assert!((0..count).all(|i| centres.contains(&particles.state(i)[0])));
        let evaluations = evaluate_distinct(&mut particles, &Ladder(1));
        prop_assert!(evaluations <= count.min(axis.count()));
        prop_assert!((0..count).all(|i| particles.values()[i] == rung(0, particles.state(i)[0])));
        let turn = axis.difference(1.2 + drift, 1.2);
        prop_assert!(!wraps || turn.abs() <= 1.75);
        prop_assert!(((turn - drift) / 3.5 - ((turn - drift) / 3.5).round()).abs() < 1e-9 && (wraps || turn == 1.2 + drift - 1.2));
    }

    #[test]
    fn ancestors_are_n_in_range_sorted_and_of_positive_weight(w in weights(), n in 0..200usize, seed: u64) {
        for scheme in [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic] {
            let ancestors = scheme.ancestors(&w, n, &mut Stage::new(seed, "property").whole());
            prop_assert_eq!(ancestors.len(), n);
            prop_assert!(ancestors.is_sorted());
            prop_assert!(ancestors.iter().all(|&a| w[a] > 0.0), "{:?}", scheme);
            let total: f64 = w.iter().sum();
            for (i, w) in w.iter().enumerate() {
                let (count, expected) = (ancestors.iter().filter(|&&a| a == i).count() as f64, w / total * n as f64);
                if scheme == Scheme::Systematic {
                    prop_assert!(count >= (expected - 1e-9).floor() && count <= (expected + 1e-9).ceil());
                }
                if scheme == Scheme::Residual {
                    prop_assert!(count >= (expected - 1e-9).floor());
                }
            }
        }
    }

    #[test]
    fn keep_once_refill_fills_every_slot_from_survivors(w in weights(), surviving in 0.0..=1.0f64, seed: u64) {
        let ancestors = keep_once_refill(&w, surviving, &mut Stage::new(seed, "property").whole());
        prop_assert_eq!(ancestors.len(), w.len());
        let least = ancestors.iter().map(|&a| w[a]).fold(f64::INFINITY, f64::min);
        let dropped = (0..w.len()).filter(|i| !ancestors.contains(i));
        prop_assert!(dropped.map(|i| w[i]).all(|w| w <= least));
    }

    #[test]
    fn truncation_leaves_offspring_to_the_same_states_in_both_readings(w in weights(), surviving in 0.0..=1.0f64, seed: u64) {
        let drawn = truncate_then_systematic(&w, surviving, &mut Stage::new(seed, "property").whole());
        prop_assert_eq!(drawn.len(), w.len());
        let kept = keep_once_refill(&w, surviving, &mut Stage::new(seed, "property").whole());
        prop_assert!(drawn.iter().all(|a| kept[*a] == *a && w[*a] > 0.0));
    }

    #[test]
    fn normalised_weights_sum_to_one_or_there_is_an_error(l in prop::collection::vec(log_weight(), 0..50)) {
        let mut w = vec![];
        match normalise(&l, &mut w) {
            Ok(log_sum) => {
                prop_assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-12 && log_sum.is_finite());
                prop_assert!(w.iter().all(|w| (0.0..=1.0).contains(w)));
                let ess = effective_number(&w);
                prop_assert!(ess >= 1.0 - 1e-12 && ess <= l.len() as f64 * (1.0 + 1e-12));
            }
            Err(e) => {
                prop_assert!(l.iter().all(|l| *l == f64::NEG_INFINITY));
                prop_assert_eq!(e, Error::AllWeightsZero { count: l.len() });
            }
        }
    }

    #[test]
    fn nan_lands_on_the_error_side(l in prop::collection::vec(log_weight(), 0..20), at in 0..20usize) {
        let mut l = l;
        l.insert(at.min(l.len()), f64::NAN);
        let is_bad = matches!(normalise(&l, &mut vec![]), Err(Error::BadWeight { .. }));
        prop_assert!(is_bad);
    }

    #[test]
    fn leapfrog_reverses(
        dim in 1..8usize, eta in 0.01..0.15f64, steps in 1..40usize, a in 0.0..0.05f64, seed: u64,
    ) {
        let target = Quartic(dim, a);
        let mut numbers = vec![Block::ZERO; 2 * dim];
        Stage::new(seed, "reverse").whole().fill_normal(Isa::best(), &mut numbers);
        let (x0, p0) = numbers.split_at(dim);
        let (mut x, mut p, mut g) = (x0.to_vec(), p0.to_vec(), vec![Block::ZERO; dim]);
        let hmc = Hmc::new(eta, &vec![1.0; dim], steps, 0.0, Isa::best()).expect("valid");
        let factor = Block([1.0, 0.8, 1.2, 0.9, 1.1, 1.0, 0.95, 1.05]);
        for _ in 0..2 {
            target.log_density_grad_block(&x, &mut g, &mut []);
            let point = PhasePoint { position: &mut x, momentum: &mut p, gradient: &mut g };
            hmc.trajectory(&target, &factor, point, &mut []);
            p.iter_mut().flat_map(|b| &mut b.0).for_each(|p| *p = -*p);
        }
        for j in 0..dim {
            for lane in 0..LANES {
                prop_assert!((x[j].0[lane] - x0[j].0[lane]).abs() < 1e-9);
                prop_assert!((p[j].0[lane] - p0[j].0[lane]).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn settings_are_taken_or_refused_without_panic(eta: f64, h: f64, steps in 0..3usize, jitter: f64) {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let valid = positive(eta) && positive(h) && steps > 0 && (0.0..1.0).contains(&jitter);
        prop_assert_eq!(Hmc::new(eta, &[h], steps, jitter, Isa::best()).is_ok(), valid);
    }
}
