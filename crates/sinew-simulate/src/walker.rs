//! A person who stands still and then walks, as states of the standard body H32.
//!
//! The world is right-handed: x to the walker's right, y forward, z up; the ground is z = 0. Angles are defined in [`sinew_body::standard`]: flexion of shoulder, elbow, hip
//! and ankle is positive about x, of the knee negative.
//!
//! 1. For [`Gait::still_s`] the state does not change at all: upright, knees and elbows slightly bent.
//! 2. Then cadence and amplitude rise from zero to their values of steady walking (quintic steps, so that acceleration has no jump); the left leg carries first.
//! 3. Hip, knee and ankle follow [`crate::gait`]. The pelvis turns ±5° about the vertical (the side that strikes is forward), rises 4° on the side that bears
//!    weight and sways ±2 cm towards it; the thighs undo this, so that the legs swing straight ahead and the feet stay where they are, 6 cm from the middle.
//!    Trunk and shoulders turn against the pelvis (1.5° and 3°), the trunk leans 3° forward, and the head looks ahead. Each arm swings with the opposite leg: shoulder 24° back to 8° forward, elbow 18° to 42°.
//! 4. Height and forward motion follow from the feet. A foot's load is 1 while it alone carries and passes from one foot to the other while both do (the first 12 % after
//!    each heel strike); within a foot it passes from heel to toes. The root is as high as puts the load-weighted height of heels and toes at 0, and moves so that
//!    their load-weighted velocity is 0. The speed is thus what step length and cadence make it, 1.2 m/s for the standard body.
//!
//! 5. A walk that is longer than the room goes along [`crate::room`]'s way, at the same speed: the body is turned to its heading, and each foot is put where the way has it,
//!    by turning the leg at the hip, so that a foot that carries stands and keeps its direction. The yaw rate stays below 2 rad/s in a room of 6 m.
//!
//! Limits: level ground, rigid feet, no leaning into turns and no slowing down for them, no variation from step to step; toes that do not bend, so that they dip up to 15 mm into the ground when they push off.

use crate::gait::{ANKLE, HIP, KNEE};
use crate::room::Way;
use sinew_body::standard::h32;
use sinew_body::{KinematicTree, Plan, Proportions, point_positions};
use sinew_core::lanes::Isa;
use std::f64::consts::TAU;

/// What to walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gait {
    /// Time of standing still at the start, seconds.
    pub still_s: f64,
    /// Duration of two steps, seconds.
    pub stride_s: f64,
    /// Time from standing to steady walking, seconds.
    pub start_s: f64,
    /// Duration of the whole motion, seconds; later poses equal the last.
    pub duration_s: f64,
    /// Size of the walker.
    pub proportions: Proportions,
    /// Width (x) and depth (y) of the room, metres, at least 4; infinite for straight ahead. A walk that fits goes straight.
    pub room_m: [f64; 2],
}

/// The room of a laboratory, metres.
pub const ROOM_M: [f64; 2] = [6.0, 6.0];

impl Default for Gait {
    fn default() -> Self {
        Self { still_s: 1.0, stride_s: 1.1, start_s: 0.9, duration_s: 4.0, proportions: Proportions::default(), room_m: ROOM_M }
    }
}

/// A walker whose way over the ground has been worked out.
#[derive(Clone, Debug)]
pub struct Walker {
    /// The body, H32.
    pub body: KinematicTree,
    /// What it walks.
    pub gait: Gait,
    /// Way and height of the root at multiples of [`STEP_S`].
    root: Vec<[f64; 2]>,
    /// Where the walker turns, if they do.
    way: Option<Way>,
    /// Hips and ankles, right ones first.
    legs: Plan,
}

/// Time step of the way over the ground, seconds.
const STEP_S: f64 = 1.0 / 480.0;

/// Fraction of the cycle after each heel strike in which both feet carry.
pub const DOUBLE_SUPPORT: f64 = 0.12;

/// Fractions of the cycle between which the load of a foot passes from heel to toes.
const ROLL: [f64; 2] = [0.08, 0.38];

/// Phase of the right leg at the start: it swings, the left one carries.
const FIRST_PHASE: f64 = 0.70;

const SWAY_M: f64 = 0.02;

/// Distance of a foot from the middle line, metres.
const FOOT_FROM_MIDDLE_M: f64 = 0.06;

const CONTACTS: [&str; 4] = ["RHeel", "RBigToe", "LHeel", "LBigToe"];

impl Walker {
    /// Works out the way over the ground. Times that are negative or no numbers count as zero, a stride takes at least 0.1 s.
    #[must_use]
    pub fn new(gait: Gait) -> Self {
        let time = |t: f64| t.max(0.0);
        let gait = Gait {
            still_s: time(gait.still_s),
            stride_s: gait.stride_s.max(0.1),
            start_s: time(gait.start_s),
            duration_s: time(gait.duration_s),
            ..gait
        };
        let body = h32(&gait.proportions);
        let feet: Vec<usize> = CONTACTS.iter().filter_map(|name| body.point_index(name)).collect();
        let plan = Plan::new(&body, &feet);
        let mut root: Vec<[f64; 2]> = Vec::new();
        let mut before: Option<([[f64; 2]; 4], [f64; 4])> = None;
        let mut forward = 0.0;
        let mut time_s = 0.0;
        while time_s < gait.duration_s + STEP_S {
            let feet = feet_below_root(&plan, &joint_angles(&gait, time_s));
            let load = loads(phase(&gait, time_s));
            if let Some((last, last_load)) = before {
                forward -= (0..4).map(|k| 0.5 * (load[k] + last_load[k]) * (feet[k][0] - last[k][0])).sum::<f64>();
            }
            let height = -(0..4).map(|k| load[k] * feet[k][1]).sum::<f64>();
            root.push([forward, height]);
            before = Some((feet, load));
            time_s = STEP_S * root.len() as f64;
        }
        let legs: Vec<usize> = LEGS.iter().filter_map(|name| body.point_index(name)).collect();
        let legs = Plan::new(&body, &legs);
        let way = Way::new(gait.room_m, forward);
        Self { body, gait, root, way, legs }
    }

    /// How far the root goes, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.root.last().map_or(0.0, |[walked, _]| *walked)
    }

    /// How far ahead of the start the middle of the room is, metres, where the walker turns.
    #[must_use]
    pub fn middle(&self) -> Option<f64> {
        self.way.as_ref().map(Way::start)
    }

    /// Turns a pose of somebody who has walked straight ahead to their place on the way.
    fn turn(&self, way: &Way, state: &mut [f64]) {
        let walked = state[1];
        let heading = way.heading(walked);
        let mut flat = [0.0; 12];
        point_positions(&self.legs, Isa::baseline(), state, &mut flat);
        let at = |k: usize| [flat[3 * k], flat[3 * k + 1] - walked, flat[3 * k + 2]];
        for (side, thigh, foot) in [(0, 24, 30), (2, 20, 28)] {
            let (hip, ankle) = (at(side), at(side + 1));
            let (to, turn) = way.bent(walked, [ankle[0], ankle[1]]);
            let (sin, cos) = turn.sin_cos();
            // Where the foot is to be, seen from the hip along its new direction, against where it was.
            let [x, y] = [to[0] - hip[0], to[1] - hip[1]];
            let leg = hip[2] - ankle[2];
            let outwards = ((cos * x + sin * y) - (ankle[0] - hip[0])) / leg;
            let ahead = ((cos * y - sin * x) - (ankle[1] - hip[1])) / leg;
            state[thigh] += turn;
            state[thigh + 1] -= outwards;
            state[thigh + 2] += ahead;
            state[foot] -= ahead;
            state[foot + 1] += outwards;
        }
        let (sin, cos) = heading.sin_cos();
        let [x, y] = way.place(walked);
        let sway = state[0];
        state[0] = x + cos * sway;
        state[1] = y + way.start() + sin * sway;
        state[3] += heading;
    }
}

/// Points by which feet are put on the way.
const LEGS: [&str; 4] = ["RHip", "RAnkle", "LHip", "LAnkle"];

/// Forward position and height of the contacts, with the root at the origin.
fn feet_below_root(plan: &Plan, state: &[f64]) -> [[f64; 2]; 4] {
    let mut flat = [0.0; 12];
    point_positions(plan, Isa::baseline(), state, &mut flat);
    std::array::from_fn(|k| [flat[3 * k + 1], flat[3 * k + 2]])
}

/// Loads of the contacts at a phase of the right leg; they sum to 1.
fn loads(phase: f64) -> [f64; 4] {
    let foot = |phase: f64| {
        let phase = phase.rem_euclid(1.0);
        let load = step(phase / DOUBLE_SUPPORT) - step((phase - 0.5) / DOUBLE_SUPPORT);
        let toes = step((phase - ROLL[0]) / (ROLL[1] - ROLL[0]));
        [load * (1.0 - toes), load * toes]
    };
    let ([a, b], [c, d]) = (foot(phase), foot(phase + 0.5));
    [a, b, c, d]
}

/// State of the walker's body at a time.
#[must_use]
pub fn walker_pose(walker: &Walker, time_s: f64) -> Vec<f64> {
    let time_s = time_s.clamp(0.0, walker.gait.duration_s);
    let mut state = joint_angles(&walker.gait, time_s);
    let place = time_s / STEP_S;
    let index = (place as usize).min(walker.root.len().saturating_sub(2));
    let part = place - index as f64;
    if let [a, b, ..] = walker.root[index..] {
        state[1] = a[0] + part * (b[0] - a[0]);
        state[2] = a[1] + part * (b[1] - a[1]);
    }
    if let Some(way) = &walker.way {
        walker.turn(way, &mut state);
    }
    state
}

/// States at a constant rate from time 0 to the end of the motion (which is excluded).
#[must_use]
pub fn walker_states(walker: &Walker, rate_hz: f64) -> Vec<Vec<f64>> {
    let frames = (walker.gait.duration_s * rate_hz).round() as usize;
    (0..frames).map(|frame| walker_pose(walker, frame as f64 / rate_hz)).collect()
}

/// 0 before 0, 1 after 1, and between them a quintic with two zero derivatives at both ends.
fn step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * t * (10.0 + t * (6.0 * t - 15.0))
}

/// Integral of [`step`] from 0.
pub(crate) fn step_integral(t: f64) -> f64 {
    let s = t.clamp(0.0, 1.0);
    s * s * s * s * (2.5 + s * (s - 3.0)) + (t - 1.0).max(0.0)
}

/// Phase of the right leg: it meets the ground at whole numbers, and leaves it [`DOUBLE_SUPPORT`] after the next half. The left leg is half a cycle ahead.
#[must_use]
pub fn phase(gait: &Gait, time_s: f64) -> f64 {
    let start = gait.start_s.max(1e-9);
    FIRST_PHASE + step_integral((time_s - gait.still_s) / start) * start / gait.stride_s
}

/// The state but for the root's forward position and height.
fn joint_angles(gait: &Gait, time_s: f64) -> Vec<f64> {
    let amplitude = step((time_s - gait.still_s) / gait.start_s.max(1e-9));
    let phase = phase(gait, time_s);
    let standing = posture(&gait.proportions, &Swing::standing());
    if amplitude <= 0.0 {
        return standing;
    }
    let walking = posture(&gait.proportions, &Swing::walking(phase));
    let mut state: Vec<f64> = standing.iter().zip(&walking).map(|(a, b)| a + amplitude * (b - a)).collect();
    // Half a knee's flexion lifts a foot by a quarter, but half a foot's slope lowers the toes by half: let the slope come last.
    for (thigh, foot) in [(22, 28), (26, 30)] {
        let slope = walking[thigh] + walking[thigh + 1] + walking[foot] + walking[5];
        state[foot] += amplitude * (1.0 - amplitude * amplitude) * (-slope).max(0.0);
    }
    state
}

/// Angles of one side, radians; flexion positive.
struct Side {
    hip: f64,
    knee: f64,
    ankle: f64,
    shoulder: f64,
    elbow: f64,
}

/// Angles of the whole body, radians, and the sway.
struct Swing {
    right: Side,
    left: Side,
    pelvis_turn: f64,
    pelvis_tilt: f64,
    trunk_turn: f64,
    girdle_turn: f64,
    lean: f64,
    sway_m: f64,
}

fn degrees(d: f64) -> f64 {
    d.to_radians()
}

impl Swing {
    fn standing() -> Self {
        let side =
            || Side { hip: degrees(2.0), knee: degrees(4.0), ankle: degrees(2.0), shoulder: 0.0, elbow: degrees(8.0) };
        Self {
            right: side(),
            left: side(),
            pelvis_turn: 0.0,
            pelvis_tilt: 0.0,
            trunk_turn: 0.0,
            girdle_turn: 0.0,
            lean: 0.0,
            sway_m: 0.0,
        }
    }

    fn walking(phase: f64) -> Self {
        let side = |phase: f64| Side {
            hip: HIP.at(phase),
            knee: KNEE.at(phase),
            ankle: ANKLE.at(phase),
            shoulder: degrees(-8.0 - 16.0 * (TAU * phase).cos()),
            elbow: degrees(30.0 - 12.0 * (TAU * phase).cos()),
        };
        let turn = (TAU * phase).cos();
        Self {
            right: side(phase),
            left: side(phase + 0.5),
            pelvis_turn: degrees(5.0) * turn,
            pelvis_tilt: degrees(-4.0) * (TAU * (phase - 0.15)).cos(),
            trunk_turn: degrees(-1.5) * turn,
            girdle_turn: degrees(-3.0) * turn,
            lean: degrees(-3.0),
            sway_m: SWAY_M * (TAU * (phase - 0.30)).cos(),
        }
    }
}

/// State of H32 in a swing; small rotations about different axes are taken to commute (an error below 0.4°).
fn posture(size: &Proportions, swing: &Swing) -> Vec<f64> {
    let mut state = vec![0.0; 32];
    state[0] = swing.sway_m;
    (state[3], state[4], state[5]) = (swing.pelvis_turn, swing.pelvis_tilt, swing.lean);
    (state[6], state[7]) = (-swing.pelvis_tilt, swing.trunk_turn - swing.pelvis_turn);
    (state[8], state[10]) = (-swing.trunk_turn, -swing.lean);
    state[11] = swing.girdle_turn;
    let leg = size.thigh + size.shin;
    for (sign, side, arm, thigh, foot) in [(-1.0, &swing.left, 12, 20, 28), (1.0, &swing.right, 16, 24, 30)] {
        state[arm + 1] = -sign * degrees(6.0);
        state[arm + 2] = side.shoulder - swing.lean;
        state[arm + 3] = side.elbow;
        let hip_x = swing.sway_m + sign * size.hip_half_width - size.pelvis_drop * swing.pelvis_tilt;
        let foot_x = sign * FOOT_FROM_MIDDLE_M.min(size.hip_half_width);
        let inward = ((hip_x - foot_x) / leg).clamp(-0.5, 0.5).asin();
        state[thigh] = -swing.pelvis_turn;
        state[thigh + 1] = inward - swing.pelvis_tilt;
        state[thigh + 2] = side.hip - swing.lean;
        state[thigh + 3] = -side.knee;
        (state[foot], state[foot + 1]) = (side.ankle, -inward);
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::points::{Trajectories, points_of_states};

    const RATE_HZ: f64 = 120.0;

    fn walk() -> (Walker, Vec<Vec<f64>>, Trajectories) {
        let walker = Walker::new(Gait { duration_s: 6.0, room_m: [f64::INFINITY; 2], ..Gait::default() });
        let states = walker_states(&walker, RATE_HZ);
        let points = points_of_states(&walker.body, &states);
        (walker, states, points)
    }

    fn column(points: &Trajectories, name: &str) -> Vec<[f64; 3]> {
        let k = points.index(name).unwrap();
        points.frames.iter().map(|frame| frame[k]).collect()
    }

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn bones_keep_their_length() {
        let (.., points) = walk();
        for (a, b, length) in [
            ("RHip", "RKnee", 0.43),
            ("LKnee", "LAnkle", 0.42),
            ("LShoulder", "LElbow", 0.30),
            ("RElbow", "RWrist", 0.26),
            ("RHip", "LHip", 0.18),
        ] {
            for (p, q) in column(&points, a).into_iter().zip(column(&points, b)) {
                assert!((distance(p, q) - length).abs() < 1e-12, "{a}-{b}");
            }
        }
    }

    #[test]
    fn the_still_phase_is_still_and_stands_on_the_ground() {
        let (_, states, points) = walk();
        assert!(states[..120].iter().all(|state| state == &states[0]));
        assert!(states[140] != states[0]);
        for name in SOLES {
            assert!(column(&points, name)[0][2].abs() < 1e-3, "{name}");
        }
        let head = column(&points, "Head")[0];
        assert!((1.73..1.75).contains(&head[2]), "{}", head[2]);
    }

    #[test]
    fn loads_sum_to_one_and_pass_without_jumps() {
        let mut last = loads(0.0);
        for i in 1..=1000 {
            let now = loads(f64::from(i) / 1000.0);
            assert!((now.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(now.iter().zip(last).all(|(a, b)| (a - b).abs() < 0.02));
            last = now;
        }
    }

    #[test]
    fn speed_and_step_length_match_natural_walking() {
        let (_, states, _) = walk();
        let (from, to) = (&states[3 * 120], &states[3 * 120 + 264]);
        let speed = (to[1] - from[1]) / 2.2;
        assert!((1.1..1.4).contains(&speed), "{speed} m/s");
        let step_length = speed * 0.55;
        assert!((0.6..0.77).contains(&step_length), "{step_length} m");
        let steady = states[3 * 120..].windows(2).map(|pair| (pair[1][1] - pair[0][1]) * RATE_HZ);
        let [slow, fast] = range(steady);
        assert!(0.7 * speed < slow && fast < 1.3 * speed, "{slow} to {fast} m/s");
        let [low, high] = range(states[3 * 120..].iter().map(|state| state[2]));
        assert!((0.015..0.06).contains(&(high - low)), "{} m", high - low);
    }

    fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    }

    const SOLES: [&str; 6] = ["RHeel", "RBigToe", "RSmallToe", "LHeel", "LBigToe", "LSmallToe"];

    #[test]
    fn the_stance_foot_slides_little() {
        let (walker, states, points) = walk();
        let phase = |frame: usize| phase(&walker.gait, frame as f64 / RATE_HZ);
        for (side, ahead) in [("R", 0.0), ("L", 0.5)] {
            for (name, from, to) in [("Heel", 0.08, 0.36), ("BigToe", 0.12, 0.56)] {
                let track = column(&points, &format!("{side}{name}"));
                let stance = |frame: usize| (from..to).contains(&(phase(frame) + ahead).rem_euclid(1.0));
                let (mut anchor, mut worst) = (None, 0.0_f64);
                for frame in 120..states.len() {
                    anchor = if stance(frame) { anchor.or(Some(frame)) } else { None };
                    worst = worst.max(anchor.map_or(0.0, |first| distance(track[frame], track[first])));
                }
                assert!(worst < 0.03, "{side}{name} slides {worst} m");
            }
        }
        let bounds = points.select(&SOLES).bounds().unwrap();
        assert!(bounds[0][2] > -0.015, "{} m below ground", bounds[0][2]);
    }

    /// A minute in rooms of several sizes, by people of several sizes and speeds.
    #[test]
    fn a_long_walk_stays_in_its_room() {
        use crate::adult::drawn;
        use sinew_core::random::Stage;
        for (seed, room_m) in [(1, ROOM_M), (2, ROOM_M), (3, ROOM_M), (4, [4.0, 5.0]), (5, [9.0, 6.0])] {
            let proportions = drawn(&Stage::new(seed, "room"));
            let gait = Gait { duration_s: 60.0, stride_s: 1.0 + 0.04 * seed as f64, proportions, room_m, ..Gait::default() };
            let walker = Walker::new(gait);
            let middle = walker.middle().unwrap();
            let states = walker_states(&walker, 30.0);
            let points = points_of_states(&walker.body, &states);
            for frame in &points.frames {
                let inside = |p: &[f64; 3]| p[0].abs() < 0.5 * room_m[0] && (p[1] - middle).abs() < 0.5 * room_m[1];
                assert!(frame.iter().all(inside), "seed {seed}");
            }
            let yaw_rate = range(states.windows(2).map(|pair| 30.0 * (pair[1][3] - pair[0][3])));
            let most = if room_m == [4.0, 5.0] { 3.6 } else { 2.0 };
            assert!(yaw_rate[0] > -most && yaw_rate[1] < most, "seed {seed}: {yaw_rate:?} rad/s");
            let speed = |pair: &[Vec<f64>]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) / 0.55;
            let each: Vec<Vec<f64>> = (0..100).map(|k| walker_pose(&walker, 3.0 + 0.55 * f64::from(k))).collect();
            let [slow, fast] = range(each.windows(2).map(speed));
            assert!(slow > 0.9 && fast < 1.7, "seed {seed}: {slow} to {fast} m/s");
        }
    }

    /// The pose before the first turn is that of a straight walk; in turns a foot that carries slides less than 4 cm.
    #[test]
    fn feet_stand_in_turns() {
        let gait = Gait { duration_s: 16.0, ..Gait::default() };
        let (walker, straight) = (Walker::new(gait), Walker::new(Gait { room_m: [f64::INFINITY; 2], ..gait }));
        let (states, before) = (walker_states(&walker, RATE_HZ), walker_states(&straight, RATE_HZ));
        let apart = states[300].iter().zip(&before[300]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9, "{apart}");
        let points = points_of_states(&walker.body, &states);
        for (side, ahead) in [("R", 0.0), ("L", 0.5)] {
            for (name, from, to) in [("Heel", 0.08, 0.36), ("BigToe", 0.12, 0.56)] {
                let track = column(&points, &format!("{side}{name}"));
                let stance = |frame: usize| {
                    (from..to).contains(&(phase(&gait, frame as f64 / RATE_HZ) + ahead).rem_euclid(1.0))
                };
                let (mut anchor, mut worst) = (None, 0.0_f64);
                for frame in 120..states.len() {
                    anchor = if stance(frame) { anchor.or(Some(frame)) } else { None };
                    worst = worst.max(anchor.map_or(0.0, |first| distance(track[frame], track[first])));
                }
                assert!(worst < 0.04, "{side}{name} slides {worst} m");
            }
        }
    }

    #[test]
    fn nothing_jerks() {
        let (.., points) = walk();
        for name in ["MidHip", "Head"] {
            let track = column(&points, name);
            for axis in 0..3 {
                let second = |w: &[[f64; 3]]| (w[2][axis] - 2.0 * w[1][axis] + w[0][axis]) * RATE_HZ * RATE_HZ;
                let [low, high] = range(track.windows(3).map(second));
                assert!(low > -15.0 && high < 15.0, "{name} axis {axis}: {low} to {high} m/s²");
            }
        }
    }
}
