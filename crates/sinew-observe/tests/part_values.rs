//! What the value of one solid says of its place on a silhouette.
//!
//! It is why partitioned sampling does not choose parts of silhouettes by it.

use sinew_body::standard::h32;
use sinew_body::standard_flesh::standard_flesh;
use sinew_body::{KinematicTree, Proportions};
use sinew_core::density::{LogDensity, PartLogDensity};
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_observe::silhouettes::contour_map::contour_map;
use sinew_observe::silhouettes::image_likelihood::{Cues, ImageLikelihood, ImageModel};
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_observe::silhouettes::solid_body::SolidBody;
use sinew_observe::{Camera, ObservationModel};
use std::sync::Arc;

const BOTH: ImageScore = ImageScore::DeutscherReid { kappa: 100.0, bidirectional: Some(0.5) };
const STATES: usize = 512;

fn standing(tree: &KinematicTree) -> Vec<f64> {
    let mut state = vec![0.0; tree.dof()];
    state[2] = 1.0;
    state
}

/// Four cameras before a body, and the silhouettes that it has there.
fn seen(score: ImageScore) -> (ImageLikelihood, Vec<Vec<usize>>, Vec<f64>) {
    let tree = h32(&Proportions::default());
    let flesh = standard_flesh(&tree).unwrap();
    let camera = |k: usize| {
        let angle = (0.25 + 0.5 * k as f64) * std::f64::consts::PI;
        let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 2.2];
        Camera::look_at(&format!("C{k}"), [320.0, 240.0], 330.0, centre, [0.0, 0.0, 1.0]).unwrap()
    };
    let body = Arc::new(SolidBody::new(&tree, &flesh).unwrap());
    let cameras = (0..4).map(camera).collect();
    let model = ImageModel { body, cameras, score, colours: Arc::default(), isa: Isa::best() };
    let state = standing(&tree);
    let cues = |silhouette| Some(Cues { edges: Some(contour_map(&silhouette)), silhouette, picture: None });
    let bound = model.bind(model.silhouettes(&state).into_iter().map(cues).collect());
    (bound, flesh.coordinates(&tree), state)
}

/// Values of one part and of the whole where that part alone has moved by half of a fast step of a walker, over those where nothing has.
fn moved(score: ImageScore, part: usize) -> [Vec<f64>; 2] {
    let (bound, coordinates, state) = seen(score);
    let values = |x: &[Block]| {
        let mut alone = [Block::ZERO];
        bound.log_density_parts_block(&[part], x, &mut alone, &mut []);
        [alone[0].0, bound.log_density_block(x, &mut []).0]
    };
    let unmoved: Vec<Block> = state.iter().map(|&x| Block::splat(x)).collect();
    let at_rest = values(&unmoved).map(|value| value[0]);
    let mut out = [vec![], vec![]];
    for block in 0..STATES / 8 {
        let mut x = unmoved.clone();
        let mut noise = vec![Block::ZERO; coordinates[part].len()];
        Stage::new(1, "part values").block(block as u32).fill_normal(Isa::best(), &mut noise);
        for (&j, noise) in coordinates[part].iter().zip(&noise) {
            let sd = if j < 3 { 0.02 } else { 0.06 };
            x[j].0.iter_mut().zip(noise.0).for_each(|(x, z)| *x += sd * z);
        }
        for ((out, values), at_rest) in out.iter_mut().zip(values(&x)).zip(at_rest) {
            out.extend(values.map(|value| value - at_rest));
        }
    }
    out
}

/// The share of states that survive a choice by these values.
fn surviving(log: &[f64]) -> f64 {
    let (sum, squares) = log.iter().map(|l| l.exp()).fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
    sum * sum / squares / log.len() as f64
}

/// By edges and region of its own, a pelvis is better than at its right place by more than 10 nats at some other place near by, though nowhere the whole body is: between trunk and thighs it has no contour.
#[test]
fn a_trunk_alone_is_best_at_a_wrong_place() {
    let [alone, whole] = moved(BOTH, 0).map(|values| values.into_iter().fold(f64::NEG_INFINITY, f64::max));
    println!("pelvis alone {alone:.1}, whole body {whole:.1}");
    assert!(alone > 10.0 && whole <= 0.0, "{alone} and {whole}");
}

/// The product over parts distinguishes hardly any places: of states in which one limb has moved more than two thirds survive it.
#[test]
fn the_product_over_parts_is_flat() {
    for part in 3..11 {
        let [product, whole] = [surviving(&moved(ImageScore::Parts, part)[0]), surviving(&moved(BOTH, part)[1])];
        println!("part {part}: {product:.2} survive the product over parts, {whole:.2} the whole silhouette");
        assert!(product > 0.67, "part {part}: {product}");
        assert!(whole < product, "part {part}: {whole}");
    }
}
