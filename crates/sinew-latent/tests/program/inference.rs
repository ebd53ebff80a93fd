//! Posteriors of latents and missing columns against quadrature.

use crate::common::circles;
use sinew_core::density::{Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_latent::inference::{Config, infer, predict};
use sinew_latent::latent_density::{LatentDensity, LatentPrior};
use sinew_latent::mapping::Mapping;
use sinew_latent::model::LatentModel;
use sinew_latent::training::{self, Training};
use sinew_latent::{Error, gplvm};
use std::sync::Arc;

const COLUMNS: usize = 7;

fn model() -> LatentModel {
    let data = circles(COLUMNS, &[60], 0.1, 2);
    let model = gplvm::model(&data, COLUMNS, &gplvm::Config { dim: 2, ..Default::default() }).expect("valid");
    let mut training =
        Training::new(model, training::Config { steps: 150, ..Default::default() }, Isa::best()).expect("valid");
    training.run(|_| true);
    training.into_model()
}

/// A new row, from the same circle.
fn row() -> Vec<f64> {
    circles(COLUMNS, &[70], 0.1, 9)[64 * COLUMNS..65 * COLUMNS].to_vec()
}

fn density(observed: &[usize]) -> LatentDensity {
    let (model, row) = (model(), row());
    let mapping = Arc::new(Mapping::new(&model, 0).expect("valid"));
    LatentDensity::given(mapping, LatentPrior::of(&model, 0), observed.iter().map(|&d| (d, row[d])).collect())
        .expect("outputs")
}

/// log N(y; 0, K) without (N/2) log 2π, by a Cholesky factor written out.
fn log_normal(gram: &[Vec<f64>], y: &[f64]) -> f64 {
    let (mut factor, mut solved) = (gram.to_vec(), y.to_vec());
    let mut value = 0.0;
    for i in 0..y.len() {
        for j in 0..i {
            factor[i][j] = (factor[i][j] - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>()) / factor[j][j];
            solved[i] -= factor[i][j] * solved[j];
        }
        factor[i][i] = (factor[i][i] - factor[i][..i].iter().map(|x| x * x).sum::<f64>()).sqrt();
        solved[i] /= factor[i][i];
        value -= factor[i][i].ln() + 0.5 * solved[i] * solved[i];
    }
    value
}

/// What was observed of a row given its latent is the joint density of all rows' columns over that of the known ones, column by column.
#[test]
fn the_density_of_a_partly_observed_row_is_joint_over_known() {
    let (model, row) = (model(), row());
    let node = &model.nodes[0];
    let prepared = model.prepared(0);
    for observed in [&[0, 3][..], &[1, 2, 6], &[0, 1, 2, 3, 4, 5, 6]] {
        let density = Lanes { leaf: density(observed), isa: Isa::best() };
        for x in [[0.3, -0.8], [1.1, 0.4], [4.0, 4.0]] {
            let latents: Vec<&[f64]> = (0..model.rows()).map(|n| node.latent(n)).chain([&x[..]]).collect();
            let white = |i: usize, j: usize| if i == j { node.covariance.white } else { 0.0 };
            let entry = |i: usize, j: usize| node.covariance.between(latents[i], latents[j]) + white(i, j);
            let gram: Vec<Vec<f64>> =
                (0..latents.len()).map(|i| (0..latents.len()).map(|j| entry(i, j)).collect()).collect();
            let conditional = |&d: &usize| {
                let mut y: Vec<f64> = prepared.iter().skip(d).step_by(COLUMNS).copied().collect();
                let known = log_normal(&gram[..y.len()], &y);
                y.push((row[d] - model.standard.mean[d]) / model.standard.scale[d]);
                log_normal(&gram, &y) - known
            };
            let prior = -0.5 * x.iter().map(|x| x * x).sum::<f64>();
            let expected = observed.iter().map(conditional).sum::<f64>() + prior;
            let found = density.log_density(&x);
            assert!(
                (found - expected).abs() < 1e-7 * expected.abs().max(1.0),
                "{observed:?} {x:?}: {found} {expected}"
            );
        }
    }
}

const SIDE: usize = 800;

/// Points of a grid over a box.
fn grid([low, high]: [[f64; 2]; 2]) -> Vec<[f64; 2]> {
    let place = |axis: usize, i: usize| low[axis] + (high[axis] - low[axis]) * i as f64 / (SIDE - 1) as f64;
    (0..SIDE * SIDE).map(|k| [place(0, k / SIDE), place(1, k % SIDE)]).collect()
}

/// Mean and variance of every output by a grid over the part of the latent plane where the density is not far below its largest value.
fn quadrature(density: &LatentDensity) -> Vec<(f64, f64)> {
    let lanes = Lanes { leaf: density.clone(), isa: Isa::best() };
    let reach = 1.2 * density.mapping.latents().iter().fold(6.0, |most: f64, x| most.max(x.abs()));
    let cell = 2.0 * reach / (SIDE - 1) as f64;
    let mut ws = vec![Block::ZERO; LogDensity::workspace(&lanes)];
    let mut logs = |points: &[[f64; 2]]| -> Vec<f64> {
        let eight = points.as_chunks::<LANES>().0.iter();
        eight
            .flat_map(|eight| {
                let axis = |axis: usize| Block(std::array::from_fn(|lane| eight[lane][axis]));
                lanes.log_density_block(&[axis(0), axis(1)], &mut ws).0
            })
            .collect()
    };
    let coarse = grid([[-reach; 2], [reach; 2]]);
    let values = logs(&coarse);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for (x, _) in coarse.iter().zip(&values).filter(|(_, log)| **log > largest - 30.0) {
        for axis in 0..2 {
            bounds[0][axis] = bounds[0][axis].min(x[axis] - cell);
            bounds[1][axis] = bounds[1][axis].max(x[axis] + cell);
        }
    }
    let points = grid(bounds);
    let values = logs(&points);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (mut total, mut sums) = (0.0, [[0.0; 2]; COLUMNS]);
    let mut spread = 0.0;
    for (x, log) in points.iter().zip(&values).filter(|(_, log)| **log > largest - 30.0) {
        let weight = (log - largest).exp();
        total += weight;
        spread += weight * density.mapping.variance_at(x);
        for (sum, mean) in sums.iter_mut().zip(density.mapping.mean_at(x)) {
            sum[0] += weight * mean;
            sum[1] += weight * mean * mean;
        }
    }
    let outputs = sums.iter().zip(density.mapping.scale());
    outputs
        .map(|(sum, scale)| {
            let mean = sum[0] / total;
            (mean, sum[1] / total - mean * mean + spread / total * scale * scale)
        })
        .collect()
}

fn check(observed: &[usize]) {
    let density = density(observed);
    let exact = quadrature(&density);
    let config = Config { draws: 8000, ..Default::default() };
    let posterior = infer(&density, &config, Stage::new(4, "inference")).expect("finite");
    assert!((posterior.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert!(posterior.effective > 500.0, "{}", posterior.effective);
    for (d, (found, (mean, variance))) in predict(&density, &posterior).into_iter().zip(exact).enumerate() {
        let error = (found.mean - mean).abs() / variance.sqrt();
        assert!(error < 4.5 / posterior.effective.sqrt(), "observed {observed:?}, column {d}: mean off by {error} sd");
        let ratio = found.variance / variance;
        // Of a bimodal or skewed posterior the fourth moment is not that of a normal distribution: twice its standard error.
        assert!(
            (ratio - 1.0).abs() < 9.0 * (2.0 / posterior.effective).sqrt(),
            "observed {observed:?}, column {d}: {ratio}"
        );
    }
}

#[test]
fn a_whole_row_has_the_posterior_of_quadrature() {
    check(&[0, 1, 2, 3, 4, 5, 6]);
}

#[test]
fn rows_with_missing_columns_have_the_posterior_of_quadrature() {
    check(&[0, 3]);
    check(&[1, 2, 6]);
}

/// Two columns half a turn apart are met twice: on the way up and on the way down.
#[test]
fn columns_that_tell_the_same_leave_several_modes() {
    let density = density(&[0, 4]);
    let posterior = infer(&density, &Config::default(), Stage::new(4, "modes")).expect("finite");
    assert!(posterior.modes.len() > 1 && posterior.modes[1].share > 0.05, "{:?}", posterior.modes);
    check(&[0, 4]);
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let density = density(&[0]);
    let given = |observed: Vec<(usize, f64)>, prior: &LatentPrior| {
        LatentDensity::given(density.mapping.clone(), prior.clone(), observed).map(drop)
    };
    let place = |name, index| move |error: Error| matches!(error, Error::OutOfRange { name: n, index: i, .. } if (n, i) == (name, index));
    assert!(given(vec![(0, 1.0), (COLUMNS, 1.0)], &density.prior).is_err_and(place("observed output", COLUMNS)));
    assert!(given(vec![(3, f64::NAN)], &density.prior).is_err_and(place("observed output", 3)));
    let flat = LatentPrior { mean: vec![0.0], precision: vec![1.0] };
    let shape = |name| move |error: Error| matches!(error, Error::Shape { name: n, .. } if n == name);
    assert!(given(vec![], &flat).is_err_and(shape("prior of latents")));
    let none = infer(&density, &Config { draws: 0, ..Default::default() }, Stage::new(1, "none"));
    assert!(none.map(drop).is_err_and(shape("draws")));
    let model = model();
    assert!(Mapping::new(&model, 1).map(drop).is_err_and(shape("nodes of a model")));
    let fit = |inputs: &[f64], dim, outputs: &[f64]| {
        Mapping::fit(model.nodes[0].covariance, inputs, dim, outputs, vec![1.0], vec![0.0]).map(drop)
    };
    assert!(fit(&[1.0, 2.0], 0, &[1.0]).is_err_and(shape("inputs")));
    assert!(fit(&[1.0, 2.0], 1, &[1.0]).is_err_and(shape("outputs")));
}

#[test]
fn posteriors_are_the_same_for_the_same_seed() {
    let density = density(&[0, 3]);
    let posterior = || infer(&density, &Config::default(), Stage::new(4, "again")).expect("finite");
    assert_eq!(posterior(), posterior());
}
