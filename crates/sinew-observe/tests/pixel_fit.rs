//! Poses from pixels: the minimum of the cost that the module states, written out here once more.

use sinew_body::standard::cf28;
use sinew_body::{KinematicTree, Plan, Proportions, point_positions};
use sinew_core::lanes::Isa;
use sinew_observe::keypoints::pixel_fit::{PixelFit, fit_pixels};
use sinew_observe::{Camera, Detection, View};

const SD: f64 = 0.7;

fn body() -> KinematicTree {
    cf28(&Proportions::default())
}

fn views(count: usize) -> Vec<View> {
    (0..count)
        .map(|i| {
            let (s, c) = (0.3 + 1.1 * i as f64).sin_cos();
            let centre = [3.5 * c, 3.5 * s, 1.3];
            let camera = Camera::look_at(&format!("C{i}"), [1000.0; 2], 900.0, centre, [0.0, 0.0, 1.0]).unwrap();
            let bias_px = vec![[4.0 - 3.0 * i as f64, 2.0 + i as f64]; body().points().len()];
            View { camera, bias_px, sigma_px: 2.0 + 0.5 * i as f64, usual_confidence: 0.8 }
        })
        .collect()
}

fn points(pose: &[f64]) -> Vec<[f64; 3]> {
    let plan = Plan::with_all_points(&body());
    let mut positions = vec![0.0; 3 * plan.points()];
    point_positions(&plan, Isa::baseline(), pose, &mut positions);
    positions.chunks(3).map(|p| [p[0], p[1], p[2]]).collect()
}

/// A standing pose, moved a little in every coordinate.
fn truth() -> Vec<f64> {
    (0..body().dof()).map(|j| 0.12 * (1.3 * j as f64 + 0.4).sin()).collect()
}

/// What the views see of a pose, biases added, each detection aside by a few pixels.
fn seen(views: &[View], pose: &[f64], aside_px: f64) -> Vec<Vec<Option<Detection>>> {
    let of = |(c, view): (usize, &View)| {
        let one = |(k, p): (usize, [f64; 3])| {
            let [u, v] = view.camera.project(p).pixel()?;
            let phase = 2.1 * k as f64 + 0.7 * c as f64;
            let [du, dv] = view.bias_of(k);
            let pixel = [u + du + aside_px * phase.sin(), v + dv + aside_px * phase.cos()];
            Some(Detection::new(pixel, 0.8))
        };
        points(pose).into_iter().enumerate().map(one).collect()
    };
    views.iter().enumerate().map(of).collect()
}

/// Distances of the detections from a pose, in pixels and in standard deviations; `None` where a point has no pixel.
fn distances(views: &[View], detections: &[Vec<Option<Detection>>], pose: &[f64]) -> Vec<Option<[f64; 2]>> {
    let points = points(pose);
    let mut all = vec![];
    for (view, seen) in views.iter().zip(detections) {
        for (k, (p, d)) in points.iter().zip(seen).enumerate() {
            let Some(d) = d else { continue };
            let [du, dv] = view.bias_of(k);
            let distance = view.camera.project(*p).pixel().map(|[u, v]| {
                let distance = (d.pixel[0] - du - u).hypot(d.pixel[1] - dv - v);
                [distance, distance / view.sigma_px]
            });
            all.push(distance);
        }
    }
    all
}

fn cost(views: &[View], detections: &[Vec<Option<Detection>>], pose: &[f64], start: &[f64]) -> f64 {
    let huber = |distance: Option<[f64; 2]>| match distance {
        Some([_, d]) if d <= 2.0 => d * d,
        Some([_, d]) => 4.0 * d - 4.0,
        None => 1e4,
    };
    let prior: f64 = pose.iter().zip(start).map(|(q, s)| ((q - s) / SD).powi(2)).sum();
    prior + distances(views, detections, pose).into_iter().map(huber).sum::<f64>()
}

fn fit(views: &[View], detections: &[Vec<Option<Detection>>], start: &[f64], steps: usize) -> PixelFit {
    fit_pixels(&Plan::with_all_points(&body()), views, detections, start, &vec![SD; start.len()], steps)
}

/// The cost is what is said of it, and no coordinate can lower it.
fn is_the_minimum(views: &[View], detections: &[Vec<Option<Detection>>], start: &[f64], found: &PixelFit) {
    let at = |pose: &[f64]| cost(views, detections, pose, start);
    assert!((found.cost / at(&found.pose) - 1.0).abs() < 1e-12, "{} against {}", found.cost, at(&found.pose));
    for j in 0..found.pose.len() {
        let moved = |by: f64| {
            let mut pose = found.pose.clone();
            pose[j] += by;
            at(&pose)
        };
        let (above, below) = (moved(1e-4), moved(-1e-4));
        let (slope, bend) = ((above - below) / 2e-4, (above + below - 2.0 * found.cost) / 1e-8);
        // The minimum along the coordinate, as seen from here.
        assert!((slope / bend).abs() < 2e-5, "coordinate {j}: {}", slope / bend);
    }
    let mut all: Vec<f64> = distances(views, detections, &found.pose).into_iter().flatten().map(|d| d[0]).collect();
    all.sort_by(f64::total_cmp);
    let median = 0.5 * (all[(all.len() - 1) / 2] + all[all.len() / 2]);
    assert!((found.median_px - median).abs() < 1e-9, "{} against {median}", found.median_px);
}

#[test]
fn the_fit_is_the_minimum_of_its_cost() {
    let start = vec![0.0; body().dof()];
    for count in [1, 3] {
        let views = views(count);
        let mut detections = seen(&views, &truth(), 1.5);
        // A gross error, and a keypoint that is not seen.
        detections[0][2].as_mut().unwrap().pixel[0] += 150.0;
        detections[0][4] = None;
        let found = fit(&views, &detections, &start, 60);
        is_the_minimum(&views, &detections, &start, &found);
        assert!(found.median_px < 3.0, "{}", found.median_px);
    }
}

#[test]
fn a_pose_that_is_seen_without_errors_is_recovered_in_a_few_steps() {
    let views = views(3);
    let detections = seen(&views, &truth(), 0.0);
    let start: Vec<f64> = truth().iter().map(|q| q + 0.02).collect();
    let found = fit(&views, &detections, &start, 6);
    is_the_minimum(&views, &detections, &start, &found);
    assert!(found.median_px < 0.2, "{}", found.median_px);
}

#[test]
fn without_steps_the_pose_stays_and_without_detections_it_is_that_of_the_prior() {
    let views = views(2);
    let detections = seen(&views, &truth(), 1.0);
    let start = vec![0.05; body().dof()];
    let found = fit(&views, &detections, &start, 0);
    assert_eq!(found.pose, start);
    assert!((found.cost / cost(&views, &detections, &start, &start) - 1.0).abs() < 1e-12);
    let found = fit(&views, &[vec![], vec![]], &start, 60);
    assert_eq!((found.pose, found.cost), (start, 0.0));
    assert!(found.median_px.is_nan());
}

/// A body behind the camera costs more than any that is before it, and pulls nowhere.
#[test]
fn points_without_a_pixel_cost_a_constant() {
    let views = views(1);
    let detections = seen(&views, &truth(), 0.0);
    let mut start = truth();
    let [x, y, _] = views[0].camera.centre();
    (start[0], start[1]) = (2.0 * x, 2.0 * y);
    let found = fit(&views, &detections, &start, 20);
    assert_eq!(found.pose, start);
    assert_eq!(found.cost, 1e4 * detections[0].iter().flatten().count() as f64);
    assert!(found.median_px.is_nan());
}
