//! Colours tell poses apart that silhouettes hardly do: arms laid on the trunk, legs that are exchanged.
//!
//! A simulated walker with bare forearms and two colours of trouser legs, before four cameras. Colours are learned from the first second, in poses that are known, and looked for in the next. All numbers are differences of the logarithm
//! of the product over parts between the true pose and a wrong one, means over the frames.

use sinew::body::{KinematicTree, hppf24};
use sinew::core::density::LogDensity;
use sinew::core::random::Stage;
use sinew::observe::colour_histogram::Counts;
use sinew::observe::girth::before_cameras;
use sinew::observe::image_likelihood::{Cues, ImageModel};
use sinew::observe::{ObservationModel, RgbImage};
use sinew_motion::hppf24_motion::{MotionFollowing, states};
use sinew_motion::points::points_of_states;
use sinew_simulate::evaluation_body::{ConvexShape, Material, MaterialSolid};
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::render::RayCamera;
use sinew_simulate::ring::Ring;
use sinew_simulate::walker::{Gait, Walker, walker_states};
use std::sync::Arc;

/// Frames a second; those of the first second give the colours.
const RATE: usize = 6;
const SEEDS: u64 = 5;
/// First coordinate of each limb of HPPF24; four follow: flexion, abduction, twist, hinge.
const LEFT_ARM: usize = 8;
const RIGHT_ARM: usize = 12;
const LEFT_LEG: usize = 16;
const RIGHT_LEG: usize = 20;

/// A person whose clothes tell left from right and arms from trunk.
struct Dressed {
    tree: KinematicTree,
    footage: SyntheticFootage,
    states: Vec<Vec<f64>>,
    seed: u64,
}

impl Dressed {
    fn new(seed: u64) -> Self {
        let walker = Walker::new(Gait { still_s: 0.0, duration_s: 2.0, ..Gait::default() });
        let points = points_of_states(&walker.body, &walker_states(&walker, RATE as f64));
        let tree = hppf24::tree(1.0);
        let states = states(&tree, &points, &MotionFollowing::default()).expect("hips");
        let footage = SyntheticFootage::new(points, RATE as f64, &Ring::SMALL_PICTURES, seed).expect("a ring");
        Self { tree, footage, states, seed }
    }

    fn solids(&self, frame: usize) -> Vec<MaterialSolid> {
        let motion = &self.footage.motion;
        let is_on = |solid: &MaterialSolid, [from, to]: [&str; 2]| {
            let [from, to] = [from, to].map(|name| motion.frames[frame][motion.index(name).expect("a joint")]);
            matches!(solid.shape, ConvexShape::Capsule { ends, .. } if is_between(middle(ends), from, to))
        };
        let mut solids = self.footage.body.solids(frame);
        for solid in &mut solids {
            if [["LElbow", "LWrist"], ["RElbow", "RWrist"]].into_iter().any(|arm| is_on(solid, arm)) {
                solid.material = Material::Skin;
            }
            if [["LHip", "LKnee"], ["LKnee", "LAnkle"]].into_iter().any(|leg| is_on(solid, leg)) {
                solid.material = Material::Shirt;
            }
        }
        solids
    }

    fn picture(&self, camera: usize, frame: usize) -> RgbImage {
        let view = RayCamera::new(&self.footage.cameras[camera]);
        view.picture(&self.solids(frame), &view.room(self.seed), &Stage::new(self.seed, "sensor").round(camera))
    }

    fn cues(&self, frame: usize) -> Vec<Option<Cues>> {
        let cue = |camera| Cues {
            silhouette: self.footage.silhouette(camera, frame),
            edges: None,
            picture: Some(self.picture(camera, frame)),
        };
        (0..self.footage.cameras.len()).map(|camera| Some(cue(camera))).collect()
    }

    /// The body, without colours and with those of the first second.
    fn models(&self) -> [ImageModel; 2] {
        let plain = before_cameras(&self.tree, &hppf24::flesh(1.0), &self.footage.cameras).expect("a body");
        let references = |camera| {
            let mut counts = vec![Counts::default(); plain.body.count()];
            for (frame, state) in self.states.iter().enumerate().take(RATE) {
                let seen = plain.colours_of(camera, state, &self.picture(camera, frame));
                counts.iter_mut().zip(&seen).for_each(|(counts, seen)| counts.merge(seen));
            }
            counts.iter().map(Counts::reference).collect()
        };
        let colours = Arc::new((0..self.footage.cameras.len()).map(references).collect());
        [plain.clone(), ImageModel { colours, ..plain }]
    }

    /// By how much the true pose is better than a wrong one, without and with colours: means over the second second.
    fn advantage(&self, wrong: fn(&mut [f64])) -> [f64; 2] {
        self.models().map(|model| {
            let of_frame = |frame: usize| {
                let bound = model.bind(self.cues(frame));
                let mut other = self.states[frame].clone();
                wrong(&mut other);
                bound.log_density(&self.states[frame]) - bound.log_density(&other)
            };
            (RATE..2 * RATE).map(of_frame).sum::<f64>() / RATE as f64
        })
    }
}

fn middle([a, b]: [[f64; 3]; 2]) -> [f64; 3] {
    [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]))
}

/// Whether a point lies between two others, within two centimetres.
fn is_between(point: [f64; 3], from: [f64; 3], to: [f64; 3]) -> bool {
    let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    distance(from, point) + distance(point, to) < distance(from, to) + 0.02
}

/// Both forearms across the trunk, as high as the elbows.
fn arms_crossed(state: &mut [f64]) {
    let forward = state[LEFT_ARM + 3].signum();
    for (arm, inwards) in [(LEFT_ARM, -forward), (RIGHT_ARM, forward)] {
        state[arm..arm + 4].copy_from_slice(&[0.3 * forward, 0.0, 1.2 * inwards, 1.6 * forward]);
    }
}

/// Each leg stands as the other one, mirrored.
fn legs_exchanged(state: &mut [f64]) {
    for angle in 0..4 {
        let mirrored = if angle == 1 || angle == 2 { -1.0 } else { 1.0 };
        let [left, right] = [state[LEFT_LEG + angle], state[RIGHT_LEG + angle]];
        state[LEFT_LEG + angle] = mirrored * right;
        state[RIGHT_LEG + angle] = mirrored * left;
    }
}

#[test]
fn print_them() {
    for seed in 1..=SEEDS {
        let dressed = Dressed::new(seed);
        println!("{seed}: arms {:?}, legs {:?}", dressed.advantage(arms_crossed), dressed.advantage(legs_exchanged));
    }
}
