//! Straight-line kinematics of the built-in bodies, written by the build script.
//!
//! What [`Plan::forward`](super::Plan::forward) and [`Plan::pullback`](super::Plan::pullback) do with loops over any tree is spelled out for each of these, link by link: frames stay in registers, products with zeros and ones
//! vanish, and what nobody uses (a column of the last link of a limb) is not computed. Bodies differ in their sizes only, which are data.

use super::visit::Visit;
use sinew_core::elementary::sin_cos;
use sinew_core::lanes::Real;

include!(concat!(env!("OUT_DIR"), "/straight_line.rs"));

impl Body {
    /// The body of that [structure](super::structure::structure).
    pub(super) fn of(structure: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known)| *known == structure).map(|(body, _)| *body)
    }
}

/// The first `N`, for code without checks of bounds.
#[inline(always)]
fn whole<T, const N: usize>(x: &[T]) -> &[T; N] {
    &x[..N].as_chunks().0[0]
}

#[inline(always)]
fn whole_mut<T, const N: usize>(x: &mut [T]) -> &mut [T; N] {
    &mut x[..N].as_chunks_mut().0[0]
}
