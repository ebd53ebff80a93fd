//! Objectives of all models.
//!
//! Gradients against differences (G1), weights (G2), linear models against principal components (G3), invariance (G5), learning (G8).

use crate::common::{circles, differences, relative_error};
use sinew_core::lanes::Isa;
use sinew_core::lbfgs::Objective;
use sinew_latent::covariance::Covariance;
use sinew_latent::hgplvm::PlannedNode;
use sinew_latent::model::{LatentModel, RootPrior};
use sinew_latent::outputs::Preparation;
use sinew_latent::training::{Config, Landscape, Training, objective};
use sinew_latent::{gpdm, gplvm, hgplvm};

const COLUMNS: usize = 7;
const LENGTHS: [usize; 2] = [11, 8];

fn data() -> Vec<f64> {
    circles(COLUMNS, &LENGTHS, 0.05, 3)
}

fn branch(parent: Option<usize>, dim: usize, columns: &[usize]) -> PlannedNode {
    PlannedNode { parent, dim, columns: columns.to_vec() }
}

/// Root, one leaf below it, an inner node with two leaves.
fn tree() -> Vec<PlannedNode> {
    vec![
        branch(None, 2, &[]),
        branch(Some(0), 2, &[0, 3]),
        branch(Some(0), 2, &[]),
        branch(Some(2), 2, &[1, 2, 6]),
        branch(Some(2), 1, &[4, 5]),
    ]
}

fn hgplvm(root_per_motion: bool) -> LatentModel {
    let config = hgplvm::Config { tree: tree(), root_per_motion };
    hgplvm::model(&data(), COLUMNS, &LENGTHS, &[1, 1], &config).expect("valid")
}

/// All kinds of models, each at its start.
fn models() -> Vec<(&'static str, LatentModel)> {
    let gplvm = |config| gplvm::model(&data(), COLUMNS, &config).expect("valid");
    let gpdm = |balanced, back| {
        let config = gpdm::Config { dim: 2, balanced, back, ..Default::default() };
        gpdm::model(&data(), COLUMNS, &LENGTHS, &config).expect("valid")
    };
    let linear = Covariance { linear: 0.7, ..Covariance::default() };
    vec![
        ("gplvm", gplvm(gplvm::Config { dim: 2, ..Default::default() })),
        (
            "gplvm, linear term, no prior",
            gplvm(gplvm::Config { covariance: linear, prior: RootPrior::Flat, ..Default::default() }),
        ),
        ("gplvm, back constraint", gplvm(gplvm::Config { back: Some(0.1), ..Default::default() })),
        ("gpdm", gpdm(false, None)),
        ("balanced gpdm", gpdm(true, None)),
        ("gpdm, back constraint", gpdm(true, Some(0.1))),
        ("hgplvm", hgplvm(false)),
        ("hgplvm, two roots", hgplvm(true)),
    ]
}

#[test]
fn gradients_are_derivatives() {
    for isa in Isa::available() {
        for (name, model) in models() {
            let (mut landscape, mut unknowns) = Landscape::new(model, isa).expect("valid");
            // Away from the start, where some slopes are 0 by symmetry.
            unknowns.iter_mut().enumerate().for_each(|(i, x)| *x += 0.1 * (i as f64 * 1.7).sin());
            let mut gradient = vec![0.0; unknowns.len()];
            landscape.evaluate(&unknowns, &mut gradient);
            let mut unused = gradient.clone();
            let expected = differences(&unknowns, |x| landscape.evaluate(x, &mut unused));
            let error = relative_error(&gradient, &expected);
            assert!(error < 1e-6, "{name}: {error:e}");
        }
    }
}

#[test]
fn weights_in_closed_form_leave_no_slope() {
    let config = gpdm::Config { dim: 2, ..Default::default() };
    let model = gpdm::model(&data(), COLUMNS, &LENGTHS, &config).expect("valid");
    let mut training = Training::new(model, Config::default(), Isa::best()).expect("valid");
    let model = training.state().model.clone();
    let value = |log_weights: &[f64]| {
        let mut moved = model.clone();
        moved.nodes[0].weights = log_weights.iter().map(|w| w.exp()).collect();
        objective(&moved, Isa::best()).expect("valid").0
    };
    let logs: Vec<f64> = model.nodes[0].weights.iter().map(|w| w.ln()).collect();
    let slopes = differences(&logs, value);
    let steepest = slopes.iter().fold(0.0, |steepest: f64, slope| steepest.max(slope.abs()));
    assert!(steepest < 1e-6 * value(&logs).abs(), "{steepest:e}");
}

#[test]
fn linear_models_find_the_principal_subspace() {
    let covariance = Covariance { variance: 0.0, inverse_width: 1.0, linear: 1.0, bias: 0.0, white: 0.1 };
    let config = gplvm::Config { dim: 2, covariance, preparation: Preparation::Centred, ..Default::default() };
    let mut model = gplvm::model(&data(), COLUMNS, &config).expect("valid");
    let principal = model.nodes[0].latents.clone();
    // Away from the answer.
    model.nodes[0].latents.iter_mut().enumerate().for_each(|(i, x)| *x += 0.3 * (i as f64 * 2.3).sin());
    let mut training =
        Training::new(model, Config { steepness: 1e-9, ..Default::default() }, Isa::best()).expect("valid");
    training.run(|_| true);
    let latents = training.into_model().nodes[0].latents.clone();
    let angle = largest_angle(&principal, &latents, 2);
    assert!(angle < 1e-3, "{angle:e} rad");
}

/// Largest principal angle between two spaces of rows by columns of two.
fn largest_angle(a: &[f64], b: &[f64], dim: usize) -> f64 {
    let basis = |rows: &[f64]| {
        let matrix = faer::Mat::from_fn(rows.len() / dim, dim, |i, j| rows[i * dim + j]);
        matrix.qr().compute_thin_Q()
    };
    let product = basis(a).transpose() * basis(b);
    let least = product.singular_values().expect("finite").into_iter().fold(1.0, f64::min);
    least.min(1.0).acos()
}

#[test]
fn objectives_do_not_see_where_the_latents_are_or_how_they_are_turned() {
    let config = gplvm::Config { dim: 2, prior: RootPrior::Flat, ..Default::default() };
    let model = gplvm::model(&data(), COLUMNS, &config).expect("valid");
    let value = |model: &LatentModel| objective(model, Isa::best()).expect("valid").0;
    let (sin, cos) = 0.7_f64.sin_cos();
    let mut turned = model.clone();
    for x in turned.nodes[0].latents.chunks_exact_mut(2) {
        let [a, b] = [x[0], x[1]];
        x.copy_from_slice(&[cos * a - sin * b + 0.3, sin * a + cos * b - 2.0]);
    }
    let mut reversed = model.clone();
    reversed.data = model.data.chunks_exact(COLUMNS).rev().flatten().copied().collect();
    reversed.nodes[0].latents = model.nodes[0].latents.chunks_exact(2).rev().flatten().copied().collect();
    for other in [turned, reversed] {
        let relative = (value(&other) / value(&model) - 1.0).abs();
        assert!(relative < 1e-9, "{relative:e}");
    }
}

#[test]
fn learning_descends_and_stays_at_the_optimum() {
    for (name, model) in models() {
        let learns_weights = model.kappa.is_some();
        let mut training =
            Training::new(model, Config { steps: 60, ..Default::default() }, Isa::best()).expect("valid");
        let mut last = training.progress().objective;
        let first = last;
        training.run(|progress| {
            // Weights are set to their optimum between rounds, which lowers the objective, too.
            assert!(progress.objective <= last + 1e-8 * last.abs(), "{name}: {} after {last}", progress.objective);
            last = progress.objective;
            true
        });
        let end = training.progress().objective;
        assert!(end < first, "{name}: {first} to {end}");
        if !learns_weights {
            let again = Training::new(training.into_model(), Config { steps: 0, ..Default::default() }, Isa::best())
                .expect("valid");
            let relative = (again.progress().objective / end - 1.0).abs();
            assert!(relative < 1e-8, "{name}: {relative:e}");
        }
    }
}

/// Learned until the gradient is flat, models begin again and stay where they are. Not with back constraints, whose coefficients reach no flat gradient in 20 000 steps.
#[test]
fn learning_that_begins_at_an_optimum_stays_there() {
    for (name, model) in models().into_iter().filter(|(name, _)| name.starts_with("gplvm") && !name.contains("back")) {
        let config = Config { steps: 20_000, steepness: 1e-5, ..Default::default() };
        let rows = model.rows() as f64;
        let mut training = Training::new(model, config, Isa::best()).expect("valid");
        let end = training.run(|_| true);
        assert!(end.steepness <= 1e-5 * rows, "{name}: not flat, {end:?}");
        let optimum = training.into_model();
        let mut again = Training::new(optimum.clone(), config, Isa::best()).expect("valid");
        let after = again.run(|_| true);
        let fell = (end.objective - after.objective) / end.objective.abs();
        assert!((0.0..1e-8).contains(&fell.max(0.0)) && after.steps <= 5, "{name}: {fell:e} in {} steps", after.steps);
        let (from, to) = (&optimum.nodes[0].latents, &again.into_model().nodes[0].latents);
        let moved = from.iter().zip(to).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(moved < 1e-4, "{name}: latents moved by {moved:e}");
    }
}

#[test]
fn learning_continues_from_its_state_to_the_same_bits() {
    for (name, model) in models() {
        let config = Config { steps: 25, ..Default::default() };
        let mut whole = Training::new(model.clone(), config, Isa::best()).expect("valid");
        assert!(whole.run(|_| true).steps <= 25, "{name}: more steps than are allowed");
        let mut part = Training::new(model, config, Isa::best()).expect("valid");
        part.run(|progress| progress.steps < 13);
        let text = serde_json::to_string(part.state()).expect("writable");
        let state = serde_json::from_str(&text).expect("as written");
        let mut part = Training::resume(state, Isa::best()).expect("as written");
        part.run(|_| true);
        assert!(part.state() == whole.state(), "{name}");
    }
}
