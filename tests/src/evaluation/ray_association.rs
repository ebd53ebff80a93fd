//! The usual recipe for several people: rays that meet, frame by frame, then the least displacement.
//!
//! As Pose2Sim associates people (Pagnon et al., Sensors 21 (2021) 6530; its `personAssociation`):
//!
//! 1. The affinity of two people in two cameras is 1 − d / [`MOST_M`], d the mean distance of the rays through their keypoints; below [`LEAST_AFFINITY`] they are not the same.
//! 2. Pairs are joined, the surest first, as long as a group has at most one person of a camera. (Pose2Sim makes its affinities consistent over the cameras by singular value thresholding instead.)
//! 3. Groups of two cameras and more are triangulated.
//! 4. From frame to frame each is the one that has moved least, by assignment; who has moved more than [`JUMP_M`] is somebody new.

use super::several_people::{Points, Track};
use sinew::observe::Camera;
use sinew::observe::association::assignment::least_cost;
use sinew::observe::association::{Config, Person, triangulated};

/// Distance of rays from which people are not the same, metres.
pub const MOST_M: f64 = 0.1;
/// Least affinity of the same person.
pub const LEAST_AFFINITY: f64 = 0.2;
/// Farthest that somebody moves between frames, metres.
pub const JUMP_M: f64 = 1.0;

/// Tracks of everybody in the frames.
#[must_use]
pub fn tracks(cameras: &[Camera], frames: &[Vec<Vec<Person>>]) -> Vec<Track> {
    let config = Config::default();
    let mut tracks: Vec<Track> = vec![];
    for (frame, people) in frames.iter().enumerate() {
        let found: Vec<Points> = groups(cameras, people, &config)
            .iter()
            .map(|members| triangulated(cameras, people, members, &config))
            .filter(|points| points.iter().flatten().count() >= config.least_keypoints)
            .collect();
        let before = |track: &Track| frame.checked_sub(1).and_then(|last| track[last].clone());
        let cost = |track: &Track, new: &Points| before(track).map_or(f64::INFINITY, |old| moved(&old, new));
        let costs: Vec<Vec<f64>> =
            found.iter().map(|new| tracks.iter().map(|track| cost(track, new)).collect()).collect();
        let assigned = least_cost(&costs, JUMP_M);
        tracks.iter_mut().for_each(|track| track.push(None));
        for (points, track) in found.into_iter().zip(assigned) {
            let track = track.unwrap_or_else(|| {
                tracks.push(vec![None; frame + 1]);
                tracks.len() - 1
            });
            tracks[track][frame] = Some(points);
        }
    }
    tracks
}

fn moved(old: &Points, new: &Points) -> f64 {
    let both: Vec<f64> = old.iter().zip(new).filter_map(|(a, b)| Some(length(minus((*a)?, (*b)?)))).collect();
    if both.is_empty() { f64::INFINITY } else { both.iter().sum::<f64>() / both.len() as f64 }
}

/// For each group the person of each camera.
fn groups(cameras: &[Camera], people: &[Vec<Person>], config: &Config) -> Vec<Vec<Option<usize>>> {
    let rays: Vec<Vec<Vec<Option<[f64; 3]>>>> = cameras
        .iter()
        .zip(people)
        .map(|(camera, people)| people.iter().map(|person| directions(camera, person, config)).collect())
        .collect();
    let mut pairs: Vec<(f64, [(usize, usize); 2])> = vec![];
    for a in 0..cameras.len() {
        for b in a + 1..cameras.len() {
            for i in 0..rays[a].len() {
                for j in 0..rays[b].len() {
                    let apart = ray_distance([&cameras[a], &cameras[b]], [&rays[a][i], &rays[b][j]]);
                    let affinity = 1.0 - apart / MOST_M;
                    if affinity >= LEAST_AFFINITY {
                        pairs.push((affinity, [(a, i), (b, j)]));
                    }
                }
            }
        }
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut groups: Vec<Vec<Option<usize>>> = vec![];
    let alone =
        |(camera, i): (usize, usize)| (0..cameras.len()).map(|c| (c == camera).then_some(i)).collect::<Vec<_>>();
    for (_, ends) in pairs {
        let [a, b] = ends.map(|(camera, i)| groups.iter().position(|group| group[camera] == Some(i)));
        let [one, other] =
            [0, 1].map(|k: usize| [a, b][k].map_or_else(|| alone(ends[k]), |place| groups[place].clone()));
        let clash = one.iter().zip(&other).any(|(x, y)| x.is_some() && y.is_some());
        if a.is_some() && a == b || clash {
            continue;
        }
        let whole = one.iter().zip(&other).map(|(x, y)| x.or(*y)).collect();
        let mut gone: Vec<usize> = [a, b].into_iter().flatten().collect();
        gone.sort_unstable();
        gone.into_iter().rev().for_each(|place| drop(groups.remove(place)));
        groups.push(whole);
    }
    groups
}

/// Unit directions in the world through the keypoints.
fn directions(camera: &Camera, person: &Person, config: &Config) -> Vec<Option<[f64; 3]>> {
    let ray = |seen: &Option<sinew::observe::Detection>| {
        let seen = seen.filter(|seen| seen.confidence >= config.least_confidence)?;
        let [u, v] = camera.undistort(seen.pixel).ok()?;
        let i = camera.intrinsics;
        let place = [(u - i.cx) / i.fx, (v - i.cy) / i.fy, 1.0];
        let world = [0, 1, 2].map(|k: usize| (0..3).map(|row| camera.rotation[row][k] * place[row]).sum::<f64>());
        let size = length(world);
        Some(world.map(|x| x / size))
    };
    person.iter().map(ray).collect()
}

/// Mean distance of the rays of keypoints that both show, metres; infinite where there are few.
fn ray_distance(cameras: [&Camera; 2], rays: [&[Option<[f64; 3]>]; 2]) -> f64 {
    let between = minus(cameras[1].centre(), cameras[0].centre());
    let apart = rays[0].iter().zip(rays[1]).filter_map(|(a, b)| {
        let normal = cross((*a)?, (*b)?);
        Some((dot(between, normal) / length(normal).max(1e-9)).abs())
    });
    let apart: Vec<f64> = apart.collect();
    if apart.len() < Config::default().least_keypoints {
        return f64::INFINITY;
    }
    apart.iter().sum::<f64>() / apart.len() as f64
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k: usize| a[k] - b[k])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
