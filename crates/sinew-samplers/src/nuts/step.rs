//! One leapfrog step of eight trees.

use super::transition::{Nuts, TreeTransition};
use super::trees::{End, States, Trees, coin};
use crate::integrator::Moving;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::BlockRng;

/// One leapfrog step of every lane in `active`, and what transitions it completes. The others stand still, but not before their tree is complete.
pub fn step<T: GradLogDensity + ?Sized>(
    target: &T,
    nuts: &Nuts,
    trees: &mut Trees,
    active: &[bool; LANES],
    rng: &mut BlockRng,
) -> [Option<TreeTransition>; LANES] {
    let mut uniforms = [Block::ZERO; 2];
    rng.fill_uniform(&mut uniforms);
    let [choice, whole] = uniforms;
    for (lane, &is_active) in active.iter().enumerate() {
        if is_active && !trees.lanes[lane].growing {
            trees.begin(nuts, lane, coin(choice.0[lane]), rng);
        }
    }
    let Trees { moving, half_sum, gradient, workspace, factor, .. } = trees;
    let End { at: States { position, force }, momentum } = moving;
    let moving = Moving { position, momentum, force, sum: half_sum, gradient, workspace };
    let (log_density, kinetic) = nuts.leapfrog.step(target, factor, moving);
    let mut complete = [None; LANES];
    for (lane, complete) in complete.iter_mut().enumerate() {
        if trees.lanes[lane].growing {
            let arrived = (log_density.0[lane], kinetic.0[lane] - log_density.0[lane]);
            *complete = trees.grow(nuts, lane, arrived, choice.0[lane], whole.0[lane]);
        }
    }
    complete
}
