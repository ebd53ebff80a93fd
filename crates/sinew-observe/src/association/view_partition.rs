//! Which detections of all views are of the same people?
//!
//! 1. Of two views, everybody in one is assigned to somebody in the other ([`least_cost`]), the cost being how far their keypoints, triangulated, are from their own pixels, in sizes of the person in the image.
//! 2. Every other view assigns its people to those found so far, by the distance from where these are projected to; after each view they are triangulated again.
//! 3. This is done from each pair of the (at most [`Config::seed_cameras`]) views that show most. The partition counts in which most keypoints agree, then the one that is off least.
//! 4. Whoever is left over is searched again, so that a person is found whom neither view of that pair shows.
//!
//! Nothing of how people look is used. Cost: linear in the number of views, cubic in that of the people.

use crate::association::assignment::least_cost;
use crate::association::{
    Config, Person, PersonGroup, distance_px, judged, person_size_px, projected, triangulated, usable,
};
use crate::cameras::camera::Camera;

/// Groups of people whom at least two views agree on, of those who are `free` in each view.
#[must_use]
pub fn partition(
    cameras: &[Camera],
    people: &[Vec<Person>],
    mut free: Vec<Vec<bool>>,
    config: &Config,
) -> Vec<PersonGroup> {
    let mut found: Vec<PersonGroup> = vec![];
    loop {
        let seeds = seeds(people, &free, config);
        let mut best: Option<(usize, f64, Vec<PersonGroup>)> = None;
        for (k, &first) in seeds.iter().enumerate() {
            for &second in &seeds[k + 1..] {
                let groups = from_pair(cameras, people, &free, [first, second], config);
                let keypoints = groups.iter().map(|group| group.keypoints).sum();
                let error = groups.iter().map(|group| group.error).sum();
                let is_better =
                    |(most, least, _): &(usize, f64, _)| keypoints > *most || keypoints == *most && error < *least;
                if keypoints > 0 && best.as_ref().is_none_or(is_better) {
                    best = Some((keypoints, error, groups));
                }
            }
        }
        let Some((.., groups)) = best else { return found };
        for group in &groups {
            let taken = group.members.iter().zip(&mut free).filter_map(|(member, free)| free.get_mut((*member)?));
            taken.for_each(|free| *free = false);
        }
        found.extend(groups);
    }
}

/// Views that show most keypoints of people who are free.
fn seeds(people: &[Vec<Person>], free: &[Vec<bool>], config: &Config) -> Vec<usize> {
    let seen = |person: &Person| person.iter().filter(|d| usable(**d, config).is_some()).count();
    let in_view = |(people, free): (&Vec<Person>, &Vec<bool>)| -> usize {
        people.iter().zip(free).filter(|(_, free)| **free).map(|(person, _)| seen(person)).sum()
    };
    let counts: Vec<usize> = people.iter().zip(free).map(in_view).collect();
    let mut seeds: Vec<usize> = (0..people.len()).filter(|view| counts[*view] > 0).collect();
    seeds.sort_by_key(|&view| (std::cmp::Reverse(counts[view]), view));
    seeds.truncate(config.seed_cameras.max(2));
    seeds
}

/// Groups that grow from an assignment between two views.
fn from_pair(
    cameras: &[Camera],
    people: &[Vec<Person>],
    free: &[Vec<bool>],
    [first, second]: [usize; 2],
    config: &Config,
) -> Vec<PersonGroup> {
    let pair = |i: usize, j: usize| {
        let mut members = vec![None; cameras.len()];
        (members[first], members[second]) = (Some(i), Some(j));
        members
    };
    let pair_cost = |i: usize, j: usize| {
        if !free[first][i] || !free[second][j] {
            return f64::INFINITY;
        }
        let points = triangulated(cameras, people, &pair(i, j), config);
        let costs = [(first, i), (second, j)]
            .map(|(view, i)| relative_distance(&people[view][i], &cameras[view], &points, config));
        let [a, b] = costs.map(|cost| cost.filter(|cost| *cost <= config.agreeing).unwrap_or(f64::INFINITY));
        a.max(b)
    };
    let costs: Vec<Vec<f64>> =
        (0..people[first].len()).map(|i| (0..people[second].len()).map(|j| pair_cost(i, j)).collect()).collect();
    let assigned = least_cost(&costs, config.agreeing).into_iter().enumerate();
    let mut groups: Vec<Vec<Option<usize>>> = assigned.filter_map(|(i, j)| Some(pair(i, j?))).collect();
    for view in (0..people.len()).filter(|view| *view != first && *view != second) {
        let costs: Vec<Vec<f64>> = groups
            .iter()
            .map(|members| {
                let points = triangulated(cameras, people, members, config);
                let cost = |(person, free): (&Person, &bool)| {
                    let near = relative_distance(person, &cameras[view], &points, config)
                        .filter(|cost| *free && *cost <= 2.0 * config.agreeing);
                    near.unwrap_or(f64::INFINITY)
                };
                people[view].iter().zip(&free[view]).map(cost).collect()
            })
            .collect();
        for (members, found) in groups.iter_mut().zip(least_cost(&costs, 2.0 * config.agreeing)) {
            members[view] = found;
        }
    }
    groups.into_iter().filter_map(|members| judged(cameras, people, members, config)).collect()
}

/// Median distance of a person's keypoints from where points are projected to, in sizes of the person in the image; `None` where too few are shared.
pub(crate) fn relative_distance(
    person: &Person,
    camera: &Camera,
    points: &[Option<[f64; 3]>],
    config: &Config,
) -> Option<f64> {
    let (distance, _) = distance_px(person, &projected(camera, points), config)?;
    Some(distance / person_size_px(person, config))
}
