//! What is constant over a recording and known up to an error, as one vector g.
//!
//! ```text
//! g = | camera 1: ten numbers | … | lengths of the body | point 1: place on its link (3) | … | camera 1, point 1: bias (2) | … | camera 1: lag | …
//! ```
//!
//! A camera's numbers are its [`crate::cameras::camera_error`]; lengths are metres beyond the body's own; a place is how far the detectors' keypoint lies from the joint that it is named after, in the frame of its link, metres;
//! a bias is how far a camera's detector sees that keypoint from where it is, in metres at the distance of the recording's middle (a detector errs in proportion to the size of the person in its image);
//! a lag is how late a camera's clock is, seconds: it shows a point x of velocity v at x − lag · v. What all cameras share of it is a shift of time, which nothing shows.
//!
//! [`linearised`] gives a frame's normal equations at a pose s and a g: with H and G the derivatives of all predicted pixels by s and g, W the inverse variances times the share of a detection that is no outlier, and r observed − predicted,
//! the blocks of `(H G)ᵀ W (H G)` and `(H G)ᵀ W r`.

use crate::cameras::camera::Camera;
use crate::cameras::camera_error::{self, NUMBERS, PixelDerivatives};
use crate::keypoints::keypoint_model::{Detection, KeypointFrame, KeypointModel};
use nalgebra::{Matrix3, Vector3};
use sinew_body::point_derivatives::PointDerivatives;
use std::ops::Range;

/// Where each number of g stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LastingErrors {
    /// Cameras.
    pub cameras: usize,
    /// Lengths of the body.
    pub lengths: usize,
    /// Points of the body that are keypoints.
    pub points: usize,
}

impl LastingErrors {
    /// How many numbers there are.
    #[must_use]
    pub const fn count(&self) -> usize {
        NUMBERS * self.cameras + self.lengths + 3 * self.points + 2 * self.cameras * self.points + self.cameras
    }

    /// A camera's difference from its calibration.
    #[must_use]
    pub const fn camera(&self, camera: usize) -> Range<usize> {
        NUMBERS * camera..NUMBERS * (camera + 1)
    }

    /// Lengths of the body.
    #[must_use]
    pub const fn lengths(&self) -> Range<usize> {
        let first = NUMBERS * self.cameras;
        first..first + self.lengths
    }

    /// Places of all points on their links.
    #[must_use]
    pub const fn places(&self) -> Range<usize> {
        let first = self.lengths().end;
        first..first + 3 * self.points
    }

    /// The place of a point on its link.
    #[must_use]
    pub const fn place(&self, point: usize) -> Range<usize> {
        let first = self.places().start + 3 * point;
        first..first + 3
    }

    /// The bias of a camera's detector for a point.
    #[must_use]
    pub const fn bias(&self, camera: usize, point: usize) -> Range<usize> {
        let first = self.places().end + 2 * (camera * self.points + point);
        first..first + 2
    }

    /// All biases.
    #[must_use]
    pub const fn biases(&self) -> Range<usize> {
        let first = self.places().end;
        first..first + 2 * self.cameras * self.points
    }

    /// Lags of all cameras.
    #[must_use]
    pub const fn lags(&self) -> Range<usize> {
        let first = self.biases().end;
        first..first + self.cameras
    }

    /// The lag of a camera.
    #[must_use]
    pub const fn lag(&self, camera: usize) -> usize {
        self.lags().start + camera
    }

    /// A name for each number, from the names of cameras, lengths and points.
    #[must_use]
    pub fn names(&self, cameras: &[String], lengths: &[&str], points: &[String]) -> Vec<String> {
        let from_cameras =
            cameras.iter().flat_map(|camera| camera_error::NAMES.iter().map(move |n| format!("{camera}.{n}")));
        let from_lengths = lengths.iter().map(|name| format!("body.{name}_m"));
        let from_places =
            points.iter().flat_map(|point| ["x", "y", "z"].map(|axis| format!("body.{point}.place_{axis}_m")));
        let from_biases = cameras.iter().flat_map(|camera| {
            points.iter().flat_map(move |point| ["u", "v"].map(|axis| format!("{camera}.{point}.bias_{axis}_m")))
        });
        let lags = cameras.iter().map(|camera| format!("{camera}.lag_s"));
        from_cameras.chain(from_lengths).chain(from_places).chain(from_biases).chain(lags).collect()
    }
}

/// What a frame says of its pose (dimension d) and of g (dimension p); matrices row after row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearisedFrame {
    /// Hᵀ W H, d × d.
    pub pose: Vec<f64>,
    /// Hᵀ W G, d × p.
    pub between: Vec<f64>,
    /// Rows of W^½ G, two for each detection: the places that are not 0 and what stands there.
    pub lasting: Vec<Vec<(usize, f64)>>,
    /// Hᵀ W r, length d.
    pub pose_pull: Vec<f64>,
    /// Gᵀ W r, length p.
    pub lasting_pull: Vec<f64>,
    /// Residual of each detection.
    pub residuals: Vec<FrameResidual>,
}

/// Observed − predicted of a detection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameResidual {
    /// Its camera.
    pub camera: usize,
    /// Its point.
    pub point: usize,
    /// Pixels.
    pub residual_px: [f64; 2],
    /// Variance by the noise of the detector, square pixels.
    pub noise_px2: f64,
    /// Variance for a model error of one metre ([`KeypointModel::by_model_error`]).
    pub by_model_error: f64,
}

/// A detection whose pixel is linearised at a pose and a g.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearisedDetection {
    /// Observed − predicted.
    pub seen: FrameResidual,
    /// W: the inverse variance times the share of the detection that is no outlier.
    pub weight: f64,
    /// Derivatives of its pixel.
    pub by: PixelDerivatives,
}

/// The shift of the whole world, metres, that small differences of some cameras look like at a point, by least squares over pixels; `None` where fewer than two cameras see it. Shown by cameras that differ by `errors`, the world that is shifted so looks as it does to the cameras as they are.
#[must_use]
pub fn common_shift(cameras: &[Camera], errors: &[[f64; NUMBERS]], at: [f64; 3]) -> Option<[f64; 3]> {
    let (mut information, mut pull) = (Matrix3::<f64>::zeros(), Vector3::<f64>::zeros());
    let mut seen_by = 0;
    for (camera, error) in cameras.iter().zip(errors) {
        let Some(PixelDerivatives { by_point, by_error, .. }) = camera_error::derivatives(camera, at) else { continue };
        seen_by += 1;
        for axis in 0..2 {
            let row = Vector3::from(by_point[axis]);
            let moved: f64 = by_error[axis].iter().zip(error).map(|(by, error)| by * error).sum();
            information += row * row.transpose();
            pull -= row * moved;
        }
    }
    let inverse = information.try_inverse().filter(|_| seen_by > 1)?;
    Some((inverse * pull).into())
}

/// A camera's pixels for a metre at the distance of the recording's middle.
#[must_use]
pub fn pixels_per_metre(camera: &Camera, middle: [f64; 3]) -> f64 {
    camera.intrinsics.fx / camera.point_in_camera(middle)[2].max(crate::MIN_DEPTH_M)
}

/// The detections of a frame, point by point, linearised; `detections` and `elsewhere` as in [`KeypointFrame`]. `model` is at g: its cameras, its biases and the points of `body` are as g says. Derivatives by a camera are by an error on top of the one that it has: right where errors are small.
///
/// Where sides may be exchanged a point has the keypoints of both names, each weighed by how probable it is, as one with their mean.
#[must_use]
pub fn linearised_detections(
    model: &KeypointModel,
    detections: &[Vec<Option<Detection>>],
    elsewhere: &[Vec<f64>],
    body: &PointDerivatives,
) -> Vec<LinearisedDetection> {
    let frame = &KeypointFrame { detections, elsewhere, predicted: &body.positions };
    let (seen_by, exchanged) = (model.seen_by(frame), model.exchanged(frame));
    let partners = model.mistakes.partners(body.positions.len() / 3);
    let mut found = vec![];
    for (point, at) in body.positions.as_chunks::<3>().0.iter().enumerate() {
        for (camera, view) in model.views.iter().enumerate() {
            let Some(by) = camera_error::derivatives(&view.camera, *at) else { continue };
            let crossed = partners[point].and_then(|(partner, limb)| Some((partner, exchanged[camera][limb]?)));
            let ways = [Some((point, 1.0 - crossed.map_or(0.0, |(_, q)| q))), crossed];
            let mut sum: Option<LinearisedDetection> = None;
            for (named, probability) in ways.into_iter().flatten().filter(|(_, probability)| *probability > SMALLEST) {
                let Some((sighting, _)) = model.sighting(frame, &seen_by, camera, [named, point]) else { continue };
                let i = &view.camera.intrinsics;
                let residual_px = [sighting.pixel[0] + i.cx - by.pixel[0], sighting.pixel[1] + i.cy - by.pixel[1]];
                let (_, share) = model.noise.at(&sighting, Some(residual_px));
                let by_model_error = model.by_model_error(camera, seen_by[point].max(1), at);
                let noise_px2 = 1.0 / sighting.information - model.model_error_m.powi(2) * by_model_error;
                let seen = FrameResidual { camera, point, residual_px, noise_px2, by_model_error };
                let own = LinearisedDetection { seen, weight: probability * share * sighting.information, by };
                sum = Some(sum.map_or(own, |other| other.with(&own)));
            }
            found.extend(sum);
        }
    }
    found
}

impl LinearisedDetection {
    /// One detection of the same point in place of two, with their weighted mean; what is known of the noise is that of the one with more weight.
    fn with(&self, other: &Self) -> Self {
        let weight = self.weight + other.weight;
        let mean = |axis: usize| {
            let sum = self.weight * self.seen.residual_px[axis] + other.weight * other.seen.residual_px[axis];
            sum / weight.max(f64::MIN_POSITIVE)
        };
        let likelier = if other.weight > self.weight { other } else { self };
        Self { seen: FrameResidual { residual_px: [mean(0), mean(1)], ..likelier.seen }, weight, by: self.by }
    }
}

/// Probability of exchanged sides that is none.
const SMALLEST: f64 = 1e-8;

/// Σ W Pᵀ P over the detections of a point, with P the derivatives of pixels by it.
#[must_use]
pub fn point_information(at_point: &[LinearisedDetection]) -> [[f64; 3]; 3] {
    let mut sum = [[0.0; 3]; 3];
    for LinearisedDetection { weight, by, .. } in at_point {
        for row in by.by_point {
            for (a, sum) in sum.iter_mut().enumerate() {
                sum.iter_mut().zip(row).for_each(|(sum, by)| *sum += weight * row[a] * by);
            }
        }
    }
    sum
}

/// Hᵀ W H, d × d, row after row.
#[must_use]
pub fn pose_information(found: &[LinearisedDetection], body: &PointDerivatives, dof: usize) -> Vec<f64> {
    let mut information = vec![0.0; dof * dof];
    let mut times = vec![0.0; 3 * dof];
    for at_point in found.chunk_by(|a, b| a.seen.point == b.seen.point) {
        let known = point_information(at_point);
        let moves = &body.by_pose[3 * at_point[0].seen.point * dof..][..3 * dof];
        let (x, y, z) = (&moves[..dof], &moves[dof..2 * dof], &moves[2 * dof..]);
        for (row, times) in known.iter().zip(times.chunks_exact_mut(dof)) {
            times.iter_mut().zip(x.iter().zip(y).zip(z)).for_each(|(out, ((x, y), z))| {
                *out = row[0] * x + row[1] * y + row[2] * z;
            });
        }
        for (axis, times) in moves.chunks_exact(dof).zip(times.chunks_exact(dof)) {
            for (row, by) in information.chunks_exact_mut(dof).zip(axis).filter(|(_, by)| **by != 0.0) {
                row.iter_mut().zip(times).for_each(|(sum, other)| *sum += by * other);
            }
        }
    }
    information
}

/// H with each row over the standard deviation of its detection: two rows for each keypoint, camera by camera, m × d; rows of 0 for what was not seen.
#[must_use]
pub fn whitened_rows(
    found: &[LinearisedDetection],
    errors: &LastingErrors,
    body: &PointDerivatives,
    dof: usize,
) -> Vec<f64> {
    let mut rows = vec![0.0; 2 * errors.cameras * errors.points * dof];
    for LinearisedDetection { seen: FrameResidual { camera, point, .. }, weight, by } in found {
        let own = rows.chunks_exact_mut(dof).skip(2 * (camera * errors.points + point));
        for (row, by_point) in own.zip(by.by_point) {
            for (by, moves) in by_point.iter().zip(body.by_pose[3 * point * dof..].chunks_exact(dof)) {
                row.iter_mut().zip(moves).for_each(|(x, moves)| *x += weight.sqrt() * by * moves);
            }
        }
    }
    rows
}

/// How a detection's pixel changes with the lag of its camera, pixels a second, where points move so, metres a second; none moves where there are none.
#[must_use]
pub fn by_lag(detection: &LinearisedDetection, velocities: &[[f64; 3]]) -> [f64; 2] {
    let velocity = velocities.get(detection.seen.point).copied().unwrap_or_default();
    detection.by.by_point.map(|row| -row.iter().zip(velocity).map(|(by, v)| by * v).sum::<f64>())
}

/// The normal equations of a frame, from [`linearised_detections`]. `scales` are the [`pixels_per_metre`] of its cameras; points move with `velocities`, metres a second.
#[must_use]
pub fn linearised(
    found: &[LinearisedDetection],
    errors: &LastingErrors,
    scales: &[f64],
    (body, velocities): (&PointDerivatives, &[[f64; 3]]),
    dof: usize,
) -> LinearisedFrame {
    let p = errors.count();
    let mut frame = LinearisedFrame {
        pose: vec![0.0; dof * dof],
        between: vec![0.0; dof * p],
        lasting: vec![],
        pose_pull: vec![0.0; dof],
        lasting_pull: vec![0.0; p],
        residuals: found.iter().map(|detection| detection.seen).collect(),
    };
    let mut pose = vec![0.0; dof];
    for detection in found {
        for axis in 0..2 {
            let (lasting, residual) = row((detection, axis), errors, scales, (body, velocities), &mut pose);
            frame.add(&pose, lasting, residual, p);
        }
    }
    frame
}

/// The row of W^½ H of a detection's axis, into `pose`; that of W^½ G, and the scaled residual.
fn row(
    (detection, axis): (&LinearisedDetection, usize),
    errors: &LastingErrors,
    scales: &[f64],
    (body, velocities): (&PointDerivatives, &[[f64; 3]]),
    pose: &mut [f64],
) -> (Vec<(usize, f64)>, f64) {
    let LinearisedDetection { seen: FrameResidual { camera, point, residual_px, .. }, weight, by } = detection;
    let root = weight.sqrt();
    let row = by.by_point[axis].map(|by| root * by);
    let across = |moves: &[f64], width: usize, column: usize| -> f64 {
        (0..3).map(|a| row[a] * moves[(3 * point + a) * width + column]).sum()
    };
    let dof = pose.len();
    pose.iter_mut().enumerate().for_each(|(j, x)| *x = across(&body.by_pose, dof, j));
    let by_camera = errors.camera(*camera).zip(by.by_error[axis].map(|by| root * by));
    let by_lengths = errors.lengths().enumerate().map(|(k, place)| (place, across(&body.by_length, errors.lengths, k)));
    let by_place = errors.place(*point).enumerate().map(|(k, place)| (place, across(&body.link_axes, 3, k)));
    let by_bias = std::iter::once((errors.bias(*camera, *point).start + axis, root * scales[*camera]));
    let by_lag = std::iter::once((errors.lag(*camera), root * by_lag(detection, velocities)[axis]));
    let all = by_camera.chain(by_lengths).chain(by_place).chain(by_bias).chain(by_lag);
    (all.filter(|(_, by)| *by != 0.0).collect(), root * residual_px[axis])
}

impl LinearisedFrame {
    /// Adds a row.
    fn add(&mut self, pose: &[f64], lasting: Vec<(usize, f64)>, residual: f64, p: usize) {
        let d = pose.len();
        for (j, by) in pose.iter().enumerate().filter(|(_, by)| **by != 0.0) {
            self.pose_pull[j] += by * residual;
            self.pose[j * d..][..d].iter_mut().zip(pose).for_each(|(sum, other)| *sum += by * other);
            lasting.iter().for_each(|(place, other)| self.between[j * p + place] += by * other);
        }
        lasting.iter().for_each(|(place, by)| self.lasting_pull[*place] += by * residual);
        self.lasting.push(lasting);
    }

    /// Gᵀ W G, p × p, row after row.
    #[must_use]
    pub fn information(&self) -> Vec<f64> {
        let p = self.lasting_pull.len();
        let mut information = vec![0.0; p * p];
        for row in &self.lasting {
            for (place, by) in row {
                row.iter().for_each(|(other, value)| information[place * p + other] += by * value);
            }
        }
        information
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All cameras moved together are a shift of the world the other way, seen from the cameras.
    #[test]
    fn cameras_that_move_together_look_like_a_shift_of_the_world() {
        let at = [0.1, -0.2, 1.0];
        let camera = |k: f64| {
            let (sin, cos) = (0.4 + 1.57 * k).sin_cos();
            Camera::look_at("C", [1000.0, 800.0], 900.0, [4.0 * cos, 4.0 * sin, 1.5], at).unwrap()
        };
        let cameras = [0.0, 1.0, 2.0, 3.0].map(camera);
        let world = [0.02, -0.01, 0.03];
        // A camera's translation in its own frame by R d moves what it shows as the world's shift d does.
        let errors = [0, 1, 2, 3].map(|c: usize| {
            let mut error = [0.0; NUMBERS];
            for (row, place) in cameras[c].rotation.iter().zip(&mut error[3..6]) {
                *place = (0..3).map(|k| row[k] * world[k]).sum();
            }
            error
        });
        let found = common_shift(&cameras, &errors, at).unwrap();
        assert!(found.iter().zip(world).all(|(f, w)| (f + w).abs() < 1e-9), "{found:?}");
        assert_eq!(common_shift(&cameras[..1], &errors[..1], at), None);
    }
}
