//! Several people who walk across each other's ways, and a detector that takes one for another.
//!
//! Each person is an adult of their own size ([`crate::adult`]) who stands for a moment and walks straight across the middle, in a direction of their own; half way all of them are near the middle, each at most [`BESIDE_M`] beside it. Where that is longer than a room of [`ROOM_M`] they turn before its walls ([`crate::room`]) and come through the middle again and again. Keypoints are as in [`crate::detector`], and besides, in a camera and frame
//!
//! 1. a keypoint that another person hides is not found: the ray to it enters their body before;
//! 2. somebody is lost with the probability [`CrowdNoise::lost`];
//! 3. of two whose boxes in the image share more than [`CLOSE`] of the smaller one, the farther is merged into the nearer with the probability [`CrowdNoise::merged`]: the farther is not found;
//! 4. else the two exchange an arm or a leg with the probability [`CrowdNoise::swapped`];
//! 5. people are listed in any order.
//!
//! With [`Absences`] people come late, leave, and come back or not ([`crate::crowd_absence`]).

use crate::Error;
use crate::adult::drawn;
use crate::calibration_error::{CalibrationError, as_they_are};
use crate::cast::Cast;
use crate::crowd_absence::{Absences, away};
use crate::detector::{DetectorNoise, detect, paired_limbs};
use crate::draws::uniforms;
use crate::evaluation_body::EvaluationBody;
use crate::recording::{body_25b, keypoint_json};
use crate::ring::{Ring, around};
use crate::room::WALL_M;
use crate::walker::{Gait, Walker, walker_states};
use sinew_body::points::{Trajectories, points_of_states};
use sinew_core::random::Stage;
use sinew_formats::Layout;
use sinew_formats::openpose::Keypoint;
use sinew_observe::Camera;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// How far people pass beside the middle, metres.
pub const BESIDE_M: f64 = 0.5;
/// Side of the square room that a crowd stays in, metres.
pub const ROOM_M: f64 = 8.0;
/// How much farther from the middle the corners of a way are than its ends.
const CORNER: f64 = 1.15;
/// Share of the smaller box from which two people are close in an image.
pub const CLOSE: f64 = 0.3;
/// A keypoint lies this deep in its own body, metres.
const FLESH_M: f64 = 0.12;

/// How a detector errs with several people.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrowdNoise {
    /// Errors of keypoints.
    pub keypoints: DetectorNoise,
    /// Probability that somebody is lost in a camera and frame.
    pub lost: f64,
    /// Probability that of two who are close in an image the farther is not found.
    pub merged: f64,
    /// Probability that two who are close exchange an arm or a leg.
    pub swapped: f64,
}

impl CrowdNoise {
    /// What a good detector does in a crowd.
    pub const DETECTOR_LIKE: Self = Self {
        keypoints: DetectorNoise { offset_px: 0.0, ..DetectorNoise::DETECTOR_LIKE },
        lost: 0.02,
        merged: 0.2,
        swapped: 0.1,
    };
}

/// Who walks before which cameras.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crowd {
    /// People.
    pub people: usize,
    /// Seconds.
    pub duration_s: f64,
    /// Frames a second.
    pub rate_hz: f64,
    /// Cameras.
    pub ring: Ring,
    /// How far cameras are from their calibration.
    pub calibration: CalibrationError,
    /// Errors of the detector.
    pub noise: CrowdNoise,
}

/// People of a frame in a camera, each with the keypoints of the layout.
pub type FoundPeople = Vec<Vec<Option<Keypoint>>>;

/// A recording of several people.
#[derive(Clone, Debug, PartialEq)]
pub struct CrowdRecording {
    /// True points of each person, also while they are away.
    pub truth: Vec<Trajectories>,
    /// Frames in which each person is away; empty where they never are.
    pub away: Vec<Range<usize>>,
    /// Cameras, as their calibration has them.
    pub cameras: Vec<Camera>,
    /// Layout of the keypoints, BODY_25B.
    pub layout: Layout,
    /// For each camera and frame the people that are found.
    pub keypoints: Vec<Vec<FoundPeople>>,
    /// For each camera, frame and person found, who it is.
    pub who: Vec<Vec<Vec<usize>>>,
    /// Frames a second.
    pub rate_hz: f64,
}

impl CrowdRecording {
    /// Records a crowd that is there all the time. The same seed gives the same recording on every machine.
    ///
    /// # Errors
    /// [`Error::Camera`] for a ring whose numbers are not finite and positive; errors of [`EvaluationBody::new`].
    pub fn new(crowd: &Crowd, seed: u64) -> Result<Self, Error> {
        Self::with_absences(crowd, None, seed)
    }

    /// Records a crowd that comes and goes.
    ///
    /// # Errors
    /// As [`CrowdRecording::new`].
    pub fn with_absences(crowd: &Crowd, absences: Option<&Absences>, seed: u64) -> Result<Self, Error> {
        let stage = Stage::new(seed, "crowd");
        let [ways, bodies, detector, mix] = stage.split(["ways", "bodies", "detector", "mix"]);
        let (mut truth, turns) = walks(crowd, &ways);
        let absent = Stage::new(seed, "absences");
        let away: Vec<Range<usize>> = truth
            .iter_mut()
            .enumerate()
            .map(|(person, one)| absences.map_or(0..0, |a| away(a, crowd.rate_hz, one, turns, &absent.round(person))))
            .collect();
        let together = |frame: usize| truth.iter().flat_map(|one| one.frames[frame].iter().copied()).collect();
        let frames = truth.first().map_or(0, |one| one.frames.len());
        let all = Trajectories { names: vec![], frames: (0..frames).map(together).collect() };
        let cameras = around(&all, &crowd.ring)?;
        let true_cameras = as_they_are(&cameras, &crowd.calibration, &Stage::new(seed, "calibration"));
        let layout = body_25b();
        let mut solid = vec![];
        let mut found = vec![];
        for (person, one) in truth.iter().enumerate() {
            solid.push(EvaluationBody::new(one, bodies.round(person))?);
            let noise = &crowd.noise.keypoints;
            found.push(detect(one, &layout, (&true_cameras, &[]), noise, detector.round(person)).keypoints);
        }
        let scene = Scene { truth: &truth, bodies: &solid, away: &away, layout: &layout, noise: &crowd.noise };
        let (mut keypoints, mut who) = (vec![], vec![]);
        for (c, camera) in true_cameras.iter().enumerate() {
            let shown = |frame: usize| {
                let seen = found.iter().map(|person| person[c][frame].clone()).collect();
                let number = u32::try_from(frame).unwrap_or(u32::MAX);
                scene.mixed(camera, frame, seen, &mix.round(c).at_frame(number))
            };
            let (found, names): (Vec<FoundPeople>, Vec<Vec<usize>>) = (0..frames).map(shown).unzip();
            keypoints.push(found);
            who.push(names);
        }
        Ok(Self { truth, away, cameras, layout, keypoints, who, rate_hz: crowd.rate_hz })
    }
}

impl CrowdRecording {
    /// Name, below the folder of keypoints, and text of every keypoint file: `C1_json/C1.0000.json`, ….
    pub fn keypoint_files(&self) -> impl Iterator<Item = (String, String)> + '_ {
        self.cameras.iter().zip(&self.keypoints).flat_map(|(camera, frames)| {
            let name = &camera.name;
            frames.iter().enumerate().map(move |(f, people)| {
                let people: Vec<&[Option<Keypoint>]> = people.iter().map(Vec::as_slice).collect();
                (format!("{name}_json/{name}.{f:04}.json"), keypoint_json(&people))
            })
        })
    }
}

/// Everybody's way, and whether they turn within the room. Who turns comes through the middle often: ways are drawn until nobody walks through anybody.
fn walks(crowd: &Crowd, stage: &Stage) -> (Vec<Trajectories>, bool) {
    let mut found = (vec![], false);
    for draw in 0..MOST_DRAWS {
        found = drawn_walks(crowd, stage, draw);
        if !found.1 || least_distance(&found.0) > THROUGH_M {
            break;
        }
    }
    found
}

/// Draws of ways after which people may walk through each other.
const MOST_DRAWS: usize = 32;
/// Distance of the hips of two people of whom one would walk through the other, metres.
const THROUGH_M: f64 = 0.15;

/// The least distance of two people's hips in any frame, metres.
fn least_distance(walks: &[Trajectories]) -> f64 {
    let hips: Vec<Vec<[f64; 3]>> = walks
        .iter()
        .filter_map(|walk| walk.index("MidHip").map(|hip| walk.frames.iter().map(|frame| frame[hip]).collect()))
        .collect();
    let apart = |(p, q): (&[f64; 3], &[f64; 3])| (p[0] - q[0]).hypot(p[1] - q[1]);
    let pairs = hips.iter().enumerate().flat_map(|(a, one)| hips[..a].iter().map(move |other| (one, other)));
    pairs.flat_map(|(one, other)| one.iter().zip(other).map(apart)).fold(f64::INFINITY, f64::min)
}

/// The `draw`-th draw of everybody's way, and whether they turn within the room.
fn drawn_walks(crowd: &Crowd, stage: &Stage, draw: usize) -> (Vec<Trajectories>, bool) {
    let own = |person: usize| stage.round(2 * crowd.people * draw + person);
    let luck: Vec<Vec<f64>> = (0..crowd.people).map(|person| uniforms(&own(person), 0, 4)).collect();
    let straight = |(person, luck): (usize, &Vec<f64>)| {
        Walker::new(Gait {
            still_s: 0.2 + 0.6 * luck[0],
            stride_s: 1.0 + 0.2 * luck[1],
            duration_s: crowd.duration_s,
            proportions: drawn(&stage.round(crowd.people + person)),
            room_m: [f64::INFINITY; 2],
            ..Gait::default()
        })
    };
    let mut walkers: Vec<Walker> = luck.iter().enumerate().map(straight).collect();
    let longest = walkers.iter().map(Walker::length).fold(0.0, f64::max);
    let turns = longest > ROOM_M - 2.0 * WALL_M;
    if turns {
        // Ways as long as people are fast: all come to the middle at about the same times, as often as they do.
        let reach = (0.5 * ROOM_M - WALL_M - BESIDE_M) / CORNER;
        let own = |walker: &Walker| 2.0 * (reach * walker.length() / longest + WALL_M);
        walkers = walkers.iter().map(|w| Walker::new(Gait { room_m: [own(w); 2], ..w.gait })).collect();
    }
    let walk = |(person, (walker, luck)): (usize, (&Walker, &Vec<f64>))| {
        let states = walker_states(walker, crowd.rate_hz);
        let half_way = states.get(states.len() / 2).map_or(0.0, |state| state[1]);
        let middle = walker.middle().unwrap_or(half_way);
        let heading = TAU * person as f64 / crowd.people as f64 + 0.4 * (luck[2] - 0.5);
        // Whoever comes from the opposite side passes on the other side.
        let beside = BESIDE_M * (0.5 + 0.5 * luck[3]);
        let (sin, cos) = (heading + if crowd.people == 1 { 0.0 } else { PI / 8.0 }).sin_cos();
        let mut motion = points_of_states(&walker.body, &states);
        for point in motion.frames.iter_mut().flatten() {
            let [x, y] = [point[0] + beside, point[1] - middle];
            (point[0], point[1]) = (cos * x - sin * y, sin * x + cos * y);
        }
        motion
    };
    (walkers.iter().zip(&luck).enumerate().map(walk).collect(), turns)
}

/// What hides and is mixed up.
struct Scene<'a> {
    truth: &'a [Trajectories],
    bodies: &'a [EvaluationBody],
    away: &'a [Range<usize>],
    layout: &'a Layout,
    noise: &'a CrowdNoise,
}

impl Scene<'_> {
    /// What a detector makes of everybody in a frame, and who is who.
    fn mixed(&self, camera: &Camera, frame: usize, mut seen: FoundPeople, stage: &Stage) -> (FoundPeople, Vec<usize>) {
        let people = self.truth.len();
        let away = self.away.iter().zip(&mut seen).filter(|(away, _)| away.contains(&frame));
        away.for_each(|(_, person)| person.fill(None));
        let boxes: Vec<Option<[f64; 4]>> = seen.iter().map(|person| image_box(person)).collect();
        let depth = |person: usize| {
            let points = &self.truth[person].frames[frame];
            points.iter().map(|point| camera.point_in_camera(*point)[2]).sum::<f64>() / points.len().max(1) as f64
        };
        let mut luck = uniforms(stage, 0, 2 * people * (people + 1)).into_iter();
        let mut next = || luck.next().unwrap_or(1.0);
        let mut is_lost: Vec<bool> = (0..people).map(|_| next() < self.noise.lost).collect();
        for near in 0..people {
            for far in (0..people).filter(|&far| far != near && depth(far) > depth(near)) {
                let [merges, swaps] = [next(), next()];
                if !boxes[near].zip(boxes[far]).is_some_and(|(a, b)| shared(a, b) > CLOSE) {
                    continue;
                }
                self.hide(camera, frame, [near, far], &mut seen[far]);
                if merges < self.noise.merged {
                    is_lost[far] = true;
                } else if swaps < self.noise.swapped {
                    let limb = &paired_limbs(self.layout)[usize::from(swaps < 0.5 * self.noise.swapped)];
                    for &(left, _) in limb {
                        let (a, b) = (seen[near][left], seen[far][left]);
                        (seen[near][left], seen[far][left]) = (b, a);
                    }
                }
            }
        }
        let order = uniforms(stage, 1, people);
        let mut names: Vec<usize> =
            (0..people).filter(|&k| !is_lost[k] && seen[k].iter().any(Option::is_some)).collect();
        names.sort_by(|a, b| order[*a].total_cmp(&order[*b]));
        (names.iter().map(|&k| std::mem::take(&mut seen[k])).collect(), names)
    }

    /// Takes away the keypoints of one person that another hides.
    fn hide(&self, camera: &Camera, frame: usize, [near, far]: [usize; 2], seen: &mut [Option<Keypoint>]) {
        let solids = self.bodies[near].solids(frame);
        let casts: Vec<Cast> = solids.iter().filter_map(|solid| Cast::new(camera, &solid.shape)).collect();
        for (name, seen) in self.layout.points.iter().zip(seen) {
            let point = name.as_deref().and_then(|name| self.truth[far].index(name));
            let Some(point) = point.map(|k| self.truth[far].frames[frame][k]) else { continue };
            let [x, y, z] = camera.point_in_camera(point);
            let place = [x / z, y / z];
            let is_inside = |cast: &&Cast| (0..2).all(|k| (cast.bounds[k][0]..=cast.bounds[k][1]).contains(&place[k]));
            let entries = casts.iter().filter(is_inside).filter_map(|cast| cast.entry(place));
            if entries.fold(f64::INFINITY, f64::min) < z - FLESH_M {
                *seen = None;
            }
        }
    }
}

/// Box around keypoints: least u and v, greatest u and v.
fn image_box(person: &[Option<Keypoint>]) -> Option<[f64; 4]> {
    let mut points = person.iter().flatten();
    let first = points.next()?;
    let grow = |[a, b, c, d]: [f64; 4], k: &Keypoint| [a.min(k.x), b.min(k.y), c.max(k.x), d.max(k.y)];
    Some(points.fold([first.x, first.y, first.x, first.y], grow))
}

/// Share of the smaller of two boxes that both have.
fn shared(a: [f64; 4], b: [f64; 4]) -> f64 {
    let side = |k: usize| (a[k + 2].min(b[k + 2]) - a[k].max(b[k])).max(0.0);
    let area = |c: [f64; 4]| (c[2] - c[0]) * (c[3] - c[1]);
    side(0) * side(1) / area(a).min(area(b)).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crowd(people: usize) -> Crowd {
        Crowd {
            people,
            duration_s: 3.0,
            rate_hz: 20.0,
            ring: Ring::default(),
            calibration: CalibrationError::NONE,
            noise: CrowdNoise::DETECTOR_LIKE,
        }
    }

    #[test]
    fn people_meet_near_the_middle_and_do_not_stand_in_each_other() {
        for seed in 1..6 {
            let recording = CrowdRecording::new(&crowd(4), seed).unwrap();
            let hip = recording.truth[0].index("RHip").unwrap();
            let at = |person: usize, frame: usize| recording.truth[person].frames[frame][hip];
            let distance = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]).hypot(a[1] - b[1]);
            let frames = recording.truth[0].frames.len();
            for (a, b) in [(0, 1), (0, 2), (1, 3)] {
                let nearest = (0..frames).map(|f| distance(at(a, f), at(b, f))).fold(f64::INFINITY, f64::min);
                assert!((0.15..1.6).contains(&nearest), "{a} and {b} pass at {nearest} m, seed {seed}");
            }
        }
    }

    #[test]
    fn a_crowd_of_a_minute_stays_in_its_room_and_nobody_walks_through_anybody() {
        for seed in 1..4 {
            let crowd = Crowd { duration_s: 60.0, rate_hz: 5.0, ..crowd(4) };
            let (truth, turns) = walks(&crowd, &Stage::new(seed, "crowd"));
            assert!(turns);
            let hip = truth[0].index("MidHip").unwrap();
            for frame in 0..300 {
                let points = truth.iter().flat_map(|one| &one.frames[frame]);
                let reach = points.map(|p| p[0].abs().max(p[1].abs())).fold(0.0, f64::max);
                assert!(reach < 0.5 * ROOM_M, "{reach} m from the middle, seed {seed}");
                for a in 0..4 {
                    for b in 0..a {
                        let [p, q] = [a, b].map(|person| truth[person].frames[frame][hip]);
                        let apart = (p[0] - q[0]).hypot(p[1] - q[1]);
                        assert!(apart > THROUGH_M, "{a} and {b} are {apart} m apart in frame {frame}, seed {seed}");
                    }
                }
            }
            let all = Trajectories { names: vec![], frames: truth.into_iter().flat_map(|one| one.frames).collect() };
            for camera in around(&all, &Ring::default()).unwrap() {
                let [x, y, _] = camera.centre();
                assert!(x.hypot(y) < 2.5 + 0.5 * ROOM_M + 0.5, "a camera at {x}, {y}, seed {seed}");
            }
        }
    }

    #[test]
    fn whoever_stands_behind_is_hidden_and_nobody_is_without_noise_before() {
        let clean = CrowdNoise { keypoints: DetectorNoise::stated_gaussian(0.0), lost: 0.0, merged: 0.0, swapped: 0.0 };
        let recording = CrowdRecording::new(&Crowd { noise: clean, ..crowd(4) }, 2).unwrap();
        let alone = CrowdRecording::new(&Crowd { noise: clean, people: 1, ..crowd(1) }, 2).unwrap();
        let count = |recording: &CrowdRecording| {
            let people = recording.keypoints.iter().flatten().flatten();
            let all: Vec<usize> = people.map(|person| person.iter().flatten().count()).collect();
            (all.iter().sum::<usize>() as f64 / all.len() as f64, all.len())
        };
        let [(seen, people), (whole, one)] = [count(&recording), count(&alone)];
        assert_eq!((people, one), (4 * 4 * 60, 4 * 60));
        assert!(seen < whole - 0.5, "{seen} of {whole} keypoints a person");
    }

    #[test]
    fn a_detector_loses_and_merges_people_and_lists_them_in_any_order() {
        let recording = CrowdRecording::new(&crowd(3), 7).unwrap();
        let lists: Vec<&Vec<usize>> = recording.who.iter().flatten().collect();
        assert!(lists.iter().any(|names| names.len() < 3));
        assert!(lists.iter().any(|names| **names == [0, 1, 2]) && lists.iter().any(|names| **names == [2, 1, 0]));
        let again = CrowdRecording::new(&crowd(3), 7).unwrap();
        assert_eq!(recording, again);
    }

    #[test]
    fn whoever_is_away_is_found_by_no_camera_and_comes_back() {
        let crowd = Crowd { duration_s: 8.0, ..crowd(3) };
        let recording = CrowdRecording::with_absences(&crowd, Some(&Absences::USUAL), 5).unwrap();
        for (person, away) in recording.away.iter().enumerate() {
            assert!(!away.is_empty() && away.end <= 160, "{away:?}");
            let cameras = |frame: usize| recording.who.iter().filter(|who| who[frame].contains(&person)).count();
            assert!(away.clone().all(|frame| cameras(frame) == 0), "{person} is seen while away");
            let stays = [(0, away.start), (away.end, 160)];
            assert!(stays.iter().all(|&(a, b)| (a..b).map(cameras).sum::<usize>() >= 2 * (b - a)), "{person}");
        }
    }
}
