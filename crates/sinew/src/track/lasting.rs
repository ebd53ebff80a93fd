//! Adds the uncertainty of what is constant over a run (cameras, lengths, places, biases, lags) to the draws of every frame.
//!
//! The tracker computes as if the set-up's values ĝ of the constants were true. The set-up also has n draws g of them ([`crate::setup::MeasuredErrors`]). Draw i of every frame is paired with draw k = i mod n, and its state s⁽ⁱ⁾ is moved to
//! s⁽ⁱ⁾ + J (g⁽ᵏ⁾ − ĝ), where the tracker's estimate would be if g⁽ᵏ⁾ were true: J is the derivative of the filter's estimate by the constants, from the filter linearised at its estimates ([`LastingMoves`]). Longer segments move the points of the body, too.
//! Errors that persist over some frames widen the draws further, since the filter takes them as independent ([`PersistentErrors`]). J is computed from keypoints alone; with silhouettes as well it is too large.
//! Lags are among the constants: what late cameras show is put where it would be at the set-up's lag ([`Scene`]), and draws of lags move the draws of poses.

use super::error::TrackError;
use super::noted::Noted;
use super::scene::Scene;
use crate::Error;
use crate::setup::Setup;
use crate::setup::lasting_draws::{detected, deviations, world_shifts};
use sinew_body::point_derivatives::Neighbours;
use sinew_body::{KinematicTree, point_positions_each};
use sinew_core::combinations::add_combinations;
use sinew_core::estimators::mean;
use sinew_core::lanes::{Block, numbers_mut};
use sinew_core::random::Stage;
use sinew_core::transition::Moments;
use sinew_dynamics::axes::along_axes;
use sinew_dynamics::factor::positive_part;
use sinew_dynamics::lasting_draws::LastingMoves;
use sinew_dynamics::linearised_filter::LinearisedFilter;
use sinew_dynamics::motion_prior::MotionPrior;
use sinew_dynamics::persistent_errors::{Persistence, PersistentErrors, root};
use sinew_observe::clocks::point_velocity::RunningVelocities;
use sinew_observe::lasting::drawn_errors::DrawnErrors;
use sinew_observe::lasting::lasting_errors::{
    LastingErrors, linearised_detections, pixels_per_metre, pose_information, whitened_rows,
};
use sinew_observe::{Camera, KeypointModel};
use sinew_tracking::StepInfo;
use sinew_tracking::moved::{Moved, Rows};

/// What is constant, beside a tracker.
#[derive(Clone)]
pub(super) struct Lasting {
    model: KeypointModel,
    drawn: DrawnErrors,
    draws: usize,
    /// The body with its keypoints where the detectors see them.
    keypoints: Neighbours,
    points: Neighbours,
    /// Points that are where a detector sees them, with the place of their keypoint.
    detected: Vec<(usize, usize)>,
    pixels_per_metre: Vec<f64>,
    /// For each draw of the errors of the cameras, the shift of the whole world that looks most like them, metres.
    shifts: Vec<[f64; 3]>,
    /// Variances of the state before the first frame, and of a step.
    initial: Vec<f64>,
    step: Vec<f64>,
    filter: LinearisedFilter,
    moves: LastingMoves,
    persistence: Option<(Persistence, PersistentErrors)>,
    /// How the keypoints move: a late camera shows them where they were.
    velocities: RunningVelocities,
    started: bool,
}

impl Lasting {
    /// `None` for a set-up that does not know what is constant. Frames follow each other after `seconds`.
    pub(super) fn new(
        setup: &Setup,
        tree: &KinematicTree,
        cameras: &[Camera],
        scene: &Scene,
        motion: &MotionPrior,
        seconds: f64,
    ) -> Option<Self> {
        let known = setup.lasting.as_ref()?;
        if cameras.iter().any(|camera| !known.cameras.contains(&camera.name)) {
            return None;
        }
        let indices = scene.point_indices();
        let errors = LastingErrors { cameras: cameras.len(), points: indices.len(), ..known.layout() };
        let all: Vec<usize> = (0..tree.points().len()).collect();
        let places = setup.detected_places(tree);
        let build = |sizes: &_| setup.tree_of(sizes).with_points_moved(&places);
        let variances = |sd: &[f64]| sd.iter().map(|sd| sd * sd).collect::<Vec<f64>>();
        let (initial, draws, isa) = (variances(motion.initial_sd()), known.draws(), scene.model().isa);
        let deviations = deviations(known, &errors, cameras, &scene.keypoints());
        let rows = Rows::new(&deviations, draws);
        let observed = 2 * errors.cameras * errors.points;
        let persistence = known.persistence(seconds).map(|p| (p, PersistentErrors::new(initial.len(), observed)));
        Some(Self {
            model: scene.model().clone(),
            shifts: world_shifts(&setup.as_they_are(cameras, 1.0), &errors, &deviations, known),
            keypoints: Neighbours::new(build, &setup.proportions, indices),
            points: Neighbours::new(|sizes| setup.tree_of(sizes), &setup.proportions, &all),
            detected: detected(setup, tree, indices),
            pixels_per_metre: cameras.iter().map(|camera| pixels_per_metre(camera, known.middle_m)).collect(),
            filter: LinearisedFilter::new(&initial),
            moves: LastingMoves::new(initial.len(), rows.blocks(), isa),
            drawn: DrawnErrors { errors, blocks: rows.blocks(), deviations: rows.values, isa },
            step: variances(motion.sd()),
            initial,
            draws,
            persistence,
            velocities: RunningVelocities::new(errors.points, seconds),
            started: false,
        })
    }

    /// Takes in a frame that was tracked, and returns by how much each of its draws is to be moved; `seed` is that of random streams.
    pub(super) fn step(&mut self, noted: &Noted, seed: u64) -> Result<Moved, Error> {
        let Noted { number, shown, info: StepInfo { mean, restarted, .. }, .. } = noted;
        if !self.started || *restarted {
            self.filter = LinearisedFilter::new(&self.initial);
            self.moves.restart();
            self.persistence.iter_mut().for_each(|(_, persistent)| persistent.restart());
            self.velocities.restart();
        } else {
            self.filter.predict(&self.step);
        }
        self.started = true;
        let dof = mean.len();
        let body = self.keypoints.at(mean);
        let found = linearised_detections(&self.model, &shown.detections, &shown.elsewhere, &body);
        let information = pose_information(&found, &body, dof);
        let shifts = self.drawn.keypoint_shifts(&body);
        let velocities = self.velocities.next(&body.positions);
        let pull = self.drawn.pull(&found, (&body, velocities), &shifts, &self.pixels_per_metre, dof);
        self.filter.update(&information).map_err(TrackError::Motion)?;
        let covariance = self.filter.covariance();
        self.moves.update(&covariance, &information, pull).map_err(TrackError::Motion)?;
        if let Some((persistence, persistent)) = &mut self.persistence {
            let whitened = whitened_rows(&found, &self.drawn.errors, &body, dof);
            persistent.update(&covariance, &information, &whitened, *persistence).map_err(TrackError::Motion)?;
        }
        let mut moved = self.moved_from(mean, Rows { values: self.moves.moves().to_vec(), draws: self.draws }, shifts);
        if let Some((_, persistent)) = &self.persistence {
            let stage = Stage::new(seed, "persistent errors").at_frame(*number as u32);
            self.widen(&mut moved.states, &persistent.missing(), stage);
        }
        Ok(moved)
    }

    /// Moments of the frame for a backward pass, from the moments `drawn` of its draws: the covariance of the draws along the axes of the linearised filter, plus what persistent errors add to it.
    ///
    /// Both terms are estimates, and their sum may have directions of negative variance, which would grow with every step of a backward pass: only its positive part is taken.
    pub(super) fn filtered(&self, drawn: Moments) -> Result<Moments, sinew_dynamics::Error> {
        let mut covariance = along_axes(&drawn.covariance, &self.filter.covariance(), &self.step)?;
        if let Some((_, persistent)) = &self.persistence {
            covariance.iter_mut().zip(persistent.missing()).for_each(|(known, missing)| *known += missing);
            covariance = positive_part("filtered covariance", &covariance, self.step.len())?;
        }
        Ok(Moments { covariance, ..drawn })
    }

    /// Adds to the states normal draws with mean 0 over the draws and covariance `missing` (d × d, row after row): what persistent errors add to the filter's covariance.
    fn widen(&self, states: &mut Rows, missing: &[f64], stage: Stage) {
        let dof = self.initial.len();
        let mut normal = vec![Block::ZERO; states.values.len()];
        stage.whole().fill_normal(self.drawn.isa, &mut normal);
        // Without their mean, which would move the estimate.
        for row in normal.chunks_exact_mut(self.drawn.blocks) {
            let row = &mut numbers_mut(row)[..self.draws];
            let middle = mean(row);
            row.iter_mut().for_each(|x| *x -= middle);
        }
        add_combinations(self.drawn.isa, &root(missing, dof), &normal, &mut states.values, self.drawn.blocks);
    }

    /// Shape and detected keypoints of the first draws, in their moved states, as they are written.
    pub(super) fn written(&self, moved: &Moved, states: &[f64]) -> [Vec<f64>; 2] {
        let at = point_positions_each(&self.model.plan, self.model.isa, states);
        moved.written(at, states.len() / self.initial.len())
    }

    /// By how much each draw moves the state, the points and the keypoints, linearised at the state `mean`. `moves` are the moves of the state, degrees of freedom × draws, row after row.
    pub(super) fn moved(&self, mean: &[f64], moves: &[f64]) -> Moved {
        let shifts = self.drawn.keypoint_shifts(&self.keypoints.at(mean));
        self.moved_from(mean, Rows::new(moves, self.draws), shifts)
    }

    /// The same with these shifts of the keypoints.
    fn moved_from(&self, mean: &[f64], states: Rows, keypoints: Vec<Block>) -> Moved {
        let draws = self.draws;
        let mut points = self.drawn.by_length(&self.points.by_length(mean));
        self.drawn.follow(&mut points, &keypoints, &self.detected);
        Moved {
            // Without keypoints nothing answers to the cameras.
            shifts: if states.is_zero() { vec![[0.0; 3]; draws] } else { self.shifts.clone() },
            states,
            points: Rows { values: points, draws },
            keypoints: Rows { values: keypoints, draws },
        }
    }

    /// Draws of what is constant.
    pub(super) const fn draws(&self) -> usize {
        self.draws
    }

    /// Moves of the draws by what is constant alone, a row for each degree of freedom.
    pub(super) fn moves(&self) -> Vec<f64> {
        Rows { values: self.moves.moves().to_vec(), draws: self.draws }.numbers()
    }

    pub(super) fn save(&self) -> Vec<f64> {
        if !self.started {
            return vec![];
        }
        let persistent = self.persistence.as_ref().map(|(_, persistent)| persistent.save());
        [self.filter.covariance(), self.moves.save(), self.velocities.save(), persistent.unwrap_or_default()].concat()
    }

    pub(super) fn restore(&mut self, saved: &[f64]) -> Result<(), sinew_dynamics::Error> {
        self.started = !saved.is_empty();
        if !self.started {
            return Ok(());
        }
        let (covariance, moves) = (self.initial.len().pow(2), self.moves.save().len());
        let (covariance, rest) = saved.split_at(covariance.min(saved.len()));
        let (moves, rest) = rest.split_at(moves.min(rest.len()));
        let (velocities, persistent) = rest.split_at(self.velocities.saved().min(rest.len()));
        self.filter.restore(covariance)?;
        self.moves.restore(moves)?;
        let (found, expected) = (velocities.len(), self.velocities.saved());
        if found != expected {
            return Err(sinew_dynamics::Error::Shape { name: "velocities of keypoints", found, expected });
        }
        self.velocities.restore(velocities);
        self.persistence.as_mut().map_or(Ok(()), |(_, own)| own.restore(persistent))
    }
}
