//! The body that silhouettes and pictures are made from: another one than any tracker's.
//!
//! It hangs on points in space, the walker's or recorded ones, without any fitting, and consists of tapered capsules (all spheres between two) and ellipsoids where the tracker has
//! truncated elliptical cones:
//!
//! 1. Fifteen joints ([`EVALUATION_JOINTS`]) are needed; big toes, heels and the nose are used where the motion has them. From them follow landmarks: two columns in the trunk, the base of the skull, knuckles, feet.
//! 2. Every segment is a chain of two to four capsules between stations, with the radius of a clothed adult at each; the trunk has two columns. Ellipsoids fill pelvis,
//!    belly, chest and head, and stand for jaw, hands, shoulders and hips.
//! 3. Radii are multiplied by the length of the legs over 0.85 m, and in each of 17 parts by a factor that is uniform in \[0.9, 1.15\] and fixed for the subject.
//! 4. Clothes move: the radius at a station is multiplied by 1 + 0.05 g. Along a chain g is a Gaussian process with correlation exp(−distance / 0.15 m), from frame to frame an
//!    autoregression with coefficient 0.9 that starts in its stationary state. Skin and hair do not move, nor do the ellipsoids below skin.
//!
//! The clothes of all frames are drawn when the body is made, so that any frame can be asked for alone.
//!
//! Limits: feet are rigid, hands do not grasp, and flesh does not bulge; where a joint is bent sharply, its capsules overlap.

use super::draws::{normals, uniforms};
use super::points::Trajectories;
use super::space::{Vector, across, along, between, cross, distance, minus, unit};
use crate::Error;
use crate::body::standard::EVALUATION_JOINTS;
use crate::core::random::Stage;

/// What a solid looks as if made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Bare skin.
    Skin,
    /// Hair.
    Hair,
    /// Upper garment.
    Shirt,
    /// Lower garment.
    Trousers,
    /// Shoes.
    Shoes,
}

impl Material {
    const fn is_cloth(self) -> bool {
        !matches!(self, Self::Skin | Self::Hair)
    }
}

/// A convex solid in the world, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// All spheres between two: centres and radii move linearly from one to the other.
    Capsule {
        /// Centres of the two spheres.
        ends: [[f64; 3]; 2],
        /// Their radii.
        radii: [f64; 2],
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Centre.
        centre: [f64; 3],
        /// Half axes, at right angles to each other.
        half_axes: [[f64; 3]; 3],
    },
}

/// A solid and what it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Where it is.
    pub shape: Shape,
    /// What it is made of.
    pub material: Material,
}

const MID_HIP: usize = 0;
const NECK: usize = 1;
const SHOULDERS: usize = 2;
const ELBOWS: usize = 4;
const WRISTS: usize = 6;
const HIPS: usize = 8;
const KNEES: usize = 10;
const ANKLES: usize = 12;
const HEAD: usize = 14;
const KNUCKLES: usize = 15;
const HEELS: usize = 17;
const BALLS: usize = 19;
const TIPS: usize = 21;
const LOINS: usize = 23;
const RIBS: usize = 25;
const SKULL: usize = 27;
/// Top of the trunk: recorded neck joints lie at very different heights, shoulders do not.
const COLLAR: usize = 28;
const LANDMARKS: usize = 29;

/// Points that are used where the motion has them: toes, heels, nose.
const EXTRA: [&str; 5] = ["LBigToe", "RBigToe", "LHeel", "RHeel", "Nose"];

/// Parts with a factor of their own; those of limbs are followed by the right one.
const TRUNK: usize = 0;
const GIRDLE: usize = 1;
const SEAT: usize = 2;
const THROAT: usize = 3;
const CRANIUM: usize = 4;
const UPPER_ARM: usize = 5;
const FOREARM: usize = 7;
const HAND: usize = 9;
const THIGH: usize = 11;
const SHIN: usize = 13;
const FOOT: usize = 15;
const PARTS: usize = 17;

/// Least and greatest factor of a part.
const GIRTH: [f64; 2] = [0.9, 1.15];
/// Standard deviation of a clothed radius over the radius.
pub const CLOTH_SD: f64 = 0.05;
/// Correlation length of clothes along a segment, metres.
pub const CLOTH_LENGTH_M: f64 = 0.15;
/// Correlation of clothes in successive frames.
pub const CLOTH_PERSISTENCE: f64 = 0.9;
/// Length of thigh and shin of the adult whose radii stand here, metres.
const LEG_M: f64 = 0.85;

/// A chain of capsules between two landmarks: stations with their fraction of the way and their radius in metres.
struct Chain {
    ends: [usize; 2],
    part: usize,
    material: Material,
    stations: &'static [[f64; 2]],
}

const UPPER_ARM_RADII: &[[f64; 2]] = &[[0.0, 0.056], [0.4, 0.050], [0.75, 0.043], [1.0, 0.040]];
const FOREARM_RADII: &[[f64; 2]] = &[[0.0, 0.041], [0.3, 0.043], [0.7, 0.034], [1.0, 0.028]];
const HAND_RADII: &[[f64; 2]] = &[[0.0, 0.026], [0.5, 0.027], [1.0, 0.022]];
const THIGH_RADII: &[[f64; 2]] = &[[0.0, 0.084], [0.3, 0.081], [0.7, 0.066], [1.0, 0.055]];
const SHIN_RADII: &[[f64; 2]] = &[[0.0, 0.053], [0.25, 0.057], [0.7, 0.043], [1.0, 0.037]];
const REAR_FOOT_RADII: &[[f64; 2]] = &[[0.0, 0.038], [0.5, 0.041], [1.0, 0.036]];
const FORE_FOOT_RADII: &[[f64; 2]] = &[[0.0, 0.038], [0.5, 0.033], [1.0, 0.025]];
const COLUMN_RADII: &[[f64; 2]] = &[[0.0, 0.098], [0.35, 0.090], [0.7, 0.096], [1.0, 0.086]];
const COLLAR_RADII: &[[f64; 2]] = &[[0.0, 0.056], [0.5, 0.060], [1.0, 0.058]];
const NECK_RADII: &[[f64; 2]] = &[[0.0, 0.062], [0.5, 0.055], [1.0, 0.056]];

const fn chain(ends: [usize; 2], part: usize, material: Material, stations: &'static [[f64; 2]]) -> Chain {
    Chain { ends, part, material, stations }
}

const CHAINS: [Chain; 19] = [
    chain([SHOULDERS, ELBOWS], UPPER_ARM, Material::Shirt, UPPER_ARM_RADII),
    chain([SHOULDERS + 1, ELBOWS + 1], UPPER_ARM + 1, Material::Shirt, UPPER_ARM_RADII),
    chain([ELBOWS, WRISTS], FOREARM, Material::Shirt, FOREARM_RADII),
    chain([ELBOWS + 1, WRISTS + 1], FOREARM + 1, Material::Shirt, FOREARM_RADII),
    chain([WRISTS, KNUCKLES], HAND, Material::Skin, HAND_RADII),
    chain([WRISTS + 1, KNUCKLES + 1], HAND + 1, Material::Skin, HAND_RADII),
    chain([HIPS, KNEES], THIGH, Material::Trousers, THIGH_RADII),
    chain([HIPS + 1, KNEES + 1], THIGH + 1, Material::Trousers, THIGH_RADII),
    chain([KNEES, ANKLES], SHIN, Material::Trousers, SHIN_RADII),
    chain([KNEES + 1, ANKLES + 1], SHIN + 1, Material::Trousers, SHIN_RADII),
    chain([HEELS, BALLS], FOOT, Material::Shoes, REAR_FOOT_RADII),
    chain([HEELS + 1, BALLS + 1], FOOT + 1, Material::Shoes, REAR_FOOT_RADII),
    chain([BALLS, TIPS], FOOT, Material::Shoes, FORE_FOOT_RADII),
    chain([BALLS + 1, TIPS + 1], FOOT + 1, Material::Shoes, FORE_FOOT_RADII),
    chain([LOINS, RIBS], TRUNK, Material::Shirt, COLUMN_RADII),
    chain([LOINS + 1, RIBS + 1], TRUNK, Material::Shirt, COLUMN_RADII),
    chain([COLLAR, SHOULDERS], GIRDLE, Material::Shirt, COLLAR_RADII),
    chain([COLLAR, SHOULDERS + 1], GIRDLE, Material::Shirt, COLLAR_RADII),
    chain([COLLAR, SKULL], THROAT, Material::Skin, NECK_RADII),
];

/// Ellipsoids of cloth: pelvis, belly, chest, shoulders, hips.
const CLOTH_BLOBS: usize = 7;

/// A person in a motion, of other proportions than a tracker's body, in clothes that move.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluationBody {
    /// Joints of every frame, in the order of [`EVALUATION_JOINTS`].
    joints: Vec<[Vector; EVALUATION_JOINTS.len()]>,
    /// Extra points of every frame.
    extra: Vec<[Option<Vector>; EXTRA.len()]>,
    /// Size over that of the adult of the tables.
    stature: f64,
    /// Factors of the parts, stature included.
    girth: [f64; PARTS],
    /// g of every station of the chains and then of every ellipsoid of cloth, frame by frame.
    clothes: Vec<Vec<f64>>,
}

impl EvaluationBody {
    /// Dresses a motion; the stage tells the subject's parts and clothes.
    ///
    /// # Errors
    /// [`Error::Input`] where one of the fifteen joints is missing, or a coordinate is no number.
    pub fn new(motion: &Trajectories, stage: Stage) -> Result<Self, Error> {
        let columns = EVALUATION_JOINTS.map(|name| motion.index(name));
        let missing: Vec<&str> =
            EVALUATION_JOINTS.into_iter().zip(columns).filter(|(_, k)| k.is_none()).map(|(name, _)| name).collect();
        if !missing.is_empty() {
            return Err(Error::Input {
                message: format!("the motion has no {}", missing.join(", ")),
                help: Some(format!("a body needs the points {}", EVALUATION_JOINTS.join(", "))),
            });
        }
        if !motion.frames.iter().flatten().flatten().all(|x| x.is_finite()) {
            return Err(Error::Input { message: "a coordinate of the motion is not finite".into(), help: None });
        }
        let columns = columns.map(Option::unwrap_or_default);
        let extra = EXTRA.map(|name| motion.index(name));
        let joints: Vec<_> = motion.frames.iter().map(|frame| columns.map(|k| frame[k])).collect();
        let extra = motion.frames.iter().map(|frame| extra.map(|k| k.map(|k| frame[k]))).collect();
        let [girth_stage, cloth_stage] = stage.split(["girth", "clothes"]);
        let stature = stature(&joints);
        let factors = uniforms(&girth_stage, 0, PARTS);
        let girth = std::array::from_fn(|part| stature * (GIRTH[0] + factors[part] * (GIRTH[1] - GIRTH[0])));
        let mut body = Self { joints, extra, stature, girth, clothes: Vec::new() };
        body.clothes = body.drawn_clothes(&cloth_stage);
        Ok(body)
    }

    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.joints.len()
    }

    /// Where the subject stands in a frame, below the middle of the hips, on the ground; `None` beyond the last frame.
    #[must_use]
    pub fn foothold(&self, frame: usize) -> Option<[f64; 2]> {
        let [x, y, _] = self.joints.get(frame)?[MID_HIP];
        Some([x, y])
    }

    /// The solids of a frame; none beyond the last.
    #[must_use]
    pub fn solids(&self, frame: usize) -> Vec<Solid> {
        let (Some(joints), Some(clothes)) = (self.joints.get(frame), self.clothes.get(frame)) else {
            return Vec::new();
        };
        let pose = Pose::new(joints, &self.extra[frame], self.stature);
        let mut clothes = clothes.iter().map(|g| 1.0 + CLOTH_SD * g);
        let mut solids = Vec::with_capacity(80);
        for chain in &CHAINS {
            let [from, to] = chain.ends.map(|end| pose.landmarks[end]);
            let spheres: Vec<(Vector, f64)> = chain
                .stations
                .iter()
                .map(|[fraction, radius]| {
                    let moved = clothes.next().filter(|_| chain.material.is_cloth()).unwrap_or(1.0);
                    (between(from, to, *fraction), self.girth[chain.part] * radius * moved)
                })
                .collect();
            solids.extend(spheres.windows(2).map(|pair| Solid {
                shape: Shape::Capsule { ends: [pair[0].0, pair[1].0], radii: [pair[0].1, pair[1].1] },
                material: chain.material,
            }));
        }
        let cloth: Vec<f64> = clothes.collect();
        solids.extend(self.blobs(&pose, &cloth));
        solids
    }

    /// The ellipsoids; first those of cloth, with their factors.
    fn blobs(&self, pose: &Pose, cloth: &[f64]) -> Vec<Solid> {
        use Material::{Hair, Shirt, Skin, Trousers};
        let at = |k: usize| pose.landmarks[k];
        let trunk = |fraction: f64| between(at(MID_HIP), at(COLLAR), fraction);
        let forward = |place: Vector, by: f64| along(place, by * self.stature, pose.trunk[1]);
        let mut blobs = vec![
            (SEAT, Trousers, forward(trunk(0.05), -0.005), pose.hips, [0.160, 0.112, 0.110]),
            (TRUNK, Shirt, forward(trunk(0.33), 0.010), pose.trunk, [0.142, 0.110, 0.150]),
            (TRUNK, Shirt, forward(trunk(0.66), 0.005), pose.trunk, [0.150, 0.116, 0.165]),
        ];
        for side in 0..2 {
            let arm = turned_along(minus(at(ELBOWS + side), at(SHOULDERS + side)), pose.trunk);
            let shoulder = between(at(SHOULDERS + side), at(ELBOWS + side), 0.08);
            blobs.push((UPPER_ARM + side, Shirt, shoulder, arm, [0.060, 0.063, 0.080]));
            let hip = forward(between(at(HIPS + side), at(KNEES + side), 0.03), -0.025);
            blobs.push((SEAT, Trousers, hip, pose.hips, [0.088, 0.092, 0.105]));
        }
        let head = pose.head;
        let skull = along(at(HEAD), -0.098 * self.stature, head[2]);
        let face = |place: Vector, right: f64, ahead: f64, up: f64| {
            let place = along(place, right * self.stature, head[0]);
            along(along(place, ahead * self.stature, head[1]), up * self.stature, head[2])
        };
        blobs.push((CRANIUM, Skin, face(skull, 0.0, 0.010, -0.004), head, [0.072, 0.092, 0.098]));
        blobs.push((CRANIUM, Skin, face(skull, 0.0, 0.038, -0.062), head, [0.050, 0.056, 0.058]));
        blobs.push((CRANIUM, Hair, face(skull, 0.0, -0.012, 0.016), head, [0.077, 0.090, 0.088]));
        for side in 0..2 {
            let fingers = minus(at(KNUCKLES + side), at(WRISTS + side));
            let hand = turned_along(fingers, pose.trunk);
            let palm = along(at(WRISTS + side), 1.02, fingers);
            blobs.push((HAND + side, Skin, palm, hand, [0.020, 0.042, 0.088]));
        }
        let cloth = cloth.iter().copied().chain(std::iter::repeat(1.0));
        let solid = |((part, material, centre, axes, lengths), moved): ((usize, _, _, [Vector; 3], [f64; 3]), f64)| {
            let factor = self.girth[part] * moved;
            let half_axes = [0, 1, 2].map(|i: usize| axes[i].map(|x| factor * lengths[i] * x));
            Solid { shape: Shape::Ellipsoid { centre, half_axes }, material }
        };
        blobs.into_iter().zip(cloth).map(solid).collect()
    }

    /// g of every station and ellipsoid in every frame.
    fn drawn_clothes(&self, stage: &Stage) -> Vec<Vec<f64>> {
        let lengths = self.chain_lengths();
        let count = CHAINS.iter().map(|chain| chain.stations.len()).sum::<usize>() + CLOTH_BLOBS;
        let fresh = (1.0 - CLOTH_PERSISTENCE * CLOTH_PERSISTENCE).sqrt();
        let mut independent: Vec<f64> = Vec::new();
        let frames = (0_u32..).zip(&self.joints).map(|(frame, _)| {
            let new = normals(stage, frame, count);
            if independent.is_empty() {
                independent = new;
            } else {
                independent.iter_mut().zip(new).for_each(|(z, new)| *z = CLOTH_PERSISTENCE * *z + fresh * new);
            }
            along_chains(&independent, &lengths)
        });
        frames.collect()
    }

    /// Medians of the chains' lengths over the frames, metres.
    fn chain_lengths(&self) -> Vec<f64> {
        let step = self.joints.len().div_ceil(SAMPLE).max(1);
        let sample: Vec<Pose> = (0..self.joints.len())
            .step_by(step)
            .map(|frame| Pose::new(&self.joints[frame], &self.extra[frame], self.stature))
            .collect();
        let length = |chain: &Chain| {
            let of = |pose: &Pose| distance(pose.landmarks[chain.ends[0]], pose.landmarks[chain.ends[1]]);
            median(sample.iter().map(of).collect())
        };
        CHAINS.iter().map(length).collect()
    }
}

/// Frames that medians are taken over.
const SAMPLE: usize = 100;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// Length of the legs over that of the adult of the tables.
fn stature(joints: &[[Vector; EVALUATION_JOINTS.len()]]) -> f64 {
    let leg = |j: &[Vector; EVALUATION_JOINTS.len()]| {
        let side = |s: usize| distance(j[HIPS + s], j[KNEES + s]) + distance(j[KNEES + s], j[ANKLES + s]);
        0.5 * (side(0) + side(1))
    };
    let step = joints.len().div_ceil(SAMPLE).max(1);
    median(joints.iter().step_by(step).map(leg).collect()) / LEG_M
}

/// Makes independent numbers into numbers that are correlated along every chain; what follows the chains stays as it is.
fn along_chains(independent: &[f64], lengths: &[f64]) -> Vec<f64> {
    let mut all = independent.to_vec();
    let mut first = 0;
    for (chain, length) in CHAINS.iter().zip(lengths) {
        for (k, pair) in chain.stations.windows(2).enumerate() {
            let near = (-(pair[1][0] - pair[0][0]) * length / CLOTH_LENGTH_M).exp();
            all[first + k + 1] = near * all[first + k] + (1.0 - near * near).sqrt() * independent[first + k + 1];
        }
        first += chain.stations.len();
    }
    all
}

/// Axes with the third along a direction and the others as near as may be to those given.
fn turned_along(direction: Vector, [right, forward, up]: [Vector; 3]) -> [Vector; 3] {
    let third = unit(direction).unwrap_or(up);
    let first = across(right, third).or_else(|| across(forward, third)).unwrap_or(right);
    [first, cross(third, first), third]
}

/// Landmarks of a frame, and the axes right, forward, up of what turns.
struct Pose {
    landmarks: [Vector; LANDMARKS],
    trunk: [Vector; 3],
    hips: [Vector; 3],
    head: [Vector; 3],
}

impl Pose {
    fn new(joints: &[Vector; EVALUATION_JOINTS.len()], extra: &[Option<Vector>; EXTRA.len()], stature: f64) -> Self {
        let mut at = [[0.0; 3]; LANDMARKS];
        at[..joints.len()].copy_from_slice(joints);
        let upright = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let spine = minus(at[NECK], at[MID_HIP]);
        let hip_line = minus(at[HIPS + 1], at[HIPS]);
        let shoulder_line = minus(at[SHOULDERS + 1], at[SHOULDERS]);
        let both = along(unit(hip_line).unwrap_or(upright[0]), 1.0, unit(shoulder_line).unwrap_or(upright[0]));
        let axes = |line: Vector| turned_along(spine, [line, upright[1], upright[2]]);
        let (trunk, hips, chest) = (axes(both), axes(hip_line), axes(shoulder_line));
        let nose = extra[4].map(|nose| minus(nose, between(at[NECK], at[HEAD], 0.5)));
        let head = match nose {
            // right = forward × up.
            Some(nose) => turned_along(minus(at[HEAD], at[NECK]), [cross(nose, trunk[2]), nose, trunk[2]]),
            None => turned_along(minus(at[HEAD], at[NECK]), trunk),
        };
        at[SKULL] = along(along(at[HEAD], -0.150 * stature, head[2]), 0.005 * stature, head[1]);
        let shoulders = between(at[SHOULDERS], at[SHOULDERS + 1], 0.5);
        at[COLLAR] = along(shoulders, 0.045 * stature, trunk[2]);
        for side in 0..2 {
            let sign = if side == 0 { -1.0 } else { 1.0 };
            let place = |fraction: f64, axes: [Vector; 3], out: f64| {
                along(between(at[MID_HIP], at[COLLAR], fraction), sign * out * stature, axes[0])
            };
            (at[LOINS + side], at[RIBS + side]) = (place(0.10, hips, 0.058), place(0.82, chest, 0.068));
            let forearm = minus(at[WRISTS + side], at[ELBOWS + side]);
            let fingers = unit(forearm).unwrap_or([0.0, 0.0, -1.0]);
            at[KNUCKLES + side] = along(at[WRISTS + side], 0.085 * stature, fingers);
            let shin = unit(minus(at[KNEES + side], at[ANKLES + side])).unwrap_or(upright[2]);
            let [heel, ball, tip] = foot(at[ANKLES + side], shin, trunk[1], extra[2 + side], extra[side], stature);
            (at[HEELS + side], at[BALLS + side], at[TIPS + side]) = (heel, ball, tip);
        }
        Self { landmarks: at, trunk, hips, head }
    }
}

/// Middle of heel, ball and tip of a foot. Recorded heels and toes are points of the sole.
fn foot(
    ankle: Vector,
    shin: Vector,
    forward: Vector,
    heel: Option<Vector>,
    toe: Option<Vector>,
    stature: f64,
) -> [Vector; 3] {
    let m = |length: f64| length * stature;
    let toe = toe.unwrap_or_else(|| {
        let ahead = across(forward, shin).unwrap_or(forward);
        along(along(ankle, m(0.15), ahead), m(-0.06), shin)
    });
    // The way from the ankle to the ball slopes down by about a third.
    let slope = unit(minus(toe, ankle)).unwrap_or(forward);
    let heel = heel.unwrap_or_else(|| {
        let down = across(shin, slope).unwrap_or(shin);
        along(along(ankle, m(-0.060), slope), m(-0.045), down)
    });
    let sole = unit(minus(toe, heel)).unwrap_or(slope);
    let up = across(minus(ankle, heel), sole).unwrap_or(shin);
    let lift = |place: Vector, by: f64| along(place, m(by), up);
    let ball = between(heel, toe, 0.72);
    [lift(along(heel, m(0.015), sole), 0.034), lift(ball, 0.032), lift(along(toe, m(0.02), sole), 0.022)]
}
