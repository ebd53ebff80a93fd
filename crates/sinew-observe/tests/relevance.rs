//! How much of a part is seen, by which the part likelihood counts it (K13).

use sinew_body::flesh::Flesh;
use sinew_body::hppf24;
use sinew_core::density::PartLogDensity;
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::silhouettes::image_likelihood::{Cues, ImageModel};
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_observe::silhouettes::solid_body::SolidBody;
use sinew_observe::{Camera, ObservationModel};
use std::sync::Arc;

const SIZE: [usize; 2] = [320, 240];

/// The solids of these numbers before a camera on the right, at the height of the elbows.
fn model(solids: &[usize]) -> ImageModel {
    let (tree, flesh) = (hppf24::tree(1.0), hppf24::flesh(1.0));
    let kept = solids.iter().map(|&solid| flesh.solids()[solid].clone()).collect();
    let body = SolidBody::new(&tree, &Flesh::new(&tree, kept).expect("solids of the tree")).expect("few");
    let size = SIZE.map(|x| x as f64);
    let camera = Camera::look_at("right", size, 330.0, [4.0, 0.0, 1.0], [0.0, 0.0, 1.0]).expect("a view");
    let (score, isa) = (ImageScore::Parts, Isa::best());
    ImageModel { body: Arc::new(body), cameras: vec![camera], score, colours: Arc::default(), isa }
}

/// Of an empty silhouette nothing matches: log λ = R log 0.001, and R is what is left.
fn relevances(model: &ImageModel, x: &[Block]) -> Vec<[f64; 8]> {
    let cues = Cues { silhouette: BitImage::new(SIZE[0], SIZE[1]), edges: None, picture: None };
    let bound = model.bind(vec![Some(cues)]);
    let all: Vec<usize> = (0..bound.parts()).collect();
    let mut out = vec![Block::ZERO; all.len()];
    bound.log_density_parts_block(&all, x, &mut out, &mut []);
    out.iter().map(|value| value.0.map(|log| log / 1e-3_f64.ln())).collect()
}

fn standing() -> Vec<Block> {
    (0..24).map(|j| Block::splat(if j == 2 { hppf24::STANDING_HEIGHT_M } else { 0.0 })).collect()
}

#[test]
fn a_part_alone_is_seen_in_full() {
    for solid in 0..10 {
        assert_eq!(relevances(&model(&[solid]), &standing()), [[1.0; 8]], "solid {solid}");
    }
}

#[test]
fn a_part_behind_others_says_nothing() {
    let model = model(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
    let found = relevances(&model, &standing());
    // The left forearm stands behind trunk and right forearm.
    assert_eq!((found[3], found[5]), ([0.0; 8], [1.0; 8]));
    let cues = Cues { silhouette: BitImage::new(SIZE[0], SIZE[1]), edges: None, picture: None };
    let mut log = [Block::splat(9.0)];
    model.bind(vec![Some(cues)]).log_density_parts_block(&[3], &standing(), &mut log, &mut []);
    assert_eq!(log[0], Block::ZERO, "its likelihood is 1");
}

#[test]
fn relevances_are_shares() {
    let model = model(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
    for block in 0..40 {
        let mut x = vec![Block::ZERO; 24];
        Stage::new(1, "poses").block(block).fill_normal(Isa::baseline(), &mut x);
        for (j, x) in x.iter_mut().enumerate() {
            let (centre, sd) = if j == 2 { (hppf24::STANDING_HEIGHT_M, 0.2) } else { (0.0, 0.7) };
            x.0 = x.0.map(|z| centre + sd * z);
        }
        for share in relevances(&model, &x).into_iter().flatten() {
            assert!((0.0..=1.0 + 1e-12).contains(&share), "{share}");
        }
    }
}
