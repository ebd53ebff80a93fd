//! Maps of learned models.
//!
//! Interpolation (G4), variances (G6), Jacobians (G7), inverse maps (G9), dynamics (G10), hierarchies (G11), laws of decoders.

use crate::common::{circles, differences, relative_error};
use sinew_core::decode::{Decode, LaneDecode};
use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, get_lane};
use sinew_core::transition::{GradTransition, Transition};
use sinew_latent::back_constraint::BackConstraint;
use sinew_latent::covariance::Covariance;
use sinew_latent::hgplvm::PlannedNode;
use sinew_latent::latent_density::{LatentDensity, LatentPrior};
use sinew_latent::mapping::Mapping;
use sinew_latent::model::LatentModel;
use sinew_latent::motion::{LatentMotion, StepNoise, path};
use sinew_latent::space::{Below, Space, ToChild};
use sinew_latent::training::{Config, Training};
use sinew_latent::tree::hierarchy;
use sinew_latent::{Error, gpdm, gplvm, hgplvm};
use std::sync::Arc;

const COLUMNS: usize = 7;
const LENGTHS: [usize; 2] = [40, 36];

fn data() -> Vec<f64> {
    circles(COLUMNS, &LENGTHS, 0.02, 5)
}

fn learned(model: LatentModel, steps: usize) -> LatentModel {
    let mut training = Training::new(model, Config { steps, ..Default::default() }, Isa::best()).expect("valid");
    training.run(|_| true);
    training.into_model()
}

fn learned_gplvm() -> LatentModel {
    let covariance = Covariance { linear: 0.2, ..Covariance::default() };
    let config = gplvm::Config { dim: 2, covariance, ..Default::default() };
    learned(gplvm::model(&data(), COLUMNS, &config).expect("valid"), 150)
}

fn learned_gpdm() -> LatentModel {
    let config = gpdm::Config { dim: 2, ..Default::default() };
    learned(gpdm::model(&data(), COLUMNS, &LENGTHS, &config).expect("valid"), 300)
}

fn learned_hgplvm() -> LatentModel {
    let branch = |parent, dim, columns: &[usize]| PlannedNode { parent, dim, columns: columns.to_vec() };
    let tree = vec![
        branch(None, 2, &[]),
        branch(Some(0), 2, &[3, 0]),
        branch(Some(0), 2, &[]),
        branch(Some(2), 2, &[6, 1, 2]),
        branch(Some(2), 1, &[4, 5]),
    ];
    let config = hgplvm::Config { tree, root_per_motion: false };
    learned(hgplvm::model(&data(), COLUMNS, &LENGTHS, &[2], &config).expect("valid"), 150)
}

fn points(dim: usize) -> Vec<Vec<f64>> {
    (0..11).map(|i| (0..dim).map(|j| 1.3 * ((3 * i + j) as f64 * 0.9).sin()).collect()).collect()
}

#[test]
fn without_noise_the_mean_goes_through_the_rows() {
    let covariance = Covariance { white: 1e-8, ..Covariance::default() };
    // Once round, so that no two latents are near each other.
    let model =
        gplvm::model(&circles(COLUMNS, &[17], 0.0, 5), COLUMNS, &gplvm::Config { covariance, ..Default::default() })
            .expect("valid");
    let mapping = Mapping::new(&model, 0).expect("valid");
    for row in 0..model.rows() {
        let mean = mapping.mean_at(model.nodes[0].latent(row));
        let worst = mean.iter().zip(model.row(row)).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
        assert!(worst < 1e-4, "row {row}: {worst:e}");
        assert!(mapping.variance_at(model.nodes[0].latent(row)) < 1e-6);
    }
}

#[test]
fn the_variance_is_that_of_the_prior_far_away_and_never_negative() {
    let model = gplvm::model(&data(), COLUMNS, &gplvm::Config::default()).expect("valid");
    let mapping = Mapping::new(&model, 0).expect("valid");
    let (far, covariance) = ([40.0, -30.0, 50.0], mapping.covariance());
    // What the bias has in common is known everywhere.
    let bias_left = mapping.variance_at(&far) - covariance.variance;
    assert!(bias_left >= 0.0 && bias_left <= covariance.bias, "{bias_left}");
    let unbiased =
        gplvm::Config { covariance: Covariance { bias: 0.0, ..Covariance::default() }, ..Default::default() };
    let mapping = Mapping::new(&gplvm::model(&data(), COLUMNS, &unbiased).expect("valid"), 0).expect("valid");
    assert!((mapping.variance_at(&far) - mapping.prior_variance(&far)).abs() < 1e-10);
    for x in points(3) {
        assert!(mapping.variance_at(&x) >= 0.0);
    }
}

fn check_decoder(name: &str, decoder: &dyn Decode) {
    let (dim, outputs) = (decoder.source_dim(), decoder.target_dim());
    let states = points(dim);
    for (i, x) in states.iter().enumerate() {
        let direction: Vec<f64> = (0..outputs).map(|d| (d as f64 * 1.1 + i as f64).cos()).collect();
        let along = |x: &[f64]| {
            let mut y = vec![0.0; outputs];
            decoder.decode(x, &mut y);
            y.iter().zip(&direction).map(|(y, g)| y * g).sum::<f64>()
        };
        let mut gradient = vec![0.0; dim];
        decoder.pullback(x, &direction, &mut gradient);
        let error = relative_error(&gradient, &differences(x, along));
        assert!(error < 1e-6, "{name}: {error:e}");
    }
    let mut ws = vec![Block::splat(f64::NAN); decoder.workspace()];
    let mut block = vec![Block::ZERO; dim];
    states[..8].iter().enumerate().for_each(|(i, x)| sinew_core::lanes::set_lane(&mut block, i, x));
    let mut decoded = vec![Block::ZERO; outputs];
    decoder.decode_block(&block, &mut decoded, &mut ws);
    let (mut in_block, mut alone) = (vec![0.0; outputs], vec![0.0; outputs]);
    for (i, x) in states[..8].iter().enumerate() {
        get_lane(&decoded, i, &mut in_block);
        decoder.decode(x, &mut alone);
        for (a, b) in in_block.iter().zip(&alone) {
            assert!((a - b).abs() <= 1e-12 * a.abs().max(1.0), "{name}: {a} in a block, {b} alone");
        }
    }
}

#[test]
fn pullbacks_are_derivatives_and_blocks_are_single_states() {
    for isa in Isa::available() {
        let lanes = |model: &LatentModel| Lanes { leaf: Space::new(model, 0).expect("valid"), isa };
        check_decoder("gplvm", &lanes(&learned_gplvm()));
        check_decoder("gpdm", &lanes(&learned_gpdm()));
        let hierarchy = learned_hgplvm();
        check_decoder("root", &Below::new(&hierarchy, 0, isa).expect("valid"));
        let space = Space::new(&hierarchy, 0).expect("valid");
        check_decoder("to a child", &ToChild::new(&hierarchy, 0, 1, space, isa).expect("valid"));
    }
}

/// With a linear term, and with a width that is learned.
#[test]
fn the_jacobian_is_one_pullback_a_row() {
    let (dim, outputs) = (2, COLUMNS);
    for model in [learned_gplvm(), learned_gpdm()] {
        let space = Space::new(&model, 0).expect("valid");
        let lanes = Lanes { leaf: space.clone(), isa: Isa::best() };
        let block: Vec<Block> = points(dim)[3].iter().map(|&x| Block::splat(x)).collect();
        let mut identity = vec![Block::ZERO; outputs * (outputs + 1) / 2];
        (0..outputs).for_each(|i| identity[i * (i + 3) / 2] = Block::splat(1.0));
        let mut square = vec![Block::ZERO; dim * (dim + 1) / 2];
        let mut ws = vec![Block::ZERO; lanes.matrix_workspace()];
        lanes.pullback_matrix_block(&block, &identity, &mut square, &mut ws);
        let row = |d: usize| {
            let (mut unit, mut gradient) = (vec![0.0; outputs], vec![0.0; dim]);
            unit[d] = 1.0;
            Decode::pullback(&lanes, &points(dim)[3], &unit, &mut gradient);
            gradient
        };
        let rows: Vec<Vec<f64>> = (0..outputs).map(row).collect();
        for (k, (i, j)) in [(0, 0), (1, 0), (1, 1)].into_iter().enumerate() {
            let expected: f64 = rows.iter().map(|row| row[i] * row[j]).sum();
            assert!((square[k].0[2] - expected).abs() < 1e-10 * expected.abs().max(1.0));
        }
        assert_eq!(LaneDecode::source_dim(&space), dim);
    }
}

#[test]
fn densities_of_latents_have_their_gradients() {
    for model in [learned_gplvm(), learned_gpdm()] {
        let mapping = Arc::new(Mapping::new(&model, 0).expect("valid"));
        let prior = LatentPrior::of(&model, 0);
        let observed = [0, 2, 5].map(|d| (d, model.row(17)[d])).to_vec();
        let given = LatentDensity::given(mapping.clone(), prior.clone(), observed).expect("outputs");
        for leaf in [given, LatentDensity::prior_of(mapping, prior)] {
            for isa in Isa::available() {
                let density = Lanes { leaf: leaf.clone(), isa };
                for x in points(2) {
                    let mut gradient = [0.0; 2];
                    density.log_density_grad(&x, &mut gradient);
                    let error = relative_error(&gradient, &differences(&x, |x| density.log_density(x)));
                    assert!(error < 1e-6, "{error:e}");
                }
            }
        }
    }
}

#[test]
fn inverse_maps_without_steps_are_regressions() {
    let model = learned_gplvm();
    let node = &model.nodes[0];
    let (known, cols) = (model.prepared(0), model.output_count(0));
    let regression = BackConstraint::fit(&known, cols, &node.latents, node.dim, 1e-3).expect("distinct rows");
    let space = Space::with_steps(&model, 0, 0).expect("valid");
    for (row, prepared) in known.chunks_exact(cols).enumerate() {
        assert_eq!(space.inverse.latent(model.row(row)), regression.latent(prepared, &known, node.dim));
    }
}

#[test]
fn inverse_maps_lead_back() {
    let model = learned_gplvm();
    let (space, node) = (Space::new(&model, 0).expect("valid"), &model.nodes[0]);
    let square = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let mut errors: Vec<f64> = Vec::new();
    let (mut direct, mut round) = (0.0, 0.0);
    for row in 0..model.rows() {
        let latent = node.latent(row);
        let decoded = space.mapping.mean_at(latent);
        errors.push(square(&space.inverse.latent(&decoded), latent).sqrt());
        direct += square(&decoded, model.row(row));
        round += square(&space.mapping.mean_at(&space.inverse.latent(model.row(row))), model.row(row));
    }
    errors.sort_by(f64::total_cmp);
    let spread = (node.latents.iter().map(|x| x * x).sum::<f64>() / node.latents.len() as f64).sqrt();
    let median = errors[errors.len() / 2] / spread;
    assert!(median < 0.05, "{median}");
    let ratio = (round / direct).sqrt();
    assert!(ratio < 1.2, "{ratio}");
}

#[test]
fn dynamics_stay_on_the_circle_that_they_were_learned_from() {
    let model = learned_gpdm();
    let motion = LatentMotion::new(&model, 0, StepNoise::Predicted, Isa::best()).expect("valid");
    let node = &model.nodes[0];
    let radius = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    // A period has 2 π / 0.35, 18 steps.
    let walked = path(&motion, node.latent(20), 54, None);
    let known: Vec<f64> = (0..18).map(|row| radius(node.latent(20 + row))).collect();
    let [least, most] =
        [known.iter().copied().fold(f64::INFINITY, f64::min), known.iter().copied().fold(0.0, f64::max)];
    for (step, x) in walked.chunks_exact(2).enumerate() {
        assert!(radius(x) > 0.8 * least && radius(x) < 1.2 * most, "step {step}: {} of {least} to {most}", radius(x));
    }
    let angle = |x: &[f64]| x[1].atan2(x[0]);
    let turned: f64 = walked
        .chunks_exact(2)
        .collect::<Vec<_>>()
        .windows(2)
        .map(|pair| {
            let change = angle(pair[1]) - angle(pair[0]);
            change - (change / std::f64::consts::TAU).round() * std::f64::consts::TAU
        })
        .sum();
    assert!((turned.abs() / std::f64::consts::TAU - 3.0).abs() < 0.3, "{turned} rad");
}

#[test]
fn steps_of_latents_have_their_density_and_its_gradient() {
    let model = learned_gpdm();
    for noise in [StepNoise::Predicted, StepNoise::Fixed(vec![0.1, 0.2])] {
        let motion = LatentMotion::new(&model, 0, noise, Isa::best()).expect("valid");
        let (from, to) = (&points(2)[1], &points(2)[2]);
        let mut gradient = [0.0; 2];
        motion.log_density_grad(from, to, &mut gradient);
        let error = relative_error(&gradient, &differences(to, |x| motion.log_density(from, x)));
        assert!(error < 1e-6, "{error:e}");
        // Moments of 8000 draws.
        let previous: Vec<Block> = from.iter().map(|&x| Block::splat(x)).collect();
        let (mut sum, mut square, mut next) = ([0.0; 2], [0.0; 2], vec![Block::ZERO; 2]);
        let mut rng = sinew_core::random::Stage::new(1, "steps").whole();
        for _ in 0..1000 {
            motion.sample_block(&previous, &mut next, &mut rng);
            for j in 0..2 {
                sum[j] += next[j].0.iter().sum::<f64>() / 8000.0;
                square[j] += next[j].0.iter().map(|x| x * x).sum::<f64>() / 8000.0;
            }
        }
        for (j, (mean, variance)) in motion.mean(from).into_iter().zip(motion.variances(from)).enumerate() {
            assert!((sum[j] - mean).abs() < 4.5 * (variance / 8000.0).sqrt());
            let found = square[j] - sum[j] * sum[j];
            assert!((found / variance - 1.0).abs() < 4.5 * (2.0 / 8000.0_f64).sqrt(), "{found} of {variance}");
        }
    }
}

#[test]
fn a_tree_decodes_as_its_nodes_do_one_after_the_other() {
    let model = learned_hgplvm();
    let spaces: Vec<Space> = (0..model.nodes.len()).map(|n| Space::new(&model, n).expect("valid")).collect();
    let below = Below::new(&model, 0, Isa::baseline()).expect("valid");
    assert_eq!(below.columns(), [0, 1, 2, 3, 4, 5, 6]);
    for x in points(2) {
        let first = spaces[0].mapping.mean_at(&x);
        let second = spaces[2].mapping.mean_at(&first[2..]);
        let mut expected = [0.0; COLUMNS];
        let leaves: [(&[usize], Vec<f64>); 3] = [
            (&[3, 0], spaces[1].mapping.mean_at(&first[..2])),
            (&[6, 1, 2], spaces[3].mapping.mean_at(&second[..2])),
            (&[4, 5], spaces[4].mapping.mean_at(&second[2..])),
        ];
        for (columns, values) in leaves {
            columns.iter().zip(values).for_each(|(&column, value)| expected[column] = value);
        }
        let mut found = [0.0; COLUMNS];
        below.decode(&x, &mut found);
        for (a, b) in found.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-12 * b.abs().max(1.0));
        }
    }
}

#[test]
fn a_model_is_a_tree_for_trackers() {
    let model = learned_hgplvm();
    let tree = hierarchy(&model, Isa::baseline()).expect("a tree");
    let layers: Vec<usize> = tree.nodes().iter().map(|node| node.layer).collect();
    assert_eq!(layers, [1, 2, 2, 3, 3]);
    assert_eq!(tree.nodes()[2].coordinates, [1, 2, 4, 5, 6]);
    // Going down changes no pose.
    for x in points(2) {
        for child in tree.nodes() {
            let (Some(parent), Some(down)) = (child.parent, &child.from_parent) else { continue };
            let above = &tree.nodes()[parent];
            let (mut latent, mut own) = (vec![0.0; child.pose.source_dim()], vec![0.0; child.coordinates.len()]);
            let mut whole = vec![0.0; above.coordinates.len()];
            down.decode(&x, &mut latent);
            child.pose.decode(&latent, &mut own);
            above.pose.decode(&x, &mut whole);
            for (coordinate, value) in child.coordinates.iter().zip(own) {
                let place = above.coordinates.iter().position(|other| other == coordinate).expect("of the parent");
                assert!((whole[place] - value).abs() < 1e-12 * value.abs().max(1.0));
            }
        }
    }
    let config = hgplvm::Config { tree: two_leaves(), root_per_motion: true };
    let roots = hgplvm::model(&data(), COLUMNS, &LENGTHS, &[1, 1], &config).expect("valid");
    assert_eq!(hierarchy(&roots, Isa::baseline()).err(), Some(Error::Roots { found: 2 }));
}

/// A root over two leaves.
fn two_leaves() -> Vec<PlannedNode> {
    let branch = |parent, columns: std::ops::Range<usize>| PlannedNode { parent, dim: 2, columns: columns.collect() };
    vec![branch(None, 0..0), branch(Some(0), 0..3), branch(Some(0), 3..COLUMNS)]
}

#[test]
fn a_tree_of_one_leaf_is_a_gplvm() {
    let leaf = PlannedNode { parent: None, dim: 2, columns: (0..COLUMNS).collect() };
    let config = hgplvm::Config { tree: vec![leaf], root_per_motion: false };
    let hierarchy = hgplvm::model(&data(), COLUMNS, &LENGTHS, &[2], &config).expect("valid");
    let single =
        gplvm::model(&data(), COLUMNS, &gplvm::Config { dim: 2, prior: hierarchy.prior, ..Default::default() });
    let single = LatentModel { sequences: LENGTHS.to_vec(), ..single.expect("valid") };
    assert_eq!(hierarchy, single);
}
