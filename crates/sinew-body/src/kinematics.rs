//! Forward kinematics and the backward sweep over lanes.
//!
//! A [`Plan`] is a [`KinematicTree`] flattened for evaluation: topological arrays, points sorted by link, every link's translations before its rotations (a link
//! written otherwise becomes two). It works in a caller's workspace, divided into [`Sections`], on one state or on a block of eight:
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
use sinew_core::lanes::triangle;
use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch, dispatch_one};

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
fn load3<V: Real>(m: &[V::Mem; 3]) -> V3<V> {
    [V::load(&m[0]), V::load(&m[1]), V::load(&m[2])]
}

#[inline(always)]
fn store3<V: Real>(v: V3<V>, m: &mut [V::Mem; 3]) {
    v[0].store(&mut m[0]);
    v[1].store(&mut m[1]);
    v[2].store(&mut m[2]);
}

#[derive(Clone, Debug)]
struct PlanLink {
    parent: Option<usize>,
    offset: [f64; 3],
    /// First degree of freedom.
    first: usize,
    translations: usize,
    rotations: usize,
    points: usize,
    has_children: bool,
}

/// A kinematic tree flattened for lane kernels.
#[derive(Clone, Debug)]
pub struct Plan {
    links: Vec<PlanLink>,
    /// Axis of each degree of freedom, in state order: link by link, translations before rotations.
    axes: Vec<Axis>,
    /// Offset of each point, link by link.
    offsets: Vec<[f64; 3]>,
    /// The caller's index of each point, in the same order.
    order: Vec<usize>,
}

const FRAME: usize = 12;
const FORCE: usize = 6;
const INERTIA: usize = 21;

/// A workspace divided among links, degrees of freedom and points. Points stand in the order of [`Plan::order`].
#[derive(Debug)]
pub struct Sections<'a, M> {
    /// Three axes and origin of each link that has children; of the others the origin only.
    frames: &'a mut [[M; FRAME]],
    /// World axis of each degree of freedom.
    axes: &'a mut [[M; 3]],
    /// World position of each point, metres; set by [`Plan::forward`].
    pub positions: &'a mut [[M; 3]],
    /// Force `∂E/∂P` on each point; read by [`Plan::pullback`].
    pub forces: &'a mut [[M; 3]],
    /// Information matrix (xx, xy, xz, yy, yz, zz) of each point; read by [`Plan::gauss_newton_diagonal`].
    pub information: &'a mut [[M; 6]],
    /// Force and moment about the world origin, of each link and what is below it.
    totals: &'a mut [[M; FORCE]],
    /// S of each link: upper triangle of the moment block, the mixed block, upper triangle of the force block.
    inertias: &'a mut [[M; INERTIA]],
}

fn divide<'a, M, const N: usize>(ws: &mut &'a mut [M], count: usize) -> &'a mut [[M; N]] {
    let (taken, rest) = std::mem::take(ws).split_at_mut(count * N);
    *ws = rest;
    taken.as_chunks_mut().0
}

impl Plan {
    /// Flattens a tree with the points of the given indices.
    ///
    /// # Panics
    /// If an index is not that of a point of the tree.
    #[must_use]
    pub fn new(tree: &KinematicTree, points: &[usize]) -> Self {
        let mut plan = Self { links: vec![], axes: vec![], offsets: vec![], order: vec![] };
        let mut last_segment: Vec<usize> = Vec::with_capacity(tree.links().len());
        for (index, link) in tree.links().iter().enumerate() {
            let mut parent = link.parent.map(|p| last_segment[p]);
            let mut offset = link.offset;
            let mut joints = link.joints.iter().peekable();
            loop {
                let before = plan.axes.len();
                while let Some(Joint::Translate(axis)) = joints.peek() {
                    plan.axes.push(*axis);
                    joints.next();
                }
                let translations = plan.axes.len() - before;
                while let Some(Joint::Rotate(axis)) = joints.peek() {
                    plan.axes.push(*axis);
                    joints.next();
                }
                let rotations = plan.axes.len() - before - translations;
                if let Some(p) = parent {
                    plan.links[p].has_children = true;
                }
                let first = before;
                plan.links.push(PlanLink {
                    parent,
                    offset,
                    first,
                    translations,
                    rotations,
                    points: 0,
                    has_children: false,
                });
                parent = Some(plan.links.len() - 1);
                offset = [0.0; 3];
                if joints.peek().is_none() {
                    break;
                }
            }
            let segment = plan.links.len() - 1;
            last_segment.push(segment);
            for (k, &p) in points.iter().enumerate() {
                let point = &tree.points()[p];
                if point.link == index {
                    plan.offsets.push(point.offset);
                    plan.order.push(k);
                    plan.links[segment].points += 1;
                }
            }
        }
        plan
    }

    /// Flattens a tree with all its points.
    #[must_use]
    pub fn with_all_points(tree: &KinematicTree) -> Self {
        Self::new(tree, &(0..tree.points().len()).collect::<Vec<_>>())
    }

    /// Number of degrees of freedom.
    #[must_use]
    pub const fn dof(&self) -> usize {
        self.axes.len()
    }

    /// Number of points.
    #[must_use]
    pub const fn points(&self) -> usize {
        self.order.len()
    }

    /// For each point of a workspace its index among the points that the plan was made with.
    #[must_use]
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// Numbers (or blocks) of scratch that the methods need.
    #[must_use]
    pub const fn workspace(&self) -> usize {
        (FRAME + FORCE + INERTIA) * self.links.len() + 3 * self.axes.len() + (3 + 3 + 6) * self.order.len()
    }

    /// Divides a workspace.
    ///
    /// # Panics
    /// If it is shorter than [`Plan::workspace`].
    #[inline(always)]
    pub fn sections<'a, M>(&self, mut ws: &'a mut [M]) -> Sections<'a, M> {
        let ws = &mut ws;
        Sections {
            frames: divide(ws, self.links.len()),
            axes: divide(ws, self.axes.len()),
            positions: divide(ws, self.order.len()),
            forces: divide(ws, self.order.len()),
            information: divide(ws, self.order.len()),
            totals: divide(ws, self.links.len()),
            inertias: divide(ws, self.links.len()),
        }
    }

    /// Computes all link frames and point positions at `q`; with `AXES` also what [`Plan::pullback`] needs.
    #[inline(always)]
    pub fn forward<V: Real, const AXES: bool>(&self, q: &[V::Mem], s: &mut Sections<'_, V::Mem>) {
        let mut joints = self.axes.iter().zip(q).zip(s.axes.iter_mut());
        let mut points = self.offsets.iter().zip(s.positions.iter_mut());
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        for (index, link) in self.links.iter().enumerate() {
            let [mut cx, mut cy, mut cz] = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
            let mut p = v3!(K => V::splat(link.offset[K]));
            if let Some(parent) = link.parent {
                let frame = &s.frames[parent];
                cx = v3!(K => V::load(&frame[K]));
                cy = v3!(K => V::load(&frame[3 + K]));
                cz = v3!(K => V::load(&frame[6 + K]));
                p = moved::<V>(v3!(K => V::load(&frame[9 + K])), cx, cy, cz, &link.offset);
            }
            for ((axis, q), stored) in joints.by_ref().take(link.translations) {
                let u = match axis {
                    Axis::X => cx,
                    Axis::Y => cy,
                    Axis::Z => cz,
                };
                let x = V::load(q);
                p = v3!(K => x.fma(u[K], p[K]));
                if AXES {
                    store3(u, stored);
                }
            }
            for ((axis, q), stored) in joints.by_ref().take(link.rotations) {
                let (sin, cos) = sin_cos(V::load(q));
                let u;
                match axis {
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
                if AXES {
                    store3(u, stored);
                }
            }
            for (offset, position) in points.by_ref().take(link.points) {
                store3(moved::<V>(p, cx, cy, cz, offset), position);
            }
            let frame = &mut s.frames[index];
            if link.has_children {
                for k in 0..3 {
                    cx[k].store(&mut frame[k]);
                    cy[k].store(&mut frame[3 + k]);
                    cz[k].store(&mut frame[6 + k]);
                }
            }
            for k in 0..3 {
                p[k].store(&mut frame[9 + k]);
            }
        }
    }

    /// Turns the forces on all points into `∂E/∂q`, after [`Plan::forward`] with axes.
    #[inline(always)]
    pub fn pullback<V: Real>(&self, s: &mut Sections<'_, V::Mem>, grad: &mut [V::Mem]) {
        let mut joints = s.axes.iter().zip(grad.iter_mut()).rev();
        let mut points = s.positions.iter().zip(s.forces.iter()).rev();
        let none = V::splat(0.0);
        for (link, total) in self.links.iter().zip(s.totals.iter_mut()) {
            if link.has_children {
                for x in total {
                    none.store(x);
                }
            }
        }
        for (index, link) in self.links.iter().enumerate().rev() {
            let (mut f, mut n) = ([none; 3], [none; 3]);
            if link.has_children {
                let total = &s.totals[index];
                f = v3!(K => V::load(&total[K]));
                n = v3!(K => V::load(&total[3 + K]));
            }
            for (position, force) in points.by_ref().take(link.points) {
                let g = load3::<V>(force);
                f = v3!(K => f[K] + g[K]);
                n = cross_add(load3::<V>(position), g, n);
            }
            if link.rotations > 0 {
                let frame = &s.frames[index];
                let m = cross_sub(v3!(K => V::load(&frame[9 + K])), f, n);
                for (axis, out) in joints.by_ref().take(link.rotations) {
                    dot(load3::<V>(axis), m).store(out);
                }
            }
            for (axis, out) in joints.by_ref().take(link.translations) {
                dot(load3::<V>(axis), f).store(out);
            }
            if let Some(parent) = link.parent {
                let total = &mut s.totals[parent];
                for k in 0..3 {
                    (V::load(&total[k]) + f[k]).store(&mut total[k]);
                    (V::load(&total[3 + k]) + n[k]).store(&mut total[3 + k]);
                }
            }
        }
    }

    /// Turns the information on all points into the diagonal of the Gauss–Newton matrix, after [`Plan::forward`] with axes.
    #[inline(always)]
    pub fn gauss_newton_diagonal<V: Real>(&self, s: &mut Sections<'_, V::Mem>, diagonal: &mut [V::Mem]) {
        self.gather::<V>(s);
        let mut joints = s.axes.iter().zip(diagonal.iter_mut()).rev();
        let none = [V::splat(0.0); 3];
        for (index, link) in self.links.iter().enumerate().rev() {
            let inertia = &s.inertias[index];
            for (axis, out) in joints.by_ref().take(link.rotations) {
                let u = load3::<V>(axis);
                let origin = v3!(K => V::load(&s.frames[index][9 + K]));
                quadratic_form(inertia, u, cross_add(origin, u, none)).store(out);
            }
            for (axis, out) in joints.by_ref().take(link.translations) {
                quadratic_form(inertia, none, load3::<V>(axis)).store(out);
            }
        }
    }

    /// Sums the information of each link's points and of what is below it.
    #[inline(always)]
    fn gather<V: Real>(&self, s: &mut Sections<'_, V::Mem>) {
        let mut points = s.positions.iter().zip(s.information.iter()).rev();
        for x in s.inertias.iter_mut().flatten() {
            V::splat(0.0).store(x);
        }
        for (index, link) in self.links.iter().enumerate().rev() {
            for (position, information) in points.by_ref().take(link.points) {
                add_point::<V>(&mut s.inertias[index], load3::<V>(position), information);
            }
            if let Some(parent) = link.parent {
                let below = s.inertias[index];
                for (a, b) in s.inertias[parent].iter_mut().zip(&below) {
                    (V::load(a) + V::load(b)).store(a);
                }
            }
        }
    }

    /// Turns the information on all points into the Gauss–Newton matrix, after [`Plan::forward`] with axes: its lower triangle, row after row. `H_ij = ξ_iᵀ S ξ_j`
    /// with the S of the deeper link where one link is above the other, else 0.
    #[inline(always)]
    pub fn gauss_newton<V: Real>(&self, s: &mut Sections<'_, V::Mem>, matrix: &mut [V::Mem]) {
        self.gather::<V>(s);
        let zero = V::splat(0.0);
        for x in matrix.iter_mut() {
            zero.store(x);
        }
        let twist = |link: &PlanLink, index: usize, j: usize, s: &Sections<'_, V::Mem>| {
            let u = load3::<V>(&s.axes[j]);
            if j < link.first + link.translations {
                return ([zero; 3], u);
            }
            let origin = v3!(K => V::load(&s.frames[index][9 + K]));
            (u, cross_add(origin, u, [zero; 3]))
        };
        for (index, link) in self.links.iter().enumerate() {
            for j in link.first..link.first + link.translations + link.rotations {
                let (w, v) = twist(link, index, j, s);
                let (moment, force) = wrench::<V>(&s.inertias[index], w, v);
                let mut above = Some(index);
                while let Some(b) = above {
                    let other = &self.links[b];
                    let end = if b == index { j + 1 } else { other.first + other.translations + other.rotations };
                    for i in other.first..end {
                        let (w, v) = twist(other, b, i, s);
                        (dot(w, moment) + dot(v, force)).store(&mut matrix[triangle(j, i)]);
                    }
                    above = other.parent;
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

/// Adds `Bᵀ M B` of a point to S.
#[inline(always)]
fn add_point<V: Real>(s: &mut [V::Mem; INERTIA], p: V3<V>, information: &[V::Mem; 6]) {
    let zero = [V::splat(0.0); 3];
    let m = |i: usize| V::load(&information[i]);
    let rows = [[m(0), m(1), m(2)], [m(1), m(3), m(4)], [m(2), m(4), m(5)]];
    let columns = [cross_add(p, rows[0], zero), cross_add(p, rows[1], zero), cross_add(p, rows[2], zero)];
    let mixed = v3!(I => v3!(J => columns[J][I]));
    let moment = [cross_add(p, mixed[0], zero), cross_add(p, mixed[1], zero), cross_add(p, mixed[2], zero)];
    let triangle = |a: [V3<V>; 3]| [a[0][0], a[0][1], a[0][2], a[1][1], a[1][2], a[2][2]];
    let mut add = |at: usize, x: V| (V::load(&s[at]) + x).store(&mut s[at]);
    for (i, x) in triangle(moment).into_iter().enumerate() {
        add(i, x);
    }
    for (i, x) in mixed.into_iter().flatten().enumerate() {
        add(6 + i, x);
    }
    for (i, x) in triangle(rows).into_iter().enumerate() {
        add(15 + i, x);
    }
}

/// `S (w, v)`: moment and force that belong to the twist with angular part `w` and linear part `v`.
#[inline(always)]
fn wrench<V: Real>(s: &[V::Mem; INERTIA], w: V3<V>, v: V3<V>) -> (V3<V>, V3<V>) {
    let m = |i: usize| V::load(&s[i]);
    let symmetric = |at: usize, x: V3<V>| {
        [
            dot([m(at), m(at + 1), m(at + 2)], x),
            dot([m(at + 1), m(at + 3), m(at + 4)], x),
            dot([m(at + 2), m(at + 4), m(at + 5)], x),
        ]
    };
    let (ww, vv) = (symmetric(0, w), symmetric(15, v));
    let mixed = |i: usize| dot([m(6 + 3 * i), m(7 + 3 * i), m(8 + 3 * i)], v);
    let transposed = |j: usize| dot([m(6 + j), m(9 + j), m(12 + j)], w);
    (
        [ww[0] + mixed(0), ww[1] + mixed(1), ww[2] + mixed(2)],
        [vv[0] + transposed(0), vv[1] + transposed(1), vv[2] + transposed(2)],
    )
}

/// `(w, v)ᵀ S (w, v)` for the twist with angular part `w` and linear part `v`.
#[inline(always)]
fn quadratic_form<V: Real>(s: &[V::Mem; INERTIA], w: V3<V>, v: V3<V>) -> V {
    let m = |i: usize| V::load(&s[i]);
    let two = V::splat(2.0);
    let symmetric = |at: usize, x: V3<V>| {
        let diagonal = (m(at + 5) * x[2]).fma(x[2], (m(at + 3) * x[1]).fma(x[1], m(at) * x[0] * x[0]));
        let off = (m(at + 4) * x[1]).fma(x[2], (m(at + 2) * x[0]).fma(x[2], m(at + 1) * x[0] * x[1]));
        two.fma(off, diagonal)
    };
    let row = |i: usize| dot([m(6 + 3 * i), m(7 + 3 * i), m(8 + 3 * i)], v);
    two.fma(dot(w, [row(0), row(1), row(2)]), symmetric(0, w) + symmetric(15, v))
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
        let mut s = self.plan.sections(self.ws);
        self.plan.forward::<V, false>(self.q, &mut s);
        let (out, _) = self.out.as_chunks_mut::<3>();
        for (position, &k) in s.positions.iter().zip(self.plan.order()) {
            out[k] = *position;
        }
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
        let mut s = plan.sections(&mut ws);
        plan.forward::<V, true>(self.q, &mut s);
        s.forces.fill([0.0; 3]);
        let (out, _) = self.positions.as_chunks_mut::<3>();
        for (i, &k) in plan.order().iter().enumerate() {
            out[k] = s.positions[i];
            for axis in 0..3 {
                s.forces[i][axis] = 1.0;
                let row = (3 * k + axis) * plan.dof();
                plan.pullback::<V>(&mut s, &mut self.jacobian[row..row + plan.dof()]);
                s.forces[i][axis] = 0.0;
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
