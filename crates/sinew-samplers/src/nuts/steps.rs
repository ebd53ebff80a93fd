//! The two halves of a leapfrog step in whitened momenta, for both metrics, every lane with a step of its own sign and size.
//!
//! With the metric G = A⁻ᵀ A⁻¹ the force is f = Aᵀ ∇ log p(x), kept from step to step, and a step of size ε is p += ε/2 f; x += ε A p; f = Aᵀ ∇ log p(x); p += ε/2 f.

use crate::metric::{Dense, Metric};
use crate::triangular::dot;
use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch};

/// η A of the metric in use.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Steps {
    Components(Vec<f64>),
    Dense(Dense),
}

impl Steps {
    pub(super) fn new(step_size: f64, metric: &Metric) -> Self {
        match metric {
            Metric::Diagonal(curvature) => Self::Components(curvature.iter().map(|h| step_size / h.sqrt()).collect()),
            Metric::Dense(dense) => Self::Dense(dense.clone().scaled(step_size)),
        }
    }

    /// p += s/2 f; x += s η A p, with the signed factors s of the lanes.
    pub(super) fn drift(&self, isa: Isa, factor: &Block, x: &mut [Block], p: &mut [Block], force: &[Block]) {
        match self {
            Self::Components(steps) => dispatch(isa, Drift { steps, factor, x, p, force }),
            Self::Dense(steps) => dispatch(isa, DenseDrift { steps, factor, x, p, force }),
        }
    }

    /// f = η Aᵀ g.
    pub(super) fn force(&self, isa: Isa, gradient: &[Block], force: &mut [Block]) {
        match self {
            Self::Components(steps) => dispatch(isa, Force { steps, gradient, force }),
            Self::Dense(steps) => dispatch(isa, DenseForce { steps, gradient, force }),
        }
    }
}

#[inline(always)]
fn half_kick<V: Real<Mem = Block>>(factor: V, p: &mut [Block], force: &[Block]) {
    let half = factor * V::splat(0.5);
    for (p, f) in p.iter_mut().zip(force) {
        half.fma(V::load(f), V::load(p)).store(p);
    }
}

struct Drift<'a> {
    steps: &'a [f64],
    factor: &'a Block,
    x: &'a mut [Block],
    p: &'a mut [Block],
    force: &'a [Block],
}

impl Kernel<Block> for Drift<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let factor = V::load(self.factor);
        half_kick(factor, self.p, self.force);
        for ((x, p), &step) in self.x.iter_mut().zip(&*self.p).zip(self.steps) {
            (factor * V::splat(step)).fma(V::load(p), V::load(x)).store(x);
        }
    }
}

struct DenseDrift<'a> {
    steps: &'a Dense,
    factor: &'a Block,
    x: &'a mut [Block],
    p: &'a mut [Block],
    force: &'a [Block],
}

impl Kernel<Block> for DenseDrift<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.steps.dim();
        let factor = V::load(self.factor);
        half_kick(factor, self.p, self.force);
        let mut row = &self.steps.rows[..];
        for (i, x) in self.x[..d].iter_mut().enumerate() {
            let (entries, rest) = row.split_at(d - i);
            row = rest;
            let sum: V = dot(entries, &self.p[i..]);
            sum.fma(factor, V::load(x)).store(x);
        }
    }
}

struct Force<'a> {
    steps: &'a [f64],
    gradient: &'a [Block],
    force: &'a mut [Block],
}

impl Kernel<Block> for Force<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        for ((f, g), &step) in self.force.iter_mut().zip(self.gradient).zip(self.steps) {
            (V::splat(step) * V::load(g)).store(f);
        }
    }
}

struct DenseForce<'a> {
    steps: &'a Dense,
    gradient: &'a [Block],
    force: &'a mut [Block],
}

impl Kernel<Block> for DenseForce<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let mut column = &self.steps.columns[..];
        for (j, f) in self.force.iter_mut().enumerate() {
            let (entries, rest) = column.split_at(j + 1);
            column = rest;
            dot::<V>(entries, self.gradient).store(f);
        }
    }
}

/// p += s/2 f; sum += p; writes p·p / 2.
pub(super) struct Arrive<'a> {
    pub(super) factor: &'a Block,
    pub(super) p: &'a mut [Block],
    pub(super) force: &'a [Block],
    pub(super) sum: &'a mut [Block],
    pub(super) kinetic: &'a mut Block,
}

impl Kernel<Block> for Arrive<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let half = V::load(self.factor) * V::splat(0.5);
        let mut square = V::splat(0.0);
        for ((p, f), sum) in self.p.iter_mut().zip(self.force).zip(&mut *self.sum) {
            let momentum = half.fma(V::load(f), V::load(p));
            momentum.store(p);
            (V::load(sum) + momentum).store(sum);
            square = momentum.fma(momentum, square);
        }
        (square * V::splat(0.5)).store(self.kinetic);
    }
}
