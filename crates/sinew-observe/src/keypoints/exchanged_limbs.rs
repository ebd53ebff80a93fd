//! Limbs of which a detector may have exchanged left and right.
//!
//! Detectors exchange whole limbs. In a camera and frame with the keypoints y of a pair of limbs, each with a partner k̄ on the other side,
//!
//! ```text
//! p(y | s) = (1 − q) Π p_k(y_k | s) + q Π p_k̄(y_k | s)
//! ```
//!
//! with q the camera's probability of it and p_k the density of a sighting of point k ([`crate::KeypointModel`]). The gradient weighs the forces of both ways by how probable each is at the state, and so does the Gauss–Newton matrix.
//!
//! Where one way is out of the question at the predicted pose (less than e⁻¹⁸ to one), the pair's sightings are ordinary ones. What is left are *doubts*; they cost no projection more.

use crate::cameras::lane_projection::LaneCamera;
use crate::cameras::lens::Distort;
use crate::keypoints::sighting::{Noise, Sighting};
use sinew_body::kinematics::{Pass, Plan, Visit};
use sinew_core::elementary::{exp, ln};
use sinew_core::lanes::Real;

/// Log odds of exchanged sides below which they are out of the question.
pub(crate) const LEAST: f64 = -18.0;

/// A point of a limb in doubt, in the camera of the doubt.
#[derive(Clone, Debug)]
pub(crate) struct Member {
    /// Its place in the plan's order.
    pub point: usize,
    /// Which doubt.
    pub doubt: usize,
    /// The keypoint of its own name.
    pub straight: Option<Sighting>,
    /// The keypoint of its partner's name.
    pub crossed: Option<Sighting>,
}

/// Pairs of limbs in doubt in a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Doubts {
    /// Log odds of exchanged sides where all keypoints lie on their points, doubt by doubt.
    log_odds: Vec<f64>,
    /// In the plan's order.
    members: Vec<Member>,
    /// Members of point k: `members[first[k]..first[k + 1]]`.
    first: Vec<usize>,
}

/// What an evaluation keeps of the doubts, in a caller's workspace.
pub(crate) struct Scratch<'a, M> {
    /// For each doubt the products of its factors, as named and exchanged; once it is settled the probability that sides are exchanged comes first.
    pub products: &'a mut [[M; 2]],
    /// For each member its position, and the forces on it, as named and exchanged.
    kept: &'a mut [[M; KEPT]],
}

/// Numbers kept of a member.
const KEPT: usize = 9;

impl Doubts {
    /// Doubts with these log odds and members, for a plan of that many points.
    pub fn new(log_odds: Vec<f64>, mut members: Vec<Member>, points: usize) -> Self {
        members.sort_by_key(|member| (member.point, member.doubt));
        let first = (0..=points).map(|k| members.partition_point(|member| member.point < k)).collect();
        Self { log_odds, members, first }
    }

    pub const fn is_empty(&self) -> bool {
        self.log_odds.is_empty()
    }

    /// Numbers (or blocks) of scratch.
    pub const fn workspace(&self) -> usize {
        2 * self.log_odds.len() + KEPT * self.members.len()
    }

    pub fn scratch<'a, M>(&self, ws: &'a mut [M]) -> Scratch<'a, M> {
        let (products, kept) = ws.split_at_mut(2 * self.log_odds.len());
        Scratch { products: products.as_chunks_mut().0, kept: kept.as_chunks_mut().0 }
    }

    /// Members of a point in the plan's order.
    #[inline(always)]
    pub fn members_of(&self, k: usize) -> &[Member] {
        if self.is_empty() { &[] } else { &self.members[self.first[k]..self.first[k + 1]] }
    }

    /// Multiplies the errors of all members; says how many keypoints there are.
    pub fn broaden(&mut self, noise: Noise, factor: f64) -> usize {
        let sightings = self.members.iter_mut().flat_map(|member| [&mut member.straight, &mut member.crossed]);
        sightings.flatten().for_each(|sighting| noise.broaden(sighting, factor));
        self.members.iter().filter(|member| member.straight.is_some()).count()
    }

    /// The log density of all doubts, from their products; leaves the probability that sides are exchanged.
    #[inline(always)]
    pub fn settle<V: Real>(&self, noise: Noise, scratch: &mut Scratch<'_, V::Mem>) -> V {
        let s = |x: f64| V::splat(x);
        let mut value = s(0.0);
        for (log_odds, products) in self.log_odds.iter().zip(scratch.products.iter_mut()) {
            let [straight, crossed] = [0, 1].map(|way: usize| ln(V::load(&products[way])) * s(noise.exponent()));
            let crossed = crossed + s(*log_odds);
            let away = crossed - straight;
            let less = exp(-away.max(-away));
            let likelier = s(1.0) / (s(1.0) + less);
            away.select_gt(0.0, likelier, less * likelier).store(&mut products[0]);
            value = value + straight.max(crossed) + ln(s(1.0) + less);
        }
        value
    }

    /// Puts the forces of both ways on the points of all members, each weighed by how probable it is.
    #[inline(always)]
    pub fn push<V: Real>(&self, scratch: &Scratch<'_, V::Mem>, plan: &Plan, pass: &mut Pass<'_, V::Mem>) {
        for (member, kept) in self.members.iter().zip(scratch.kept.iter()) {
            let exchanged = V::load(&scratch.products[member.doubt][0]);
            let at = |first: usize| [0, 1, 2].map(|axis: usize| V::load(&kept[first + axis]));
            let ([px, py, pz], straight, crossed) = (at(0), at(3), at(6));
            let force = [0, 1, 2].map(|k: usize| exchanged.fma(crossed[k] - straight[k], straight[k]));
            plan.push::<V>(pass, member.point, [px, py, pz], force);
        }
    }
}

/// A visitor that wants nothing.
pub(crate) struct Nothing;

impl<V: Real> Visit<V> for Nothing {
    #[inline(always)]
    fn point(&mut self, _k: usize, _p: [V; 3]) -> [V; 3] {
        [V::splat(0.0); 3]
    }
}

/// Collects what doubts need on a walk, beside what others want of it.
pub(crate) struct Exchanging<'a, 'b, M, L, I, const GRAD: bool> {
    pub doubts: &'a Doubts,
    pub noise: Noise,
    pub cameras: &'a [LaneCamera<L>],
    pub scratch: &'a mut Scratch<'b, M>,
    pub others: &'a mut I,
}

impl<M, L, I, const GRAD: bool> Exchanging<'_, '_, M, L, I, GRAD> {
    /// Empty products.
    #[inline(always)]
    pub fn begin<V: Real<Mem = M>>(&mut self) {
        for product in self.scratch.products.iter_mut().flatten() {
            V::splat(1.0).store(product);
        }
    }
}

impl<V: Real, L: Distort, I: Visit<V>, const GRAD: bool> Visit<V> for Exchanging<'_, '_, V::Mem, L, I, GRAD> {
    #[inline(always)]
    fn point(&mut self, k: usize, p: [V; 3]) -> [V; 3] {
        let doubts = self.doubts;
        let (from, to) = (doubts.first[k], doubts.first[k + 1]);
        for (member, kept) in doubts.members[from..to].iter().zip(&mut self.scratch.kept[from..to]) {
            for (x, place) in p.iter().zip(kept.iter_mut()) {
                x.store(place);
            }
            for (way, sighting) in [&member.straight, &member.crossed].into_iter().enumerate() {
                let mut force = [V::splat(0.0); 3];
                if let Some(sighting) = sighting {
                    let camera = &self.cameras[sighting.camera];
                    let shown = camera.show::<V, GRAD>(p);
                    let [r0, r1] = camera.residual(&shown, sighting.pixel);
                    let (factor, weight) = self.noise.factor(sighting, [r0, r1], shown.depth);
                    let product = &mut self.scratch.products[member.doubt][way];
                    (V::load(product) * factor).store(product);
                    if GRAD {
                        force = camera.pull(&shown, [weight * r0, weight * r1]);
                    }
                }
                for (axis, x) in force.into_iter().enumerate() {
                    x.store(&mut kept[3 * (way + 1) + axis]);
                }
            }
        }
        self.others.point(k, p)
    }
}
