//! Colours tell poses apart that silhouettes do not: folded arms that are exchanged, or elsewhere on the trunk.
//!
//! A simulated person with one bare forearm stands before four cameras, first with hanging arms, from which colours are learned, then with folded arms. Compared are the true pose and wrong ones: differences of the logarithm of the
//! product over parts, means over the frames.

use sinew::body::{KinematicTree, hppf24};
use sinew::core::density::LogDensity;
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::Stage;
use sinew::observe::silhouettes::colour_histogram::Counts;
use sinew::observe::silhouettes::girth::{Sight, before_cameras, intersection_over_union, mask_overlap};
use sinew::observe::silhouettes::image_likelihood::{Cues, ImageModel};
use sinew::observe::{ObservationModel, RgbImage};
use sinew_body::points::points_of_states;
use sinew_simulate::evaluation_body::{ConvexShape, Material, MaterialSolid};
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::render::RayCamera;
use sinew_simulate::ring::Ring;
use std::sync::Arc;

/// Frames with hanging arms, then as many with folded ones.
const FRAMES: usize = 4;
const SEEDS: u64 = 5;
/// Least intersection over union of the silhouettes of two poses that are called equal.
const EQUAL: f64 = 0.95;
/// First coordinate of each arm of HPPF24; four follow: flexion, abduction, twist, hinge.
const LEFT_ARM: usize = 8;
const RIGHT_ARM: usize = 12;

/// A person with one bare forearm.
struct Dressed {
    tree: KinematicTree,
    footage: SyntheticFootage,
    states: Vec<Vec<f64>>,
    seed: u64,
}

impl Dressed {
    fn new(seed: u64) -> Self {
        let tree = hppf24::tree(1.0);
        let states: Vec<Vec<f64>> = (0..2 * FRAMES).map(|frame| state(frame, seed)).collect();
        let motion = points_of_states(&tree, &states);
        let footage = SyntheticFootage::new(motion, 6.0, &Ring::SMALL_PICTURES, seed).expect("a ring");
        Self { tree, footage, states, seed }
    }

    /// What the person is made of, with a bare forearm on the left.
    fn solids(&self, frame: usize) -> Vec<MaterialSolid> {
        let motion = &self.footage.motion;
        let [elbow, wrist] =
            ["LElbow", "LWrist"].map(|name| motion.frames[frame][motion.index(name).expect("a joint")]);
        let mut solids = self.footage.body.solids(frame);
        for solid in &mut solids {
            if matches!(solid.shape, ConvexShape::Capsule { ends: [a, b], .. } if is_between(a, elbow, wrist) && is_between(b, elbow, wrist))
            {
                solid.material = Material::Skin;
            }
        }
        solids
    }

    fn picture(&self, camera: usize, frame: usize) -> RgbImage {
        let view = RayCamera::new(&self.footage.cameras[camera]);
        let stage = Stage::new(self.seed, "sensor").round(camera).at_frame(frame as u32);
        view.picture(&self.solids(frame), &view.room(self.seed), &stage)
    }

    fn cues(&self, frame: usize) -> Vec<Option<Cues>> {
        let cues = |camera| Cues {
            silhouette: self.footage.silhouette(camera, frame),
            edges: None,
            picture: Some(self.picture(camera, frame)),
        };
        (0..self.footage.cameras.len()).map(|camera| Some(cues(camera))).collect()
    }

    /// The body, without colours and with the colours seen with hanging arms.
    fn models(&self) -> [ImageModel; 2] {
        let plain = before_cameras(&self.tree, &hppf24::flesh(1.0), &self.footage.cameras).expect("a body");
        let references = |camera| {
            let mut counts = vec![Counts::default(); plain.body.count()];
            for (frame, state) in self.states.iter().enumerate().take(FRAMES) {
                let seen = plain.colours_of(camera, state, &self.picture(camera, frame));
                counts.iter_mut().zip(&seen).for_each(|(counts, seen)| counts.merge(seen));
            }
            counts.iter().map(Counts::reference).collect()
        };
        let colours = Arc::new((0..self.footage.cameras.len()).map(references).collect());
        [plain.clone(), ImageModel { colours, ..plain }]
    }

    /// By how much the true pose is better than a wrong one, without and with colours, and how equal the silhouettes of the two are: means over the frames with folded arms.
    fn advantage(&self, wrong: fn(&mut [f64])) -> ([f64; 2], f64) {
        let models = self.models();
        let frames = FRAMES..2 * FRAMES;
        let mean = |value: &dyn Fn(usize) -> f64| frames.clone().map(value).sum::<f64>() / FRAMES as f64;
        let other = |frame: usize| {
            let mut state = self.states[frame].clone();
            wrong(&mut state);
            state
        };
        let advantage = models.each_ref().map(|model| {
            mean(&|frame| {
                let bound = model.bind(self.cues(frame));
                bound.log_density(&self.states[frame]) - bound.log_density(&other(frame))
            })
        });
        let equality = mean(&|frame| {
            let silhouettes = models[0].silhouettes(&self.states[frame]).into_iter().map(Some).collect();
            intersection_over_union(mask_overlap(&models[0], &Sight { state: other(frame), silhouettes }))
        });
        (advantage, equality)
    }
}

/// Whether a point lies between two others, within a millimetre.
fn is_between(point: [f64; 3], from: [f64; 3], to: [f64; 3]) -> bool {
    let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    distance(from, point) + distance(point, to) < distance(from, to) + 0.001
}

/// Someone who stands, with hanging and later with folded arms, and never quite still.
fn state(frame: usize, seed: u64) -> Vec<f64> {
    let mut draws = [Block::ZERO; 24];
    Stage::new(seed, "stance").at_frame(frame as u32).whole().fill_normal(Isa::baseline(), &mut draws);
    let mut state: Vec<f64> = draws.iter().map(|draw| 0.03 * draw.0[0]).collect();
    state[2] += hppf24::STANDING_HEIGHT_M;
    let arms = if frame < FRAMES { [[0.1, 0.0, 0.3]; 2] } else { [[0.25, 1.2, 1.3], [0.45, 1.2, 1.8]] };
    for (first, sign, [flexion, twist, hinge]) in [(LEFT_ARM, -1.0, arms[0]), (RIGHT_ARM, 1.0, arms[1])] {
        let away = if frame < FRAMES { -0.3 * sign } else { 0.0 };
        state[first..first + 4].iter_mut().zip([flexion, away, sign * twist, hinge]).for_each(|(x, add)| *x += add);
    }
    state
}

/// Each arm is where the other one is, mirrored.
fn arms_exchanged(state: &mut [f64]) {
    for (angle, mirrored) in [1.0, -1.0, -1.0, 1.0].into_iter().enumerate() {
        let [left, right] = [state[LEFT_ARM + angle], state[RIGHT_ARM + angle]];
        state[LEFT_ARM + angle] = mirrored * right;
        state[RIGHT_ARM + angle] = mirrored * left;
    }
}

/// The bare forearm lies higher on the trunk.
fn arm_raised(state: &mut [f64]) {
    state[LEFT_ARM + 3] += 0.5;
}

/// In every seed the true pose is better with colours, and by more than without.
#[test]
fn colours_tell_folded_arms_apart() {
    for (name, wrong) in [("exchanged", arms_exchanged as fn(&mut [f64])), ("raised", arm_raised)] {
        for seed in 1..=SEEDS {
            let ([plain, coloured], equality) = Dressed::new(seed).advantage(wrong);
            println!("{name}, seed {seed}: {plain:.3} without colours, {coloured:.3} with, silhouettes {equality:.3}");
            assert!(equality > EQUAL, "{name}, seed {seed}: the silhouettes are not equal: {equality}");
            assert!(
                coloured > 0.0 && coloured > plain,
                "{name}, seed {seed}: {coloured} with colours, {plain} without"
            );
        }
    }
}
