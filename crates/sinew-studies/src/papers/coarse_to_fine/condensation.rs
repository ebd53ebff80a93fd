//! CONDENSATION with the motion model of the coarse-to-fine tracker (eq. 2), without its grid.
//!
//! s(t + 1) = s(t) + A (X̂(t) − X̂(t − 1)) + B ω, A = 0.2 I, B = diag(δ), X̂ the weighted means of the last two frames.

use crate::support::outcome::Outcome;
use sinew::core::lanes::Isa;
use sinew::dynamics::first_order::FirstOrder;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::tracking::bootstrap::{Bootstrap, Config};

/// A filter with steps `sd` a frame that starts at a pose; `part` is A.
pub(super) fn condensation(
    particles: usize,
    sd: &[f64],
    part: f64,
    start: &[f64],
    isa: Isa,
) -> Outcome<Bootstrap<FirstOrder<RandomWalk>>> {
    let walk = RandomWalk::new(sd, 1.0, Between::Mixture, isa)?;
    let config = Config { particles, ..Config::default() };
    Ok(Bootstrap::new(config, FirstOrder::new(walk, part)?, start.to_vec())?)
}
