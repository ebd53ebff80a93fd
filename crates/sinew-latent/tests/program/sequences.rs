//! Posteriors of the latents of a sequence, against differences and exact answers.

use crate::common::{circles, differences, relative_error};
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_latent::Error;
use sinew_latent::covariance::Covariance;
use sinew_latent::gpdm;
use sinew_latent::latent_density::LatentPrior;
use sinew_latent::mapping::Mapping;
use sinew_latent::model::LatentModel;
use sinew_latent::motion::{LatentMotion, StepNoise};
use sinew_latent::sequence::{Config, climb, infer, likeliest_known, predict};
use sinew_latent::sequence_density::{SequenceDensity, SequenceLink};
use sinew_latent::training::{self, Training};
use std::sync::Arc;

const COLUMNS: usize = 6;
/// Rows of the sequences: no multiple of eight.
const ROWS: usize = 11;

fn model() -> LatentModel {
    let lengths = [25, 20];
    let data = circles(COLUMNS, &lengths, 0.1, 2);
    let config = gpdm::Config { dim: 2, ..Default::default() };
    let model = gpdm::model(&data, COLUMNS, &lengths, &config).expect("valid");
    let mut training =
        Training::new(model, training::Config { steps: 60, ..Default::default() }, Isa::best()).expect("valid");
    training.run(|_| true);
    training.into_model()
}

/// Rows of another sequence of the same kind whose later half lacks columns.
fn observed() -> Vec<Vec<(usize, f64)>> {
    let rows = circles(COLUMNS, &[5, ROWS], 0.1, 9);
    let rows = rows.chunks_exact(COLUMNS).skip(5).enumerate();
    let seen = |t: usize, d: usize| t < ROWS / 2 || d.is_multiple_of(3);
    rows.map(|(t, row)| row.iter().copied().enumerate().filter(|&(d, _)| seen(t, d)).collect()).collect()
}

fn links(model: &LatentModel) -> [SequenceLink; 3] {
    let motion = LatentMotion::new(model, 0, StepNoise::Predicted, Isa::baseline()).expect("dynamics");
    [SequenceLink::None, SequenceLink::Walk(vec![3.0, 8.0]), SequenceLink::Dynamics(motion)]
}

fn density(model: &LatentModel, link: SequenceLink, isa: Isa) -> SequenceDensity {
    let mapping = Arc::new(Mapping::new(model, 0).expect("valid"));
    SequenceDensity::new(mapping, LatentPrior::of(model, 0), link, 1.7, &observed(), isa).expect("valid")
}

#[test]
fn gradients_are_the_slopes_of_differences() {
    let model = model();
    for link in links(&model) {
        let density = density(&model, link, Isa::baseline());
        // Between the known latents, where variances change.
        let x: Vec<f64> =
            likeliest_known(&density).iter().enumerate().map(|(i, x)| x + 0.1 * (i as f64).sin()).collect();
        let mut gradient = vec![0.0; x.len()];
        let _ = density.log_density_grad(&x, &mut gradient);
        let mut unused = vec![0.0; x.len()];
        let expected = differences(&x, |x| density.log_density_grad(x, &mut unused));
        let error = relative_error(&gradient, &expected);
        assert!(error < 1e-6, "{:?}: {error}", density.link);
    }
}

#[test]
fn a_climb_ends_above_its_start_where_the_density_is_flat() {
    let model = model();
    for link in links(&model) {
        let density = density(&model, link, Isa::baseline());
        let start = likeliest_known(&density);
        let mut gradient = vec![0.0; start.len()];
        let before = density.log_density_grad(&start, &mut gradient);
        let (mode, after) = climb(&density, start, 500);
        let _ = density.log_density_grad(&mode, &mut gradient);
        let steepness = gradient.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
        assert!(after > before && steepness < 1e-3, "{:?}: from {before} to {after}, {steepness}", density.link);
    }
}

/// Everything is linear and normal: the map has a linear covariance, and rows enough that its variance is nothing beside the noise.
fn linear(link: SequenceLink) -> SequenceDensity {
    let count = 1000;
    let inputs: Vec<f64> = (0..2 * count).map(|i| 3.0 * (1.7 * i as f64).sin()).collect();
    let outputs: Vec<f64> = inputs
        .chunks_exact(2)
        .flat_map(|x| (0..COLUMNS).map(|d| (d as f64).cos() * x[0] + (2.0 * d as f64).sin() * x[1]))
        .collect();
    let covariance = Covariance { variance: 0.0, inverse_width: 1.0, linear: 1.0, bias: 0.0, white: 0.04 };
    let mapping =
        Mapping::fit(covariance, &inputs, 2, &outputs, vec![1.5; COLUMNS], vec![0.3; COLUMNS]).expect("valid");
    let prior = LatentPrior { mean: vec![0.2, -0.1], precision: vec![1.0, 2.0] };
    SequenceDensity::new(Arc::new(mapping), prior, link, 1.0, &observed(), Isa::baseline()).expect("valid")
}

/// Posterior mean and covariance by Gauss-Jordan elimination of the normal equations.
fn exact(density: &SequenceDensity, precision: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let (dim, length) = (2, 2 * ROWS);
    let (mapping, prior) = (&density.mapping, &density.prior);
    let origin = mapping.mean_at(&[0.0, 0.0]);
    let slopes: Vec<Vec<f64>> = [[1.0, 0.0], [0.0, 1.0]]
        .iter()
        .map(|x| mapping.mean_at(x).iter().zip(&origin).map(|(a, b)| a - b).collect())
        .collect();
    let mut equations = vec![vec![0.0; 2 * length + 1]; length];
    let mut add = |i: usize, j: usize, value: f64| equations[i][j] += value;
    for (t, row) in observed().iter().enumerate() {
        for &(d, y) in row {
            let noise = mapping.noise() * mapping.scale()[d].powi(2);
            for a in 0..dim {
                (0..dim).for_each(|b| add(t * dim + a, t * dim + b, slopes[a][d] * slopes[b][d] / noise));
                add(t * dim + a, 2 * length, slopes[a][d] * (y - origin[d]) / noise);
            }
        }
        for (j, &precision) in precision.iter().enumerate() {
            let i = t * dim + j;
            if t == 0 {
                add(i, i, prior.precision[j]);
                add(i, 2 * length, prior.precision[j] * prior.mean[j]);
            } else {
                for (a, b, sign) in [(i, i, 1.0), (i - dim, i - dim, 1.0), (i, i - dim, -1.0), (i - dim, i, -1.0)] {
                    add(a, b, sign * precision);
                }
            }
        }
    }
    (0..length).for_each(|i| equations[i][length + i] = 1.0);
    for pivot in 0..length {
        let top: Vec<f64> = equations[pivot].iter().map(|x| x / equations[pivot][pivot]).collect();
        for (i, row) in equations.iter_mut().enumerate() {
            let factor = row[pivot];
            if i == pivot {
                row.copy_from_slice(&top);
            } else {
                row.iter_mut().zip(&top).for_each(|(x, top)| *x -= factor * top);
            }
        }
    }
    let covariance = equations.iter().map(|row| row[length..2 * length].to_vec()).collect();
    (equations.iter().map(|row| row[2 * length]).collect(), covariance)
}

/// What is left of the variance of the map, about 1e-3 of the noise, is the tolerance of the mode; that of moments by 4000 draws is four standard errors.
#[test]
fn a_linear_map_and_a_random_walk_have_the_posterior_of_the_normal_equations() {
    let precision = vec![3.0, 8.0];
    let density = linear(SequenceLink::Walk(precision.clone()));
    let (mean, covariance) = exact(&density, &precision);
    let draws = 4000;
    let posterior = infer(&density, &Config { steps: 500, draws }, Stage::new(3, "linear")).expect("finite");
    for (i, mean) in mean.iter().enumerate() {
        let sd = covariance[i][i].sqrt();
        assert!((posterior.mode[i] - mean).abs() < 0.02 * sd, "{i}: {} and {mean}, sd {sd}", posterior.mode[i]);
        for j in 0..=i {
            let product = |draw: &Vec<f64>| (draw[i] - posterior.mode[i]) * (draw[j] - posterior.mode[j]);
            let found = posterior.draws.iter().map(product).sum::<f64>() / draws as f64;
            let (exact, most) = (covariance[i][j], sd * covariance[j][j].sqrt());
            assert!(
                (found - exact).abs() < (4.0 * (2.0 / draws as f64).sqrt() + 0.01) * most,
                "{i}, {j}: {found}, {exact}"
            );
        }
    }
    let predictions = predict(&density, &posterior);
    let (origin, first) = (density.mapping.mean_at(&[0.0, 0.0]), density.mapping.mean_at(&mean[2 * ROWS - 2..]));
    for (d, prediction) in predictions[ROWS - 1].iter().enumerate() {
        assert!((prediction.mean - first[d]).abs() < 4.5 * (prediction.variance / draws as f64).sqrt() + 1e-3, "{d}");
        assert!(prediction.variance > 0.0 && origin[d].is_finite());
    }
}

#[test]
fn posteriors_are_the_same_on_one_thread_and_on_three() {
    let model = model();
    let density = density(&model, links(&model)[2].clone(), Isa::baseline());
    let posterior = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| infer(&density, &Config::default(), Stage::new(4, "again")).expect("finite"))
    };
    assert_eq!(posterior(1), posterior(3));
}

#[test]
fn sequences_that_do_not_fit_are_refused() {
    let model = model();
    let mapping = Arc::new(Mapping::new(&model, 0).expect("valid"));
    let prior = LatentPrior::of(&model, 0);
    let with = |link: SequenceLink, balance: f64, observed: &[Vec<(usize, f64)>]| {
        SequenceDensity::new(mapping.clone(), prior.clone(), link, balance, observed, Isa::baseline()).map(|_| ())
    };
    assert_eq!(with(SequenceLink::None, 1.0, &observed()), Ok(()));
    assert!(matches!(with(SequenceLink::None, 1.0, &[]), Err(Error::Shape { found: 0, .. })));
    assert!(matches!(with(SequenceLink::Walk(vec![1.0]), 1.0, &observed()), Err(Error::Shape { found: 1, .. })));
    assert!(matches!(
        with(SequenceLink::Walk(vec![1.0, -1.0]), 1.0, &observed()),
        Err(Error::OutOfRange { index: 1, .. })
    ));
    assert!(matches!(with(SequenceLink::None, f64::NAN, &observed()), Err(Error::OutOfRange { .. })));
    assert!(matches!(with(SequenceLink::None, 1.0, &[vec![(COLUMNS, 0.0)]]), Err(Error::OutOfRange { .. })));
    assert!(matches!(with(SequenceLink::None, 1.0, &[vec![(0, f64::NAN)]]), Err(Error::OutOfRange { .. })));
}
