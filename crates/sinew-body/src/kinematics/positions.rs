//! World positions of the points of a body.

use super::plan::Plan;
use super::vector::{V3, store3};
use super::visit::Visit;
use sinew_core::lanes::{Block, Isa, LANES, LaneMap, Real, get_lane, map_block, map_one, set_lane};

/// Writes positions in the caller's order.
pub(super) struct Record<'a, M> {
    pub order: &'a [usize],
    pub out: &'a mut [[M; 3]],
}

impl<V: Real> Visit<V> for Record<'_, V::Mem> {
    #[inline(always)]
    fn point(&mut self, k: usize, p: V3<V>) -> V3<V> {
        store3(p, &mut self.out[self.order[k]]);
        [V::splat(0.0); 3]
    }
}

struct Positions<'a>(&'a Plan);

impl LaneMap<1, 1> for Positions<'_> {
    #[inline(always)]
    fn run<V: Real>(&self, [q]: [&[V::Mem]; 1], [out]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        let mut record = Record { order: self.0.order(), out: out.as_chunks_mut::<3>().0 };
        self.0.sweep::<V, false>(q, &mut [], ws, &mut record);
    }
}

/// World positions of all points of the plan for one state: `out[3 k..3 k + 3]` is point k, metres.
pub fn point_positions(plan: &Plan, isa: Isa, q: &[f64], out: &mut [f64]) {
    map_one(isa, &Positions(plan), [q], [out], plan.workspace());
}

/// World positions of all points of the plan for a block of states, with the caller's workspace of [`Plan::workspace`] blocks.
pub fn point_positions_block(plan: &Plan, isa: Isa, q: &[Block], out: &mut [Block], ws: &mut [Block]) {
    map_block(isa, &Positions(plan), [q], [out], ws);
}

/// Positions of all points in some states that stand one after the other, eight at a time.
#[must_use]
pub fn point_positions_each(plan: &Plan, isa: Isa, states: &[f64]) -> Vec<f64> {
    let mut points = vec![0.0; states.len() / plan.dof() * 3 * plan.points()];
    point_positions_into(plan, isa, states, &mut points);
    points
}

/// [`point_positions_each`] into the caller's memory, `3 · points` numbers a state.
pub fn point_positions_into(plan: &Plan, isa: Isa, states: &[f64], out: &mut [f64]) {
    let (d, width) = (plan.dof(), 3 * plan.points());
    let (mut block, mut at) = (vec![Block::ZERO; d], vec![Block::ZERO; width]);
    let mut ws = vec![Block::ZERO; plan.workspace()];
    for (states, out) in states.chunks(LANES * d).zip(out.chunks_mut(LANES * width)) {
        states.chunks_exact(d).enumerate().for_each(|(lane, state)| set_lane(&mut block, lane, state));
        point_positions_block(plan, isa, &block, &mut at, &mut ws);
        out.chunks_exact_mut(width).enumerate().for_each(|(lane, out)| get_lane(&at, lane, out));
    }
}
