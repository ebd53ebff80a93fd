//! What is constant over a run, in every frame's draws.
//!
//! Tracking takes the set-up's values ĝ of what is constant for true. The set-up also drew how far the truth may be from them ([`crate::setup::MeasuredErrors`]). Draw i of every frame belongs to draw i mod n of these, and so is moved to
//! where the tracker's estimate would be had that been true: s⁽ⁱ⁾ + J (g⁽ⁱ⁾ − ĝ), with the answer J of the filter linearised at its estimates ([`LastingMoves`]). Longer segments move the points of the body, too.
//! Keypoints alone enter J: beside silhouettes it is too large.

use super::error::TrackError;
use super::moved::Moved;
use super::scene::Scene;
use crate::Error;
use crate::setup::Setup;
use crate::setup::lasting_draws::{deviations, world_shifts};
use sinew_body::KinematicTree;
use sinew_body::point_derivatives::{Neighbours, PointDerivatives};
use sinew_dynamics::lasting_draws::LastingMoves;
use sinew_dynamics::motion_prior::MotionPrior;
use sinew_observe::Camera;
use sinew_observe::lasting_errors::{LastingErrors, linearised, pixels_per_metre};

/// What is constant, beside a tracker.
pub(super) struct Lasting {
    errors: LastingErrors,
    /// The body with its keypoints where the detectors see them.
    keypoints: Neighbours,
    points: Neighbours,
    pixels_per_metre: Vec<f64>,
    draws: usize,
    /// The shift of the world that each draw of the cameras looks like, metres.
    shifts: Vec<[f64; 3]>,
    /// Draws less the values that tracking uses, p × n, row after row.
    deviations: Vec<f64>,
    initial: Vec<f64>,
    step: Vec<f64>,
    moves: LastingMoves,
    started: bool,
}

impl Lasting {
    /// `None` for a set-up that does not know what is constant.
    pub(super) fn new(
        setup: &Setup,
        tree: &KinematicTree,
        cameras: &[Camera],
        scene: &Scene,
        motion: &MotionPrior,
    ) -> Result<Option<Self>, Error> {
        let Some(known) = &setup.lasting else { return Ok(None) };
        if cameras.iter().any(|camera| !known.cameras.contains(&camera.name)) {
            return Ok(None);
        }
        let indices = scene.point_indices();
        let errors = LastingErrors { cameras: cameras.len(), points: indices.len(), ..known.layout() };
        let all: Vec<usize> = (0..tree.points().len()).collect();
        let places = setup.detected_places(tree);
        let build = |sizes: &_| setup.body.tree(sizes).with_points_moved(&places);
        let variances = |sd: &[f64]| sd.iter().map(|sd| sd * sd).collect::<Vec<f64>>();
        let (initial, draws) = (variances(motion.initial_sd()), known.draws());
        let deviations = deviations(known, &errors, cameras, &scene.keypoints());
        let moves = LastingMoves::new(&initial, draws, &deviations).map_err(TrackError::Motion)?;
        Ok(Some(Self {
            shifts: world_shifts(&setup.as_they_are(cameras, 1.0), &errors, &deviations, known),
            keypoints: Neighbours::new(build, &setup.proportions, indices),
            points: Neighbours::new(|sizes| setup.body.tree(sizes), &setup.proportions, &all),
            pixels_per_metre: cameras.iter().map(|camera| pixels_per_metre(camera, known.middle_m)).collect(),
            deviations,
            moves,
            step: variances(motion.sd()),
            errors,
            initial,
            draws,
            started: false,
        }))
    }

    /// Takes in a frame that was tracked, `mean` its estimate, and says where its draws go.
    pub(super) fn step(&mut self, scene: &Scene, mean: &[f64], restarted: bool) -> Result<Moved, Error> {
        if !self.started || restarted {
            self.moves.restart(&self.initial);
        } else {
            self.moves.predict(&self.step);
        }
        self.started = true;
        let body = self.keypoints.at(mean);
        let seen = linearised(scene.model(), &self.errors, &self.pixels_per_metre, scene.detections(), &body, false);
        self.moves.update(&seen.pose, &seen.between).map_err(TrackError::Motion)?;
        Ok(self.moved_from(mean, &body, self.moves.moves()))
    }

    /// Points on a body moved by draws, 3 a point, × n: by lengths, and by their places where they are keypoints.
    fn shifted(&self, by_length: &[Vec<f64>], link_axes: &[Vec<f64>]) -> Vec<f64> {
        let n = self.draws;
        let mut shifts = vec![0.0; by_length.first().map_or(0, Vec::len) * n];
        let mut add = |row: usize, by: f64, place: usize| {
            let deviations = &self.deviations[place * n..][..n];
            shifts[row * n..][..n].iter_mut().zip(deviations).for_each(|(x, deviation)| *x += by * deviation);
        };
        for (place, moved) in self.errors.lengths().zip(by_length) {
            moved.iter().enumerate().for_each(|(row, by)| add(row, *by, place));
        }
        for (axis, moved) in link_axes.iter().enumerate() {
            moved.iter().enumerate().for_each(|(row, by)| add(row, *by, self.errors.place(row / 3).start + axis));
        }
        shifts
    }

    /// Where draws go that move the state so, at a mean.
    pub(super) fn moved(&self, mean: &[f64], states: Vec<f64>) -> Moved {
        self.moved_from(mean, &self.keypoints.at(mean), states)
    }

    /// The same with the keypoints in that pose.
    fn moved_from(&self, mean: &[f64], keypoints: &PointDerivatives, states: Vec<f64>) -> Moved {
        let body = self.points.at(mean);
        Moved {
            // Without keypoints nothing answers to the cameras.
            shifts: if states.iter().any(|x| *x != 0.0) { self.shifts.clone() } else { vec![[0.0; 3]; self.draws] },
            draws: self.draws,
            states,
            points: self.shifted(&body.by_length, &[]),
            keypoints: self.shifted(&keypoints.by_length, &keypoints.link_axes),
        }
    }

    /// Draws of what is constant.
    pub(super) const fn draws(&self) -> usize {
        self.draws
    }

    pub(super) fn save(&self) -> Vec<f64> {
        if self.started { self.moves.save() } else { vec![] }
    }

    pub(super) fn restore(&mut self, saved: &[f64]) -> Result<(), sinew_dynamics::Error> {
        self.started = !saved.is_empty();
        if self.started { self.moves.restore(saved) } else { Ok(()) }
    }
}
