//! Gauss–Newton matrix of observations of points, by spatial inertias.
//!
//! The caller puts a symmetric information matrix `M` on each point. With twists `ξ_j = (u_j, p_b × u_j)` (translations: `(0, u_j)`), `B = [−[P]× | I]` and
//! `S_b = Σ Bᵀ M B` over the points at and below link b, `H_ij = ξ_iᵀ S_b ξ_j` with the S of the deeper link where one link is above the other, else 0 (the composite rigid
//! body algorithm of R. Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 6, with information in place of mass).

use super::plan::{Plan, PlanLink};
use super::vector::{V3, cross_add, dot, load3, v3};
use super::visit::{Pass, Visit, take};
use sinew_core::lanes::{Real, triangle};

/// Upper triangle of the moment block, the mixed block, upper triangle of the force block.
pub(super) const INERTIA: usize = 21;

/// Information of a point's observations on its position.
pub trait Inform<V> {
    /// Information matrix (xx, xy, xz, yy, yz, zz) of point k in the plan's order at the world position `p`, 1/m². Must be `#[inline(always)]`.
    fn information(&self, k: usize, p: V3<V>) -> [V; 6];
}

/// Adds the information of each point to its link.
struct Gather<'a, M, I> {
    inertias: &'a mut [[M; INERTIA]],
    link_of: &'a [usize],
    from: &'a I,
}

impl<V: Real, I: Inform<V>> Visit<V> for Gather<'_, V::Mem, I> {
    #[inline(always)]
    fn point(&mut self, k: usize, p: V3<V>) -> V3<V> {
        add_point::<V>(&mut self.inertias[self.link_of[k]], p, self.from.information(k, p));
        [V::splat(0.0); 3]
    }
}

/// Frames, and the inertia of each link with what is below it.
struct Composite<'a, M> {
    pass: Pass<'a, M>,
    inertias: &'a mut [[M; INERTIA]],
}

impl Plan {
    /// Writes the diagonal of the Gauss–Newton matrix at `q`. `ws` ≥ [`Plan::workspace`].
    #[inline(always)]
    pub fn gauss_newton_diagonal<V: Real>(
        &self,
        q: &[V::Mem],
        ws: &mut [V::Mem],
        diagonal: &mut [V::Mem],
        from: &impl Inform<V>,
    ) {
        let c = self.composite::<V>(q, ws, from);
        let mut entries = diagonal.iter_mut();
        for (link, inertia) in self.links.iter().zip(c.inertias.iter()) {
            for (j, entry) in link.dofs().zip(entries.by_ref()) {
                let (w, v) = self.twist::<V>(link, j, &c.pass);
                quadratic_form(inertia, w, v).store(entry);
            }
        }
    }

    /// Writes the lower triangle of the Gauss–Newton matrix at `q`, row after row; the rest as in [`Plan::gauss_newton_diagonal`].
    #[inline(always)]
    pub fn gauss_newton<V: Real>(&self, q: &[V::Mem], ws: &mut [V::Mem], matrix: &mut [V::Mem], from: &impl Inform<V>) {
        let c = self.composite::<V>(q, ws, from);
        for x in matrix.iter_mut() {
            V::splat(0.0).store(x);
        }
        for (index, link) in self.links.iter().enumerate() {
            for j in link.dofs() {
                let (w, v) = self.twist::<V>(link, j, &c.pass);
                let (moment, force) = wrench::<V>(&c.inertias[index], w, v);
                let mut above = Some(index);
                while let Some(b) = above {
                    let other = &self.links[b];
                    let end = if b == index { j + 1 } else { other.dofs().end };
                    for i in other.first..end {
                        let (w, v) = self.twist::<V>(other, i, &c.pass);
                        (dot(w, moment) + dot(v, force)).store(&mut matrix[triangle(j, i)]);
                    }
                    above = other.parent;
                }
            }
        }
    }

    /// Sums the information of each link's points and of what is below it.
    #[inline(always)]
    fn composite<'a, V: Real>(
        &self,
        q: &[V::Mem],
        mut ws: &'a mut [V::Mem],
        from: &impl Inform<V>,
    ) -> Composite<'a, V::Mem> {
        let inertias: &mut [[V::Mem; INERTIA]] = take(&mut ws, self.links.len());
        let mut pass = self.pass(ws);
        for x in inertias.iter_mut().flatten() {
            V::splat(0.0).store(x);
        }
        let mut gather = Gather { inertias: &mut *inertias, link_of: &self.link_of, from };
        self.forward::<V, true>(q, &mut pass, &mut gather);
        for (index, link) in self.links.iter().enumerate().rev() {
            if let Some(parent) = link.parent {
                let below = inertias[index];
                for (a, b) in inertias[parent].iter_mut().zip(&below) {
                    (V::load(a) + V::load(b)).store(a);
                }
            }
        }
        Composite { pass, inertias }
    }

    /// Angular and linear part of the motion of degree of freedom j of a link.
    #[inline(always)]
    fn twist<V: Real>(&self, link: &PlanLink, j: usize, pass: &Pass<'_, V::Mem>) -> (V3<V>, V3<V>) {
        let zero = [V::splat(0.0); 3];
        let u = load3::<V>(&pass.vectors[self.joints[j].place]);
        if j < link.first + link.translations {
            return (zero, u);
        }
        (u, cross_add(load3::<V>(&pass.vectors[link.origin()]), u, zero))
    }
}

/// Adds `Bᵀ M B` of a point to S.
#[inline(always)]
fn add_point<V: Real>(s: &mut [V::Mem; INERTIA], p: V3<V>, m: [V; 6]) {
    let zero = [V::splat(0.0); 3];
    let rows = [[m[0], m[1], m[2]], [m[1], m[3], m[4]], [m[2], m[4], m[5]]];
    let columns = [cross_add(p, rows[0], zero), cross_add(p, rows[1], zero), cross_add(p, rows[2], zero)];
    let mixed = v3!(I => v3!(J => columns[J][I]));
    let moment = [cross_add(p, mixed[0], zero), cross_add(p, mixed[1], zero), cross_add(p, mixed[2], zero)];
    let upper = |a: [V3<V>; 3]| [a[0][0], a[0][1], a[0][2], a[1][1], a[1][2], a[2][2]];
    let mut add = |at: usize, x: V| (V::load(&s[at]) + x).store(&mut s[at]);
    for (i, x) in upper(moment).into_iter().enumerate() {
        add(i, x);
    }
    for (i, x) in mixed.into_iter().flatten().enumerate() {
        add(6 + i, x);
    }
    for (i, x) in upper(rows).into_iter().enumerate() {
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
