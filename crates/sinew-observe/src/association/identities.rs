//! Who is who, over all views and frames: everybody at once.
//!
//! Each frame:
//!
//! 1. Everybody who was there a moment ago is expected where they were, moved on with their velocity. In each view, people are assigned to those who are expected ([`least_cost`]), within the gate [`Config::near`]. So two who cross keep their names.
//! 2. Views that contradict the others of a person are taken from them again; one view alone must lie nearer.
//! 3. Whoever is left over is grouped over the views ([`partition`]). A group that stands where somebody is whom these views had missed is that person. Another one begins a stay.
//! 4. Points in space and velocities are brought up to date, and lengths of segments are kept.
//!
//! After the last frame, stays of the same person are joined ([`crate::association::identities_joining`]): who comes is not decided by the first frame.
//!
//! What somebody looks like is not used. Cost of a frame: linear in the views, and in the people but for the assignment, which is cubic and small.

use crate::association::assignment::least_cost;
use crate::association::identities_joining::{Naming, Stay, joined};
use crate::association::view_partition::{partition, relative_distance};
use crate::association::{Config, Person, PersonGroup, distance_px, person_size_px, projected, size_px, triangulated};
use crate::cameras::camera::Camera;
use sinew_core::estimators::{mean, median};

/// Distance in space up to which a group is somebody who is there, metres.
const SAME_PLACE_M: f64 = 0.3;
/// Share of a new velocity that counts.
const FRESH: f64 = 0.3;

/// Somebody who stays, and where they were last.
#[derive(Clone, Debug, PartialEq)]
struct Known {
    points: Vec<Option<[f64; 3]>>,
    /// Metres a frame.
    velocity: [f64; 3],
    /// Frames since two views agreed on them.
    unseen: u64,
    stay: Stay,
}

/// Everybody so far.
#[derive(Clone, Debug)]
pub struct Identities<'a> {
    cameras: &'a [Camera],
    config: Config,
    /// Segments, each on the left and the right: pairs of keypoints at their ends.
    segments: Vec<Vec<(usize, usize)>>,
    fps: f64,
    /// Frames so far.
    frames: u64,
    known: Vec<Known>,
}

/// For each view and each of its people, the number of the stay, counted from 0 in the order of coming.
pub type Named = Vec<Vec<Option<usize>>>;

impl<'a> Identities<'a> {
    /// Nobody yet. `segments` are pairs of keypoints, those on the left and the right of one length together; `fps` frames a second.
    #[must_use]
    pub const fn new(cameras: &'a [Camera], segments: Vec<Vec<(usize, usize)>>, fps: f64, config: Config) -> Self {
        Self { cameras, config, segments, fps, frames: 0, known: vec![] }
    }

    /// Who the stays so far are of.
    #[must_use]
    pub fn people(&self) -> Vec<Naming> {
        let stays: Vec<Stay> = self.known.iter().map(|known| known.stay.clone()).collect();
        joined(&stays, self.fps)
    }

    /// Finds the stays of the people of the next frame.
    pub fn name(&mut self, people: &[Vec<Person>]) -> Named {
        let views = self.cameras.len();
        for known in &mut self.known {
            known.unseen += 1;
        }
        let present: Vec<usize> = (0..self.known.len()).filter(|&k| self.is_present(k)).collect();
        let mut members: Vec<Vec<Option<usize>>> = vec![vec![None; views]; self.known.len()];
        let expected: Vec<Vec<Option<[f64; 3]>>> = present.iter().map(|&k| self.known[k].expected()).collect();
        for (view, people) in people.iter().enumerate() {
            let costs: Vec<Vec<f64>> = expected.iter().map(|points| self.costs(view, people, points)).collect();
            for (k, found) in present.iter().zip(least_cost(&costs, self.config.near)) {
                members[*k][view] = found;
            }
        }
        for (&k, expected) in present.iter().zip(&expected) {
            self.drop_contradicting(people, &mut members[k], expected);
        }
        let mut free: Vec<Vec<bool>> = people.iter().map(|people| vec![true; people.len()]).collect();
        for (view, found) in members.iter().flat_map(|members| members.iter().enumerate()) {
            found.iter().for_each(|i| free[view][*i] = false);
        }
        let mut groups = partition(self.cameras, people, free, &self.config);
        groups.retain(|group| !self.joins(group, &present, &mut members));
        for group in groups {
            let stay = Stay { log_lengths: vec![vec![]; self.segments.len()], ..Stay::default() };
            self.known.push(Known { points: vec![], velocity: [0.0; 3], unseen: 0, stay });
            members.push(group.members);
        }
        for (k, members) in members.iter().enumerate() {
            self.see(k, &triangulated(self.cameras, people, members, &self.config), members);
        }
        self.frames += 1;
        let mut named: Named = people.iter().map(|people| vec![None; people.len()]).collect();
        for (k, members) in members.iter().enumerate() {
            let seen = members.iter().enumerate().filter_map(|(view, i)| Some((view, (*i)?)));
            seen.for_each(|(view, i)| named[view][i] = Some(k));
        }
        named
    }

    fn is_present(&self, k: usize) -> bool {
        self.known[k].unseen <= self.config.lost_frames as u64
    }

    /// How far each person of a view is from where someone is expected, in sizes; infinite beyond the gate.
    fn costs(&self, view: usize, people: &[Person], expected: &[Option<[f64; 3]>]) -> Vec<f64> {
        let pixels = projected(&self.cameras[view], expected);
        let expected_px = size_px(pixels.iter().flatten().copied());
        let cost = |person: &Person| {
            let (distance, _) = distance_px(person, &pixels, &self.config)?;
            let size = expected_px.min(2.0 * person_size_px(person, &self.config));
            Some(distance / size).filter(|cost| *cost <= self.config.near)
        };
        people.iter().map(|person| cost(person).unwrap_or(f64::INFINITY)).collect()
    }

    /// Takes views from a person that contradict their others, the one that is off most first; of two, the one that is farther from where they are expected.
    fn drop_contradicting(&self, people: &[Vec<Person>], members: &mut [Option<usize>], expected: &[Option<[f64; 3]>]) {
        let off = |members: &[Option<usize>], points: &[Option<[f64; 3]>]| -> Vec<(f64, usize)> {
            let seen = members.iter().enumerate().filter_map(|(view, i)| Some((view, (*i)?)));
            let distance = |(view, i): (usize, usize)| {
                relative_distance(&people[view][i], &self.cameras[view], points, &self.config)
            };
            seen.map(|(view, i)| (distance((view, i)).unwrap_or(f64::INFINITY), view)).collect()
        };
        let most = |all: Vec<(f64, usize)>| all.into_iter().max_by(|a, b| a.0.total_cmp(&b.0));
        loop {
            let count = members.iter().flatten().count();
            let points = triangulated(self.cameras, people, members, &self.config);
            match count {
                0 => return,
                1 => {
                    let is_near = most(off(members, expected)).is_some_and(|(off, _)| off <= self.config.agreeing);
                    if !is_near {
                        members.fill(None);
                    }
                    return;
                }
                _ => {
                    let Some((worst, mut view)) = most(off(members, &points)) else { return };
                    if worst <= 2.0 * self.config.agreeing {
                        return;
                    }
                    if count == 2 {
                        view = most(off(members, expected)).map_or(view, |(_, view)| view);
                    }
                    members[view] = None;
                }
            }
        }
    }

    /// Whether a group is somebody present whom its views had missed; then the views are theirs.
    fn joins(&self, group: &PersonGroup, present: &[usize], members: &mut [Vec<Option<usize>>]) -> bool {
        let is_he = |&&k: &&usize| {
            let fits = distance_m(&group.points, &self.known[k].expected()).is_some_and(|m| m <= SAME_PLACE_M);
            fits && members[k].iter().zip(&group.members).all(|(own, found)| own.is_none() || found.is_none())
        };
        let Some(&k) = present.iter().find(is_he) else { return false };
        members[k].iter_mut().zip(&group.members).for_each(|(own, found)| *own = own.or(*found));
        true
    }

    /// Takes in where somebody is.
    fn see(&mut self, k: usize, points: &[Option<[f64; 3]>], members: &[Option<usize>]) {
        let known = &mut self.known[k];
        if members.iter().flatten().count() < 2 || points.iter().flatten().count() < self.config.least_keypoints {
            return;
        }
        let frames = known.unseen.max(1) as f64;
        if let Some(moved) = moved_m(points, &known.points) {
            for (velocity, moved) in known.velocity.iter_mut().zip(moved) {
                *velocity += FRESH * (moved / frames - *velocity);
            }
        }
        let (begins, expected) = (known.points.is_empty(), known.expected());
        known.points = (0..points.len()).map(|p| points[p].or_else(|| expected.get(p).copied().flatten())).collect();
        for (log_lengths, sides) in known.stay.log_lengths.iter_mut().zip(&self.segments) {
            let seen: Vec<f64> =
                sides.iter().filter_map(|ends| Some(length(points, *ends)?.ln())).filter(|x| x.is_finite()).collect();
            log_lengths.extend((!seen.is_empty()).then(|| mean(&seen)));
        }
        let place =
            [0, 1, 2].map(|axis: usize| median(&mut points.iter().flatten().map(|p| p[axis]).collect::<Vec<_>>()));
        let stay = &mut known.stay;
        if begins {
            (stay.frames[0], stay.places[0]) = (self.frames, place);
        }
        (stay.frames[1], stay.places[1]) = (self.frames, place);
        known.unseen = 0;
    }
}

impl Known {
    /// Where they are expected now.
    fn expected(&self) -> Vec<Option<[f64; 3]>> {
        let frames = self.unseen as f64;
        let moved = |point: &[f64; 3]| [0, 1, 2].map(|axis: usize| point[axis] + frames * self.velocity[axis]);
        self.points.iter().map(|point| point.as_ref().map(moved)).collect()
    }
}

fn length(points: &[Option<[f64; 3]>], (a, b): (usize, usize)) -> Option<f64> {
    let [a, b] = [a, b].map(|k| points.get(k).copied().flatten());
    Some(norm(difference(a?, b?)))
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|axis: usize| a[axis] - b[axis])
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Points that both have, the first less the second.
fn differences(a: &[Option<[f64; 3]>], b: &[Option<[f64; 3]>]) -> Vec<[f64; 3]> {
    a.iter().zip(b).filter_map(|(a, b)| Some(difference((*a)?, (*b)?))).collect()
}

/// Median distance between points that both have, metres.
fn distance_m(a: &[Option<[f64; 3]>], b: &[Option<[f64; 3]>]) -> Option<f64> {
    let mut distances: Vec<f64> = differences(a, b).into_iter().map(norm).collect();
    (!distances.is_empty()).then(|| median(&mut distances))
}

/// Median over the points of how far they have moved along each axis, metres.
fn moved_m(now: &[Option<[f64; 3]>], before: &[Option<[f64; 3]>]) -> Option<[f64; 3]> {
    let moved = differences(now, before);
    (!moved.is_empty())
        .then(|| [0, 1, 2].map(|axis: usize| median(&mut moved.iter().map(|v| v[axis]).collect::<Vec<_>>())))
}
