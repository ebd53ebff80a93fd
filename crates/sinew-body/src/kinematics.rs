//! Forward kinematics and the backward sweep over lanes.
//!
//! A [`Plan`] is a [`KinematicTree`](crate::KinematicTree) flattened for evaluation. It works in a caller's workspace ([`Plan::pass`]), on one state or on a block of eight:
//!
//! 1. [`Plan::forward`] walks from the root outwards, computes the frame of each link (columns of `R`, origin `p`) and the world axis `u` of each degree of freedom, and shows
//!    the caller the position `P` of each point. The caller answers with a force `g = ∂E/∂P`; f and n sum the forces and moments about the *world* origin of each link's points.
//! 2. [`Plan::pullback`] walks back. Children's f and n are added to their parents' without any shift, and
//!
//! ```text
//! revolute j of link b:      ∂E/∂q_j = u_j · (n_b − p_b × f_b)
//! translation j of link b:   ∂E/∂q_j = u_j · f_b
//! ```
//!
//! [`Plan::sweep`] does both, for the built-in bodies in straight-line code that the build script writes. Points never go through memory. Cost O(links + points + degrees of freedom); nothing is allocated. [`Plan::gauss_newton`] gives the curvature.

mod gauss_newton;
mod jacobian;
mod plan;
mod straight_line;
mod structure;
mod vector;

use crate::tree::Axis;
use gauss_newton::INERTIA;
pub use gauss_newton::Inform;
pub use jacobian::point_jacobian;
use plan::ORIGIN;
pub use plan::Plan;
use sinew_core::elementary::sin_cos;
use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch, dispatch_one};
pub use vector::V3;
use vector::{cross_add, cross_sub, dot, load3, moved, store3, turned, v3};

/// Force and moment.
const WRENCH: usize = 6;

/// What [`Plan::forward`] shows its points to. A trait and no closure: closures cannot be `#[inline(always)]`, and a long one stays outside the entry point of its instruction set.
pub trait Visit<V> {
    /// Point k in the plan's order at the world position `p`, metres. Answers with the force `∂E/∂P` on it. Must be `#[inline(always)]`.
    fn point(&mut self, k: usize, p: V3<V>) -> V3<V>;
}

/// What one evaluation keeps, in a caller's workspace.
#[derive(Debug)]
pub struct Pass<'a, M> {
    /// Frames and axes, where the plan places them.
    vectors: &'a mut [[M; 3]],
    /// Force and moment about the world origin, of each link's points, in the backward sweep also of what was gathered from below.
    wrenches: &'a mut [[M; WRENCH]],
}

/// Takes `count` groups of `N` from the front of a workspace.
fn take<'a, M, const N: usize>(ws: &mut &'a mut [M], count: usize) -> &'a mut [[M; N]] {
    let (taken, rest) = std::mem::take(ws).split_at_mut(count * N);
    *ws = rest;
    taken.as_chunks_mut().0
}

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
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let vectors = &mut *pass.vectors;
        for (column, unit) in
            [[one, zero, zero], [zero, one, zero], [zero, zero, one], [zero; 3]].into_iter().enumerate()
        {
            store3(unit, &mut vectors[column]);
        }
        for (link, wrench) in self.links.iter().zip(pass.wrenches.iter_mut()) {
            let from = &vectors[link.from..=link.from + ORIGIN];
            let [mut cx, mut cy, mut cz] = [load3::<V>(&from[0]), load3::<V>(&from[1]), load3::<V>(&from[2])];
            let mut p = moved(load3::<V>(&from[ORIGIN]), [cx, cy, cz], &link.offset);
            for (joint, q) in joints.by_ref().take(link.translations) {
                let u = match joint.axis {
                    Axis::X => cx,
                    Axis::Y => cy,
                    Axis::Z => cz,
                };
                let x = V::load(q);
                p = v3!(K => x.fma(u[K], p[K]));
            }
            for (joint, q) in joints.by_ref().take(link.rotations) {
                let (sin, cos) = sin_cos(V::load(q));
                let u;
                match joint.axis {
                    Axis::X => {
                        u = cx;
                        (cy, cz) = turned(cy, cz, sin, cos);
                    }
                    Axis::Y => {
                        u = cy;
                        (cz, cx) = turned(cz, cx, sin, cos);
                    }
                    Axis::Z => {
                        u = cz;
                        (cx, cy) = turned(cx, cy, sin, cos);
                    }
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

/// Writes positions in the caller's order.
struct Record<'a, M> {
    order: &'a [usize],
    out: &'a mut [[M; 3]],
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::{Proportions, cf28, h32};
    use crate::tree::{Joint, KinematicTree, Link, Point};

    fn positions(tree: &KinematicTree, q: &[f64]) -> Vec<[f64; 3]> {
        let plan = Plan::with_all_points(tree);
        let mut out = vec![0.0; 3 * plan.points()];
        point_positions(&plan, Isa::best(), q, &mut out);
        out.chunks(3).map(|p| [p[0], p[1], p[2]]).collect()
    }

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    /// K1
    #[test]
    fn at_the_zero_pose_points_lie_at_the_cumulative_offsets() {
        for tree in [cf28(&Proportions::default()), h32(&Proportions::default())] {
            for (point, found) in tree.points().iter().zip(positions(&tree, &vec![0.0; tree.dof()])) {
                let mut expected = point.offset;
                let mut link = Some(point.link);
                while let Some(index) = link {
                    for (e, o) in expected.iter_mut().zip(tree.links()[index].offset) {
                        *e += o;
                    }
                    link = tree.links()[index].parent;
                }
                assert!(distance(expected, found) < 1e-14, "{}", point.name);
            }
        }
    }

    /// K2
    #[test]
    fn turning_and_shifting_the_root_moves_every_point_rigidly() {
        let tree = h32(&Proportions::default());
        let mut q: Vec<f64> = (0..tree.dof()).map(|j| 0.3 * (j as f64).sin()).collect();
        q[3..6].fill(0.0);
        let before = positions(&tree, &q);
        let origin = [q[0], q[1], q[2]];
        q[3] = 0.7;
        for (x, shift) in q.iter_mut().zip([0.1, -2.0, 0.4]) {
            *x += shift;
        }
        let (s, c) = 0.7_f64.sin_cos();
        for (a, b) in before.into_iter().zip(positions(&tree, &q)) {
            let (x, y) = (a[0] - origin[0], a[1] - origin[1]);
            let expected = [c * x - s * y + origin[0] + 0.1, s * x + c * y + origin[1] - 2.0, a[2] + 0.4];
            assert!(distance(expected, b) < 1e-12);
        }
    }

    /// K3
    #[test]
    fn rotations_act_left_to_right_as_listed() {
        let half_turn = std::f64::consts::FRAC_PI_2;
        let link = Link {
            name: "root".into(),
            parent: None,
            offset: [0.0; 3],
            joints: [Axis::Z, Axis::Y, Axis::X].map(Joint::Rotate).to_vec(),
        };
        let points = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .iter()
            .enumerate()
            .map(|(k, &offset)| Point { name: k.to_string(), link: 0, offset })
            .collect();
        let tree = KinematicTree::new(vec![link], points).expect("valid");
        let cases = [
            ([half_turn, 0.0, 0.0], [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
            ([0.0, half_turn, 0.0], [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
            ([0.0, 0.0, half_turn], [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
            ([half_turn, half_turn, 0.0], [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
        ];
        for (q, expected) in cases {
            for (found, expected) in positions(&tree, &q).into_iter().zip(expected) {
                assert!(distance(found, expected) < 1e-15);
            }
        }
    }

    #[test]
    fn a_link_may_translate_after_it_has_rotated() {
        let joints = vec![Joint::Rotate(Axis::Z), Joint::Translate(Axis::X), Joint::Rotate(Axis::Z)];
        let tree = KinematicTree::new(
            vec![Link { name: "a".into(), parent: None, offset: [0.0; 3], joints }],
            vec![Point { name: "p".into(), link: 0, offset: [1.0, 0.0, 0.0] }],
        )
        .expect("valid");
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!(distance(positions(&tree, &[quarter, 2.0, quarter])[0], [-1.0, 2.0, 0.0]) < 1e-15);
        let plan = Plan::with_all_points(&tree);
        let (mut p, mut jacobian) = ([0.0; 3], [0.0; 9]);
        point_jacobian(&plan, Isa::best(), &[quarter, 2.0, quarter], &mut p, &mut jacobian);
        let expected = [-2.0, 0.0, 0.0, -1.0, 1.0, -1.0, 0.0, 0.0, 0.0];
        assert!(jacobian.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{jacobian:?}");
    }
}
