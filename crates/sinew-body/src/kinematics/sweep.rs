//! The walk outwards with its forces back: frames, points and gradients.

use super::gauss_newton::INERTIA;
use super::plan::{ORIGIN, Plan};
use super::vector::{V3, along, cross_add, cross_sub, dot, load3, moved, store3, turned, turned_about, v3};
use super::visit::{Pass, Visit, WRENCH, take};
use crate::tree::Axis;
use sinew_core::elementary::sin_cos;
use sinew_core::lanes::Real;

impl Plan {
    /// Numbers (or blocks) of scratch that the methods need.
    #[must_use]
    pub const fn workspace(&self) -> usize {
        3 * self.vectors + (WRENCH + INERTIA) * self.links.len()
    }

    /// Divides a workspace.
    ///
    /// # Panics
    /// If it is shorter than [`Plan::workspace`].
    #[inline(always)]
    pub fn pass<'a, M>(&self, mut ws: &'a mut [M]) -> Pass<'a, M> {
        Pass { vectors: take(&mut ws, self.vectors), wrenches: take(&mut ws, self.links.len()) }
    }

    /// Walks to all points at `q`, shows them to the visitor and, with `BACK`, turns its forces into `∂E/∂q`; `ws` as [`Plan::workspace`] says.
    ///
    /// Does what [`Plan::forward`] and [`Plan::pullback`] do. The built-in bodies have straight-line code for it, in which the visitor is written out once for each point: for short visitors only.
    #[inline(always)]
    pub fn sweep<V: Real, const BACK: bool>(
        &self,
        q: &[V::Mem],
        grad: &mut [V::Mem],
        ws: &mut [V::Mem],
        visitor: &mut impl Visit<V>,
    ) {
        match &self.straight_line {
            Some((body, links)) if BACK => body.sweep::<V, _>(q, links, &self.offsets, ws, grad, visitor),
            Some((body, links)) => body.positions::<V, _>(q, links, &self.offsets, ws, visitor),
            None => self.walk::<V, BACK>(q, grad, ws, visitor),
        }
    }

    /// [`Plan::sweep`] by loops for every body, with one copy of the visitor: for long ones.
    #[inline(always)]
    pub fn walk<V: Real, const BACK: bool>(
        &self,
        q: &[V::Mem],
        grad: &mut [V::Mem],
        ws: &mut [V::Mem],
        visitor: &mut impl Visit<V>,
    ) {
        let mut pass = self.pass(ws);
        self.forward::<V, BACK>(q, &mut pass, visitor);
        if BACK {
            self.pullback::<V>(&mut pass, grad);
        }
    }

    /// Walks to all points at `q` and shows them to the visitor. With `BACK` it keeps what [`Plan::pullback`] needs; else the answers are not used.
    #[inline(always)]
    pub fn forward<V: Real, const BACK: bool>(
        &self,
        q: &[V::Mem],
        pass: &mut Pass<'_, V::Mem>,
        visitor: &mut impl Visit<V>,
    ) {
        let mut joints = self.joints.iter().zip(q);
        let mut points = self.offsets.iter().enumerate();
        let zero = V::splat(0.0);
        let vectors = &mut *pass.vectors;
        store_world::<V>(vectors);
        for (link, wrench) in self.links.iter().zip(pass.wrenches.iter_mut()) {
            let from = &vectors[link.from..=link.from + ORIGIN];
            let [mut cx, mut cy, mut cz] = [load3::<V>(&from[0]), load3::<V>(&from[1]), load3::<V>(&from[2])];
            let mut p = moved(load3::<V>(&from[ORIGIN]), [cx, cy, cz], &link.offset);
            for (joint, q) in joints.by_ref().take(link.translations) {
                let u = column(joint.axis, [cx, cy, cz]);
                if BACK && let Axis::Free(_) = joint.axis {
                    store3(u, &mut vectors[joint.place]);
                }
                let x = V::load(q);
                p = v3!(K => x.fma(u[K], p[K]));
            }
            for (joint, q) in joints.by_ref().take(link.rotations) {
                let (sin, cos) = sin_cos(V::load(q));
                let u = column(joint.axis, [cx, cy, cz]);
                match joint.axis {
                    Axis::X => (cy, cz) = turned(cy, cz, sin, cos),
                    Axis::Y => (cz, cx) = turned(cz, cx, sin, cos),
                    Axis::Z => (cx, cy) = turned(cx, cy, sin, cos),
                    Axis::Free(axis) => [cx, cy, cz] = turned_about(axis, u, [cx, cy, cz], sin, cos),
                }
                if BACK && joint.stored {
                    store3(u, &mut vectors[joint.place]);
                }
            }
            if link.has_children {
                let frame = &mut vectors[link.frame..=link.frame + ORIGIN];
                for (vector, place) in [cx, cy, cz, p].into_iter().zip(frame) {
                    store3(vector, place);
                }
            } else if BACK {
                store3(p, &mut vectors[link.frame]);
            }
            let (mut f, mut n) = ([zero; 3], [zero; 3]);
            for (k, offset) in points.by_ref().take(link.points) {
                let position = moved(p, [cx, cy, cz], offset);
                let g = visitor.point(k, position);
                if BACK {
                    f = v3!(K => f[K] + g[K]);
                    n = cross_add(position, g, n);
                }
            }
            if BACK && link.gathers {
                for k in 0..3 {
                    f[k].store(&mut wrench[k]);
                    n[k].store(&mut wrench[3 + k]);
                }
            }
        }
    }

    /// Puts one more force on point k in the plan's order, at the world position `p`, between [`Plan::forward`] with `BACK` and [`Plan::pullback`].
    #[inline(always)]
    pub fn push<V: Real>(&self, pass: &mut Pass<'_, V::Mem>, k: usize, p: V3<V>, force: V3<V>) {
        let moment = cross_add(p, force, [V::splat(0.0); 3]);
        let wrench = &mut pass.wrenches[self.link_of[k]];
        for (total, more) in wrench.iter_mut().zip(force.into_iter().chain(moment)) {
            (V::load(total) + more).store(total);
        }
    }

    /// Turns the forces on all points into `∂E/∂q`, after [`Plan::forward`] with `BACK`.
    #[inline(always)]
    pub fn pullback<V: Real>(&self, pass: &mut Pass<'_, V::Mem>, grad: &mut [V::Mem]) {
        let mut joints = self.joints.iter().zip(grad.iter_mut()).rev();
        let none = [V::splat(0.0); 3];
        let (mut f, mut n) = (none, none);
        for (index, link) in self.links.iter().enumerate().rev() {
            if link.gathers {
                let wrench = &pass.wrenches[index];
                f = v3!(K => f[K] + V::load(&wrench[K]));
                n = v3!(K => n[K] + V::load(&wrench[3 + K]));
            }
            if link.rotations > 0 {
                let m = cross_sub(load3::<V>(&pass.vectors[link.origin()]), f, n);
                for (joint, out) in joints.by_ref().take(link.rotations) {
                    dot(load3::<V>(&pass.vectors[joint.place]), m).store(out);
                }
            }
            for (joint, out) in joints.by_ref().take(link.translations) {
                dot(load3::<V>(&pass.vectors[joint.place]), f).store(out);
            }
            if link.follows {
                continue;
            }
            if let Some(parent) = link.parent {
                let total = &mut pass.wrenches[parent];
                for k in 0..3 {
                    (V::load(&total[k]) + f[k]).store(&mut total[k]);
                    (V::load(&total[3 + k]) + n[k]).store(&mut total[3 + k]);
                }
            }
            (f, n) = (none, none);
        }
    }
}

/// Puts the frame of the world first.
#[inline(always)]
fn store_world<V: Real>(vectors: &mut [[V::Mem; 3]]) {
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    for (column, unit) in [[one, zero, zero], [zero, one, zero], [zero, zero, one], [zero; 3]].into_iter().enumerate() {
        store3(unit, &mut vectors[column]);
    }
}

/// An axis of a frame in the world.
#[inline(always)]
fn column<V: Real>(axis: Axis, [cx, cy, cz]: [V3<V>; 3]) -> V3<V> {
    match axis {
        Axis::X => cx,
        Axis::Y => cy,
        Axis::Z => cz,
        Axis::Free(axis) => along(axis, [cx, cy, cz]),
    }
}
