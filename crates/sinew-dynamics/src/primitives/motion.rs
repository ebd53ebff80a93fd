//! Action primitives as the motion model of a whole state.
//!
//! One feature vector, usually all joint angles, moves by the three models of [`crate::primitives::switching`]; the coordinates that it does not cover, such as the root's, always walk at random, model (8). The density sums over the three models
//! ([`crate::primitives::density`]), so that a step has an exact density with gradient.
//!
//! The action primitive of a state at frame t is made of the estimates of the frames t − D to t − 2 and, as the newest, of the state's own values at t − 1. While there are fewer than D estimates, all coordinates walk at random.
//!
//! As a prior between frames it is the mean over draws of the last frame, each with all its three models ([`Between::Mixture`]), or the Gaussian of its mean and covariance ([`Between::Gaussian`]). Coordinates are not wrapped: they are to be continuous in time and near the angles of the training motion.
//!
//! It moves no part alone: which model moves a state is drawn once for all of the feature vector, and parts moved one after the other would each draw it again, which is another law than the whole transition's.

use crate::Error;
use crate::gaussian::Gaussian;
use crate::mixture::Mixture;
use crate::primitives::density::SwitchingMixture;
use crate::primitives::matched;
use crate::primitives::model::PrimitiveModel;
use crate::primitives::places::Places;
use crate::primitives::switching::{Choice, Switching};
use crate::prior::Prior;
use crate::random_walk::Between;
use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::BlockRng;
use sinew_core::transition::{Cloud, GradTransition, MotionModel, Predict, Transition};
use std::sync::Arc;

/// Draws of the last frame that a prior between frames is averaged over, at least: with the last states of a few chains it has holes where no chain ended.
const AVERAGED: usize = 400;

/// How far the time between frames may be from that of the training motion, as a share.
const SAME_RATE: f64 = 0.01;

/// The motion model of one recording.
#[derive(Clone, Debug)]
pub struct PrimitiveMotion {
    switching: Arc<Switching>,
    places: Arc<Places>,
    initial_sd: Vec<f64>,
    /// The feature vectors of the last D estimates, the oldest first.
    past: Vec<f64>,
    /// Estimates taken in, D at most.
    seen: usize,
    length: usize,
    between: Between,
    isa: Isa,
}

/// Refuses frames that are not as far apart as the training motion's.
pub(crate) fn check_rate(model: &PrimitiveModel, dt: f64) -> Result<(), Error> {
    let off = (dt * model.frame_rate - 1.0).abs();
    if off <= SAME_RATE {
        return Ok(());
    }
    let expected = "must be that of the motion that the model was learned from";
    Err(Error::OutOfRange { name: "time step", index: 0, value: dt, expected })
}

impl PrimitiveMotion {
    /// The motion of the feature vector called `feature`, for frames `dt` seconds apart. The first frame's spread about its given centre is that of one step of the random walk.
    ///
    /// # Errors
    /// [`Error::Unknown`] where the model has no such feature vector, [`Error::OutOfRange`] where `dt` is more than 1 % off the frame time of the training motion, and as [`Switching::new`] for a model that was not checked.
    pub fn new(model: &PrimitiveModel, feature: &str, dt: f64, isa: Isa) -> Result<Self, Error> {
        let Some(primitives) = model.find(feature) else {
            let known = model.primitives.iter().map(|primitives| primitives.feature.name.clone()).collect();
            return Err(Error::Unknown { name: feature.into(), known });
        };
        check_rate(model, dt)?;
        let covered = sinew_core::part::Part::new(primitives.feature.coordinates.clone(), model.dim)?;
        let sd = model.noise_sd.clone();
        if sd.len() != model.dim {
            return Err(Error::Shape { name: "noise", found: sd.len(), expected: model.dim });
        }
        let covered_sd: Vec<f64> = primitives.feature.coordinates.iter().map(|&j| sd[j]).collect();
        let switching = Switching::new(primitives, &covered_sd, isa)?;
        if switching.matcher().older_len() + covered_sd.len() != model.length * covered_sd.len() {
            let (found, expected) = (switching.matcher().older_len(), (model.length - 1) * covered_sd.len());
            return Err(Error::Shape { name: "older feature vectors", found, expected });
        }
        let places = Places {
            rest: (0..model.dim).filter(|j| !covered.indices().contains(j)).collect(),
            covered: primitives.feature.coordinates.clone(),
            inverse_sd: sd.iter().map(|sd| 1.0 / sd).collect(),
            sd: sd.clone(),
        };
        let past = vec![0.0; model.length * places.covered.len()];
        let (switching, places) = (Arc::new(switching), Arc::new(places));
        let between = Between::Mixture;
        Ok(Self { switching, places, initial_sd: sd, past, seen: 0, length: model.length, between, isa })
    }

    /// The same motion with another form of its prior between frames; that of [`PrimitiveMotion::new`] is the mixture.
    #[must_use]
    pub fn with_between(self, between: Between) -> Self {
        Self { between, ..self }
    }

    /// The same motion with another spread of the first frame about its centre.
    ///
    /// # Errors
    /// [`Error::Shape`] or [`Error::OutOfRange`].
    pub fn with_initial_sd(self, initial_sd: Vec<f64>) -> Result<Self, Error> {
        if initial_sd.len() != self.dim() {
            return Err(Error::Shape { name: "initial sd", found: initial_sd.len(), expected: self.dim() });
        }
        if let Some(index) = initial_sd.iter().position(|sd| !(*sd > 0.0 && sd.is_finite())) {
            let expected = "must be positive and finite";
            return Err(Error::OutOfRange { name: "initial sd", index, value: initial_sd[index], expected });
        }
        Ok(Self { initial_sd, ..self })
    }

    /// Standard deviations B of a step of the random walk.
    #[must_use]
    pub fn sd(&self) -> &[f64] {
        &self.places.sd
    }

    /// Standard deviations of the first frame about its centre.
    #[must_use]
    pub fn initial_sd(&self) -> &[f64] {
        &self.initial_sd
    }

    /// Whether there are enough estimates to match action primitives.
    #[must_use]
    pub fn is_matching(&self) -> bool {
        self.seen == self.length
    }

    /// Draws the next state of each lane, and says by which model; nothing while all coordinates walk at random.
    pub fn sample_with_choices(
        &self,
        previous: &[Block],
        next: &mut [Block],
        rng: &mut BlockRng,
    ) -> Option<[Choice; LANES]> {
        self.walk(previous, &self.places.sd, next, rng);
        if !self.is_matching() {
            return None;
        }
        let own = self.own(previous);
        let mut moved = vec![Block::ZERO; own.len()];
        let choices = self.switching.sample_block(self.older(), &own, &mut moved, rng);
        for (&j, moved) in self.places.covered.iter().zip(moved) {
            next[j] = moved;
        }
        Some(choices)
    }

    /// The density of the frame after some states; at least one. Each is a component of its own.
    fn after(&self, states: &[Block], count: usize) -> Result<Prior, Error> {
        if !self.is_matching() || count == 0 {
            let leaf = Mixture::new((0..count).map(|i| self.state(states, i)).collect(), &self.places.sd)?;
            return Ok(Prior::Mixture(Lanes { leaf, isa: self.isa }));
        }
        let (switching, places) = (self.switching.clone(), self.places.clone());
        let leaf = SwitchingMixture::new(switching, places, self.origins(states, count))?;
        Ok(Prior::Switching(Lanes { leaf, isa: self.isa }))
    }

    /// The Gaussian with the moments of that density.
    fn gaussian(&self, cloud: Cloud<'_>) -> Result<Prior, Error> {
        let leaf = if self.is_matching() && cloud.count > 0 {
            matched::gaussian(&self.switching, &self.places, &self.origins(cloud.last, cloud.count))?
        } else {
            Gaussian::widened(cloud.moments, &self.places.sd)?
        };
        Ok(Prior::Gaussian(Lanes { leaf, isa: self.isa }))
    }

    fn state(&self, states: &[Block], i: usize) -> Vec<f64> {
        states[i / LANES * self.dim()..][..self.dim()].iter().map(|b| b.0[i % LANES]).collect()
    }

    /// Some states with the clusters of their action primitives.
    fn origins(&self, states: &[Block], count: usize) -> Vec<(usize, Vec<f64>)> {
        let mut origins = Vec::with_capacity(count);
        for (block, own) in states.chunks_exact(self.dim()).take(count.div_ceil(LANES)).enumerate() {
            let clusters = self.switching.matcher().nearest_block(self.older(), &self.own(own));
            for (lane, cluster) in clusters.into_iter().enumerate().take(count - block * LANES) {
                origins.push((cluster, self.state(states, block * LANES + lane)));
            }
        }
        origins
    }

    fn walk(&self, previous: &[Block], sd: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        rng.fill_normal(self.isa, next);
        for ((x, p), sd) in next.iter_mut().zip(previous).zip(sd) {
            x.0.iter_mut().zip(p.0).for_each(|(x, p)| *x = p + sd * *x);
        }
    }

    /// The D − 1 estimates before the last.
    fn older(&self) -> &[f64] {
        &self.past[..self.past.len() - self.places.covered.len()]
    }

    fn own(&self, states: &[Block]) -> Vec<Block> {
        self.places.covered.iter().map(|&j| states[j]).collect()
    }

    fn single(&self, previous: &[f64]) -> Option<Prior> {
        let block: Vec<Block> = previous.iter().map(|&x| Block::splat(x)).collect();
        self.after(&block, 1).ok()
    }
}

impl MotionModel for PrimitiveMotion {
    fn dim(&self) -> usize {
        self.places.sd.len()
    }

    fn follow(&mut self, _before: Option<&[f64]>, estimate: &[f64]) {
        let features = self.places.covered.len();
        self.past.rotate_left(features);
        let newest = self.past.len() - features;
        for (x, &j) in self.past[newest..].iter_mut().zip(&self.places.covered) {
            *x = estimate[j];
        }
        self.seen = (self.seen + 1).min(self.length);
    }

    fn memory(&self) -> Vec<f64> {
        [&self.past[..], &[self.seen as f64]].concat()
    }

    fn recall(&mut self, memory: &[f64]) {
        if let Some((&seen, past)) = memory.split_last() {
            self.past.copy_from_slice(past);
            self.seen = (seen as usize).min(self.length);
        }
    }
}

impl Transition for PrimitiveMotion {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        let _ = self.sample_with_choices(previous, next, rng);
    }

    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        let centre: Vec<Block> = centre.iter().map(|&x| Block::splat(x)).collect();
        self.walk(&centre, &self.initial_sd, next, rng);
    }

    /// −∞ where the previous state is no number.
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        self.single(previous).map_or(f64::NEG_INFINITY, |density| density.log_density(next))
    }
}

impl GradTransition for PrimitiveMotion {
    fn log_density_grad(&self, previous: &[f64], next: &[f64], grad: &mut [f64]) -> f64 {
        self.single(previous).map_or(f64::NEG_INFINITY, |density| density.log_density_grad(next, grad))
    }
}

impl Predict for PrimitiveMotion {
    type Prior = Prior;
    type Error = Error;

    fn predict(&self, cloud: Cloud<'_>) -> Result<Prior, Error> {
        match self.between {
            Between::Mixture => self.after(cloud.last, cloud.count),
            Between::Gaussian => self.gaussian(cloud),
        }
    }

    fn wanted_draws(&self) -> usize {
        AVERAGED
    }

    fn initial(&self, centre: &[f64]) -> Result<Prior, Error> {
        let leaf = Mixture::new(vec![centre.to_vec()], &self.initial_sd)?;
        Ok(Prior::Mixture(Lanes { leaf, isa: self.isa }))
    }
}
