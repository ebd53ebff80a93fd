//! Density of a state that action primitives move: all three models of every state before it, summed.
//!
//! With A the F coordinates of the feature vector and R the others, and states s_i of the frame before (i ≤ M) in the clusters k(i),
//!
//! p(x) = 1/(3M) Σ_i N(x_R; s_iR, B_R²) · [N(x_A; m_k, Σ_k) + N(x_A; s_iA + m*_k, Σ*_k) + N(x_A; s_iA, B_A²)].
//!
//! With M = 1 it is the density of a step, with the states of a cloud the prior of a frame. States of one cluster share the products with its factors: L⁻¹ (x_A − m_k) once, and L*⁻¹ x_A once, of which each state's own
//! L*⁻¹ (s_iA + m*_k) is taken off. So a state adds about 2 d operations, a cluster 2 F².

use crate::Error;
use crate::primitives::matched;
use crate::primitives::places::Places;
use crate::primitives::switching::{Factored, Switching};
use core::f64::consts::TAU;
use sinew_core::density::LaneDensity;
use sinew_core::elementary::{exp, ln};
use sinew_core::lanes::{Block, Isa, LANES, Real};
use sinew_core::random::BlockRng;
use std::sync::Arc;

/// States of one cluster.
#[derive(Clone, Debug)]
struct Group {
    cluster: usize,
    /// The states, d numbers each, in the order of the coordinates of the state.
    states: Vec<f64>,
    /// L*⁻¹ (s_A + m* − centre) of each.
    centres: Vec<f64>,
}

/// The density.
#[derive(Clone, Debug)]
pub struct SwitchingMixture {
    switching: Arc<Switching>,
    places: Arc<Places>,
    groups: Vec<Group>,
    /// The M states with their clusters, in the order given.
    origins: Vec<(usize, Vec<f64>)>,
    /// Mean of the states' coordinates A, about which products are taken, so that few digits are lost.
    centre: Vec<f64>,
    /// Diagonal of an upper bound of every component's precision.
    precision_bound: Vec<f64>,
    /// Precision of the Gaussian with the mixture's moments, d × d.
    precision: Vec<f64>,
    /// The logarithm of 1/(3M) times the normalisation of the random walk of R, and of that of all coordinates.
    log_rest: f64,
    log_walk: f64,
}

impl SwitchingMixture {
    /// The density after some states of known clusters.
    pub(crate) fn new(
        switching: Arc<Switching>,
        places: Arc<Places>,
        origins: Vec<(usize, Vec<f64>)>,
    ) -> Result<Self, Error> {
        let (f, count) = (places.covered.len(), origins.len());
        if count == 0 {
            return Err(Error::Shape { name: "states", found: 0, expected: 1 });
        }
        for (_, state) in &origins {
            if let Some(index) = state.iter().position(|x| !x.is_finite()) {
                let (name, value) = ("state", state[index]);
                return Err(Error::OutOfRange { name, index, value, expected: "must be finite" });
            }
        }
        let mean = |j: &usize| origins.iter().map(|(_, state)| state[*j]).sum::<f64>() / count as f64;
        let centre: Vec<f64> = places.covered.iter().map(mean).collect();
        let mut groups: Vec<Group> = Vec::new();
        for (cluster, state) in &origins {
            let at = groups.iter().position(|group| group.cluster == *cluster).unwrap_or_else(|| {
                groups.push(Group { cluster: *cluster, states: Vec::new(), centres: Vec::new() });
                groups.len() - 1
            });
            let step = &switching.step[*cluster];
            let moved = |i: usize| state[places.covered[i]] + step.mean[i] - centre[i];
            let whitened = (0..f).map(|i| (0..=i).map(|j| step.whitening[i * f + j] * moved(j)).sum::<f64>());
            groups[at].centres.extend(whitened);
            groups[at].states.extend_from_slice(state);
        }
        let log_norm = |j: &usize| -0.5 * TAU.ln() - places.sd[*j].ln();
        let log_rest = -(3.0 * count as f64).ln() + places.rest.iter().map(log_norm).sum::<f64>();
        let log_walk = log_rest + places.covered.iter().map(log_norm).sum::<f64>();
        let precision_bound = precision_bound(&switching, &places, &groups);
        let precision = matched::gaussian(&switching, &places, &origins)?.precision().to_vec();
        Ok(Self { switching, places, groups, origins, centre, precision_bound, precision, log_rest, log_walk })
    }

    /// Diagonal of an upper bound of the precision of every component, and so of the curvature of the mixture.
    pub(crate) fn precision_bound(&self) -> &[f64] {
        &self.precision_bound
    }

    /// Precision of the Gaussian with the mixture's moments, d × d: for metrics. In units of the bound, which a narrow cluster sets, trajectories would be tens of times too short for all others.
    pub(crate) fn precision(&self) -> &[f64] {
        &self.precision
    }

    /// Draws eight states, one from each of eight states in turn, by a model drawn for each.
    pub(crate) fn sample_block(&self, isa: Isa, block: usize, out: &mut [Block], rng: &mut BlockRng) {
        let origin = |lane: usize| &self.origins[(block * LANES + lane) % self.origins.len()];
        let own: Vec<Block> = self.places.covered.iter().map(|&j| lanes(|lane| origin(lane).1[j])).collect();
        let choices = Switching::branches(core::array::from_fn(|lane| origin(lane).0), rng);
        let mut moved = vec![Block::ZERO; own.len()];
        self.switching.draw_block(&choices, &own, &mut moved, rng);
        rng.fill_normal(isa, out);
        for &j in &self.places.rest {
            let noise = out[j].0;
            out[j] = lanes(|lane| origin(lane).1[j] + self.places.sd[j] * noise[lane]);
        }
        for (&j, moved) in self.places.covered.iter().zip(moved) {
            out[j] = moved;
        }
    }
}

fn lanes(value: impl Fn(usize) -> f64) -> Block {
    Block(core::array::from_fn(value))
}

/// For a positive definite P and scales t_j = √P_jj of the largest, P ≤ diag(Σ_l |P_jl| t_j / t_l) (Gershgorin); of all components the largest entry.
fn precision_bound(switching: &Switching, places: &Places, groups: &[Group]) -> Vec<f64> {
    let f = places.covered.len();
    let mut bound: Vec<f64> = places.inverse_sd.iter().map(|inverse| inverse * inverse).collect();
    let factors = || groups.iter().flat_map(|group| [&switching.next[group.cluster], &switching.step[group.cluster]]);
    let precisions: Vec<Vec<f64>> = factors().map(|factor| precision(factor, f)).collect();
    let largest = |j: usize| precisions.iter().map(|p| p[j * (f + 1)]).fold(0.0, f64::max).sqrt();
    let scales: Vec<f64> = (0..f).map(largest).collect();
    for p in &precisions {
        for (j, &coordinate) in places.covered.iter().enumerate() {
            let sum: f64 = (0..f).map(|l| p[j * f + l].abs() * scales[j] / scales[l]).sum();
            bound[coordinate] = bound[coordinate].max(sum);
        }
    }
    bound
}

/// Wᵀ W of a whitening W.
fn precision(factor: &Factored, f: usize) -> Vec<f64> {
    let w = &factor.whitening;
    (0..f * f).map(|k| (0..f).map(|i| w[i * f + k / f] * w[i * f + k % f]).sum()).collect()
}

/// Writes W (x − centre) to `out`.
#[inline(always)]
fn whiten<V: Real>(whitening: &[f64], x: &[V::Mem], places: &[usize], centre: &[f64], out: &mut [V::Mem]) {
    let f = places.len();
    for i in 0..f {
        let row = &whitening[i * f..i * f + i + 1];
        let mut sum = V::splat(0.0);
        for j in 0..row.len() {
            sum = (V::load(&x[places[j]]) - V::splat(centre[j])).fma(V::splat(row[j]), sum);
        }
        sum.store(&mut out[i]);
    }
}

/// Takes Wᵀ y off the gradient at `places`.
#[inline(always)]
fn pull_back<V: Real>(whitening: &[f64], y: &[V::Mem], places: &[usize], grad: &mut [V::Mem]) {
    let f = places.len();
    for i in 0..f {
        let (row, y) = (&whitening[i * f..i * f + i + 1], V::load(&y[i]));
        for j in 0..row.len() {
            let slot = &mut grad[places[j]];
            y.fnma(V::splat(row[j]), V::load(slot)).store(slot);
        }
    }
}

/// Σ ((x_j − s_j) / B_j)² over some coordinates.
#[inline(always)]
fn scaled_square<V: Real>(x: &[V::Mem], state: &[f64], coordinates: &[usize], inverse_sd: &[f64]) -> V {
    let mut sum = V::splat(0.0);
    for &j in coordinates {
        let e = (V::load(&x[j]) - V::splat(state[j])) * V::splat(inverse_sd[j]);
        sum = e.fma(e, sum);
    }
    sum
}

impl SwitchingMixture {
    /// Writes the logarithms of the terms, three a state, group after group, and to `white` L⁻¹ (x_A − m) and L*⁻¹ (x_A − centre) of each group. The largest is returned.
    #[inline(always)]
    fn terms<V: Real>(&self, x: &[V::Mem], terms: &mut [V::Mem], white: &mut [V::Mem]) -> V {
        let Places { covered, rest, inverse_sd, .. } = &*self.places;
        let (d, f) = (inverse_sd.len(), covered.len());
        let half = V::splat(-0.5);
        let lost = V::splat(f64::MIN);
        let (mut largest, mut n) = (lost, 0);
        for (group, white) in self.groups.iter().zip(white.chunks_exact_mut(2 * f)) {
            let (next, step) = (&self.switching.next[group.cluster], &self.switching.step[group.cluster]);
            let (y, z) = white.split_at_mut(f);
            whiten::<V>(&next.whitening, x, covered, &next.mean, y);
            whiten::<V>(&step.whitening, x, covered, &self.centre, z);
            let mut from_next = V::splat(0.0);
            for y in y.iter() {
                from_next = V::load(y).fma(V::load(y), from_next);
            }
            for (state, centre) in group.states.chunks_exact(d).zip(group.centres.chunks_exact(f)) {
                let away = scaled_square::<V>(x, state, rest, inverse_sd);
                let walk = away + scaled_square::<V>(x, state, covered, inverse_sd);
                let mut from_step = V::splat(0.0);
                for i in 0..f {
                    let e = V::load(&z[i]) - V::splat(centre[i]);
                    from_step = e.fma(e, from_step);
                }
                let values = [
                    (from_next + away).fma(half, V::splat(self.log_rest + next.log_norm)),
                    (from_step + away).fma(half, V::splat(self.log_rest + step.log_norm)),
                    walk.fma(half, V::splat(self.log_walk)),
                ];
                let mut branch = 0;
                while branch < 3 {
                    // Squares that overflow count as no density.
                    let value = values[branch].select_gt(f64::MIN, values[branch], lost);
                    largest = largest.max(value);
                    value.store(&mut terms[n + branch]);
                    branch += 1;
                }
                n += 3;
            }
        }
        largest
    }

    /// Writes the gradient; `shares` are the terms as shares of the density, `pull` is scratch of F.
    #[inline(always)]
    fn gradient<V: Real>(
        &self,
        x: &[V::Mem],
        shares: &[V::Mem],
        white: &mut [V::Mem],
        pull: &mut [V::Mem],
        grad: &mut [V::Mem],
    ) {
        let Places { covered, rest, inverse_sd, .. } = &*self.places;
        let (d, f) = (inverse_sd.len(), covered.len());
        for g in &mut grad[..d] {
            V::splat(0.0).store(g);
        }
        let mut n = 0;
        for (group, white) in self.groups.iter().zip(white.chunks_exact_mut(2 * f)) {
            let (y, z) = white.split_at_mut(f);
            let mut from_cluster = V::splat(0.0);
            for p in pull.iter_mut() {
                V::splat(0.0).store(p);
            }
            for (state, centre) in group.states.chunks_exact(d).zip(group.centres.chunks_exact(f)) {
                let [next, step, walk] = [V::load(&shares[n]), V::load(&shares[n + 1]), V::load(&shares[n + 2])];
                from_cluster = from_cluster + next;
                for i in 0..f {
                    step.fma(V::load(&z[i]) - V::splat(centre[i]), V::load(&pull[i])).store(&mut pull[i]);
                }
                add_walk::<V>(walk, x, state, covered, inverse_sd, grad);
                add_walk::<V>(next + step + walk, x, state, rest, inverse_sd, grad);
                n += 3;
            }
            for y in y.iter_mut() {
                (V::load(y) * from_cluster).store(y);
            }
            pull_back::<V>(&self.switching.next[group.cluster].whitening, y, covered, grad);
            pull_back::<V>(&self.switching.step[group.cluster].whitening, pull, covered, grad);
        }
    }
}

/// Adds share · (s − x) / B² at some coordinates of the gradient.
#[inline(always)]
fn add_walk<V: Real>(
    share: V,
    x: &[V::Mem],
    state: &[f64],
    coordinates: &[usize],
    inverse_sd: &[f64],
    grad: &mut [V::Mem],
) {
    for &j in coordinates {
        let pull = (V::splat(state[j]) - V::load(&x[j])) * V::splat(inverse_sd[j] * inverse_sd[j]);
        share.fma(pull, V::load(&grad[j])).store(&mut grad[j]);
    }
}

impl LaneDensity for SwitchingMixture {
    fn dim(&self) -> usize {
        self.places.sd.len()
    }
    fn workspace(&self) -> usize {
        3 * self.origins.len() + (2 * self.groups.len() + 1) * self.centre.len()
    }
    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V {
        let (f, d) = (self.centre.len(), self.places.sd.len());
        let x = &x[..d];
        let (terms, rest) = ws.split_at_mut(3 * self.origins.len());
        let (pull, white) = rest.split_at_mut(f);
        let white = &mut white[..2 * self.groups.len() * f];
        let largest = self.terms::<V>(x, terms, white);
        let mut sum = V::splat(0.0);
        for term in terms.iter_mut() {
            let share = exp(V::load(term) - largest);
            sum = sum + share;
            share.store(term);
        }
        if GRAD {
            let scale = V::splat(1.0) / sum;
            for term in terms.iter_mut() {
                (V::load(term) * scale).store(term);
            }
            self.gradient::<V>(x, terms, white, pull, grad);
        }
        let value = largest + ln(sum);
        // All terms lost: as far from every component as numbers reach.
        largest.select_gt(f64::MIN, value, V::splat(f64::NEG_INFINITY))
    }
}
