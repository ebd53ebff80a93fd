//! The model of the filter's times: one dimension, Gaussian steps and errors.

use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch};
use sinew_tracking::BlockRng;
use sinew_tracking::state_space::StateSpace;

/// x_t = x_{t−1} + N(0, 1), y_t = x_t + N(0, 1); by blocks of eight states or one state after the other.
pub struct Walk<const BLOCKS: bool>(pub Isa);

/// y = a + y, and −½ (y − a)² less its constant.
struct Add<'a>(&'a Block, &'a mut Block);
struct Gaussian<'a>(f64, &'a Block, &'a mut Block);

impl Kernel<Block> for Add<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        (V::load(self.0) + V::load(self.1)).store(self.1);
    }
}

impl Kernel<Block> for Gaussian<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let e = V::load(self.1) - V::splat(self.0);
        (e * e).fma(V::splat(-0.5), V::splat(-0.5 * std::f64::consts::TAU.ln())).store(self.2);
    }
}

impl<const BLOCKS: bool> StateSpace for Walk<BLOCKS> {
    type Observation = f64;
    fn dim(&self) -> usize {
        1
    }
    fn draw_first(&self, x: &mut [f64], rng: &mut BlockRng) {
        x[0] = rng.normal();
    }
    fn draw_next(&self, _frame: usize, before: &[f64], x: &mut [f64], rng: &mut BlockRng) {
        x[0] = before[0] + rng.normal();
    }
    fn log_density(&self, _frame: usize, y: &f64, x: &[f64]) -> f64 {
        -0.5 * (y - x[0]).powi(2) - 0.5 * std::f64::consts::TAU.ln()
    }
    fn draw_next_block(&self, frame: usize, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        if BLOCKS {
            rng.fill_normal(self.0, next);
            dispatch(self.0, Add(&previous[0], &mut next[0]));
        } else {
            let each = |before: &[f64], x: &mut [f64]| self.draw_next(frame, before, x, rng);
            sinew_core::transition::lane_by_lane(previous, next, each);
        }
    }
    fn log_density_block(&self, frame: usize, y: &f64, states: &[Block]) -> Block {
        let mut values = [Block::ZERO];
        if BLOCKS {
            dispatch(self.0, Gaussian(*y, &states[0], &mut values[0]));
        } else {
            let each = |x: &[f64], value: &mut [f64]| value[0] = self.log_density(frame, y, x);
            sinew_core::transition::lane_by_lane(states, &mut values, each);
        }
        values[0]
    }
}
