//! Laws of weights, resampling and the integrator, for every input that the types let in.

use proptest::prelude::*;
use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_samplers::Error;
use sinew_samplers::hmc::{Hmc, leapfrog};
use sinew_samplers::resample::{Scheme, keep_once_refill};
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

proptest! {
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
            leapfrog(&target, &hmc, &factor, &mut x, &mut p, &mut g, &mut []);
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
