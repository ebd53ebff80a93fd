//! What is constant over a run, in every frame's draws.
//!
//! Tracking takes the set-up's values ĝ of what is constant for true. The set-up also drew how far the truth may be from them ([`MeasuredErrors`]). Draw i of every frame belongs to draw i mod n of these, and so is moved to
//! where the tracker's estimate would be had that been true: s⁽ⁱ⁾ + J (g⁽ⁱ⁾ − ĝ), with the answer J of the filter linearised at its estimates ([`LastingMoves`]). Longer segments move the points of the body, too.
//! Keypoints alone enter J: beside silhouettes it is too large.

use super::error::TrackError;
use super::scene::Scene;
use crate::Error;
use crate::setup::{MeasuredErrors, Setup};
use sinew_body::KinematicTree;
use sinew_body::point_derivatives::Neighbours;
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::BlockRng;
use sinew_dynamics::lasting_draws::LastingMoves;
use sinew_dynamics::motion_prior::MotionPrior;
use sinew_observe::Camera;
use sinew_observe::lasting_errors::{LastingErrors, common_shift, linearised, pixels_per_metre};
use sinew_tracking::posterior::Posterior;

/// Weighted draws are made this many of equal weight before they are moved.
const EQUAL_DRAWS: usize = 512;

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

/// Where the draws of a frame go.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Moved {
    /// The part of it that all points share in all frames, draw by draw, metres.
    pub shifts: Vec<[f64; 3]>,
    /// Draws n of what is constant.
    pub draws: usize,
    /// By how much each moves the state, d × n, row after row.
    pub states: Vec<f64>,
    /// By how much each moves the points of the body beyond that, 3 a point, × n, metres.
    pub points: Vec<f64>,
    /// The same of the keypoints as the detectors see them.
    pub keypoints: Vec<f64>,
}

/// Draws of equal weight.
pub(super) struct EqualDraws {
    pub states: Vec<Block>,
    pub weights: Vec<f64>,
}

impl Lasting {
    /// `None` for a set-up that does not know what is constant.
    pub(super) fn new(
        setup: &Setup,
        tree: &KinematicTree,
        cameras: &[Camera],
        scene: &Scene,
        motion: &MotionPrior,
    ) -> Option<Self> {
        let known = setup.lasting.as_ref()?;
        if cameras.iter().any(|camera| !known.cameras.contains(&camera.name)) {
            return None;
        }
        let indices = scene.point_indices();
        let errors = LastingErrors { cameras: cameras.len(), points: indices.len(), ..known.layout() };
        let all: Vec<usize> = (0..tree.points().len()).collect();
        let places = setup.detected_places(tree);
        let build = |sizes: &_| setup.body.tree(sizes).with_points_moved(&places);
        let variances = |sd: &[f64]| sd.iter().map(|sd| sd * sd).collect::<Vec<f64>>();
        let (initial, draws) = (variances(motion.initial_sd()), known.draws());
        let deviations = deviations(known, &errors, cameras, &scene.keypoints());
        Some(Self {
            shifts: shifts(&setup.as_they_are(cameras, 1.0), &errors, &deviations, known),
            keypoints: Neighbours::new(build, &setup.proportions, indices),
            points: Neighbours::new(|sizes| setup.body.tree(sizes), &setup.proportions, &all),
            pixels_per_metre: cameras.iter().map(|camera| pixels_per_metre(camera, known.middle_m)).collect(),
            deviations,
            moves: LastingMoves::new(&initial, draws),
            step: variances(motion.sd()),
            errors,
            initial,
            draws,
            started: false,
        })
    }

    /// Takes in a frame that was tracked, `mean` its estimate, and says where its draws go.
    pub(super) fn step(&mut self, scene: &Scene, mean: &[f64], restarted: bool) -> Result<Moved, Error> {
        if !self.started || restarted {
            self.moves = LastingMoves::new(&self.initial, self.draws);
        } else {
            self.moves.predict(&self.step);
        }
        self.started = true;
        let body = self.keypoints.at(mean);
        let seen = linearised(scene.model(), &self.errors, &self.pixels_per_metre, scene.detections(), &body, false);
        self.moves.update(&seen.pose, &seen.between, &self.deviations).map_err(TrackError::Motion)?;
        Ok(self.moved(mean, self.moves.moves()))
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
        let (body, keypoints) = (self.points.at(mean), self.keypoints.at(mean));
        Moved {
            shifts: self.shifts.clone(),
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

/// The shift of the world that each draw of the cameras looks like at the middle of the set-up's frames; 0 where fewer than two see it.
fn shifts(cameras: &[Camera], errors: &LastingErrors, deviations: &[f64], known: &MeasuredErrors) -> Vec<[f64; 3]> {
    let draws = known.draws();
    let of_draw = |draw: usize| {
        let error = |camera: usize| {
            let first = errors.camera(camera).start;
            std::array::from_fn(|k| deviations[(first + k) * draws + draw])
        };
        let drawn: Vec<_> = (0..cameras.len()).map(error).collect();
        common_shift(cameras, &drawn, known.middle_m).unwrap_or_default()
    };
    (0..draws).map(of_draw).collect()
}

/// Draws of the set-up for these cameras and points, in the order of `errors`; what the set-up has no draws of stays where it is.
fn deviations(known: &MeasuredErrors, errors: &LastingErrors, cameras: &[Camera], points: &[String]) -> Vec<f64> {
    let layout = known.layout();
    let camera_of = |camera: usize| known.cameras.iter().position(|name| *name == cameras[camera].name);
    let point_of = |point: usize| known.points.iter().position(|name| *name == points[point]);
    let mut from: Vec<Option<usize>> = vec![None; errors.count()];
    let mut put = |own: std::ops::Range<usize>, theirs: Option<std::ops::Range<usize>>| {
        let theirs = theirs.into_iter().flatten().map(Some).chain(std::iter::repeat(None));
        own.zip(theirs).for_each(|(place, theirs)| from[place] = theirs);
    };
    put(errors.lengths(), Some(layout.lengths()));
    for point in 0..points.len() {
        put(errors.place(point), point_of(point).map(|theirs| layout.place(theirs)));
    }
    for camera in 0..cameras.len() {
        put(errors.camera(camera), camera_of(camera).map(|theirs| layout.camera(theirs)));
        for point in 0..points.len() {
            let theirs = camera_of(camera).zip(point_of(point)).map(|(camera, point)| layout.bias(camera, point));
            put(errors.bias(camera, point), theirs);
        }
    }
    let draws = known.draws();
    from.into_iter()
        .flat_map(|place| place.map_or_else(|| vec![0.0; draws], |place| known.number[place].draws.clone()))
        .collect()
}

impl Moved {
    /// Mean move of the state.
    pub(super) fn mean(&self) -> Vec<f64> {
        self.states.chunks_exact(self.draws).map(|row| row.iter().sum::<f64>() / self.draws as f64).collect()
    }

    /// Shifts of the first draws, one after the other: of `shifts`, rows of the draws.
    fn of_draws(&self, shifts: &[f64], count: usize) -> Vec<f64> {
        let rows = shifts.chunks_exact(self.draws);
        (0..count).flat_map(|draw| rows.clone().map(move |row| row[draw % self.draws])).collect()
    }

    /// Draws of a frame as they are written: `states` are moved, `scene` has the keypoints.
    pub(super) fn written(&self, scene: &Scene, states: &[f64], dim: usize) -> [Vec<f64>; 2] {
        let count = states.len() / dim;
        let mut detected = self.of_draws(&self.keypoints, count);
        let at = states.chunks_exact(dim).flat_map(|state| scene.points(state));
        detected.iter_mut().zip(at).for_each(|(x, at)| *x += at);
        [self.of_draws(&self.points, count), detected]
    }

    /// Moves some states, one after the other, the k-th as draw k says.
    pub(super) fn apply(&self, states: &mut [f64], dim: usize) {
        for (draw, state) in states.chunks_exact_mut(dim).enumerate() {
            state.iter_mut().enumerate().for_each(|(j, x)| *x += self.states[j * self.draws + draw % self.draws]);
        }
    }

    /// The draws of a posterior, of equal weight and moved.
    pub(super) fn equal_draws(&self, posterior: &Posterior<'_>, rng: &mut BlockRng) -> EqualDraws {
        let d = posterior.dim;
        let is_equal = posterior.weights.windows(2).all(|pair| pair[0] == pair[1]);
        let mut states = if is_equal {
            posterior.states.to_vec()
        } else {
            let chosen = posterior.equal_weight(EQUAL_DRAWS, rng);
            let mut states = vec![Block::ZERO; EQUAL_DRAWS / LANES * d];
            for (draw, &index) in chosen.iter().enumerate() {
                for j in 0..d {
                    states[draw / LANES * d + j].0[draw % LANES] =
                        posterior.states[index / LANES * d + j].0[index % LANES];
                }
            }
            states
        };
        for (block, state) in states.chunks_exact_mut(d).enumerate() {
            for (j, x) in state.iter_mut().enumerate() {
                x.0.iter_mut()
                    .enumerate()
                    .for_each(|(lane, x)| *x += self.states[j * self.draws + (block * LANES + lane) % self.draws]);
            }
        }
        let count = if is_equal { posterior.count() } else { EQUAL_DRAWS };
        EqualDraws { states, weights: vec![1.0 / count as f64; count] }
    }
}
