//! Two transitions side by side: of the place of a body and of its latent pose.

use crate::lanes::Block;
use crate::random::BlockRng;
use crate::transition::{GradTransition, MotionModel, Transition};

/// The first coordinates move by one model, those after them by another; a part that is `None` has no coordinates.
///
/// Law `densities_multiply`: the parts are independent given the state before, so that the log density is the sum of both, and its gradient is put together.
#[derive(Clone, Debug, PartialEq)]
pub struct SideBySide<A, B>(pub A, pub B);

/// None has no coordinates.
impl<T: MotionModel> MotionModel for Option<T> {
    fn dim(&self) -> usize {
        self.as_ref().map_or(0, MotionModel::dim)
    }
    fn follow(&mut self, before: Option<&[f64]>, estimate: &[f64]) {
        if let Some(motion) = self {
            motion.follow(before, estimate);
        }
    }
    fn memory(&self) -> Vec<f64> {
        self.as_ref().map_or(vec![], MotionModel::memory)
    }
    fn recall(&mut self, memory: &[f64]) {
        if let Some(motion) = self {
            motion.recall(memory);
        }
    }
}

impl<T: Transition> Transition for Option<T> {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        if let Some(motion) = self {
            motion.sample_block(previous, next, rng);
        }
    }
    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        if let Some(motion) = self {
            motion.sample_initial_block(centre, next, rng);
        }
    }
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        self.as_ref().map_or(0.0, |motion| motion.log_density(previous, next))
    }
}

impl<A: MotionModel, B: MotionModel> MotionModel for SideBySide<A, B> {
    fn dim(&self) -> usize {
        self.0.dim() + self.1.dim()
    }
    fn follow(&mut self, before: Option<&[f64]>, estimate: &[f64]) {
        let first = self.0.dim();
        self.0.follow(before.map(|before| &before[..first]), &estimate[..first]);
        self.1.follow(before.map(|before| &before[first..]), &estimate[first..]);
    }
    fn memory(&self) -> Vec<f64> {
        [self.0.memory(), self.1.memory()].concat()
    }
    fn recall(&mut self, memory: &[f64]) {
        let (first, second) = memory.split_at(self.0.memory().len());
        self.0.recall(first);
        self.1.recall(second);
    }
}

impl<A: Transition, B: Transition> Transition for SideBySide<A, B> {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        let ((first, second), (to_first, to_second)) =
            (previous.split_at(self.0.dim()), next.split_at_mut(self.0.dim()));
        self.0.sample_block(first, to_first, rng);
        self.1.sample_block(second, to_second, rng);
    }
    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        let ((first, second), (to_first, to_second)) = (centre.split_at(self.0.dim()), next.split_at_mut(self.0.dim()));
        self.0.sample_initial_block(first, to_first, rng);
        self.1.sample_initial_block(second, to_second, rng);
    }
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        let first = self.0.dim();
        self.0.log_density(&previous[..first], &next[..first]) + self.1.log_density(&previous[first..], &next[first..])
    }
}

impl<A: GradTransition, B: GradTransition> GradTransition for SideBySide<A, B> {
    fn log_density_grad(&self, previous: &[f64], next: &[f64], grad: &mut [f64]) -> f64 {
        let (first, (to_first, to_second)) = (self.0.dim(), grad.split_at_mut(self.0.dim()));
        self.0.log_density_grad(&previous[..first], &next[..first], to_first)
            + self.1.log_density_grad(&previous[first..], &next[first..], to_second)
    }
}
