//! World positions of the points of a body.

use super::plan::Plan;
use super::vector::{V3, store3};
use super::visit::Visit;
use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch, dispatch_one};

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

struct Positions<'a, M> {
    plan: &'a Plan,
    q: &'a [M],
    out: &'a mut [M],
    ws: &'a mut [M],
}

impl<M: Copy> Kernel<M> for Positions<'_, M> {
    #[inline(always)]
    fn run<V: Real<Mem = M>>(&mut self) {
        let (out, _) = self.out.as_chunks_mut::<3>();
        let mut record = Record { order: self.plan.order(), out };
        self.plan.sweep::<V, false>(self.q, &mut [], self.ws, &mut record);
    }
}

/// World positions of all points of the plan for one state: `out[3 k..3 k + 3]` is point k, metres.
pub fn point_positions(plan: &Plan, isa: Isa, q: &[f64], out: &mut [f64]) {
    dispatch_one(isa, Positions { plan, q, out, ws: &mut vec![0.0; plan.workspace()] });
}

/// World positions of all points of the plan for a block of states, with the caller's workspace of [`Plan::workspace`] blocks.
pub fn point_positions_block(plan: &Plan, isa: Isa, q: &[Block], out: &mut [Block], ws: &mut [Block]) {
    dispatch(isa, Positions { plan, q, out, ws });
}
