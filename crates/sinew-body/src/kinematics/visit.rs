//! What a walk over a body shows its points to, and where it keeps frames and forces.

use super::vector::V3;

/// Force and moment.
pub(super) const WRENCH: usize = 6;

/// What the forward pass of [`Plan`](super::Plan) shows its points to. A trait and no closure: closures cannot be `#[inline(always)]`, and a long one stays outside the entry point of its instruction set.
pub trait Visit<V> {
    /// Point k in the plan's order at the world position `p`, metres. Answers with the force `∂E/∂P` on it. Must be `#[inline(always)]`.
    fn point(&mut self, k: usize, p: V3<V>) -> V3<V>;
}

/// What one evaluation keeps, in a caller's workspace.
#[derive(Debug)]
pub struct Pass<'a, M> {
    /// Frames and axes, where the plan places them.
    pub(super) vectors: &'a mut [[M; 3]],
    /// Force and moment about the world origin, of each link's points, in the backward sweep also of what was gathered from below.
    pub(super) wrenches: &'a mut [[M; WRENCH]],
}

/// Takes `count` groups of `N` from the front of a workspace.
pub(super) fn take<'a, M, const N: usize>(ws: &mut &'a mut [M], count: usize) -> &'a mut [[M; N]] {
    let (taken, rest) = std::mem::take(ws).split_at_mut(count * N);
    *ws = rest;
    taken.as_chunks_mut().0
}
