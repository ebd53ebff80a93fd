//! The silhouette likelihood with a gradient: derivatives, blocks, and what it says.

use sinew_body::hppf24;
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES, triangle};
use sinew_core::random::Stage;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::silhouettes::image_likelihood::ImageModel;
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_observe::silhouettes::soft_silhouette::{SoftSilhouette, SoftSilhouetteModel};
use sinew_observe::silhouettes::solid_body::SolidBody;
use sinew_observe::{Camera, ObservationModel};
use std::sync::Arc;

fn cameras() -> Vec<Camera> {
    let camera = |k: usize| {
        let angle = 0.25 + 2.0 * k as f64;
        let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 1.8];
        Camera::look_at(&format!("C{k}"), [160.0, 120.0], 200.0, centre, [0.0, 0.0, 1.0]).expect("a view")
    };
    (0..3).map(camera).collect()
}

fn poses(count: usize, spread: f64) -> Vec<Vec<f64>> {
    let mut noise = vec![Block::ZERO; 24 * count.div_ceil(LANES)];
    Stage::new(3, "poses").whole().fill_normal(Isa::baseline(), &mut noise);
    let pose = |i: usize| {
        let z = |j: usize| spread * noise[i / LANES * 24 + j].0[i % LANES];
        (0..24)
            .map(
                |j| if j == 2 { hppf24::STANDING_HEIGHT_M + 0.2 * z(j) } else { if j < 2 { 0.3 * z(j) } else { z(j) } },
            )
            .collect()
    };
    (0..count).map(pose).collect()
}

fn silhouettes(state: &[f64]) -> Vec<Option<BitImage>> {
    let body = Arc::new(SolidBody::new(&hppf24::tree(1.0), &hppf24::flesh(1.0)).expect("ten solids"));
    let isa = Isa::baseline();
    let model = ImageModel { body, cameras: cameras(), score: ImageScore::Parts, colours: Arc::default(), isa };
    model.silhouettes(state).into_iter().map(Some).collect()
}

fn bound(isa: Isa) -> SoftSilhouette {
    let model = SoftSilhouetteModel::new(&hppf24::tree(1.0), &hppf24::flesh(1.0), cameras(), 2.0, isa);
    model.expect("new names").bind(&silhouettes(&poses(1, 0.0)[0]))
}

#[test]
fn gradients_match_differences() {
    let bound = bound(Isa::best());
    let (mut outside, mut judged) = (0, 0);
    for state in poses(20, 0.5) {
        let mut grad = vec![0.0; 24];
        let value = bound.log_density_grad(&state, &mut grad);
        assert_eq!(value, bound.log_density(&state));
        outside += usize::from(value < -1.0);
        let largest = grad.iter().fold(1.0_f64, |a, g| a.max(g.abs()));
        for j in 0..24 {
            let at = |h: f64| {
                let mut moved = state.clone();
                moved[j] += h;
                bound.log_density(&moved)
            };
            let difference = (at(1e-7) - at(-1e-7)) / 2e-7;
            // Between pixels the slope jumps: a step that crosses a border is not judged.
            let halves = [(at(1e-7) - at(0.0)) / 1e-7, (at(0.0) - at(-1e-7)) / 1e-7];
            if (halves[0] - halves[1]).abs() < 1e-5 * largest {
                judged += 1;
                assert!((difference - grad[j]).abs() < 1e-5 * largest, "{j}: {difference} for {}", grad[j]);
            }
        }
    }
    assert!(outside > 10 && judged > 450, "{outside} of 20 poses stick out, {judged} of 480 derivatives judged");
}

#[test]
fn blocks_and_instruction_sets_agree() {
    let states = poses(LANES, 0.4);
    let block: Vec<Block> = (0..24).map(|j| Block(core::array::from_fn(|lane| states[lane][j]))).collect();
    for isa in Isa::available() {
        let bound = bound(isa);
        let mut ws = vec![Block::ZERO; bound.workspace()];
        let mut grads = vec![Block::ZERO; 24];
        let values = bound.log_density_grad_block(&block, &mut grads, &mut ws);
        for (lane, state) in states.iter().enumerate() {
            let mut grad = vec![0.0; 24];
            let value = bound.log_density_grad(state, &mut grad);
            assert!((value - values.0[lane]).abs() < 1e-12 * value.abs().max(1.0));
            assert!(grad.iter().zip(&grads).all(|(g, b)| (g - b.0[lane]).abs() < 1e-9 * g.abs().max(1.0)));
        }
    }
}

/// The matrix is positive semi-definite, its diagonal is the one that is computed alone, and where all is inside it is zero.
#[test]
fn curvature_belongs_to_the_gradient() {
    let bound = bound(Isa::best());
    let mut ws = vec![Block::ZERO; bound.workspace()];
    let at = |state: &[f64]| -> Vec<Block> { state.iter().map(|&x| Block::splat(x)).collect() };
    for state in poses(6, 0.5) {
        let (mut matrix, mut diagonal) = (vec![Block::ZERO; 24 * 25 / 2], vec![Block::ZERO; 24]);
        bound.gauss_newton_block(&at(&state), &mut matrix, &mut ws);
        bound.gauss_newton_diagonal_block(&at(&state), &mut diagonal, &mut ws);
        let entry = |i: usize, j: usize| matrix[triangle(i.max(j), i.min(j))].0[2];
        assert!((0..24).all(|j| (entry(j, j) - diagonal[j].0[2]).abs() < 1e-9 * entry(j, j).max(1.0)));
        for direction in poses(4, 1.0) {
            let form: f64 = (0..24)
                .flat_map(|i| (0..24).map(move |j| (i, j)))
                .map(|(i, j)| direction[i] * entry(i, j) * direction[j])
                .sum();
            assert!(form > -1e-6, "{form}");
        }
    }
    let mut slim = hppf24::flesh(1.0).solids().to_vec();
    slim.iter_mut().for_each(|solid| solid.frustum.radii = [0.01; 2]);
    let flesh = sinew_body::flesh::Flesh::new(&hppf24::tree(1.0), slim).expect("valid");
    let model = SoftSilhouetteModel::new(&hppf24::tree(1.0), &flesh, cameras(), 2.0, Isa::best()).expect("new names");
    let state = poses(1, 0.0).remove(0);
    assert_eq!(model.bind(&silhouettes(&state)).log_density(&state), 0.0);
}

#[test]
fn limbs_outside_are_reported_and_nothing_breaks_behind_cameras() {
    let bound = bound(Isa::best());
    let state = poses(1, 0.0).remove(0);
    let mut arm_up = state.clone();
    arm_up[9] = 1.5;
    assert!(bound.log_density(&arm_up) < bound.log_density(&state) - 5.0);
    let mut gone = state.clone();
    (gone[0], gone[1]) = (40.0, 3.0);
    let mut grad = vec![0.0; 24];
    let value = bound.log_density_grad(&gone, &mut grad);
    assert!(value.is_finite() && value < -100.0 && grad.iter().all(|g| g.is_finite()));
    let model = SoftSilhouetteModel::new(&hppf24::tree(1.0), &hppf24::flesh(1.0), cameras(), 2.0, Isa::best());
    let nobody = vec![None, Some(BitImage::new(160, 120)), None];
    assert_eq!(model.expect("new names").bind(&nobody).log_density(&gone), 0.0);
}
