//! Several motions one after the other, as one person makes them.
//!
//! For instance the sequence CMB of walking, running and free movement.
//!
//! Trials of different people at different places become one motion of the first trial's person:
//!
//! 1. Lengths: every segment keeps its direction and takes its median length in the first trial; the middle of the hips keeps its height over the lowest joint, in proportion to the legs.
//! 2. Places: each trial is turned about the vertical and moved so that its person looks where the one before looked at the end, and continues from there.
//! 3. Joins: 2 s in which the directions of the segments go from the last frame's to the first frame's by the smooth cubic `3s² − 2s³`, and the middle of the hips along the cubic with the velocities of
//!    both ends that comes to rest half-way: it covers a sixth of what the velocities would.
//! 4. Space: recorded walks are straight and short. The path of a trial may be bent to the left, so that its person goes round: the heading turns by the way gone forward over a radius. In joins
//!    the curvature goes from the one to the other. A radius of [`TURN_RADIUS_M`] suits walks; nobody runs round it ([`comfortable_radius_m`]).
//!
//! `recorded_combo` of the tests is CMB: a walk, a run and balancing on one leg. Without recordings [`synthetic_combo`] does the same with the walker: its usual gait, a quicker one, and standing with arms that swing. It is no replacement for running and dancing, and its name says so.
//!
//! Limits: feet slide in joins and, by some centimetres, where paths are bent.

use sinew_body::points::{Trajectories, distance, points_of_states};
use sinew_body::standard::EVALUATION_JOINTS;
use sinew_simulate::walker::{Gait, Walker, walker_states};
use std::f64::consts::TAU;
use std::ops::Range;

/// A point or a direction.
type Vector = [f64; 3];

/// `a + s b`.
fn along(a: Vector, s: f64, b: Vector) -> Vector {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

fn minus(a: Vector, b: Vector) -> Vector {
    along(a, -1.0, b)
}

/// The direction of a vector; `None` where it has none.
fn unit(a: Vector) -> Option<Vector> {
    let norm = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt();
    (norm > 1e-9).then(|| a.map(|x| x / norm))
}

/// A motion and what it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Name, as reports use it.
    pub name: String,
    /// Points over time at the rate of the sequence.
    pub motion: Trajectories,
    /// Radius of the circle that its path is bent to, metres; none stays as it is.
    pub turn_radius_m: Option<f64>,
}

/// Frames of a sequence that belong together; joins belong to what they lead to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Phase {
    /// Name of the trial.
    pub name: String,
    /// Its frames.
    pub frames: Range<usize>,
}

/// Several motions in one.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// Where it comes from: `CMB` or `synthetic CMB`.
    pub name: String,
    /// The points.
    pub motion: Trajectories,
    /// Frames per second.
    pub rate_hz: f64,
    /// Its parts in order. The first, the first two and all three are the frame sets 1, 2 and 3 of the experiments.
    pub phases: Vec<Phase>,
}

/// Duration of a join, seconds.
pub const JOIN_S: f64 = 2.0;
/// Radius of the circle that walks are bent to, metres.
pub const TURN_RADIUS_M: f64 = 1.2;
/// Largest acceleration sideways of a comfortable turn, metres a second squared: the body leans by 17°.
const SIDEWAYS_MS2: f64 = 3.0;

/// Radius of a turn that is comfortable at a motion's mean horizontal speed, at least [`TURN_RADIUS_M`], metres.
#[must_use]
pub fn comfortable_radius_m(motion: &Trajectories, rate_hz: f64) -> f64 {
    let hips = motion.index("MidHip").unwrap_or_default();
    let [Some(first), Some(last)] = [motion.frames.first(), motion.frames.last()] else { return TURN_RADIUS_M };
    let [x, y, _] = minus(last[hips], first[hips]);
    let speed = x.hypot(y) * rate_hz / (motion.frames.len() - 1).max(1) as f64;
    TURN_RADIUS_M.max(speed * speed / SIDEWAYS_MS2)
}

/// Points and the points they hang on, parents first.
const BONES: [(&str, &str); 18] = [
    ("Neck", "MidHip"),
    ("Head", "Neck"),
    ("LShoulder", "Neck"),
    ("RShoulder", "Neck"),
    ("LElbow", "LShoulder"),
    ("RElbow", "RShoulder"),
    ("LWrist", "LElbow"),
    ("RWrist", "RElbow"),
    ("LHip", "MidHip"),
    ("RHip", "MidHip"),
    ("LKnee", "LHip"),
    ("RKnee", "RHip"),
    ("LAnkle", "LKnee"),
    ("RAnkle", "RKnee"),
    ("LBigToe", "LAnkle"),
    ("RBigToe", "RAnkle"),
    ("LHeel", "LAnkle"),
    ("RHeel", "RAnkle"),
];

/// Joins walking, running and free movement, or any trials, to a sequence at the rate that all of them have. Points that some trial lacks are left out.
///
/// # Errors
/// No trials; one without a frame, and where one of [`EVALUATION_JOINTS`] is missing.
pub fn combo(name: &str, trials: &[Trial], rate_hz: f64) -> Result<Sequence, String> {
    let first = trials.first().ok_or("a sequence of no trials")?;
    for trial in trials {
        let missing = EVALUATION_JOINTS.iter().find(|joint| trial.motion.index(joint).is_none());
        let what = match (missing, trial.motion.frames.is_empty()) {
            (Some(joint), _) => format!("has no {joint}"),
            (None, true) => "has no frame".into(),
            (None, false) => continue,
        };
        return Err(format!("the trial {} {what}", trial.name));
    }
    let in_all = |name: &str| trials.iter().all(|trial| trial.motion.index(name).is_some());
    let bones: Vec<(&str, &str)> = BONES.into_iter().filter(|(name, _)| in_all(name)).collect();
    let names: Vec<&str> = std::iter::once("MidHip").chain(bones.iter().map(|(name, _)| *name)).collect();
    let parents: Vec<usize> =
        bones.iter().map(|(_, parent)| names.iter().position(|name| name == parent).unwrap_or(0)).collect();
    let skeleton = Skeleton::of(&first.motion.select(&names), parents);
    let mut joined = Joined { skeleton: &skeleton, rate_hz, poses: Vec::new(), curvatures: Vec::new() };
    let mut phases = Vec::new();
    for trial in trials {
        let start = joined.poses.len();
        joined.add(&trial.motion.select(&names), trial.turn_radius_m);
        phases.push(Phase { name: trial.name.clone(), frames: start..joined.poses.len() });
    }
    let frames = joined.bent();
    let names = names.into_iter().map(str::to_owned).collect();
    Ok(Sequence { name: name.to_owned(), motion: Trajectories { names, frames }, rate_hz, phases })
}

/// A person's segments.
struct Skeleton {
    /// For each point but the first, the point it hangs on.
    parents: Vec<usize>,
    /// Lengths of the segments, metres.
    lengths: Vec<f64>,
    feet: Vec<usize>,
    hips: [usize; 2],
    shoulders: [usize; 2],
}

/// Directions of the segments and place of the middle of the hips.
#[derive(Clone)]
struct Pose {
    root: Vector,
    directions: Vec<Vector>,
}

impl Skeleton {
    fn of(motion: &Trajectories, parents: Vec<usize>) -> Self {
        let length = |(k, parent): (usize, &usize)| {
            let mut all: Vec<f64> = motion.frames.iter().map(|frame| distance(frame[k + 1], frame[*parent])).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        let lengths = parents.iter().enumerate().map(length).collect();
        let index = |name: &str| motion.index(name).unwrap_or_default();
        let feet = (0..motion.names.len()).filter(|&k| FEET.contains(&motion.names[k].as_str())).collect();
        let [hips, shoulders] = [["LHip", "RHip"], ["LShoulder", "RShoulder"]].map(|pair| pair.map(index));
        Self { parents, lengths, feet, hips, shoulders }
    }

    /// The pose of a frame of someone else, with the root at the height that puts the lowest foot where it was in proportion.
    fn pose(&self, frame: &[Vector]) -> Pose {
        let direction =
            |(k, parent): (usize, &usize)| unit(minus(frame[k + 1], frame[*parent])).unwrap_or([0.0, 0.0, -1.0]);
        let directions = self.parents.iter().enumerate().map(direction).collect();
        let mut pose = Pose { root: frame[0], directions };
        let lowest = self.feet.iter().map(|&k| frame[k][2]).fold(f64::INFINITY, f64::min);
        pose.root[2] += lowest - self.lowest_foot(&pose);
        pose
    }

    fn points(&self, pose: &Pose) -> Vec<Vector> {
        let mut points = vec![pose.root];
        for ((direction, length), parent) in pose.directions.iter().zip(&self.lengths).zip(&self.parents) {
            points.push(along(points[*parent], *length, *direction));
        }
        points
    }

    fn lowest_foot(&self, pose: &Pose) -> f64 {
        let points = self.points(pose);
        self.feet.iter().map(|&k| points[k][2]).fold(f64::INFINITY, f64::min)
    }

    /// Where the person looks, by hips and shoulders: a horizontal unit vector.
    fn heading(&self, pose: &Pose) -> Vector {
        let points = self.points(pose);
        let right = [self.hips, self.shoulders].map(|[l, r]| unit(minus(points[r], points[l])).unwrap_or_default());
        let [x, y, _] = along(right[0], 1.0, right[1]);
        let forward = [-y, x, 0.0];
        unit(forward).unwrap_or([0.0, 1.0, 0.0])
    }
}

const FEET: [&str; 6] = ["LAnkle", "RAnkle", "LBigToe", "RBigToe", "LHeel", "RHeel"];

/// Turns a vector about the vertical.
fn turned([x, y, z]: Vector, angle: f64) -> Vector {
    let (sin, cos) = angle.sin_cos();
    [cos * x - sin * y, sin * x + cos * y, z]
}

/// A sequence in the making, its path still straight.
struct Joined<'a> {
    skeleton: &'a Skeleton,
    rate_hz: f64,
    poses: Vec<Pose>,
    /// How much the heading turns in each frame by the way gone forward, radians a metre.
    curvatures: Vec<f64>,
}

impl Joined<'_> {
    fn add(&mut self, motion: &Trajectories, turn_radius_m: Option<f64>) {
        let mut new: Vec<Pose> = motion.frames.iter().map(|frame| self.skeleton.pose(frame)).collect();
        let curvature = turn_radius_m.map_or(0.0, f64::recip);
        if let Some(last) = self.poses.last().cloned() {
            let angle = |pose: &Pose| {
                let [x, y, _] = self.skeleton.heading(pose);
                y.atan2(x)
            };
            let turn = angle(&last) - angle(&new[0]);
            for pose in &mut new {
                pose.root = turned(pose.root, turn);
                pose.directions.iter_mut().for_each(|direction| *direction = turned(*direction, turn));
            }
            let (leaving, arriving) = (self.velocity(&self.poses, false), self.velocity(&new, true));
            let way = [0, 1].map(|i: usize| (leaving[i] + arriving[i]) * JOIN_S / 6.0);
            let moved = [0, 1].map(|i: usize| last.root[i] + way[i] - new[0].root[i]);
            for pose in &mut new {
                pose.root = [pose.root[0] + moved[0], pose.root[1] + moved[1], pose.root[2]];
            }
            let before = self.curvatures.last().copied().unwrap_or(curvature);
            let steps = (JOIN_S * self.rate_hz).round().max(1.0) as usize;
            for k in 1..steps {
                let s = k as f64 / steps as f64;
                self.poses.push(self.between(&last, &new[0], [leaving, arriving], s));
                self.curvatures.push(before + (curvature - before) * smooth(s));
            }
        }
        self.curvatures.extend(std::iter::repeat_n(curvature, new.len()));
        self.poses.extend(new);
    }

    /// Horizontal velocity of the root at an end, over a tenth of a second, metres a second.
    fn velocity(&self, poses: &[Pose], at_start: bool) -> Vector {
        let span = ((0.1 * self.rate_hz).round().max(1.0) as usize).min(poses.len() - 1);
        if span == 0 {
            return [0.0; 3];
        }
        let (from, to) = if at_start { (0, span) } else { (poses.len() - 1 - span, poses.len() - 1) };
        let [x, y, _] = minus(poses[to].root, poses[from].root).map(|x| x * self.rate_hz / span as f64);
        [x, y, 0.0]
    }

    /// A pose at a fraction of a join.
    fn between(&self, last: &Pose, next: &Pose, [leaving, arriving]: [Vector; 2], s: f64) -> Pose {
        let part = smooth(s);
        let directions = last.directions.iter().zip(&next.directions).map(|(a, b)| {
            let mixed = along(a.map(|x| (1.0 - part) * x), part, *b);
            unit(mixed).unwrap_or(*b)
        });
        let [out, back] = [s * (1.0 - s) * (1.0 - s) * JOIN_S, s * s * (s - 1.0) * JOIN_S];
        let horizontal =
            |i: usize| (1.0 - part) * last.root[i] + part * next.root[i] + out * leaving[i] + back * arriving[i];
        let mut pose = Pose { root: [horizontal(0), horizontal(1), last.root[2]], directions: directions.collect() };
        let [from, to] = [last, next].map(|end| self.skeleton.lowest_foot(end));
        pose.root[2] += (1.0 - part) * from + part * to - self.skeleton.lowest_foot(&pose);
        pose
    }

    /// Points of all frames with the path bent.
    fn bent(&self) -> Vec<Vec<Vector>> {
        let mut frames = Vec::with_capacity(self.poses.len());
        let (mut turn, mut root) = (0.0, [0.0; 3]);
        let mut before: Option<&Pose> = None;
        for (pose, curvature) in self.poses.iter().zip(&self.curvatures) {
            let step = before.map_or(pose.root, |before| minus(pose.root, before.root));
            let heading = self.skeleton.heading(pose);
            let forward = before.map_or(0.0, |_| step[0] * heading[0] + step[1] * heading[1]);
            let more = curvature * forward.max(0.0);
            root = along(root, 1.0, turned(step, turn + 0.5 * more));
            turn += more;
            let directions = pose.directions.iter().map(|direction| turned(*direction, turn)).collect();
            frames.push(self.skeleton.points(&Pose { root, directions }));
            before = Some(pose);
        }
        frames
    }
}

/// `3s² − 2s³`.
fn smooth(s: f64) -> f64 {
    s * s * (3.0 - 2.0 * s)
}

/// A sequence like CMB from the walker alone: its usual gait, a quicker one, then standing with arms that swing to the front, to the sides and overhead.
///
/// # Errors
/// Never for a rate that is finite and positive; as [`combo`] else.
pub fn synthetic_combo(rate_hz: f64) -> Result<Sequence, String> {
    let gait = |stride_s: f64, duration_s: f64| {
        let walker = Walker::new(Gait { still_s: 0.0, start_s: 0.9, stride_s, duration_s, ..Gait::default() });
        points_of_states(&walker.body, &walker_states(&walker, rate_hz))
    };
    let standing = Walker::new(Gait { still_s: FREE_S, duration_s: FREE_S, ..Gait::default() });
    let mut states = walker_states(&standing, rate_hz);
    for (k, state) in states.iter_mut().enumerate() {
        swing_arms(state, k as f64 / rate_hz);
    }
    let trial = |name: &str, motion, turn_radius_m| Trial { name: name.into(), motion, turn_radius_m };
    let trials = [
        trial("synthetic walk", gait(1.1, 4.0), Some(TURN_RADIUS_M)),
        trial("synthetic quick walk", gait(0.75, 3.0), Some(TURN_RADIUS_M)),
        trial("synthetic arm swings", points_of_states(&standing.body, &states), None),
    ];
    combo("synthetic CMB", &trials, rate_hz)
}

/// Duration of free movement without recordings, seconds.
const FREE_S: f64 = 6.0;

/// Moves arms, head and trunk of a standing H32; begins and ends at rest.
fn swing_arms(state: &mut [f64], time_s: f64) {
    let rest = 0.5 - 0.5 * (TAU * time_s / FREE_S).cos();
    let wave = |rate_hz: f64, phase: f64| rest * (TAU * (rate_hz * time_s + phase)).sin();
    state[6 + 1] += 0.25 * wave(0.4, 0.0);
    state[8] += 0.3 * wave(0.5, 0.3);
    for (sign, arm, phase) in [(-1.0, 12, 0.0), (1.0, 16, 0.35)] {
        state[arm + 1] -= sign * rest * (0.7 + 0.6 * (TAU * (0.5 * time_s + phase)).sin());
        state[arm + 2] += 0.9 * rest * (0.8 + (TAU * (0.6 * time_s + phase)).sin());
        state[arm + 3] += 0.6 * rest * (1.0 + (TAU * (0.9 * time_s + phase)).sin());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 60.0;

    #[test]
    fn phases_follow_each_other_and_lengths_stay() {
        let sequence = synthetic_combo(RATE_HZ).unwrap();
        let names: Vec<&str> = sequence.phases.iter().map(|phase| phase.name.as_str()).collect();
        assert_eq!(names, ["synthetic walk", "synthetic quick walk", "synthetic arm swings"]);
        assert_eq!(sequence.phases[0].frames, 0..240);
        assert!(sequence.phases.windows(2).all(|pair| pair[0].frames.end == pair[1].frames.start));
        assert_eq!(sequence.phases[2].frames.end, sequence.motion.frames.len());
        for (child, parent) in BONES {
            let columns = [child, parent].map(|name| sequence.motion.index(name).unwrap());
            let length = |frame: &Vec<Vector>| distance(frame[columns[0]], frame[columns[1]]);
            let first = length(&sequence.motion.frames[0]);
            assert!(sequence.motion.frames.iter().all(|frame| (length(frame) - first).abs() < 1e-9), "{child}");
        }
    }

    #[test]
    fn nothing_jumps_and_nobody_sinks() {
        let sequence = synthetic_combo(RATE_HZ).unwrap();
        for pair in sequence.motion.frames.windows(2) {
            for (a, b) in pair[0].iter().zip(&pair[1]) {
                assert!(distance(*a, *b) * RATE_HZ < 9.0, "{} m/s", distance(*a, *b) * RATE_HZ);
            }
        }
        let [low, high] = sequence.motion.bounds().unwrap();
        assert!(low[2] > -0.03 && high[2] < 2.3, "{low:?} {high:?}");
        assert!((0..2).all(|i| high[i] - low[i] < 4.5), "{low:?} {high:?}");
    }

    /// The middle of the hips begins and ends a join with the velocities of its trials, and the heading continues.
    #[test]
    fn joins_are_smooth() {
        let sequence = synthetic_combo(RATE_HZ).unwrap();
        let hips = sequence.motion.index("MidHip").unwrap();
        let velocity = |frame: usize| {
            let [x, y, _] = minus(sequence.motion.frames[frame + 1][hips], sequence.motion.frames[frame][hips]);
            [RATE_HZ * x, RATE_HZ * y]
        };
        for start in [240_usize, 539] {
            for end in [start - 1, start + 118] {
                let [a, b] = [velocity(end - 1), velocity(end + 1)];
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 0.45, "{a:?} {b:?} at {end}");
            }
            let [x, y] = velocity(start + 59);
            assert!(x.hypot(y) < 0.5, "{x} {y}");
        }
    }

    #[test]
    fn what_cannot_be_joined_is_refused() {
        let message = |trials: &[Trial]| combo("x", trials, 30.0).unwrap_err().to_string();
        assert_eq!(message(&[]), "a sequence of no trials");
        let trial = |motion| Trial { name: "a".into(), motion, turn_radius_m: None };
        assert_eq!(message(&[trial(Trajectories::default())]), "the trial a has no MidHip");
        let names = EVALUATION_JOINTS.map(str::to_owned).to_vec();
        assert_eq!(message(&[trial(Trajectories { names, frames: vec![] })]), "the trial a has no frame");
    }

    #[test]
    fn a_sequence_may_be_one_frame() {
        let names = EVALUATION_JOINTS.map(str::to_owned).to_vec();
        let frame: Vec<Vector> = (0..15).map(|k| [0.1 * f64::from(k), 0.0, 0.07 * f64::from(k * k)]).collect();
        let trial = Trial {
            name: "a".into(),
            motion: Trajectories { names, frames: vec![frame] },
            turn_radius_m: Some(TURN_RADIUS_M),
        };
        let sequence = combo("x", &[trial.clone(), trial], 10.0).unwrap();
        assert_eq!(sequence.motion.frames.len(), 21);
    }

    /// A body goes twice as fast on four times the radius, and never on less than that of walks.
    #[test]
    fn radii_follow_the_square_of_the_speed() {
        let line = |speed: f64| {
            let frames = (0..=30).map(|k| vec![[0.0, speed * f64::from(k) / 30.0, 1.0]]).collect();
            comfortable_radius_m(&Trajectories { names: vec!["MidHip".into()], frames }, 30.0)
        };
        assert!((line(3.0) - 3.0).abs() < 1e-12 && (line(6.0) - 12.0).abs() < 1e-12);
        assert_eq!(line(1.3).to_bits(), TURN_RADIUS_M.to_bits());
    }
}
