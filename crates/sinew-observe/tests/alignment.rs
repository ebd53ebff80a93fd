//! The global alignment likelihood against sets of pixels.

use sinew_body::hppf24;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_observe::silhouettes::alignment::{Aligned, SIGMA};
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::silhouettes::image_likelihood::{Cues, ImageLikelihood, ImageModel};
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_observe::silhouettes::solid_body::SolidBody;
use sinew_observe::{Camera, ObservationModel};
use std::sync::Arc;

const SIZE: [usize; 2] = [160, 120];

fn model(isa: Isa) -> ImageModel {
    let camera = |k: usize| {
        let angle = (0.25 + 0.5 * k as f64) * std::f64::consts::PI;
        let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 2.2];
        Camera::look_at(&format!("C{k}"), SIZE.map(|x| x as f64), 200.0, centre, [0.0, 0.0, 1.0]).expect("a view")
    };
    ImageModel {
        body: Arc::new(SolidBody::new(&hppf24::tree(1.0), &hppf24::flesh(1.0)).expect("ten solids")),
        cameras: (0..4).map(camera).collect(),
        score: ImageScore::Parts,
        colours: Arc::default(),
        isa,
    }
}

/// Bodies within `reach` metres of the middle of all views, turned and bent anyhow.
fn poses(blocks: usize, reach: f64, seed: u64) -> Vec<Vec<Block>> {
    let pose = |block: usize| {
        let mut x = vec![Block::ZERO; 24];
        Stage::new(seed, "poses").block(block as u32).fill_normal(Isa::baseline(), &mut x);
        for (j, x) in x.iter_mut().enumerate() {
            let (centre, sd) = match j {
                0 | 1 => (0.0, reach),
                2 => (hppf24::STANDING_HEIGHT_M, 0.3 * reach),
                3 => (0.0, 2.0),
                _ => (0.0, 0.4),
            };
            x.0 = x.0.map(|z| centre + sd * z);
        }
        x
    };
    (0..blocks).map(pose).collect()
}

fn state(x: &[Block], lane: usize) -> Vec<f64> {
    x.iter().map(|x| x.0[lane]).collect()
}

fn bind(model: &ImageModel, silhouettes: Vec<BitImage>) -> ImageLikelihood {
    let cues = |silhouette| Some(Cues { silhouette, edges: None, picture: None });
    model.bind(silhouettes.into_iter().map(cues).collect())
}

fn standing() -> Vec<f64> {
    let mut state = vec![0.0; 24];
    state[2] = hppf24::STANDING_HEIGHT_M;
    state
}

/// Both sets pixel by pixel in the box around the corners of all outlines; and where boxes lie of the image.
fn brute_force(model: &ImageModel, silhouettes: &[BitImage], state: &[f64]) -> Vec<(Aligned, &'static str)> {
    let bodies = model.silhouettes(state);
    let outlines = model.outlines(state);
    let count = |camera: usize| {
        let (body, silhouette) = (&bodies[camera], &silhouettes[camera]);
        let corners: Vec<[f64; 2]> = outlines[camera].iter().flat_map(|(_, corners)| corners.clone()).collect();
        let range = |k: usize| {
            let least = corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
            let most = corners.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max);
            [least - 0.25 * (most - least), most + 0.25 * (most - least)]
        };
        let (xs, ys) = (range(0), range(1));
        let mut out = Aligned::default();
        for x in 0..SIZE[0] {
            for y in 0..SIZE[1] {
                let [u, v] = [x, y].map(|k| k as f64 + 0.5);
                if u < xs[0] || u > xs[1] || v < ys[0] || v > ys[1] {
                    continue;
                }
                let (seen, covered) = (silhouette.get(x, y), body.get(x, y));
                out.both += u64::from(seen && covered);
                out.mismatch += u64::from(seen && !covered);
                out.either += u64::from(seen || covered);
            }
        }
        let [width, height] = SIZE.map(|size| size as f64);
        let place = if corners.is_empty() || xs[1] < 0.0 || ys[1] < 0.0 || xs[0] > width || ys[0] > height {
            "outside"
        } else if xs[0] < 0.0 || ys[0] < 0.0 || xs[1] > width || ys[1] > height {
            "cut"
        } else {
            "inside"
        };
        (out, place)
    };
    (0..silhouettes.len()).map(count).collect()
}

/// Pixel counts (K12): counts and values agree with sets of pixels, on every instruction set, also where boxes are cut or not in the image at all.
#[test]
fn alignment_is_what_sets_of_pixels_say() {
    let mut places = std::collections::BTreeMap::new();
    for isa in Isa::available() {
        let model = model(isa);
        // A body with holes and something beside it.
        let mut silhouettes = model.silhouettes(&standing());
        for silhouette in &mut silhouettes {
            let body = silhouette.clone();
            *silhouette = BitImage::from_fn(SIZE[0], SIZE[1], |x, y| {
                body.get(x, y) && (x * x + 3 * y) % 11 != 0 || (100..130).contains(&x) && (20..50).contains(&y)
            });
        }
        let bound = bind(&model, silhouettes.clone());
        for (reach, seed) in [(0.1, 1), (1.0, 2), (4.0, 3)] {
            for x in poses(12, reach, seed) {
                let found = bound.alignment_block(&x);
                let mut views: Vec<[Aligned; LANES]> = vec![];
                bound.aligned_block(&x, |camera, view| {
                    assert_eq!(camera, views.len());
                    views.push(*view);
                });
                for lane in 0..LANES {
                    let expected = brute_force(&model, &silhouettes, &state(&x, lane));
                    let (mut log, mut met) = (0.0, 0.0);
                    for (view, (expected, place)) in views.iter().zip(&expected) {
                        assert_eq!(view[lane], *expected, "{place}, reach {reach}, lane {lane}, {}", isa.name());
                        *places.entry(*place).or_insert(0) += 1;
                        log -= expected.ratio() / SIGMA;
                        met += f64::from(u8::from(expected.both > 0));
                    }
                    assert!((found.log_likelihood.0[lane] - log).abs() < 1e-12 && found.met.0[lane] == met);
                }
            }
        }
    }
    assert!(places.len() == 3 && places.values().all(|count| *count > 100), "{places:?}");
}

/// Alignment likelihood (K14): 0 for the right body, −4 a camera for one that is not in view of any.
#[test]
fn the_right_body_is_aligned_and_none_at_all_is_not() {
    let model = model(Isa::best());
    let bound = bind(&model, model.silhouettes(&standing()));
    let block = |state: &[f64]| state.iter().map(|&x| Block::splat(x)).collect::<Vec<_>>();
    let right = bound.alignment_block(&block(&standing()));
    assert_eq!((right.log_likelihood, right.met), (Block::ZERO, Block::splat(4.0)));
    // Behind one camera, and nearer than a few centimetres to none.
    let one = ImageModel { cameras: vec![model.cameras[0].clone()], ..model.clone() };
    let mut behind = standing();
    (behind[0], behind[1]) = (9.0, 9.0);
    let none = bind(&one, one.silhouettes(&standing())).alignment_block(&block(&behind));
    assert_eq!((none.log_likelihood, none.met), (Block::splat(-4.0), Block::ZERO));
    // Nothing seen and nothing there.
    let empty = bind(&one, vec![BitImage::new(SIZE[0], SIZE[1])]).alignment_block(&block(&behind));
    assert_eq!(empty.log_likelihood, Block::splat(-4.0));
}

/// K14b: the flaw. A body away from all foreground has the largest value, and says that it meets nothing.
#[test]
fn a_body_away_from_all_foreground_has_the_largest_value() {
    let model = model(Isa::best());
    let corner = BitImage::from_fn(SIZE[0], SIZE[1], |x, y| x < 8 && y < 8);
    let bound = bind(&model, vec![corner; 4]);
    let x: Vec<Block> = standing().iter().map(|&x| Block::splat(x)).collect();
    let away = bound.alignment_block(&x);
    assert_eq!((away.log_likelihood, away.met), (Block::ZERO, Block::ZERO));
    // A camera without a silhouette says nothing.
    let unseen = model.bind(vec![None; 4]).alignment_block(&x);
    assert_eq!((unseen.log_likelihood, unseen.met), (Block::ZERO, Block::ZERO));
}
