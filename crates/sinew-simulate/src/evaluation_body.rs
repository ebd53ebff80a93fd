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
//! The clothes of all frames are drawn when the body is made, so that any frame can be made alone.
//!
//! Limits: feet are rigid, hands do not grasp, and flesh does not bulge; where a joint is bent sharply, its capsules overlap.

use crate::Error;
use crate::draws::{normals, uniforms};
use crate::space::{Vector, across, along, between, cross, distance, minus, unit};
use sinew_body::points::Trajectories;
use sinew_body::standard::EVALUATION_JOINTS;
use sinew_core::estimators::median;
use sinew_core::random::Stage;

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
pub enum ConvexShape {
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
pub struct MaterialSolid {
    /// Where it is.
    pub shape: ConvexShape,
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

/// Parts with a factor of their own; parts of limbs are followed by the right one.
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

/// What all frames show of a subject.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Size {
    /// Length of the legs over that of the adult of the tables.
    stature: f64,
    /// How far the top of the head is beyond the joint of that name, metres.
    crown_m: f64,
}

/// A person in a motion, of other proportions than a tracker's body, in clothes that move.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluationBody {
    /// Joints of every frame, in the order of [`EVALUATION_JOINTS`].
    joints: Vec<[Vector; EVALUATION_JOINTS.len()]>,
    /// Extra points of every frame.
    extra: Vec<[Option<Vector>; EXTRA.len()]>,
    size: Size,
    /// Factors of the parts, stature included.
    girth: [f64; PARTS],
    /// g of every station of the chains and then of every ellipsoid of cloth, frame by frame.
    clothes: Vec<Vec<f64>>,
}

impl EvaluationBody {
    /// Dresses a motion; the stage fixes the subject's parts and clothes.
    ///
    /// # Errors
    /// [`Error::MissingJoints`] where one of the fifteen joints is missing, [`Error::NotFinite`].
    pub fn new(motion: &Trajectories, stage: Stage) -> Result<Self, Error> {
        let columns = EVALUATION_JOINTS.map(|name| motion.index(name));
        let missing: Vec<&'static str> =
            EVALUATION_JOINTS.into_iter().zip(columns).filter(|(_, k)| k.is_none()).map(|(name, _)| name).collect();
        if !missing.is_empty() {
            return Err(Error::MissingJoints(missing));
        }
        if !motion.frames.iter().flatten().flatten().all(|x| x.is_finite()) {
            return Err(Error::NotFinite);
        }
        let columns = columns.map(Option::unwrap_or_default);
        let extra = EXTRA.map(|name| motion.index(name));
        let joints: Vec<_> = motion.frames.iter().map(|frame| columns.map(|k| frame[k])).collect();
        let extra = motion.frames.iter().map(|frame| extra.map(|k| k.map(|k| frame[k]))).collect();
        let [girth_stage, cloth_stage] = stage.split(["girth", "clothes"]);
        let size = Size::of(&joints);
        let factors = uniforms(&girth_stage, 0, PARTS);
        let girth = std::array::from_fn(|part| size.stature * (GIRTH[0] + factors[part] * (GIRTH[1] - GIRTH[0])));
        let mut body = Self { joints, extra, size, girth, clothes: Vec::new() };
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
    pub fn solids(&self, frame: usize) -> Vec<MaterialSolid> {
        let (Some(joints), Some(clothes)) = (self.joints.get(frame), self.clothes.get(frame)) else {
            return Vec::new();
        };
        let pose = Pose::new(joints, &self.extra[frame], self.size);
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
            solids.extend(spheres.windows(2).map(|pair| MaterialSolid {
                shape: ConvexShape::Capsule { ends: [pair[0].0, pair[1].0], radii: [pair[0].1, pair[1].1] },
                material: chain.material,
            }));
        }
        let cloth: Vec<f64> = clothes.collect();
        solids.extend(self.blobs(&pose, &cloth));
        solids
    }

    /// The ellipsoids; first the ones of cloth, with their factors.
    fn blobs(&self, pose: &Pose, cloth: &[f64]) -> Vec<MaterialSolid> {
        use Material::{Hair, Shirt, Skin, Trousers};
        let at = |k: usize| pose.landmarks[k];
        let trunk = |fraction: f64| between(at(MID_HIP), at(COLLAR), fraction);
        let forward = |place: Vector, by: f64| along(place, by * self.size.stature, pose.trunk[1]);
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
        let skull = along(at(HEAD), -0.098 * self.size.stature, head[2]);
        let face = |place: Vector, right: f64, ahead: f64, up: f64| {
            let place = along(place, right * self.size.stature, head[0]);
            along(along(place, ahead * self.size.stature, head[1]), up * self.size.stature, head[2])
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
            MaterialSolid { shape: ConvexShape::Ellipsoid { centre, half_axes }, material }
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
            .map(|frame| Pose::new(&self.joints[frame], &self.extra[frame], self.size))
            .collect();
        let length = |chain: &Chain| {
            let of = |pose: &Pose| distance(pose.landmarks[chain.ends[0]], pose.landmarks[chain.ends[1]]);
            median(&mut sample.iter().map(of).collect::<Vec<_>>())
        };
        CHAINS.iter().map(length).collect()
    }
}

/// Frames that medians are taken over.
const SAMPLE: usize = 100;

/// Distance from the middle of the shoulders to the top of the head in the adult of the tables, metres. Recorded joints of that name may end inside the head.
const HEAD_OVER_SHOULDERS_M: f64 = 0.30;

impl Size {
    fn of(joints: &[[Vector; EVALUATION_JOINTS.len()]]) -> Self {
        type Joints = [Vector; EVALUATION_JOINTS.len()];
        let over = |of: fn(&Joints) -> f64| {
            median(&mut joints.iter().step_by(joints.len().div_ceil(SAMPLE).max(1)).map(of).collect::<Vec<_>>())
        };
        let stature = over(|j| {
            let side = |s: usize| distance(j[HIPS + s], j[KNEES + s]) + distance(j[KNEES + s], j[ANKLES + s]);
            0.5 * (side(0) + side(1))
        }) / LEG_M;
        let head = over(|j| distance(j[HEAD], between(j[SHOULDERS], j[SHOULDERS + 1], 0.5)));
        Self { stature, crown_m: (HEAD_OVER_SHOULDERS_M * stature - head).max(0.0) }
    }
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
    fn new(
        joints: &[Vector; EVALUATION_JOINTS.len()],
        extra: &[Option<Vector>; EXTRA.len()],
        Size { stature, crown_m }: Size,
    ) -> Self {
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
        at[HEAD] = along(at[HEAD], crown_m, head[2]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walker::{Gait, Walker, walker_states};
    use sinew_body::points::points_of_states;

    fn walk(duration_s: f64) -> Trajectories {
        let walker = Walker::new(Gait { duration_s, ..Gait::default() });
        points_of_states(&walker.body, &walker_states(&walker, 30.0))
    }

    fn body(motion: &Trajectories, seed: u64) -> EvaluationBody {
        EvaluationBody::new(motion, Stage::new(seed, "test")).unwrap()
    }

    fn still(frames: usize) -> EvaluationBody {
        let motion = walk(0.1);
        body(&Trajectories { frames: vec![motion.frames[0].clone(); frames], ..motion }, 3)
    }

    fn correlation(pairs: impl Iterator<Item = (f64, f64)>) -> [f64; 3] {
        let (mut n, mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0, 0.0);
        for (x, y) in pairs {
            (n, xx, yy, xy) = (n + 1.0, xx + x * x, yy + y * y, xy + x * y);
        }
        [xy / (xx * yy).sqrt(), xx / n, yy / n]
    }

    /// Over 4000 frames of 68 stations; the effective number of independent numbers is about a tenth.
    #[test]
    fn clothes_remember_the_frame_before_and_vary_as_stated() {
        let clothes = still(4000).clothes;
        let pairs = clothes.windows(2).flat_map(|pair| pair[0].iter().copied().zip(pair[1].iter().copied()));
        let [persistence, variance, _] = correlation(pairs);
        assert!((persistence - 0.9).abs() < 0.005, "{persistence}");
        assert!((variance - 1.0).abs() < 0.03, "{variance}");
        assert!((correlation(clothes[..1].iter().flat_map(|g| g.iter().map(|g| (*g, *g))))[1] - 1.0).abs() < 0.6);
    }

    #[test]
    fn clothes_are_correlated_along_a_segment_and_not_between_segments() {
        let body = still(4000);
        let lengths = body.chain_lengths();
        // The right thigh, its stations apart by 0.3, 0.4 and 0.3 of its length.
        let thigh = 7;
        let first: usize = CHAINS[..thigh].iter().map(|chain| chain.stations.len()).sum();
        assert!((lengths[thigh] - 0.43).abs() < 1e-9);
        for (a, b) in [(0, 1), (1, 2), (0, 3)] {
            let apart = (THIGH_RADII[b][0] - THIGH_RADII[a][0]) * lengths[thigh];
            let [found, ..] = correlation(body.clothes.iter().map(|g| (g[first + a], g[first + b])));
            assert!((found - (-apart / 0.15).exp()).abs() < 0.15, "{found} at {apart} m");
        }
        let [other, ..] = correlation(body.clothes.iter().map(|g| (g[first], g[first - 1])));
        assert!(other.abs() < 0.15, "{other}");
    }

    #[test]
    fn radii_match_the_part_and_move_with_the_clothes_alone() {
        let motion = walk(0.2);
        for seed in 0..40 {
            let body = body(&motion, seed);
            assert!(body.girth.iter().all(|girth| (0.9..1.15).contains(girth)), "{:?}", body.girth);
        }
        let body = body(&motion, 1);
        let (first, last) = (body.solids(0), body.solids(5));
        assert_eq!(first.len(), last.len());
        for (a, b) in first.iter().zip(&last) {
            if let (ConvexShape::Capsule { radii: p, .. }, ConvexShape::Capsule { radii: q, .. }) = (a.shape, b.shape) {
                assert_eq!(p == q, !a.material.is_cloth());
                assert!(p.iter().chain(&q).all(|r| (0.015..0.15).contains(r)));
            }
        }
    }

    #[test]
    fn a_frame_does_not_depend_on_those_that_follow() {
        let motion = walk(1.0);
        let start = Trajectories { frames: motion.frames[..12].to_vec(), ..motion.clone() };
        let (whole, part) = (body(&motion, 5), body(&start, 5));
        assert_eq!(whole.clothes[11], part.clothes[11]);
        assert_eq!(whole.solids(11).len(), part.solids(11).len());
        assert!(whole.solids(30).is_empty() && whole.foothold(30).is_none());
        assert_eq!(whole, body(&motion, 5));
        assert!(whole.girth != body(&motion, 6).girth);
    }

    /// Chains begin where others end: a flood over overlapping spheres reaches every solid.
    #[test]
    fn nothing_is_detached_and_the_person_is_as_tall_as_it_was() {
        let motion = walk(3.0);
        let body = body(&motion, 2);
        for frame in [0, 45, 60, 75, 89] {
            let spheres: Vec<(Vector, f64)> = body
                .solids(frame)
                .iter()
                .flat_map(|solid| match solid.shape {
                    ConvexShape::Capsule { ends, radii } => (0..=8)
                        .map(|k| f64::from(k) / 8.0)
                        .map(|s| (between(ends[0], ends[1], s), radii[0] + s * (radii[1] - radii[0])))
                        .collect::<Vec<_>>(),
                    ConvexShape::Ellipsoid { centre, half_axes } => {
                        let least = half_axes.iter().map(|h| crate::space::length(*h)).fold(f64::INFINITY, f64::min);
                        vec![(centre, least)]
                    }
                })
                .collect();
            let mut reached = vec![false; spheres.len()];
            let mut open = vec![0];
            reached[0] = true;
            while let Some(i) = open.pop() {
                for j in 0..spheres.len() {
                    if !reached[j] && distance(spheres[i].0, spheres[j].0) < 0.9 * (spheres[i].1 + spheres[j].1) {
                        reached[j] = true;
                        open.push(j);
                    }
                }
            }
            assert!(reached.iter().all(|reached| *reached), "frame {frame}");
            let top = spheres.iter().map(|(c, r)| c[2] + r).fold(0.0, f64::max);
            let bottom = spheres.iter().map(|(c, r)| c[2] - r).fold(1.0, f64::min);
            assert!(
                (1.66..1.80).contains(&top) && (-0.04..0.03).contains(&bottom),
                "{bottom} to {top} m in frame {frame}"
            );
        }
    }

    #[test]
    fn what_is_no_person_is_refused() {
        let motion = walk(0.1);
        let error = EvaluationBody::new(&motion.select(&["Head", "Neck"]), Stage::new(1, "test")).unwrap_err();
        assert!(error.to_string().starts_with("the motion has no MidHip, LShoulder, RShoulder"), "{error}");
        let mut broken = motion;
        broken.frames[0][0][1] = f64::NAN;
        let error = EvaluationBody::new(&broken, Stage::new(1, "test")).unwrap_err();
        assert_eq!(error.to_string(), "a coordinate of the motion is not finite");
    }
}
