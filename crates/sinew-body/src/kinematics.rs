//! Forward kinematics and the backward sweep over lanes.
//!
//! A [`Plan`] is a [`KinematicTree`] flattened for evaluation: topological arrays, points sorted by link, every link's translations before its rotations (a link
//! written otherwise becomes two). It works in a caller's workspace, on one state or on a block of eight:
//!
//! 1. [`Plan::forward`] stores for each link its axes (columns of `R`) and origin `p`, for each degree of freedom its world axis `u`, for each point its position `P`.
//! 2. The caller puts a force `g = ∂E/∂P` on each point, and [`Plan::pullback`] returns `∂E/∂q`. With f and n the force and moment about the *world* origin
//!    that act on a link and everything below it (children are added to parents without any shift),
//!
//! ```text
//! revolute j of link b:      ∂E/∂q_j = u_j · (n_b − p_b × f_b)
//! translation j of link b:   ∂E/∂q_j = u_j · f_b
//! ```
//!
//! 3. For the Gauss–Newton diagonal the caller puts a symmetric information matrix `M` on each point; with twists `ξ_j = (u_j, p_b × u_j)`, `B = [−[P]× | I]` and
//!    `S_b = Σ Bᵀ M B` over the points at and below the link, `H_jj = ξ_jᵀ S_b ξ_j`.
//!
//! Cost O(links + points + degrees of freedom); nothing is allocated.

use crate::tree::{Axis, Joint, KinematicTree};
use sinew_core::elementary::sin_cos;
use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch, dispatch_one};
use std::ops::Range;

/// Vector of three lanes.
pub type V3<V> = [V; 3];

/// Componentwise `[e(0), e(1), e(2)]`, spelled out so that nothing is outlined.
macro_rules! v3 {
    ($k:ident => $e:expr) => {
        [
            {
                const $k: usize = 0;
                $e
            },
            {
                const $k: usize = 1;
                $e
            },
            {
                const $k: usize = 2;
                $e
            },
        ]
    };
}

#[inline(always)]
fn dot<V: Real>(a: V3<V>, b: V3<V>) -> V {
    a[2].fma(b[2], a[1].fma(b[1], a[0] * b[0]))
}

/// `c + a × b`.
#[inline(always)]
fn cross_add<V: Real>(a: V3<V>, b: V3<V>, c: V3<V>) -> V3<V> {
    [
        a[2].fnma(b[1], a[1].fma(b[2], c[0])),
        a[0].fnma(b[2], a[2].fma(b[0], c[1])),
        a[1].fnma(b[0], a[0].fma(b[1], c[2])),
    ]
}

/// `c − a × b`.
#[inline(always)]
fn cross_sub<V: Real>(a: V3<V>, b: V3<V>, c: V3<V>) -> V3<V> {
    [
        a[2].fma(b[1], a[1].fnma(b[2], c[0])),
        a[0].fma(b[2], a[2].fnma(b[0], c[1])),
        a[1].fma(b[0], a[0].fnma(b[1], c[2])),
    ]
}

#[inline(always)]
fn load3<V: Real>(m: &[V::Mem], at: usize) -> V3<V> {
    let m = &m[at..at + 3];
    [V::load(&m[0]), V::load(&m[1]), V::load(&m[2])]
}

#[inline(always)]
fn store3<V: Real>(v: V3<V>, m: &mut [V::Mem], at: usize) {
    let m = &mut m[at..at + 3];
    v[0].store(&mut m[0]);
    v[1].store(&mut m[1]);
    v[2].store(&mut m[2]);
}

#[derive(Clone, Copy, Debug)]
struct PlanJoint {
    axis: Axis,
    dof: usize,
}

#[derive(Clone, Debug)]
struct PlanLink {
    parent: Option<usize>,
    offset: [f64; 3],
    translations: Range<usize>,
    rotations: Range<usize>,
    points: Range<usize>,
    has_children: bool,
}

#[derive(Clone, Debug)]
struct PlanPoint {
    offset: [f64; 3],
    /// Position in the caller's order.
    slot: usize,
}

/// A kinematic tree flattened for lane kernels.
#[derive(Clone, Debug)]
pub struct Plan {
    links: Vec<PlanLink>,
    joints: Vec<PlanJoint>,
    points: Vec<PlanPoint>,
    dof: usize,
}

// Workspace: 12 numbers a link (three columns, origin), 3 a degree of freedom (axis), 3 a point (position),
// 6 a point (force or information), 21 a link (force and moment, or the upper triangle of S).
const LINK: usize = 12;
const AXIS: usize = 3;
const POSITION: usize = 3;
const LOAD: usize = 6;
const SUM: usize = 21;

impl Plan {
    /// Flattens a tree with the points of the given indices, in that order.
    ///
    /// # Panics
    /// If an index is not that of a point of the tree.
    #[must_use]
    pub fn new(tree: &KinematicTree, points: &[usize]) -> Self {
        let mut plan = Self { links: vec![], joints: vec![], points: vec![], dof: tree.dof() };
        let mut last_segment: Vec<usize> = Vec::with_capacity(tree.links().len());
        for (index, link) in tree.links().iter().enumerate() {
            let mut parent = link.parent.map(|p| last_segment[p]);
            let mut offset = link.offset;
            let mut rest: Vec<PlanJoint> = vec![];
            let mut kinds = link.joints.iter().enumerate().peekable();
            loop {
                let first = plan.joints.len();
                rest.clear();
                while let Some((j, Joint::Translate(axis))) = kinds.peek().copied() {
                    plan.joints.push(PlanJoint { axis: *axis, dof: tree.first_dof(index) + j });
                    kinds.next();
                }
                let middle = plan.joints.len();
                while let Some((j, Joint::Rotate(axis))) = kinds.peek().copied() {
                    plan.joints.push(PlanJoint { axis: *axis, dof: tree.first_dof(index) + j });
                    kinds.next();
                }
                if let Some(p) = parent {
                    plan.links[p].has_children = true;
                }
                plan.links.push(PlanLink {
                    parent,
                    offset,
                    translations: first..middle,
                    rotations: middle..plan.joints.len(),
                    points: 0..0,
                    has_children: false,
                });
                parent = Some(plan.links.len() - 1);
                offset = [0.0; 3];
                if kinds.peek().is_none() {
                    break;
                }
            }
            last_segment.push(plan.links.len() - 1);
        }
        for (index, &segment) in last_segment.iter().enumerate() {
            let first = plan.points.len();
            for (slot, &p) in points.iter().enumerate() {
                let point = &tree.points()[p];
                if point.link == index {
                    plan.points.push(PlanPoint { offset: point.offset, slot });
                }
            }
            plan.links[segment].points = first..plan.points.len();
        }
        plan
    }

    /// Flattens a tree with all its points, in their order.
    #[must_use]
    pub fn with_all_points(tree: &KinematicTree) -> Self {
        Self::new(tree, &(0..tree.points().len()).collect::<Vec<_>>())
    }

    /// Number of degrees of freedom.
    #[must_use]
    pub const fn dof(&self) -> usize {
        self.dof
    }

    /// Number of points.
    #[must_use]
    pub const fn points(&self) -> usize {
        self.points.len()
    }

    /// Numbers (or blocks) of scratch that the methods need.
    #[must_use]
    pub const fn workspace(&self) -> usize {
        (LINK + SUM) * self.links.len() + AXIS * self.joints.len() + (POSITION + LOAD) * self.points.len()
    }

    const fn axes_at(&self) -> usize {
        LINK * self.links.len()
    }
    const fn positions_at(&self) -> usize {
        self.axes_at() + AXIS * self.joints.len()
    }
    const fn loads_at(&self) -> usize {
        self.positions_at() + POSITION * self.points.len()
    }
    const fn sums_at(&self) -> usize {
        self.loads_at() + LOAD * self.points.len()
    }

    /// Computes all link frames and point positions at `q`; with `AXES` also what [`Plan::pullback`] needs.
    #[inline(always)]
    pub fn forward<V: Real, const AXES: bool>(&self, q: &[V::Mem], ws: &mut [V::Mem]) {
        let q = &q[..self.dof];
        let ws = &mut ws[..self.workspace()];
        let (links, rest) = ws.split_at_mut(self.axes_at());
        let (axes, rest) = rest.split_at_mut(self.positions_at() - self.axes_at());
        let (positions, _) = rest.split_at_mut(self.loads_at() - self.positions_at());
        for (index, link) in self.links.iter().enumerate() {
            let zero = V::splat(0.0);
            let one = V::splat(1.0);
            let [mut cx, mut cy, mut cz] = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
            let mut p = v3!(K => V::splat(link.offset[K]));
            if let Some(parent) = link.parent {
                let at = LINK * parent;
                cx = load3::<V>(links, at);
                cy = load3::<V>(links, at + 3);
                cz = load3::<V>(links, at + 6);
                p = moved::<V>(load3::<V>(links, at + 9), cx, cy, cz, &link.offset);
            }
            for j in link.translations.clone() {
                let joint = self.joints[j];
                let x = V::load(&q[joint.dof]);
                let u = match joint.axis {
                    Axis::X => cx,
                    Axis::Y => cy,
                    Axis::Z => cz,
                };
                p = v3!(K => x.fma(u[K], p[K]));
                if AXES {
                    store3(u, axes, AXIS * j);
                }
            }
            for j in link.rotations.clone() {
                let joint = self.joints[j];
                let (s, c) = sin_cos(V::load(&q[joint.dof]));
                let u;
                match joint.axis {
                    Axis::X => {
                        u = cx;
                        (cy, cz) = turned(cy, cz, s, c);
                    }
                    Axis::Y => {
                        u = cy;
                        (cz, cx) = turned(cz, cx, s, c);
                    }
                    Axis::Z => {
                        u = cz;
                        (cx, cy) = turned(cx, cy, s, c);
                    }
                }
                if AXES {
                    store3(u, axes, AXIS * j);
                }
            }
            let at = LINK * index;
            if link.has_children {
                store3(cx, links, at);
                store3(cy, links, at + 3);
                store3(cz, links, at + 6);
            }
            store3(p, links, at + 9);
            for k in link.points.clone() {
                let point = &self.points[k];
                store3(moved::<V>(p, cx, cy, cz, &point.offset), positions, POSITION * point.slot);
            }
        }
    }

    /// World position of a point, metres, after [`Plan::forward`].
    #[inline(always)]
    pub fn position<V: Real>(&self, ws: &[V::Mem], point: usize) -> V3<V> {
        load3::<V>(ws, self.positions_at() + POSITION * point)
    }

    /// Puts the force `∂E/∂P` on a point.
    #[inline(always)]
    pub fn set_force<V: Real>(&self, ws: &mut [V::Mem], point: usize, force: V3<V>) {
        store3(force, ws, self.loads_at() + LOAD * point);
    }

    /// Turns the forces on all points into `∂E/∂q`, after [`Plan::forward`] with axes.
    #[inline(always)]
    pub fn pullback<V: Real>(&self, ws: &mut [V::Mem], grad: &mut [V::Mem]) {
        let grad = &mut grad[..self.dof];
        let ws = &mut ws[..self.workspace()];
        let (links, rest) = ws.split_at_mut(self.axes_at());
        let (axes, rest) = rest.split_at_mut(self.positions_at() - self.axes_at());
        let (positions, rest) = rest.split_at_mut(self.loads_at() - self.positions_at());
        let (loads, sums) = rest.split_at_mut(self.sums_at() - self.loads_at());
        let none = [V::splat(0.0); 3];
        for (index, link) in self.links.iter().enumerate() {
            if link.has_children {
                store3(none, sums, SUM * index);
                store3(none, sums, SUM * index + 3);
            }
        }
        for (index, link) in self.links.iter().enumerate().rev() {
            let (mut f, mut n) = (none, none);
            if link.has_children {
                f = load3::<V>(sums, SUM * index);
                n = load3::<V>(sums, SUM * index + 3);
            }
            for k in link.points.clone() {
                let slot = self.points[k].slot;
                let g = load3::<V>(loads, LOAD * slot);
                f = v3!(K => f[K] + g[K]);
                n = cross_add(load3::<V>(positions, POSITION * slot), g, n);
            }
            for j in link.translations.clone() {
                dot(load3::<V>(axes, AXIS * j), f).store(&mut grad[self.joints[j].dof]);
            }
            if !link.rotations.is_empty() {
                let m = cross_sub(load3::<V>(links, LINK * index + 9), f, n);
                for j in link.rotations.clone() {
                    dot(load3::<V>(axes, AXIS * j), m).store(&mut grad[self.joints[j].dof]);
                }
            }
            if let Some(parent) = link.parent {
                let at = SUM * parent;
                let (f0, n0) = (load3::<V>(sums, at), load3::<V>(sums, at + 3));
                store3(v3!(K => f0[K] + f[K]), sums, at);
                store3(v3!(K => n0[K] + n[K]), sums, at + 3);
            }
        }
    }

    /// Puts a symmetric information matrix (xx, xy, xz, yy, yz, zz) on a point.
    #[inline(always)]
    pub fn set_information<V: Real>(&self, ws: &mut [V::Mem], point: usize, m: [V; 6]) {
        let at = self.loads_at() + LOAD * point;
        store3([m[0], m[1], m[2]], ws, at);
        store3([m[3], m[4], m[5]], ws, at + 3);
    }

    /// Turns the information on all points into the diagonal of the Gauss–Newton matrix, after [`Plan::forward`] with axes.
    #[inline(always)]
    pub fn gauss_newton_diagonal<V: Real>(&self, ws: &mut [V::Mem], diagonal: &mut [V::Mem]) {
        let ws = &mut ws[..self.workspace()];
        let (links, rest) = ws.split_at_mut(self.axes_at());
        let (axes, rest) = rest.split_at_mut(self.positions_at() - self.axes_at());
        let (positions, rest) = rest.split_at_mut(self.loads_at() - self.positions_at());
        let (loads, sums) = rest.split_at_mut(self.sums_at() - self.loads_at());
        for sum in sums.iter_mut() {
            V::splat(0.0).store(sum);
        }
        for (index, link) in self.links.iter().enumerate().rev() {
            let sum = &mut sums[SUM * index..SUM * (index + 1)];
            for k in link.points.clone() {
                let slot = self.points[k].slot;
                let m0 = load3::<V>(loads, LOAD * slot);
                let m1 = load3::<V>(loads, LOAD * slot + 3);
                add_point(sum, load3::<V>(positions, POSITION * slot), [m0, m1]);
            }
            for j in link.translations.clone() {
                let u = load3::<V>(axes, AXIS * j);
                let none = [V::splat(0.0); 3];
                quadratic_form(sum, none, u).store(&mut diagonal[self.joints[j].dof]);
            }
            for j in link.rotations.clone() {
                let u = load3::<V>(axes, AXIS * j);
                let zero = [V::splat(0.0); 3];
                let v = cross_add(load3::<V>(links, LINK * index + 9), u, zero);
                quadratic_form(sum, u, v).store(&mut diagonal[self.joints[j].dof]);
            }
            if let Some(parent) = link.parent {
                let (above, below) = sums.split_at_mut(SUM * index);
                let above = &mut above[SUM * parent..SUM * (parent + 1)];
                for (a, b) in above.iter_mut().zip(&below[..SUM]) {
                    (V::load(a) + V::load(b)).store(a);
                }
            }
        }
    }
}

/// `p + cx·o₀ + cy·o₁ + cz·o₂`, skipping zero components.
#[inline(always)]
fn moved<V: Real>(p: V3<V>, cx: V3<V>, cy: V3<V>, cz: V3<V>, offset: &[f64; 3]) -> V3<V> {
    let mut p = p;
    for (column, &x) in [cx, cy, cz].into_iter().zip(offset) {
        if x != 0.0 {
            let x = V::splat(x);
            p = v3!(K => x.fma(column[K], p[K]));
        }
    }
    p
}

/// The two columns after a rotation by the angle of (s, c) that carries `a` towards `b`.
#[inline(always)]
fn turned<V: Real>(a: V3<V>, b: V3<V>, s: V, c: V) -> (V3<V>, V3<V>) {
    (v3!(K => s.fma(b[K], c * a[K])), v3!(K => s.fnma(a[K], c * b[K])))
}

/// Adds `Bᵀ M B` of a point to the upper triangle (moment–moment, moment–force, force–force) of S: 6 + 9 + 6 numbers.
#[inline(always)]
fn add_point<V: Real>(sum: &mut [V::Mem], p: V3<V>, m: [V3<V>; 2]) {
    let sum = &mut sum[..SUM];
    let zero = [V::splat(0.0); 3];
    let rows = [[m[0][0], m[0][1], m[0][2]], [m[0][1], m[1][0], m[1][1]], [m[0][2], m[1][1], m[1][2]]];
    // Row i of [P]× M has as its columns P × (column of M); [P]× M [P]×ᵀ follows by the same product on rows.
    let columns = [cross_add(p, rows[0], zero), cross_add(p, rows[1], zero), cross_add(p, rows[2], zero)];
    let mixed = v3!(I => v3!(J => columns[J][I]));
    let moment = [cross_add(p, mixed[0], zero), cross_add(p, mixed[1], zero), cross_add(p, mixed[2], zero)];
    let all = [
        moment[0][0],
        moment[0][1],
        moment[0][2],
        moment[1][1],
        moment[1][2],
        moment[2][2],
        mixed[0][0],
        mixed[0][1],
        mixed[0][2],
        mixed[1][0],
        mixed[1][1],
        mixed[1][2],
        mixed[2][0],
        mixed[2][1],
        mixed[2][2],
        rows[0][0],
        rows[0][1],
        rows[0][2],
        rows[1][1],
        rows[1][2],
        rows[2][2],
    ];
    for (s, x) in sum.iter_mut().zip(all) {
        (V::load(s) + x).store(s);
    }
}

/// `(w, v)ᵀ S (w, v)` for the twist with angular part `w` and linear part `v`.
#[inline(always)]
fn quadratic_form<V: Real>(sum: &[V::Mem], w: V3<V>, v: V3<V>) -> V {
    let sum = &sum[..SUM];
    let symmetric = |at: usize, x: V3<V>| {
        let two = V::splat(2.0);
        let a = load3::<V>(sum, at);
        let b = load3::<V>(sum, at + 3);
        let diagonal = (b[2] * x[2]).fma(x[2], (b[0] * x[1]).fma(x[1], a[0] * x[0] * x[0]));
        let off = (b[1] * x[1]).fma(x[2], (a[2] * x[0]).fma(x[2], a[1] * x[0] * x[1]));
        two.fma(off, diagonal)
    };
    let rows = v3!(I => dot(load3::<V>(sum, 6 + 3 * I), v));
    V::splat(2.0).fma(dot(w, rows), symmetric(0, w) + symmetric(15, v))
}

struct Positions<'a, M> {
    plan: &'a Plan,
    q: &'a [M],
    out: &'a mut [M],
    ws: &'a mut [M],
}

impl<M: Copy> Kernel<M> for Positions<'_, M> {
    type Out = ();
    #[inline(always)]
    fn run<V: Real<Mem = M>>(self) {
        self.plan.forward::<V, false>(self.q, self.ws);
        let at = self.plan.positions_at();
        let n = POSITION * self.plan.points();
        self.out[..n].copy_from_slice(&self.ws[at..at + n]);
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

struct Jacobian<'a> {
    plan: &'a Plan,
    q: &'a [f64],
    positions: &'a mut [f64],
    jacobian: &'a mut [f64],
}

impl Kernel<f64> for Jacobian<'_> {
    type Out = ();
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(self) {
        let plan = self.plan;
        let mut ws = vec![0.0; plan.workspace()];
        plan.forward::<V, true>(self.q, &mut ws);
        let n = POSITION * plan.points();
        self.positions[..n].copy_from_slice(&ws[plan.positions_at()..plan.positions_at() + n]);
        for k in 0..plan.points() {
            for axis in 0..3 {
                for other in 0..plan.points() {
                    let unit = |i: usize| V::splat(if other == k && i == axis { 1.0 } else { 0.0 });
                    plan.set_force::<V>(&mut ws, other, [unit(0), unit(1), unit(2)]);
                }
                let row = (3 * k + axis) * plan.dof;
                plan.pullback::<V>(&mut ws, &mut self.jacobian[row..row + plan.dof]);
            }
        }
    }
}

/// Positions of all points and their derivatives: `jacobian[(3 k + a) · dof + j] = ∂P_k,a / ∂q_j`. For fitting, not for hot loops.
pub fn point_jacobian(plan: &Plan, isa: Isa, q: &[f64], positions: &mut [f64], jacobian: &mut [f64]) {
    dispatch_one(isa, Jacobian { plan, q, positions, jacobian });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::{Proportions, cf28, h32};
    use crate::tree::{Link, Point};

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
