//! Hamiltonian trajectories with jumps.
//!
//! Each update of a chain is one trajectory followed by some independence proposals (Tierney 1994) from a mixture fitted to warm-up draws.
//!
//! A jump proposes y ~ q, whatever the state x is, and accepts it with probability min(1, p(y) q(x) / (p(x) q(y))). It leaves p unchanged for any fixed q. Where q resembles p, one jump in a few is an independent draw
//! and chains go from mode to mode at once; where q is far too thin, a chain would wait for ever, and there the trajectories carry it on (Gabrié, Rotskoff & Vanden-Eijnden 2022 do so with
//! a flow). q must be fixed before the kept draws are made, and comes from draws that are thrown away.
//!
//! A proposal costs a gradient, which the next trajectory starts from. It does not depend on the state, so that where fewer than eight chains run, the idle lanes make proposals for them
//! too, one after the other (Jacob, Robert & Smith 2011): one chain alone gets eight jumps at the cost of one.

pub(crate) mod kernel;
mod sample;

pub use kernel::{JumpRun, JumpWorkspace, Jumps, draw_with_jumps, jump};
pub use sample::{Settings, sample};
