//! First-order motion: another motion model from where a part of the estimate's last change leads.
//!
//! s(t + 1) = s(t) + a (X̂(t) − X̂(t − 1)) + noise, X̂ the estimates of the tracker that is served; before there are two of them, the difference is 0. The noise, the first frame and how a cloud becomes a prior are the other model's.
//! Coordinates are not wrapped.

use crate::Error;
use sinew_core::lanes::Block;
use sinew_core::part::Part;
use sinew_core::random::BlockRng;
use sinew_core::transition::{Cloud, GradTransition, Moments, MotionModel, PartTransition, Predict, Transition};

/// The motion model.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstOrder<T> {
    model: T,
    part: f64,
    drift: Vec<f64>,
}

impl<T: MotionModel> FirstOrder<T> {
    /// The motion of `model`, moved on by the part a of the last change.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless `part` is finite.
    pub fn new(model: T, part: f64) -> Result<Self, Error> {
        if !part.is_finite() {
            return Err(Error::OutOfRange { name: "drift", index: 0, value: part, expected: "must be finite" });
        }
        let drift = vec![0.0; model.dim()];
        Ok(Self { model, part, drift })
    }

    /// What is added to each state before the noise.
    #[must_use]
    pub fn drift(&self) -> &[f64] {
        &self.drift
    }

    fn moved(&self, state: &[f64]) -> Vec<f64> {
        state.iter().zip(&self.drift).map(|(x, drift)| x + drift).collect()
    }
}

fn shift(states: &mut [Block], drift: &[f64]) {
    for (x, drift) in states.iter_mut().zip(drift) {
        x.0.iter_mut().for_each(|x| *x += drift);
    }
}

impl<T: MotionModel> MotionModel for FirstOrder<T> {
    fn dim(&self) -> usize {
        self.model.dim()
    }

    fn follow(&mut self, before: Option<&[f64]>, estimate: &[f64]) {
        if let Some(before) = before {
            for ((drift, from), to) in self.drift.iter_mut().zip(before).zip(estimate) {
                *drift = self.part * (to - from);
            }
        }
        self.model.follow(before, estimate);
    }

    fn memory(&self) -> Vec<f64> {
        [&self.drift[..], &self.model.memory()].concat()
    }

    fn recall(&mut self, memory: &[f64]) {
        let (drift, rest) = memory.split_at(self.drift.len());
        self.drift.copy_from_slice(drift);
        self.model.recall(rest);
    }
}

impl<T: Transition> Transition for FirstOrder<T> {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        self.model.sample_block(previous, next, rng);
        shift(next, &self.drift);
    }

    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        self.model.sample_initial_block(centre, next, rng);
    }

    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        self.model.log_density(&self.moved(previous), next)
    }
}

impl<T: GradTransition> GradTransition for FirstOrder<T> {
    fn log_density_grad(&self, previous: &[f64], next: &[f64], grad: &mut [f64]) -> f64 {
        self.model.log_density_grad(&self.moved(previous), next, grad)
    }
}

impl<T: PartTransition> PartTransition for FirstOrder<T> {
    fn sample_part_block(&self, part: &Part, next: &mut [Block], rng: &mut BlockRng) {
        self.model.sample_part_block(part, next, rng);
        for &j in part.indices() {
            shift(&mut next[j..=j], &self.drift[j..=j]);
        }
    }

    fn sample_initial_part_block(&self, part: &Part, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        self.model.sample_initial_part_block(part, centre, next, rng);
    }
}

/// The cloud moves on as a whole, before the other model makes a prior of it.
impl<T: Predict> Predict for FirstOrder<T> {
    type Prior = T::Prior;
    type Error = T::Error;

    fn predict(&self, cloud: Cloud<'_>) -> Result<T::Prior, T::Error> {
        let mut last = cloud.last.to_vec();
        last.chunks_exact_mut(self.drift.len()).for_each(|states| shift(states, &self.drift));
        let Moments { mean, covariance } = cloud.moments;
        let moments = Moments { mean: self.moved(mean), covariance: covariance.clone() };
        self.model.predict(Cloud { last: &last, moments: &moments, ..cloud })
    }

    fn wanted_draws(&self) -> usize {
        self.model.wanted_draws()
    }

    fn initial(&self, centre: &[f64]) -> Result<T::Prior, T::Error> {
        self.model.initial(centre)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random_walk::{Between, RandomWalk};
    use sinew_core::density::LogDensity;
    use sinew_core::lanes::Isa;
    use sinew_core::random::Stage;

    fn walk(between: Between) -> RandomWalk {
        let walk = RandomWalk::new(&[0.5, 1.0, 2.0], 0.25, between, Isa::best()).expect("valid");
        walk.with_initial_sd(vec![3.0; 3]).expect("valid")
    }

    fn drifting(between: Between) -> FirstOrder<RandomWalk> {
        let mut model = FirstOrder::new(walk(between), 0.5).expect("finite");
        model.follow(None, &[9.0; 3]);
        assert_eq!(model.drift(), [0.0; 3]);
        model.follow(Some(&[1.0, 2.0, 3.0]), &[3.0, 1.0, 3.0]);
        assert_eq!(model.drift(), [1.0, -0.5, 0.0]);
        model
    }

    fn sampled(fill: impl Fn(&mut [Block], &mut BlockRng)) -> [Block; 3] {
        let mut next = [Block::splat(7.0); 3];
        fill(&mut next, &mut Stage::new(1, "first order").whole());
        next
    }

    #[test]
    fn states_move_on_by_the_drift_and_the_first_frame_does_not() {
        let (model, plain) = (drifting(Between::Mixture), walk(Between::Mixture));
        let moved = |mut states: [Block; 3], coordinates: &[usize]| {
            coordinates.iter().for_each(|&j| shift(&mut states[j..=j], &[[1.0, -0.5, 0.0][j]]));
            states
        };
        let from = [1.0, 2.0, 3.0].map(Block::splat);
        let expected = moved(sampled(|next, rng| plain.sample_block(&from, next, rng)), &[0, 1, 2]);
        assert_eq!(sampled(|next, rng| model.sample_block(&from, next, rng)), expected);
        let part = Part::new(vec![1, 2], 3).expect("valid");
        let expected = moved(sampled(|next, rng| plain.sample_part_block(&part, next, rng)), &[1]);
        assert_eq!(sampled(|next, rng| model.sample_part_block(&part, next, rng)), expected);
        for centre in [[0.0; 3], [1.0, 2.0, 3.0]] {
            assert_eq!(
                sampled(|next, rng| model.sample_initial_block(&centre, next, rng)),
                sampled(|next, rng| plain.sample_initial_block(&centre, next, rng))
            );
            assert_eq!(
                sampled(|next, rng| model.sample_initial_part_block(&part, &centre, next, rng)),
                sampled(|next, rng| plain.sample_initial_part_block(&part, &centre, next, rng))
            );
        }
    }

    #[test]
    fn densities_and_priors_are_about_the_place_moved_to() {
        let (from, to, next) = ([1.0, 2.0, 3.0], [2.0, 1.5, 3.0], [2.2, 1.0, 2.5]);
        for between in [Between::Mixture, Between::Gaussian] {
            let (model, plain) = (drifting(between), walk(between));
            assert_eq!(Transition::log_density(&model, &from, &next), Transition::log_density(&plain, &to, &next));
            let (mut grad, mut expected) = ([0.0; 3], [0.0; 3]);
            GradTransition::log_density_grad(&model, &from, &next, &mut grad);
            GradTransition::log_density_grad(&plain, &to, &next, &mut expected);
            assert_eq!(grad, expected);
            for (j, grad) in grad.into_iter().enumerate() {
                let at = |h: f64| {
                    let mut next = next;
                    next[j] += h;
                    Transition::log_density(&model, &from, &next)
                };
                assert!(((at(1e-5) - at(-1e-5)) / 2e-5 - grad).abs() < 1e-8);
            }
            let prior = |at: [f64; 3], model: &dyn Fn(Cloud<'_>) -> Result<crate::prior::Prior, Error>| {
                let last: Vec<Block> = (0..6).map(|k| Block::splat(at[k % 3])).collect();
                let moments = Moments { mean: at.to_vec(), covariance: vec![0.0; 9] };
                model(Cloud { last: &last, count: 11, moments: &moments }).expect("valid").log_density(&next)
            };
            assert_eq!(prior(from, &|cloud| model.predict(cloud)), prior(to, &|cloud| plain.predict(cloud)));
            let initial = |model: &dyn Predict<Prior = crate::prior::Prior, Error = Error>| {
                model.initial(&from).expect("valid").log_density(&next)
            };
            assert_eq!(initial(&model), initial(&plain));
        }
    }

    #[test]
    fn memory_resumes() {
        let mut outer = FirstOrder::new(drifting(Between::Mixture), 2.0).expect("finite");
        outer.follow(Some(&[0.0; 3]), &[1.0, 2.0, 4.0]);
        let memory = outer.memory();
        assert_eq!(memory, [2.0, 4.0, 8.0, 0.5, 1.0, 2.0]);
        let fresh = || FirstOrder::new(FirstOrder::new(walk(Between::Mixture), 0.5).expect("finite"), 2.0);
        let mut other = fresh().expect("finite");
        assert_ne!(other, outer);
        other.recall(&memory);
        assert_eq!(other, outer);
        assert!(FirstOrder::new(walk(Between::Mixture), f64::NAN).is_err());
    }
}
