//! Who is who in several views, and what the other views say about one.
//!
//! Stick figures of nine points stand in a ring of four cameras and are seen without noise, so that every answer is exact.

use sinew_observe::association::following::{Associated, Following, follow};
use sinew_observe::association::identities::Identities;
use sinew_observe::association::view_partition::partition;
use sinew_observe::association::{Config, Person, groups, nearest, triangulated};
use sinew_observe::cameras::cross_view::{
    best_lag, cameras_behind, expected_from_others, lag_change, residual_by_lag, swapped_spans,
};
use sinew_observe::cameras::offsets::{CameraNoise, Sighted};
use sinew_observe::{Camera, Detection};

fn cameras() -> Vec<Camera> {
    (0..4)
        .map(|i| {
            let (s, c) = (0.4 + 1.57 * f64::from(i)).sin_cos();
            let centre = [4.0 * c, 4.0 * s, 1.2 + 0.2 * f64::from(i)];
            Camera::look_at(&format!("C{i}"), [1000.0; 2], 900.0, centre, [0.0, 0.0, 1.0]).expect("not straight down")
        })
        .collect()
}

/// Nine points of a figure of that size at a place.
fn figure(x: f64, y: f64, size: f64) -> Vec<[f64; 3]> {
    let shape = [
        [0.0, 0.05, 1.7],
        [-0.2, 0.0, 1.4],
        [0.2, 0.02, 1.4],
        [-0.35, 0.1, 1.1],
        [0.4, -0.05, 1.05],
        [-0.1, 0.0, 0.9],
        [0.12, 0.0, 0.9],
        [-0.12, 0.08, 0.05],
        [0.15, -0.1, 0.08],
    ];
    shape.iter().map(|p| [x + size * p[0], y + size * p[1], size * p[2]]).collect()
}

fn seen(camera: &Camera, points: &[[f64; 3]]) -> Person {
    points.iter().map(|p| Some(Detection::new(camera.project(*p).pixel()?, 0.9))).collect()
}

/// Only the keypoints of the given places.
fn only(person: Person, kept: std::ops::Range<usize>) -> Person {
    person.into_iter().enumerate().map(|(k, d)| d.filter(|_| kept.contains(&k))).collect()
}

fn pixels(person: &Person) -> Vec<Option<[f64; 2]>> {
    person.iter().map(|d| d.map(|d| d.pixel)).collect()
}

fn agree(found: &[Option<[f64; 3]>], expected: &[[f64; 3]]) -> bool {
    found.iter().zip(expected).all(|(f, e)| f.is_some_and(|f| (0..3).all(|k| (f[k] - e[k]).abs() < 1e-6)))
}

#[test]
fn groups_are_the_people_most_complete_first() {
    let (cameras, a, b) = (cameras(), figure(0.3, 0.2, 1.0), figure(-0.6, -0.4, 0.9));
    // The second has six keypoints; every other camera lists it first, and the last does not see the first.
    let people: Vec<Vec<Person>> = cameras
        .iter()
        .enumerate()
        .map(|(c, camera)| {
            let (a, b) = (seen(camera, &a), only(seen(camera, &b), 0..6));
            match c {
                3 => vec![b],
                1 => vec![b, a],
                _ => vec![a, b],
            }
        })
        .collect();
    let found = groups(&cameras, &people, 5, &Config::default());
    assert_eq!(found.len(), 2);
    assert_eq!(found[0].members, [Some(0), Some(1), Some(0), None]);
    assert_eq!(found[1].members, [Some(1), Some(0), Some(1), Some(0)]);
    assert_eq!((found[0].keypoints, found[1].keypoints), (27, 24));
    assert!(found.iter().all(|group| group.error < 1e-9));
    assert!(agree(&found[0].points, &a) && agree(&found[1].points[..6], &b));
    assert_eq!(found[1].points[6..], [None; 3]);
    assert_eq!(groups(&cameras, &people, 1, &Config::default()), found[..1]);
}

/// The pair that is tried first has the fewest keypoints.
#[test]
fn a_more_complete_pair_takes_the_place_of_the_first() {
    let (cameras, a, b) = (cameras(), figure(0.3, 0.2, 1.0), figure(-0.6, -0.4, 0.9));
    let both = |camera: &Camera| vec![only(seen(camera, &b), 0..6), seen(camera, &a)];
    let people: Vec<Vec<Person>> = cameras.iter().map(both).collect();
    let found = groups(&cameras, &people, 5, &Config::default());
    assert_eq!(found.iter().map(|group| group.keypoints).collect::<Vec<_>>(), [36, 24]);
    assert_eq!(found[0].members, [Some(1); 4]);
}

#[test]
fn a_group_does_not_take_who_stands_elsewhere() {
    let (cameras, a) = (cameras(), figure(0.0, 0.0, 1.0));
    // Half as tall: of two people of one height, two views alone would make one who stands where the rays cross.
    let elsewhere = figure(0.9, -0.8, 0.5);
    let mut people: Vec<Vec<Person>> = cameras.iter().map(|camera| vec![seen(camera, &a)]).collect();
    people[2] = vec![seen(&cameras[2], &elsewhere)];
    let found = groups(&cameras, &people, 1, &Config::default());
    assert_eq!(found[0].members, [Some(0), Some(0), None, Some(0)]);
    // Two views that show two people make none, and neither do fewer keypoints than required.
    people = vec![vec![seen(&cameras[0], &a)], vec![seen(&cameras[1], &elsewhere)], vec![], vec![]];
    assert!(groups(&cameras, &people, 1, &Config::default()).is_empty());
    people = cameras.iter().map(|camera| vec![only(seen(camera, &a), 0..3)]).collect();
    assert!(groups(&cameras, &people, 1, &Config::default()).is_empty());
    // Keypoints of low confidence do not count.
    let doubtful = |d: Option<Detection>| d.map(|d| Detection { confidence: 0.1, ..d });
    people = cameras.iter().map(|camera| vec![seen(camera, &a).into_iter().map(doubtful).collect()]).collect();
    assert!(groups(&cameras, &people, 1, &Config::default()).is_empty());
}

#[test]
fn one_camera_orders_its_people_by_their_keypoints() {
    let camera = cameras().swap_remove(0);
    let whole = seen(&camera, &figure(0.0, 0.0, 1.0));
    let people = vec![vec![only(whole.clone(), 0..5), whole.clone(), only(whole, 0..2)]];
    let found = groups(&[camera], &people, 9, &Config::default());
    let of = |k: usize| (found[k].members[0], found[k].keypoints, found[k].points.len());
    assert_eq!((found.len(), of(0), of(1)), (2, (Some(1), 9, 9), (Some(0), 5, 9)));
}

#[test]
fn the_nearest_within_the_gate_is_taken() {
    let camera = &cameras()[0];
    let at = |x: f64| seen(camera, &figure(x, 0.0, 1.0));
    let expected = [pixels(&at(0.0))];
    let found = |people: Vec<Person>| nearest(&[people], &expected, &Config::default())[0];
    assert_eq!(found(vec![at(0.3), at(-0.1), at(0.2)]), Some(1));
    assert_eq!(found(vec![at(1.2)]), None);
    assert_eq!(found(vec![]), None);
    assert_eq!(found(vec![only(at(0.0), 0..3), at(0.2)]), Some(1), "too few keypoints to compare");
}

#[test]
fn points_need_two_views_that_have_them_in_front() {
    let (cameras, a) = (cameras(), figure(0.1, 0.0, 1.0));
    let mut people: Vec<Vec<Person>> = cameras.iter().map(|camera| vec![seen(camera, &a)]).collect();
    let with = |people: &[Vec<Person>], members: [Option<usize>; 4]| {
        triangulated(&cameras, people, &members, &Config::default())
    };
    assert!(agree(&with(&people, [Some(0), None, Some(0), None]), &a));
    assert!(with(&people, [Some(0), None, None, None]).iter().all(Option::is_none));
    assert!(with(&people, [None; 4]).is_empty());
    people[1][0][4] = None;
    let found = with(&people, [Some(0), Some(0), None, None]);
    assert_eq!((found.len(), found.iter().flatten().count(), found[4]), (9, 8, None));
}

/// The frame in which the followed person stands at x beside a shorter one who stays; cameras list the shorter one first.
fn frame(cameras: &[Camera], x: Option<f64>) -> Vec<Vec<Person>> {
    let other = figure(-0.9, 0.6, 0.6);
    let people = |camera: &Camera| {
        let mut people = vec![seen(camera, &other)];
        people.extend(x.map(|x| seen(camera, &figure(x, 0.0, 1.0))));
        people
    };
    cameras.iter().map(people).collect()
}

/// Follows over frames and says where they were found in the first camera, and how long they have been lost.
fn followed(following: &mut Following, x: &[Option<f64>]) -> Vec<(Option<usize>, usize)> {
    let cameras = cameras();
    let step = |x: &Option<f64>| {
        let found = follow(following, &cameras, &frame(&cameras, *x), None, &Config::default());
        assert_eq!(found.is_present(), found.members.iter().any(Option::is_some));
        for (c, person) in found.people.iter().enumerate() {
            let expected = found.members[c].map_or(vec![], |i| frame(&cameras, *x)[c][i].clone());
            assert_eq!(person, &expected);
        }
        (found.members[0], following.lost)
    };
    x.iter().map(step).collect()
}

#[test]
fn the_second_person_is_followed_lost_and_found_by_his_limbs() {
    let a = figure(0.0, 0.0, 1.0);
    let length = |i: usize, j: usize| (0..3).map(|k| (a[i][k] - a[j][k]).powi(2)).sum::<f64>().sqrt();
    let lengths = vec![(0, 5, length(0, 5)), (1, 2, length(1, 2)), (5, 7, length(5, 7))];
    // Both have nine keypoints: the one found first is the one with the smaller error, so the person is selected by place.
    let cameras = cameras();
    let first = groups(&cameras, &frame(&cameras, Some(0.3)), 2, &Config::default());
    let person = first.iter().position(|g| g.members[0] == Some(1)).expect("the person is seen");
    let mut following = Following { person, lengths, ..Following::default() };
    let there = |n: usize| vec![Some(0.3); n];
    assert_eq!(followed(&mut following, &there(2)), [(Some(1), 0); 2]);
    assert!(following.started);
    // Nobody is where they were: lost, frame by frame, and found again near there.
    let lost = followed(&mut following, &[None, None, None, Some(0.35)]);
    assert_eq!(lost, [(None, 1), (None, 2), (None, 3), (Some(1), 0)]);
    // Away for ten frames, then far from there: known by their limbs, and not the shorter one.
    let away = followed(&mut following, &[None; 10]);
    assert_eq!(away.last(), Some(&(None, 10)));
    assert_eq!(followed(&mut following, &[None]), [(None, 11)], "the shorter one is someone else");
    assert_eq!(followed(&mut following, &[Some(-0.2)]), [(Some(1), 0)]);
}

#[test]
fn where_a_prediction_is_given_it_counts() {
    let cameras = cameras();
    let mut following = Following::default();
    let at = |x: f64| cameras.iter().map(|c| vec![seen(c, &figure(x, 0.0, 1.0))]).collect::<Vec<_>>();
    assert_eq!(follow(&mut following, &cameras, &at(0.0), None, &Config::default()).members, [Some(0); 4]);
    let predicted: Vec<_> = at(0.9).iter().map(|people| pixels(&people[0])).collect();
    let mut other = following.clone();
    assert_eq!(follow(&mut other, &cameras, &at(0.9), Some(&predicted), &Config::default()).members, [Some(0); 4]);
    assert_eq!(follow(&mut following, &cameras, &at(0.9), None, &Config::default()).members, [None; 4]);
}

#[test]
fn fragments_of_one_person_are_put_together() {
    let cameras = cameras();
    let whole: Vec<Vec<Person>> = cameras.iter().map(|c| vec![seen(c, &figure(0.0, 0.0, 1.0))]).collect();
    let mut following = Following::default();
    follow(&mut following, &cameras, &whole, None, &Config::default());
    let mut broken = whole.clone();
    let bystander = seen(&cameras[0], &figure(0.5, 0.3, 1.0));
    broken[0] = vec![only(whole[0][0].clone(), 0..5), only(whole[0][0].clone(), 5..9), bystander.clone()];
    let Associated { members, people } = follow(&mut following, &cameras, &broken, None, &Config::default());
    assert_eq!((members[0], &people[0]), (Some(0), &whole[0][0]));
    // Someone who shows the same keypoints is no fragment, however near.
    broken[0] = vec![only(whole[0][0].clone(), 0..5), seen(&cameras[0], &figure(0.05, 0.0, 1.0))];
    let Associated { members, people } = follow(&mut following, &cameras, &broken, None, &Config::default());
    let chosen = members[0].expect("someone stands there");
    assert_eq!(people[0], broken[0][chosen]);
}

/// A figure on a round, seen by all cameras; the third camera is `late` frames behind.
fn round(frames: u64, late: u64) -> Vec<(u64, Sighted)> {
    let cameras = cameras();
    let at = |t: f64| {
        let (s, c) = (0.11 * t).sin_cos();
        figure(0.5 * c + 0.1 * (0.37 * t).sin(), 0.4 * s, 1.0)
    };
    (0..frames)
        .map(|f| {
            let seen_by = |(c, camera): (usize, &Camera)| {
                let time = if c == 2 { f as f64 - late as f64 } else { f as f64 };
                seen(camera, &at(time))
            };
            (100 + f, cameras.iter().enumerate().map(seen_by).collect())
        })
        .collect()
}

fn quiet(offset_px: [f64; 2]) -> Vec<CameraNoise> {
    let of = |c: usize| CameraNoise {
        offset_px: if c == 2 { offset_px } else { [0.0; 2] },
        sigma_px: 1.0,
        usual_confidence: 0.9,
        residuals: 100,
    };
    (0..4).map(of).collect()
}

#[test]
fn the_others_expect_a_camera_where_it_sees_but_for_its_offset() {
    let (cameras, noise) = (cameras(), quiet([3.0, -2.0]));
    let (_, mut sighted) = round(1, 0).remove(0);
    let expected = expected_from_others(&cameras, &noise, &sighted, 2, 0.3);
    for (e, d) in expected.iter().zip(&sighted[2]) {
        let (e, d) = (e.expect("three others see it"), d.expect("seen").pixel);
        assert!((e[0] - d[0] - 3.0).abs() < 1e-6 && (e[1] - d[1] + 2.0).abs() < 1e-6, "{e:?} {d:?}");
    }
    sighted[0].clear();
    sighted[1].clear();
    assert!(
        expected_from_others(&cameras, &noise, &sighted, 2, 0.3).iter().all(Option::is_none),
        "one other is too few"
    );
}

#[test]
fn the_lag_of_a_clock_is_found_and_its_change() {
    let (cameras, noise) = (cameras(), quiet([0.0; 2]));
    let lags = |frames: &[(u64, Sighted)]| residual_by_lag(&cameras, &noise, frames, 2, 5, 0.3);
    for late in [0, 3] {
        let lags = lags(&round(40, late)).expect("long enough");
        assert_eq!(lags.iter().map(|l| l.0).collect::<Vec<_>>(), (-5..=5).collect::<Vec<_>>());
        let best = best_lag(&lags).expect("has a lag of 0");
        assert_eq!(best.frames, late as i64);
        assert!(best.best_px < 1e-6 && (late == 0) == (best.now_px < 1e-6), "{best:?}");
    }
    let (early, late) = (lags(&round(40, 1)).expect("long"), lags(&round(40, 4)).expect("long"));
    assert_eq!((lag_change(&early, &late), lag_change(&late, &early)), (Some(3), Some(-3)));
    assert_eq!(lag_change(&early, &early), None);
    assert_eq!(lags(&round(14, 0)), None, "shorter than three times the largest lag");
    // Where every third frame is missing, neighbours are one frame apart or two: nothing is compared at larger lags.
    let mut gaps = round(60, 3);
    gaps.retain(|(number, _)| number % 3 != 0);
    let judged: Vec<i64> = lags(&gaps).expect("long enough").iter().map(|lag| lag.0).collect();
    assert_eq!(judged, [-1, 0, 1]);
    assert_eq!(
        best_lag(&[(-2, 1.0), (0, 4.0), (1, 1.0)]).map(|b| (b.frames, b.best_px, b.now_px)),
        Some((1, 1.0, 4.0))
    );
    assert_eq!(best_lag(&[(1, 1.0)]), None);
}

/// Errors of −3, 0 and 3 px along one axis: their median is 0, that of their distances from it 3.
#[test]
fn a_lag_is_judged_by_the_median_residual_of_both_axes() {
    for axis in 0..2 {
        let mut frames = round(42, 0);
        for (f, (_, sighted)) in frames.iter_mut().enumerate() {
            for (k, detection) in sighted[2].iter_mut().enumerate() {
                detection.as_mut().expect("seen").pixel[axis] += 3.0 * (((f + k) % 3) as f64 - 1.0);
            }
        }
        let lags = residual_by_lag(&cameras(), &quiet([0.0; 2]), &frames, 2, 5, 0.3).expect("long enough");
        let now_px = best_lag(&lags).expect("has a lag of 0").now_px;
        assert!((now_px - 3.0).abs() < 1e-6, "{now_px} px along axis {axis}");
    }
}

#[test]
fn frames_with_left_and_right_exchanged_are_found() {
    let (cameras, noise, pairs) = (cameras(), quiet([0.0; 2]), [(1, 2), (3, 4), (5, 6), (7, 8)]);
    let mut frames = round(40, 0);
    let mut swap = |camera: usize, numbers: std::ops::RangeInclusive<u64>| {
        for (_, sighted) in frames.iter_mut().filter(|(n, _)| numbers.contains(n)) {
            pairs.iter().for_each(|&(l, r)| sighted[camera].swap(l, r));
        }
    };
    swap(1, 110..=118);
    // Two frames of another opinion do not end a span, two frames alone make none.
    swap(1, 113..=114);
    swap(1, 130..=131);
    let found = swapped_spans(&cameras, &noise, &frames, 1, &pairs, 0.3);
    assert_eq!(found.iter().map(|s| (s.first, s.last)).collect::<Vec<_>>(), [(110, 118)]);
    assert!(found[0].swapped_px < 1e-6 && found[0].residual_px > 20.0, "{found:?}");
    assert!(swapped_spans(&cameras, &noise, &frames, 0, &pairs, 0.3).is_empty());
}

#[test]
fn a_camera_that_the_subject_stands_behind_is_counted() {
    let (mut cameras, a) = (cameras(), figure(0.0, 0.0, 1.0));
    let people: Vec<Vec<Person>> = cameras.iter().map(|camera| vec![seen(camera, &a)]).collect();
    assert_eq!(cameras_behind(&cameras, &people), (0, 4));
    // Seen through the pinhole from behind.
    let camera = Camera::look_at("turned", [1000.0; 2], 900.0, [3.0, 1.0, 1.0], [6.0, 2.0, 1.1]).expect("level");
    let through = |p: &[f64; 3]| {
        let [x, y, z] = camera.point_in_camera(*p);
        assert!(z < 0.0);
        Some(Detection::new(camera.pixel_from_normalised([x / z, y / z]), 0.9))
    };
    let mut people = people;
    people[3] = vec![a.iter().map(through).collect()];
    cameras[3] = camera;
    assert_eq!(cameras_behind(&cameras, &people), (1, 4));
    people[3].clear();
    assert_eq!(cameras_behind(&cameras, &people), (0, 3));
}

/// Everybody in every view, in an order that changes from view to view and frame to frame.
fn listed(cameras: &[Camera], figures: &[Vec<[f64; 3]>], frame: usize) -> Vec<Vec<Person>> {
    let in_view = |(c, camera): (usize, &Camera)| {
        let mut people: Vec<Person> = figures.iter().map(|figure| seen(camera, figure)).collect();
        if (frame + c).is_multiple_of(2) {
            people.reverse();
        }
        people
    };
    cameras.iter().enumerate().map(in_view).collect()
}

/// Pairs of points whose distances are lengths of limbs, left and right together.
fn segments() -> Vec<Vec<(usize, usize)>> {
    vec![vec![(1, 3), (2, 4)], vec![(5, 7), (6, 8)]]
}

/// The name that each figure has in a view, by where it stands in the list.
fn names(named: &[Vec<Option<usize>>], figures: usize, frame: usize) -> Vec<Vec<Option<usize>>> {
    let of = |figure: usize| {
        let place = |(c, view): (usize, &Vec<Option<usize>>)| {
            let i = if (frame + c).is_multiple_of(2) { figures - 1 - figure } else { figure };
            view.get(i).copied().flatten()
        };
        named.iter().enumerate().map(place).collect()
    };
    (0..figures).map(of).collect()
}

#[test]
fn people_who_pass_each_other_keep_their_names_in_all_views() {
    let cameras = cameras();
    let mut identities = Identities::new(&cameras, segments(), 30.0, Config::default());
    for frame in 0..60 {
        let x = 0.04 * frame as f64 - 1.2;
        let figures = [figure(x, 0.15, 1.0), figure(-x, -0.15, 1.0), figure(0.0, 1.0, 0.95)];
        let named = identities.name(&listed(&cameras, &figures, frame));
        let first = names(&named, 3, frame);
        for (figure, views) in first.iter().enumerate() {
            assert!(views.iter().all(|name| name.is_some() && *name == views[0]), "{frame} {figure}: {views:?}");
        }
        let all: Vec<_> = first.iter().map(|views| views[0]).collect();
        let mut sorted = all.clone();
        sorted.sort();
        assert_eq!(sorted, [Some(0), Some(1), Some(2)], "frame {frame}");
        if frame == 0 || frame == 59 {
            // The first and the last frame have the same names.
            let mut again = Identities::new(&cameras, segments(), 30.0, Config::default());
            let start = [figure(-1.2, 0.15, 1.0), figure(1.2, -0.15, 1.0), figure(0.0, 1.0, 0.95)];
            let begun = names(&again.name(&listed(&cameras, &start, 0)), 3, 0);
            assert_eq!(all, begun.iter().map(|views| views[0]).collect::<Vec<_>>(), "frame {frame}");
        }
    }
}

/// For five frames nobody sees them. Where they come out each stands nearer to where the other one went in.
#[test]
fn people_who_pass_each_other_unseen_keep_their_names() {
    let cameras = cameras();
    let mut identities = Identities::new(&cameras, segments(), 30.0, Config::default());
    let mut begun = None;
    for frame in 0..60 {
        let x = 0.05 * frame as f64 - 1.475;
        let is_hidden = (27..32).contains(&frame);
        let figures = [figure(x, 0.1, 1.0), figure(-x, -0.1, 1.0)];
        let seen: &[Vec<[f64; 3]>] = if is_hidden { &[] } else { &figures };
        let named = identities.name(&listed(&cameras, seen, frame));
        if !is_hidden {
            let now = names(&named, 2, frame);
            assert_eq!(*begun.get_or_insert(now.clone()), now, "frame {frame}");
        }
    }
}

/// Who comes to stay when `figures` are there for some frames each, one after the other.
fn staying(acts: &[(u64, Vec<Vec<[f64; 3]>>)]) -> Vec<usize> {
    let cameras = cameras();
    let mut identities = Identities::new(&cameras, segments(), 30.0, Config::default());
    for (frames, figures) in acts {
        for _ in 0..*frames {
            identities.name(&listed(&cameras, figures, 1));
        }
    }
    identities.people().iter().map(|naming| naming.person).collect()
}

#[test]
fn a_person_who_comes_back_is_known_by_limbs_and_a_stranger_is_new() {
    let (tall, short) = (figure(0.5, 0.0, 1.0), figure(-0.5, 0.0, 0.7));
    let start = (10, vec![tall, short.clone()]);
    let without = (15, vec![short.clone()]);
    let back = |scale: f64| (10, vec![figure(0.7, 0.2, scale), short.clone()]);
    let stays = |scale: f64| staying(&[start.clone(), without.clone(), back(scale)]);
    // Two stays from the start, in the order of the groups, and one more.
    assert!([0, 1].contains(&stays(1.0)[2]) && stays(1.0).len() == 3);
    assert_eq!(stays(1.4)[2], 2);
    // Each is who they were before.
    let (gone, both) = ((15, vec![]), |a: f64, b: f64| (10, vec![figure(0.3, 0.2, a), figure(-0.3, 0.0, b)]));
    let again = staying(&[both(1.0, 0.7), gone.clone(), both(1.0, 0.7)]);
    let other = staying(&[both(1.0, 0.7), gone.clone(), both(0.7, 1.0)]);
    assert_eq!(again[..2], other[..2]);
    assert!(again[2..].iter().chain(&other[2..]).all(|person| *person < 2), "{again:?} {other:?}");
    // From one side of the room to the other in half a second goes nobody.
    assert_eq!(staying(&[(10, vec![short]), gone, (10, vec![figure(-9.0, 0.2, 0.7)])]), [0, 1]);
}

#[test]
fn a_view_that_contradicts_the_others_is_not_taken() {
    let cameras = cameras();
    let mut identities = Identities::new(&cameras, segments(), 30.0, Config::default());
    let own = figure(0.2, 0.0, 1.0);
    identities.name(&listed(&cameras, std::slice::from_ref(&own), 1));
    let mut people = listed(&cameras, std::slice::from_ref(&own), 1);
    // In one view somebody else stands near where they are expected.
    people[2] = vec![seen(&cameras[2], &figure(0.36, -0.38, 1.0))];
    let named = identities.name(&people);
    assert_eq!(named, [vec![Some(0)], vec![Some(0)], vec![None], vec![Some(0)]]);
}

#[test]
fn the_partition_finds_those_whom_no_pair_of_views_shows_together() {
    let (cameras, a, b) = (cameras(), figure(0.3, 0.2, 1.0), figure(-0.6, -0.4, 0.9));
    let show = |c: usize, figure: &Vec<[f64; 3]>| seen(&cameras[c], figure);
    let people = vec![vec![show(0, &a)], vec![show(1, &b), show(1, &a)], vec![show(2, &b)], vec![]];
    let free = people.iter().map(|people| vec![true; people.len()]).collect();
    let mut found: Vec<Vec<Option<usize>>> =
        partition(&cameras, &people, free, &Config::default()).into_iter().map(|group| group.members).collect();
    found.sort();
    assert_eq!(found, [vec![None, Some(0), Some(0), None], vec![Some(0), Some(1), None, None]]);
}
