//! Normal equations of a frame against finite differences of its likelihood.

use sinew_body::point_derivatives::{Neighbours, length_names};
use sinew_body::standard::h32;
use sinew_body::{Plan, Proportions};
use sinew_core::lanes::{Block, Isa, numbers, numbers_mut};
use sinew_observe::cameras::camera_error::{NUMBERS, with_error};
use sinew_observe::clocks::on_time::on_time;
use sinew_observe::lasting::drawn_errors::DrawnErrors;
use sinew_observe::lasting::lasting_errors::{
    LastingErrors, linearised, linearised_detections, pixels_per_metre, pose_information, whitened_rows,
};
use sinew_observe::{Camera, Detection, KeypointModel, Mistakes, Noise, View};
use std::sync::Arc;

const POINTS: [usize; 5] = [1, 4, 7, 12, 20];
const MIDDLE: [f64; 3] = [0.0, 0.0, 1.0];

/// A body before three cameras, with detections a few pixels aside.
struct Scene {
    cameras: Vec<Camera>,
    neighbours: Neighbours,
    detections: Vec<Vec<Option<Detection>>>,
    errors: LastingErrors,
    scales: Vec<f64>,
    /// Metres a second.
    velocities: Vec<[f64; 3]>,
}

fn scene() -> Scene {
    let camera = |c: usize| {
        let (sin, cos) = (0.4 + 1.9 * c as f64).sin_cos();
        Camera::look_at(&format!("C{c}"), [1000.0, 800.0], 900.0, [4.0 * cos, 4.0 * sin, 1.5], MIDDLE).unwrap()
    };
    let cameras: Vec<Camera> = (0..3).map(camera).collect();
    let neighbours = Neighbours::new(h32, &Proportions::default(), &POINTS);
    let at = neighbours.at(&pose()).positions;
    let seen = |(c, camera): (usize, &Camera)| {
        let one = |k: usize| {
            let [u, v] = camera.project([at[3 * k], at[3 * k + 1], at[3 * k + 2]]).pixel()?;
            let aside = (1.3 * (5 * c + k) as f64).sin();
            Some(Detection::new([u + 3.0 * aside, v - 2.0 * aside], 0.7 + 0.2 * aside))
        };
        (0..POINTS.len()).map(one).collect()
    };
    let detections = cameras.iter().enumerate().map(seen).collect();
    let errors = LastingErrors { cameras: 3, lengths: length_names().len(), points: POINTS.len() };
    let scales = cameras.iter().map(|camera| pixels_per_metre(camera, MIDDLE)).collect();
    let velocities = (0..POINTS.len()).map(|k| [0, 1, 2].map(|a| 2.0 * f64::from(7 * k as u32 + a).sin())).collect();
    Scene { cameras, neighbours, detections, errors, scales, velocities }
}

fn pose() -> Vec<f64> {
    let mut pose: Vec<f64> = (0..32).map(|j| 0.1 * (1.7 * f64::from(j)).sin()).collect();
    pose[2] += 1.0;
    pose
}

impl Scene {
    fn model(&self, g: &[f64]) -> KeypointModel {
        let view = |(c, camera): (usize, &Camera)| {
            let mut error = [0.0; NUMBERS];
            error.copy_from_slice(&g[self.errors.camera(c)]);
            let bias = |k| {
                let first = self.errors.bias(c, k).start;
                [first, first + 1].map(|place| self.scales[c] * g[place])
            };
            let bias_px = (0..POINTS.len()).map(bias).collect();
            View { camera: with_error(camera, &error), bias_px, sigma_px: 4.0, usual_confidence: 0.7 }
        };
        KeypointModel {
            plan: Arc::new(Plan::new(&h32(&Proportions::default()), &POINTS)),
            views: self.cameras.iter().enumerate().map(view).collect(),
            noise: Noise::OutlierFloor { outlier: 1e-12 },
            model_error_m: 0.0,
            least_confidence: 0.1,
            mistakes: Mistakes::default(),
            isa: Isa::baseline(),
        }
    }

    /// Half the sum of the squared residuals over their variances.
    fn half_square(&self, pose: &[f64], g: &[f64]) -> f64 {
        let frame = self.linearised(pose, g);
        let square = |[u, v]: [f64; 2]| u * u + v * v;
        0.5 * frame.residuals.iter().map(|r| square(r.residual_px) / r.noise_px2).sum::<f64>()
    }

    fn linearised(&self, pose: &[f64], g: &[f64]) -> sinew_observe::lasting::lasting_errors::LinearisedFrame {
        let body = self.neighbours.reshaped(&g[self.errors.lengths()], &g[self.errors.places()]).at(pose);
        let seen = |(c, camera): (usize, &Camera)| {
            on_time(camera, &self.detections[c], &body.positions, &self.velocities, g[self.errors.lag(c)])
        };
        let detections: Vec<_> = self.cameras.iter().enumerate().map(seen).collect();
        let found = linearised_detections(&self.model(g), &detections, &[], &body);
        linearised(&found, &self.errors, &self.scales, (&body, &self.velocities), pose.len())
    }
}

#[test]
fn pulls_are_the_gradient_of_the_likelihood() {
    let count = scene().errors.count();
    pulls_are_the_gradient_at(vec![0.0; count]);
    pulls_are_the_gradient_at(elsewhere());
}

/// Lengths, places and biases as far from 0 as real people have them. Cameras and lags stay: derivatives by cameras are by an error on top of the one that is there, those by lags where the point is now.
fn elsewhere() -> Vec<f64> {
    let errors = scene().errors;
    let mut g: Vec<f64> = (0..errors.count()).map(|place| 0.02 * (2.3 * place as f64).sin()).collect();
    (0..3).flat_map(|camera| errors.camera(camera)).chain(errors.lags()).for_each(|place| g[place] = 0.0);
    g
}

fn pulls_are_the_gradient_at(g: Vec<f64>) {
    let scene = scene();
    let pose = pose();
    let found = scene.linearised(&pose, &g);
    assert_eq!(found.residuals.len(), 15);
    let step = 1e-6;
    let near = |name: &str, found: f64, high: f64, low: f64| {
        let difference = (low - high) / (2.0 * step);
        assert!((found - difference).abs() < 1e-4 * (1.0 + difference.abs()), "{name}: {found} for {difference}");
    };
    for j in 0..pose.len() {
        let at = |by: f64| {
            let mut moved = pose.clone();
            moved[j] += by;
            scene.half_square(&moved, &g)
        };
        near("pose", found.pose_pull[j], at(step), at(-step));
    }
    let names = scene.errors.names(
        &scene.cameras.iter().map(|camera| camera.name.clone()).collect::<Vec<_>>(),
        &length_names(),
        &POINTS.map(|k| format!("P{k}")),
    );
    assert_eq!(names.len(), g.len());
    for (place, name) in names.iter().enumerate() {
        let at = |by: f64| {
            let mut moved = g.clone();
            moved[place] += by;
            scene.half_square(&pose, &moved)
        };
        near(name, found.lasting_pull[place], at(step), at(-step));
    }
}

/// The pulls change along a step as the matrices say, where residuals are small.
#[test]
fn matrices_are_how_pulls_change() {
    let mut scene = scene();
    let (pose, g) = (pose(), elsewhere());
    // Without residuals the matrices are the whole second derivative.
    let body = scene.neighbours.reshaped(&g[scene.errors.lengths()], &g[scene.errors.places()]);
    let at = body.at(&pose).positions;
    for (view, seen) in scene.model(&g).views.iter().zip(&mut scene.detections) {
        for (k, seen) in seen.iter_mut().enumerate() {
            let pixel = view.camera.project([at[3 * k], at[3 * k + 1], at[3 * k + 2]]).pixel();
            let bias = view.bias_of(k);
            let pixel = pixel.map(|pixel| [pixel[0] + bias[0], pixel[1] + bias[1]]);
            *seen = pixel.map(|pixel| Detection::new(pixel, 0.7));
        }
    }
    let found = scene.linearised(&pose, &g);
    let (d, p, step) = (pose.len(), g.len(), 1e-6);
    let information = found.information();
    for place in (0..p).step_by(7) {
        let mut moved = g.clone();
        moved[place] += step;
        let after = scene.linearised(&pose, &moved);
        for j in 0..d {
            let (change, expected) = (-after.pose_pull[j] / step, found.between[j * p + place]);
            assert!((change - expected).abs() < 1e-2 * (1.0 + expected.abs()), "{j}, {place}: {change} for {expected}");
        }
        for other in (0..p).step_by(5) {
            let (change, expected) = (-after.lasting_pull[other] / step, information[other * p + place]);
            assert!(
                (change - expected).abs() < 1e-2 * (1.0 + expected.abs()),
                "{other}, {place}: {change}, {expected}"
            );
        }
    }
    for k in 0..d {
        let mut moved = pose.clone();
        moved[k] += step;
        let after = scene.linearised(&moved, &g);
        for j in 0..d {
            let (change, expected) = (-after.pose_pull[j] / step, found.pose[j * d + k]);
            assert!((change - expected).abs() < 1e-2 * (1.0 + expected.abs()), "{j}, {k}: {change} for {expected}");
        }
    }
}

/// What tracking needs of a frame is the same as the whole matrices say.
#[test]
fn pulls_on_draws_are_the_matrix_times_each_draw() {
    let scene = scene();
    let (pose, g) = (pose(), vec![0.0; scene.errors.count()]);
    let whole = scene.linearised(&pose, &g);
    let (d, p, blocks) = (pose.len(), g.len(), 3);
    let body = scene.neighbours.at(&pose);
    let found = linearised_detections(&scene.model(&g), &scene.detections, &[], &body);
    let agree = |found: &[f64], expected: &[f64]| {
        assert_eq!(found.len(), expected.len());
        for (f, e) in found.iter().zip(expected) {
            assert!((f - e).abs() < 1e-8 * (1.0 + e.abs()), "{f} for {e}");
        }
    };
    agree(&pose_information(&found, &body, d), &whole.pose);
    let rows = whitened_rows(&found, &scene.errors, &body, d);
    assert_eq!(rows.len(), 2 * 3 * POINTS.len() * d);
    let square = |e: usize| rows.chunks_exact(d).map(|row| row[e / d] * row[e % d]).sum::<f64>();
    agree(&(0..d * d).map(square).collect::<Vec<f64>>(), &whole.pose);

    let mut deviations = vec![Block::ZERO; p * blocks];
    numbers_mut(&mut deviations).iter_mut().enumerate().for_each(|(e, x)| *x = 0.01 * (0.37 * e as f64).sin());
    let drawn = DrawnErrors { errors: scene.errors, deviations, blocks, isa: Isa::best() };
    let shifts = drawn.keypoint_shifts(&body);
    let pull = drawn.pull(&found, (&body, &scene.velocities), &shifts, &scene.scales, d);
    let width = 8 * blocks;
    let by_draw = |e: usize| -> f64 {
        let (row, draw) = (e / width, e % width);
        (0..p).map(|k| whole.between[row * p + k] * numbers(&drawn.deviations)[k * width + draw]).sum()
    };
    agree(numbers(&pull), &(0..d * width).map(by_draw).collect::<Vec<f64>>());

    // A draw's keypoints are where a body of its lengths and places has them.
    let one_draw: Vec<f64> = (0..p).map(|k| numbers(&drawn.deviations)[k * width + 5]).collect();
    let other =
        scene.neighbours.reshaped(&one_draw[scene.errors.lengths()], &one_draw[scene.errors.places()]).at(&pose);
    let away: Vec<f64> = other.positions.iter().zip(&body.positions).map(|(a, b)| a - b).collect();
    agree(&(0..away.len()).map(|row| numbers(&shifts)[row * width + 5]).collect::<Vec<f64>>(), &away);
}
