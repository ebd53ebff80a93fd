//! Targets and strategies: gradients belong to values, draws have the density, strategies keep their promise.

use proptest::prelude::*;
use sinew_core::density::LogDensity;
use sinew_core::random::Stage;
use sinew_invariance::targets::{Banana, ExactTarget, GaussianTarget, HalfLine, MixtureTarget, Truncated};
use sinew_invariance::{Differences, gradient, strategies};

/// E exp(log q(x) − log p(x)) over draws from p is 1 for a normalised q with lighter tails inside the support of p.
fn integrates_to_one(target: &impl ExactTarget, inner: &impl LogDensity, missing: f64) {
    let mut rng = Stage::new(5, "normalisation").whole();
    let n = 20_000;
    let ratios: Vec<f64> = (0..n)
        .map(|_| {
            let x = target.draw(&mut rng);
            (inner.log_density(&x) - target.log_density(&x)).exp() * missing
        })
        .collect();
    let mean = ratios.iter().sum::<f64>() / f64::from(n);
    let variance = ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / f64::from(n - 1);
    let z = (mean - 1.0) / (variance / f64::from(n)).sqrt().max(1e-12);
    assert!(z.abs() < 4.5, "mean ratio {mean}, z = {z}, bound 4.5, seed 5");
}

/// Densities with all constants agree with their draws. Seven statistics at |z| < 4.5.
#[test]
fn draws_have_the_density_that_is_claimed() {
    let narrow = GaussianTarget::new(vec![0.1, -0.2], vec![vec![0.5], vec![0.1, 0.4]]);
    integrates_to_one(&GaussianTarget::equicorrelated(2, 0.5), &narrow, 1.0);
    integrates_to_one(&Banana { sd: 1.2, bend: 0.4 }, &narrow, 1.0);
    let wide =
        MixtureTarget::new(vec![1.0, 3.0], vec![GaussianTarget::standard(2), GaussianTarget::scaled(&[3.0, 2.0])]);
    integrates_to_one(&wide, &narrow, 1.0);
    integrates_to_one(&HalfLine { rate: vec![1.0, 2.0] }, &HalfLine { rate: vec![1.5, 3.0] }, 1.0);
    // Half of N(0, 1) is left, so the density of its draws is twice the value.
    for beyond in [f64::NEG_INFINITY, f64::NAN] {
        let half = Truncated { whole: GaussianTarget::standard(2), edge: 0.0, beyond };
        let inner = Truncated { whole: GaussianTarget::scaled(&[0.5, 0.5]), edge: 0.0, beyond };
        integrates_to_one(&half, &inner, 1.0);
    }
}

#[test]
fn an_equicorrelated_gaussian_is_what_it_says() {
    let target = GaussianTarget::equicorrelated(6, 0.7);
    for i in 0..6 {
        for j in 0..6 {
            assert!((target.covariance(i, j) - if i == j { 1.0 } else { 0.7 }).abs() < 1e-12);
        }
    }
}

fn has_its_gradient(target: &impl ExactTarget) {
    let mut rng = Stage::new(1, "gradient").whole();
    // Points at an edge have no gradient: differences would straddle it.
    let inside = |x: &Vec<f64>| {
        let around = [-1e-2, 1e-2]
            .iter()
            .all(|h| target.log_density(&x.iter().map(|x| x + h * x.abs().max(1.0)).collect::<Vec<_>>()).is_finite());
        around && x.iter().all(|x| x.abs() < 100.0)
    };
    let points: Vec<Vec<f64>> = (0..40).map(|_| target.draw(&mut rng)).filter(inside).take(5).collect();
    if !points.is_empty() {
        let bound = Differences { tolerance: 1e-5, ..Differences::default() };
        gradient(&bound, |x, g| target.log_density_grad(x, g), &points).assert_holds();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn gaussians_have_their_gradients(target in strategies::gaussians(1..=5)) {
        has_its_gradient(&target);
    }

    #[test]
    fn mixtures_have_their_gradients(target in strategies::mixtures(1..=3)) {
        has_its_gradient(&target);
    }

    #[test]
    fn bananas_have_their_gradients(target in strategies::bananas()) {
        has_its_gradient(&target);
    }

    #[test]
    fn edges_have_none_beyond(half in strategies::half_lines(1..=3), cliff in strategies::cliffs(1..=3), region in strategies::nan_regions(1..=3)) {
        has_its_gradient(&cliff);
        has_its_gradient(&region);
        prop_assert_eq!(half.log_density(&vec![-1e-9; half.dim()]), f64::NEG_INFINITY);
        let far = |target: &Truncated| vec![target.edge + 1.0; target.dim()];
        prop_assert_eq!(cliff.log_density(&far(&cliff)), f64::NEG_INFINITY);
        prop_assert!(region.log_density(&far(&region)).is_nan());
        let mut rng = Stage::new(2, "edge").whole();
        prop_assert!(cliff.log_density(&cliff.draw(&mut rng)).is_finite());
        prop_assert!(region.log_density(&region.draw(&mut rng)).is_finite());
    }

    #[test]
    fn weights_are_normalised(weights in strategies::weights(1..=50)) {
        prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        prop_assert!(weights.iter().all(|&w| (0.0..=1.0).contains(&w)));
    }

    #[test]
    fn trees_have_parents_first_and_unit_axes(tree in strategies::trees(1..=12)) {
        prop_assert_eq!(tree.parents.len(), tree.offsets.len());
        prop_assert_eq!(tree.parents.len(), tree.axes.len());
        for (i, parent) in tree.parents.iter().enumerate() {
            prop_assert_eq!(parent.is_none(), i == 0);
            prop_assert!(parent.is_none_or(|p| p < i));
        }
        for axis in tree.axes.iter().flatten() {
            prop_assert!((axis.iter().map(|a| a * a).sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }
}
