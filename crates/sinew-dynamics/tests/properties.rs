//! Laws of densities and factors, for random sizes and values.

use proptest::prelude::*;
use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES, set_lane};
use sinew_core::transition::Moments;
use sinew_dynamics::factor::{cholesky, root};
use sinew_dynamics::gaussian::Gaussian;
use sinew_dynamics::joint_limits::JointLimits;
use sinew_dynamics::joint_ranges::JointRanges;
use sinew_dynamics::linear_gaussian::LinearGaussian;
use sinew_dynamics::mixture::Mixture;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_dynamics::smoother::Smoother;

fn vector(dim: usize, size: f64) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-size..size, dim)
}

/// B Bᵀ + 0.1 I.
fn covariance(dim: usize) -> impl Strategy<Value = Vec<f64>> {
    vector(dim * dim, 1.0).prop_map(move |b| {
        let entry = |i: usize, j: usize| (0..dim).map(|k| b[i * dim + k] * b[j * dim + k]).sum::<f64>();
        (0..dim * dim).map(|e| entry(e / dim, e % dim) + if e / dim == e % dim { 0.1 } else { 0.0 }).collect()
    })
}

fn mixture() -> impl Strategy<Value = (Mixture, Vec<Vec<f64>>)> {
    (1..30usize, 1..10usize).prop_flat_map(|(count, dim)| {
        let sd = prop::collection::vec(0.05..2.0f64, dim);
        (prop::collection::vec(vector(dim, 3.0), count), sd, prop::collection::vec(vector(dim, 4.0), LANES))
            .prop_map(|(means, sd, x)| (Mixture::new(means, &sd).expect("valid"), x))
    })
}

fn gaussian() -> impl Strategy<Value = (Gaussian, Vec<Vec<f64>>)> {
    (1..12usize).prop_flat_map(|dim| {
        (vector(dim, 2.0), covariance(dim), prop::collection::vec(vector(dim, 4.0), LANES))
            .prop_map(|(mean, c, x)| (Gaussian::new(mean, &c).expect("positive definite"), x))
    })
}

fn limits() -> impl Strategy<Value = (JointLimits, Vec<Vec<f64>>)> {
    (1..12usize).prop_flat_map(|dim| {
        let range = prop::option::of((-2.0..0.0f64, 0.1..2.0f64).prop_map(|(low, width)| [low, low + width]));
        let ranges = prop::collection::vec(range, dim);
        (ranges, 0.1..1.0f64, prop::collection::vec(vector(dim, 4.0), LANES))
            .prop_map(|(ranges, sigma, x)| (JointLimits::new(&JointRanges::new(ranges).expect("rising"), sigma), x))
    })
}

/// Every instruction set, block and single state, and differences.
fn check(density: &dyn Fn(Isa) -> Box<dyn GradLogDensity>, x: &[Vec<f64>]) -> Result<(), TestCaseError> {
    let d = x[0].len();
    let reference = density(Isa::baseline());
    for isa in Isa::available() {
        let density = density(isa);
        let mut block = vec![Block::ZERO; d];
        x.iter().enumerate().for_each(|(lane, x)| set_lane(&mut block, lane, x));
        let mut grads = vec![Block::ZERO; d];
        let mut ws = vec![Block::ZERO; density.workspace()];
        let values = density.log_density_grad_block(&block, &mut grads, &mut ws);
        prop_assert_eq!(density.log_density_block(&block, &mut ws), values);
        for (lane, x) in x.iter().enumerate() {
            let mut grad = vec![0.0; d];
            let exact = reference.log_density_grad(x, &mut grad);
            let bound = 1e-12 * exact.abs().max(1.0);
            prop_assert!((values.0[lane] - exact).abs() <= bound);
            prop_assert!((density.log_density(x) - exact).abs() <= bound);
            let scale = grad.iter().fold(1.0_f64, |a, g| a.max(g.abs()));
            for j in 0..d {
                prop_assert!((grads[j].0[lane] - grad[j]).abs() <= 1e-11 * scale);
            }
            let j = lane % d;
            let at = |h: f64| {
                let mut x = x.clone();
                x[j] += h;
                reference.log_density(&x)
            };
            let numeric = (at(1e-5) - at(-1e-5)) / 2e-5;
            prop_assert!((numeric - grad[j]).abs() < 1e-6 * scale * scale, "{} against {}", numeric, grad[j]);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn mixture_obeys_the_laws_of_densities((leaf, x) in mixture()) {
        check(&|isa| Box::new(Lanes { leaf: leaf.clone(), isa }), &x)?;
    }

    #[test]
    fn gaussian_obeys_the_laws_of_densities((leaf, x) in gaussian()) {
        check(&|isa| Box::new(Lanes { leaf: leaf.clone(), isa }), &x)?;
    }

    #[test]
    fn limits_of_joints_obey_the_laws_of_densities((leaf, x) in limits()) {
        check(&|isa| Box::new(Lanes { leaf: leaf.clone(), isa }), &x)?;
    }

    #[test]
    fn a_density_is_finite_or_minus_infinity((leaf, _) in mixture(), x: f64) {
        let density = Lanes { leaf, isa: Isa::best() };
        let state = vec![x; density.dim()];
        let value = density.log_density(&state);
        prop_assert!(!x.is_finite() || value.is_finite() || value == f64::NEG_INFINITY, "{}", value);
    }

    #[test]
    fn factors_accept_or_refuse_without_panic(entries in prop::collection::vec(prop::num::f64::ANY, 9)) {
        let finite = entries.iter().all(|x| x.is_finite());
        prop_assert!(finite || cholesky("any", &entries, 3).is_err() && root("any", &entries, 3).is_err());
        prop_assert!(cholesky("any", &entries, 3).is_ok() || Gaussian::new(entries[..3].to_vec(), &entries).is_err());
        let _ = LinearGaussian::new(3, entries.clone(), entries.clone(), entries.clone(), Isa::best());
        let _ = Mixture::new(vec![entries[..3].to_vec()], &entries[3..6]);
        let _ = RandomWalk::new(&entries[..3], entries[3], Between::Gaussian, Isa::best());
    }

    /// With no process noise and A = I all frames are one: smoothing repeats the last; with endless noise it changes nothing.
    #[test]
    fn smoothing_has_its_limits(p in covariance(3), q in covariance(3), mean in vector(3, 1.0), next in vector(3, 1.0)) {
        let eye = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let (filtered, last) = (Moments { mean, covariance: p }, Moments { mean: next, covariance: q.clone() });
        let still = Smoother::new(3, eye.clone(), vec![0.0; 9]).expect("square").step(&filtered, &last).expect("valid");
        let wild = Smoother::new(3, eye, q.iter().map(|q| q * 1e9).collect()).expect("square");
        let wild = wild.step(&filtered, &last).expect("valid");
        for i in 0..3 {
            prop_assert!((still.mean[i] - last.mean[i]).abs() < 1e-8);
            prop_assert!((wild.mean[i] - filtered.mean[i]).abs() < 1e-5);
            prop_assert!((still.covariance[i * 4] - last.covariance[i * 4]).abs() < 1e-8);
            prop_assert!((wild.covariance[i * 4] - filtered.covariance[i * 4]).abs() < 1e-5);
        }
    }
}
