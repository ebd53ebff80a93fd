//! How far data tell the constants of a set-up apart: posterior against prior, for pairs that look alike.
//!
//! A pair is two combinations of the numbers g ([`sinew::setup::MeasuredErrors`]) in the same unit, of which the data see the sum. Of each member and of the sum the share of the prior's standard deviation that is left is given, and the correlation of the two in the posterior: −1 where the data see nothing but the sum.
//! A common movement of all cameras, and the part of the biases of a keypoint that agrees in 3D, are coordinates along a direction v of g: vᵀ Σ₀⁻¹ g / vᵀ Σ₀⁻¹ v, Σ₀ the prior's covariance.

use crate::simulated_source::{set_up, source};
use sinew::body::Proportions;
use sinew::body::point_derivatives::{Neighbours, PointDerivatives, length_names, lengths};
use sinew::observe::Camera;
use sinew::observe::lasting::lasting_errors::LastingErrors;
use sinew::setup::{MeasuredErrors, Setup, SetupRequest};
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_simulate::ring::Ring;
use std::error::Error;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// A simulated recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// Cameras.
    pub cameras: usize,
    /// Seconds; in the first the walker stands.
    pub duration_s: f64,
}

/// Biases of the simulated detectors, pixels: a centimetre at the walker.
const BIAS_PX: f64 = 3.3;

/// What is left of a pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Its name.
    pub name: &'static str,
    /// Posterior over prior standard deviation of the first, the second and the sum; NaN where there is no second.
    pub left: [f64; 3],
    /// Correlation in the posterior.
    pub correlation: f64,
}

/// A combination of the numbers g.
type Combination = Vec<f64>;

/// Pairs of one name; what is left is their mean.
type Alike = (&'static str, Vec<[Combination; 2]>);

/// What a set-up of a scene leaves of every pair.
///
/// # Errors
/// Errors of the simulation and of the set-up.
pub fn pairs(scene: Scene, seed: u64) -> Outcome<Vec<Pair>> {
    let noise = DetectorNoise { offset_px: 0.0, bias_px: BIAS_PX, persistence: 0.8, ..DetectorNoise::DETECTOR_LIKE };
    let script = Script {
        duration_s: scene.duration_s,
        ring: Ring { cameras: scene.cameras, ..Ring::default() },
        calibration: CalibrationError::USUAL,
        noise,
        ..Script::default()
    };
    let recording = SyntheticRecording::new(&script, seed)?;
    let (fps, cameras) = (script.rate_hz, recording.cameras.clone());
    let mut source = source(&recording);
    let setup = set_up(&mut source, &SetupRequest::default(), fps, seed)?;
    let Some(known) = &setup.lasting else { return Ok(vec![]) };
    let prior_sd = (0..known.number.len()).map(|place| known.known(place).prior_sd).collect();
    let (layout, body, velocity) = (known.layout(), body(&setup, known), mean_velocity(&recording, fps));
    let found = Posterior { known, prior_sd, cameras: &cameras, layout, body, velocity };
    Ok(found.all().into_iter().map(|alike| found.mean(alike)).collect())
}

/// The keypoints in the set-up's first pose.
fn body(setup: &Setup, known: &MeasuredErrors) -> PointDerivatives {
    let tree = setup.tree();
    let indices: Vec<usize> = known.points.iter().filter_map(|name| tree.point_index(name)).collect();
    Neighbours::new(|sizes| setup.body.tree(sizes), &setup.proportions, &indices).at(&setup.start_pose)
}

/// From where all points of the person are in the first frame to where they are in the last, metres a second.
fn mean_velocity(recording: &SyntheticRecording, fps: f64) -> [f64; 3] {
    let frames = &recording.truth.frames;
    let seconds = (frames.len() - 1) as f64 / fps;
    let mean = |frame: &[[f64; 3]], axis: usize| frame.iter().map(|x| x[axis]).sum::<f64>() / frame.len() as f64;
    let ends = frames.first().zip(frames.last());
    [0, 1, 2].map(|axis: usize| ends.map_or(0.0, |(first, last)| (mean(last, axis) - mean(first, axis)) / seconds))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn seen_from(camera: &Camera, direction: [f64; 3]) -> [f64; 3] {
    camera.rotation.map(|row| dot(&row, &direction))
}

/// A unit vector along an axis.
fn axis(k: usize) -> [f64; 3] {
    std::array::from_fn(|j| if j == k { 1.0 } else { 0.0 })
}

/// a + factor × b.
fn plus(a: &[f64], factor: f64, b: &[f64]) -> Combination {
    a.iter().zip(b).map(|(a, b)| a + factor * b).collect()
}

struct Posterior<'a> {
    known: &'a MeasuredErrors,
    /// Standard deviations of the prior.
    prior_sd: Vec<f64>,
    cameras: &'a [Camera],
    layout: LastingErrors,
    body: PointDerivatives,
    /// Of the person, metres a second.
    velocity: [f64; 3],
}

impl Posterior<'_> {
    fn none(&self) -> Combination {
        vec![0.0; self.layout.count()]
    }

    fn of(&self, numbers: &[(usize, f64)]) -> Combination {
        let mut combination = self.none();
        numbers.iter().for_each(|(place, factor)| combination[*place] += factor);
        combination
    }

    /// The coordinate along a direction.
    fn along(&self, direction: &[f64]) -> Combination {
        let weighted: Combination = direction.iter().zip(&self.prior_sd).map(|(v, sd)| v / (sd * sd)).collect();
        let size = dot(&weighted, direction);
        weighted.iter().map(|x| x / size).collect()
    }

    fn drawn(&self, combination: &[f64]) -> Vec<f64> {
        let used: Vec<_> = self.known.number.iter().zip(combination).filter(|(_, c)| **c != 0.0).collect();
        (0..self.known.draws()).map(|draw| used.iter().map(|(number, c)| *c * number.draws[draw]).sum()).collect()
    }

    /// What is left of a combination.
    fn left(&self, combination: &[f64]) -> f64 {
        let prior: f64 = combination.iter().zip(&self.prior_sd).map(|(c, sd)| (c * sd).powi(2)).sum();
        let drawn = self.drawn(combination);
        (covariance(&drawn, &drawn) / prior).sqrt()
    }

    fn mean(&self, (name, alike): Alike) -> Pair {
        let (mut left, mut correlation) = ([0.0; 3], 0.0);
        let count = alike.len() as f64;
        for [first, second] in alike {
            let (a, b) = (self.drawn(&first), self.drawn(&second));
            let sum = plus(&first, 1.0, &second);
            left.iter_mut().zip([&first, &second, &sum]).for_each(|(left, c)| *left += self.left(c) / count);
            correlation += covariance(&a, &b) / (covariance(&a, &a) * covariance(&b, &b)).sqrt() / count;
        }
        Pair { name, left, correlation }
    }

    fn all(&self) -> Vec<Alike> {
        let mut all = self.common_movements();
        all.extend(self.within_cameras());
        all.push(("biases that agree in 3D, place on the body", self.agreeing()));
        all.extend(self.limbs());
        all
    }

    /// The body's size as a share of itself.
    fn size(&self) -> Combination {
        let all: f64 = lengths(&Proportions::default()).iter().sum();
        self.of(&self.layout.lengths().map(|place| (place, all.recip())).collect::<Vec<_>>())
    }

    /// The direction in which all cameras see the world moved by a shift, a turn about the recording's middle, and a scale about it.
    fn moved(&self, shift: [f64; 3], turn: [f64; 3], scale: f64) -> Combination {
        let mut direction = self.none();
        for (c, camera) in self.cameras.iter().enumerate() {
            let (shift, turn) = (seen_from(camera, shift), seen_from(camera, turn));
            let middle = camera.point_in_camera(self.known.middle_m);
            let carried = cross(turn, middle);
            let first = self.layout.camera(c).start;
            for k in 0..3 {
                direction[first + k] = turn[k];
                direction[first + 3 + k] = shift[k] - carried[k] - scale * middle[k];
            }
        }
        direction
    }

    fn common_movements(&self) -> Vec<Alike> {
        let still = [0.0; 3];
        let alone = |direction: Combination| [self.along(&direction), self.none()];
        let late = self.of(&self.layout.lags().map(|place| (place, 1.0)).collect::<Vec<_>>());
        let shifts = (0..3).map(|k| alone(self.moved(axis(k), still, 0.0))).collect();
        let turns = (0..3).map(|k| alone(self.moved(still, axis(k), 0.0))).collect();
        let scale = [self.along(&self.moved(still, still, 1.0)), self.size()];
        vec![
            ("all cameras shifted", shifts),
            ("all cameras turned", turns),
            ("all cameras late", vec![alone(late)]),
            ("all cameras scaled, size of the body", vec![scale]),
        ]
    }

    /// Depth of the recording's middle in a camera, metres.
    fn depth(&self, camera: usize) -> f64 {
        self.cameras[camera].point_in_camera(self.known.middle_m)[2]
    }

    /// How the rotation of a camera, its principal point, and the mean of its biases shift images along u or v, radians.
    fn shifts(&self, camera: usize, along: usize) -> [Combination; 3] {
        let first = self.layout.camera(camera).start;
        let turn = self.of(&[[(first + 1, 1.0)], [(first, -1.0)]][along]);
        let by = (self.depth(camera) * self.layout.points as f64).recip();
        let bias = |point| (self.layout.bias(camera, point).start + along, by);
        let biases: Vec<_> = (0..self.layout.points).map(bias).collect();
        [turn, self.of(&[(first + 7 + along, 1.0)]), self.of(&biases)]
    }

    fn within_cameras(&self) -> Vec<Alike> {
        let cameras = 0..self.layout.cameras;
        let axes = || cameras.clone().flat_map(|camera| [(camera, 0), (camera, 1)]);
        let turned = |(camera, along)| {
            let [turn, principal_point, _] = self.shifts(camera, along);
            [turn, principal_point]
        };
        let offset = |(camera, along)| {
            let [turn, principal_point, biases] = self.shifts(camera, along);
            [plus(&turn, 1.0, &principal_point), biases]
        };
        let focal = |camera| self.of(&[(self.layout.camera(camera).start + 6, 1.0)]);
        let nearer = |camera| self.of(&[(self.layout.camera(camera).start + 5, -self.depth(camera).recip())]);
        let add = |all: Combination, one: Combination| plus(&all, (self.layout.cameras as f64).recip(), &one);
        let sized = [cameras.clone().map(focal).fold(self.none(), add), self.size()];
        vec![
            ("rotation, principal point", axes().map(turned).collect()),
            ("focal length, distance", cameras.clone().map(|camera| [focal(camera), nearer(camera)]).collect()),
            ("mean focal length, size of the body", vec![sized]),
            ("offset of a camera, mean of its biases", axes().map(offset).collect()),
            ("lag of a camera, its offset along the motion", cameras.clone().map(|camera| self.late(camera)).collect()),
        ]
    }

    /// How the lag of a camera, and rotation and principal point together, shift images along the mean motion of the person, radians.
    fn late(&self, camera: usize) -> [Combination; 2] {
        let [x, y, z] = self.cameras[camera].point_in_camera(self.known.middle_m);
        let [vx, vy, vz] = seen_from(&self.cameras[camera], self.velocity);
        let flow = [(vx - vz * x / z) / z, (vy - vz * y / z) / z];
        let speed = flow[0].hypot(flow[1]);
        let offset = [0, 1].map(|along: usize| {
            let [turn, principal_point, _] = self.shifts(camera, along);
            plus(&self.none(), flow[along] / speed, &plus(&turn, 1.0, &principal_point))
        });
        [self.of(&[(self.layout.lag(camera), -speed)]), plus(&offset[0], 1.0, &offset[1])]
    }

    /// The part of the biases of a keypoint that is a shift in 3D, along a direction.
    fn bias_along(&self, point: usize, direction: [f64; 3]) -> Combination {
        let mut v = self.none();
        for (c, camera) in self.cameras.iter().enumerate() {
            let seen = seen_from(camera, direction);
            self.layout.bias(c, point).zip(seen).for_each(|(place, by)| v[place] = by);
        }
        self.along(&v)
    }

    /// The place of a keypoint on its link, along a direction of the world.
    fn place_along(&self, point: usize, direction: [f64; 3]) -> Combination {
        let rows = &self.body.link_axes[9 * point..][..9];
        let along = |axis: usize| dot(&[rows[axis], rows[3 + axis], rows[6 + axis]], &direction);
        let numbers: Vec<_> = self.layout.place(point).zip((0..3).map(along)).collect();
        self.of(&numbers)
    }

    /// Every keypoint, along the axes of the first camera's image.
    fn agreeing(&self) -> Vec<[Combination; 2]> {
        let [u, v, _] = self.cameras[0].rotation;
        let pair = |(point, direction)| [self.bias_along(point, direction), self.place_along(point, direction)];
        (0..self.layout.points).flat_map(|point| [(point, u), (point, v)]).map(pair).collect()
    }

    /// Lengths of forearms and shins, and what their ends show along them.
    fn limbs(&self) -> Vec<Alike> {
        let (mut biases, mut places) = (vec![], vec![]);
        for (length, near, far) in [("forearm", "Elbow", "Wrist"), ("shin", "Knee", "Ankle")] {
            let Some(place) = length_names().iter().position(|name| *name == length) else { continue };
            let length = self.of(&[(self.layout.lengths().start + place, 1.0)]);
            let sides = ["L", "R"].map(|side| self.limb(&format!("{side}{near}"), &format!("{side}{far}")));
            let [Some([bias, shift]), Some([other_bias, other_shift])] = sides else { continue };
            let half = |a: &[f64], b: &[f64]| plus(&plus(&self.none(), 0.5, a), 0.5, b);
            biases.push([length.clone(), half(&bias, &other_bias)]);
            places.push([length, half(&shift, &other_shift)]);
        }
        vec![("length of a limb, biases along it", biases), ("length of a limb, place of its end along it", places)]
    }

    /// Biases of the two ends of a limb along it, far less near, and the place of the far one.
    fn limb(&self, near: &str, far: &str) -> Option<[Combination; 2]> {
        let index = |name: &str| self.known.points.iter().position(|point| point == name);
        let (near, far) = (index(near)?, index(far)?);
        let at = |point: usize| &self.body.positions[3 * point..][..3];
        let along: [f64; 3] = std::array::from_fn(|k| at(far)[k] - at(near)[k]);
        let along = along.map(|x| x / dot(&along, &along).sqrt());
        let bias = plus(&self.bias_along(far, along), -1.0, &self.bias_along(near, along));
        Some([bias, self.place_along(far, along)])
    }
}

/// Covariance of two series.
fn covariance(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    a.iter().zip(b).map(|(a, b)| (a - mean_a) * (b - mean_b)).sum::<f64>() / a.len() as f64
}
