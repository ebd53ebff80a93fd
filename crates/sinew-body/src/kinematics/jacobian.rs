//! Derivatives of all points by all degrees of freedom, for fitting.

use super::plan::Plan;
use super::positions::Record;
use super::vector::{cross_add, load3, v3};

use sinew_core::lanes::{Isa, Kernel, Real, dispatch_one};

struct Jacobian<'a> {
    plan: &'a Plan,
    q: &'a [f64],
    positions: &'a mut [f64],
    jacobian: &'a mut [f64],
}

impl Kernel<f64> for Jacobian<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        let plan = self.plan;
        let mut ws = vec![0.0; plan.workspace()];
        let mut pass = plan.pass(&mut ws);
        let (out, _) = self.positions.as_chunks_mut::<3>();
        plan.forward::<V, true>(self.q, &mut pass, &mut Record { order: plan.order(), out: &mut *out });
        self.jacobian.fill(0.0);
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
                        x.store(&mut self.jacobian[(3 * k + axis) * plan.dof() + j]);
                    }
                }
                above = link.parent;
            }
        }
    }
}

/// Positions of all points and their derivatives: `jacobian[(3 k + a) · dof + j] = ∂P_k,a / ∂q_j`. For fitting, not for hot loops.
pub fn point_jacobian(plan: &Plan, isa: Isa, q: &[f64], positions: &mut [f64], jacobian: &mut [f64]) {
    dispatch_one(isa, Jacobian { plan, q, positions, jacobian });
}
