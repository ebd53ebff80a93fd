//! Derivatives of all points by all degrees of freedom, for fitting.

use super::plan::Plan;
use super::positions::Record;
use super::vector::{cross_add, load3, v3};
use sinew_core::lanes::{Block, Isa, LANES, LaneMap, Real, get_lane, map_block, map_one, set_lane};

struct Jacobian<'a>(&'a Plan);

impl LaneMap<1, 2> for Jacobian<'_> {
    #[inline(always)]
    fn run<V: Real>(&self, [q]: [&[V::Mem]; 1], [positions, jacobian]: [&mut [V::Mem]; 2], ws: &mut [V::Mem]) {
        let plan = self.0;
        let mut pass = plan.pass(ws);
        let out = positions.as_chunks_mut::<3>().0;
        plan.forward::<V, true>(q, &mut pass, &mut Record { order: plan.order(), out: &mut *out });
        for entry in &mut *jacobian {
            V::splat(0.0).store(entry);
        }
        for (&k, &link) in plan.order().iter().zip(&plan.link_of) {
            let point = load3::<V>(&out[k]);
            let mut above = Some(link);
            while let Some(b) = above {
                let link = &plan.links[b];
                let origin = load3::<V>(&pass.vectors[link.origin()]);
                let arm = v3!(K => point[K] - origin[K]);
                for j in link.dofs() {
                    let u = load3::<V>(&pass.vectors[plan.joints[j].place]);
                    let turns = j >= link.first + link.translations;
                    let moves = if turns { cross_add(u, arm, [V::splat(0.0); 3]) } else { u };
                    for (axis, x) in moves.into_iter().enumerate() {
                        x.store(&mut jacobian[(3 * k + axis) * plan.dof() + j]);
                    }
                }
                above = link.parent;
            }
        }
    }
}

/// Positions of all points and their derivatives: `jacobian[(3 k + a) · dof + j] = ∂P_k,a / ∂q_j`. For fitting, not for hot loops.
pub fn point_jacobian(plan: &Plan, isa: Isa, q: &[f64], positions: &mut [f64], jacobian: &mut [f64]) {
    map_one(isa, &Jacobian(plan), [q], [positions, jacobian], plan.workspace());
}

/// [`point_jacobian`] of states that stand one after the other, eight at a time; so do their positions (metres) and derivatives.
pub fn point_jacobian_each(plan: &Plan, isa: Isa, states: &[f64], positions: &mut [f64], jacobians: &mut [f64]) {
    let (d, width) = (plan.dof(), 3 * plan.points());
    let (mut block, mut at) = (vec![Block::ZERO; d], vec![Block::ZERO; width]);
    let (mut by_state, mut ws) = (vec![Block::ZERO; width * d], vec![Block::ZERO; plan.workspace()]);
    let results = positions.chunks_mut(LANES * width).zip(jacobians.chunks_mut(LANES * width * d));
    for (states, (positions, jacobians)) in states.chunks(LANES * d).zip(results) {
        states.chunks_exact(d).enumerate().for_each(|(lane, state)| set_lane(&mut block, lane, state));
        map_block(isa, &Jacobian(plan), [&block], [&mut at, &mut by_state], &mut ws);
        positions.chunks_exact_mut(width).enumerate().for_each(|(lane, out)| get_lane(&at, lane, out));
        jacobians.chunks_exact_mut(width * d).enumerate().for_each(|(lane, out)| get_lane(&by_state, lane, out));
    }
}
