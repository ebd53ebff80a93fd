//! Leapfrog integrator of Hamiltonian dynamics for a block of eight chains, in a diagonal or a dense metric.
//!
//! With the metric G = A⁻ᵀ A⁻¹ (see [`crate::metric`]), unit-variance momenta and a step η, a kick is p += s η Aᵀ ∇ log p(x) and a drift is x += s η A p, where every lane has a signed factor s of its own.
//! One step (Duane et al. 1987; Neal 2011) is half a kick, a drift, and half a kick from where that led:
//!
//! - [`Leapfrog::trajectory`] makes L steps in which adjacent half kicks are fused, each from the gradient;
//! - `Leapfrog::step` makes one and keeps the force η Aᵀ ∇ log p(x), since in a no-U-turn tree a lane may change its direction, or stand still, after any step.
//!
//! A metric is what its kick, its drift and its force are; both ways are put together from these. Nothing is allocated.

use crate::Error;
use crate::metric::{Dense, Metric};
use crate::triangular::dot;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch};

/// The matrix η A of the metric in use.
#[derive(Clone, Debug, PartialEq)]
enum Steps {
    Diagonal(Components),
    Dense(Dense),
}

/// Does the same with either kind of steps.
macro_rules! either {
    ($steps:expr, $whitening:ident => $action:expr) => {
        match $steps {
            Steps::Diagonal($whitening) => $action,
            Steps::Dense($whitening) => $action,
        }
    };
}

/// Step η and metric of the trajectories; fixed while chains run.
#[derive(Clone, Debug, PartialEq)]
pub struct Leapfrog {
    steps: Steps,
    isa: Isa,
}

/// States of eight chains with their momenta and the gradients of the log density there, d blocks each.
#[derive(Debug)]
pub struct PhasePoint<'a> {
    /// x.
    pub position: &'a mut [Block],
    /// p.
    pub momentum: &'a mut [Block],
    /// ∇ log p(x).
    pub gradient: &'a mut [Block],
}

/// Where a trajectory ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End {
    /// Log density of the last state.
    pub log_density: Block,
    /// Kinetic energy p·p / 2 of the last momentum.
    pub kinetic: Block,
    /// 0 where every log density on the way was finite, else NaN.
    pub broken: Block,
}

/// What `Leapfrog::step` moves: states, momenta, the forces there and the sums of the momenta so far; with scratch for a gradient, and the target's.
pub(crate) struct Moving<'a> {
    pub(crate) position: &'a mut [Block],
    pub(crate) momentum: &'a mut [Block],
    pub(crate) force: &'a mut [Block],
    pub(crate) sum: &'a mut [Block],
    pub(crate) gradient: &'a mut [Block],
    pub(crate) workspace: &'a mut [Block],
}

impl Leapfrog {
    /// Steps η A for a metric.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the step size and each curvature are positive and finite and there is at least one coordinate.
    pub fn new(step_size: f64, metric: &Metric, isa: Isa) -> Result<Self, Error> {
        positive("step size", step_size)?;
        let steps = match metric {
            Metric::Diagonal(curvature) => {
                positive("number of curvatures", curvature.len() as f64)?;
                curvature.iter().try_for_each(|&h| positive("curvature", h))?;
                Steps::Diagonal(Components(curvature.iter().map(|h| step_size / h.sqrt()).collect()))
            }
            Metric::Dense(dense) => Steps::Dense(dense.clone().scaled(step_size)),
        };
        Ok(Self { steps, isa })
    }

    /// Dimension of the states.
    #[must_use]
    pub fn dim(&self) -> usize {
        match &self.steps {
            Steps::Diagonal(components) => components.0.len(),
            Steps::Dense(dense) => dense.dim(),
        }
    }

    /// Instruction set of the kernels.
    #[must_use]
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// A trajectory of `steps` steps, η being multiplied by the lane's `factor`. `workspace` is the target's.
    ///
    /// # Panics
    /// When the metric has another dimension than the states: coordinates without a step would never move.
    pub fn trajectory<T: GradLogDensity + ?Sized>(
        &self,
        target: &T,
        steps: usize,
        factor: &Block,
        point: PhasePoint<'_>,
        workspace: &mut [Block],
    ) -> End {
        let PhasePoint { position, momentum, gradient } = point;
        assert_eq!(self.dim(), position.len(), "dimension of the metric and of the states");
        let (matrix, isa) = (&self.steps, self.isa);
        let mut log_density = Block::ZERO;
        let mut broken = Block::ZERO;
        for step in 0..steps {
            let size = if step == 0 { 0.5 } else { 1.0 };
            either!(matrix, whitening => dispatch(isa, KickDrift { whitening, size, factor, position, momentum, gradient }));
            log_density = target.log_density_grad_block(position, gradient, workspace);
            for (b, l) in broken.0.iter_mut().zip(log_density.0) {
                *b += 0.0 * l;
            }
        }
        either!(matrix, whitening => dispatch(isa, LastKick { whitening, size: 0.5, factor, momentum, gradient }));
        End { log_density, kinetic: kinetic(isa, momentum), broken }
    }

    /// f = η Aᵀ ∇ log p(x).
    pub(crate) fn force(&self, gradient: &[Block], force: &mut [Block]) {
        either!(&self.steps, whitening => dispatch(self.isa, Force { whitening, gradient, force }));
    }

    /// One step of every lane by its signed `factor`, 0 where it stands still; the new momenta are added to their sums. Log density and kinetic energy p·p / 2 of the new states.
    pub(crate) fn step<T: GradLogDensity + ?Sized>(
        &self,
        target: &T,
        factor: &Block,
        moving: Moving<'_>,
    ) -> (Block, Block) {
        let Moving { position, momentum, force, sum, gradient, workspace } = moving;
        either!(&self.steps, whitening => dispatch(self.isa, Depart { whitening, factor, position, momentum, force }));
        let log_density = target.log_density_grad_block(position, gradient, workspace);
        self.force(gradient, force);
        let mut kinetic = Block::ZERO;
        dispatch(self.isa, Arrive { factor, momentum, force, sum, kinetic: &mut kinetic });
        (log_density, kinetic)
    }
}

fn positive(name: &'static str, value: f64) -> Result<(), Error> {
    let expected = "must be positive and finite";
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(Error::OutOfRange { name, value, expected }) }
}

/// Refuses a jitter outside of [0, 1).
pub(crate) fn check_jitter(jitter: f64) -> Result<(), Error> {
    let expected = "must be in [0, 1)";
    if (0.0..1.0).contains(&jitter) {
        Ok(())
    } else {
        Err(Error::OutOfRange { name: "jitter", value: jitter, expected })
    }
}

/// p·p / 2.
pub(crate) fn kinetic(isa: Isa, momentum: &[Block]) -> Block {
    let mut energy = Block::ZERO;
    dispatch(isa, Kinetic { momentum, energy: &mut energy });
    energy
}

/// Diagonal of η A.
#[derive(Clone, Debug, PartialEq)]
struct Components(Vec<f64>);

/// What trajectories need of a matrix η A.
trait Whitening {
    /// p += s η Aᵀ g.
    fn kick<V: Real<Mem = Block>>(&self, s: V, gradient: &[Block], momentum: &mut [Block]);

    /// x += s η A p.
    fn drift<V: Real<Mem = Block>>(&self, s: V, momentum: &[Block], position: &mut [Block]);

    /// f = η Aᵀ g.
    fn force<V: Real<Mem = Block>>(&self, gradient: &[Block], force: &mut [Block]);

    /// A kick of `size` times s, then a drift.
    #[inline(always)]
    fn kick_drift<V: Real<Mem = Block>>(
        &self,
        size: V,
        s: V,
        gradient: &[Block],
        momentum: &mut [Block],
        position: &mut [Block],
    ) {
        self.kick(s * size, gradient, momentum);
        self.drift(s, momentum, position);
    }
}

impl Whitening for Components {
    #[inline(always)]
    fn kick<V: Real<Mem = Block>>(&self, s: V, gradient: &[Block], momentum: &mut [Block]) {
        for ((p, g), &step) in momentum.iter_mut().zip(gradient).zip(&self.0) {
            (V::splat(step) * s).fma(V::load(g), V::load(p)).store(p);
        }
    }

    #[inline(always)]
    fn drift<V: Real<Mem = Block>>(&self, s: V, momentum: &[Block], position: &mut [Block]) {
        for ((x, p), &step) in position.iter_mut().zip(momentum).zip(&self.0) {
            (V::splat(step) * s).fma(V::load(p), V::load(x)).store(x);
        }
    }

    #[inline(always)]
    fn force<V: Real<Mem = Block>>(&self, gradient: &[Block], force: &mut [Block]) {
        for ((f, g), &step) in force.iter_mut().zip(gradient).zip(&self.0) {
            (V::splat(step) * V::load(g)).store(f);
        }
    }

    /// In one pass, since coordinates do not mix.
    #[inline(always)]
    fn kick_drift<V: Real<Mem = Block>>(
        &self,
        size: V,
        s: V,
        gradient: &[Block],
        momentum: &mut [Block],
        position: &mut [Block],
    ) {
        let d = self.0.len();
        let (x, p, g) = (&mut position[..d], &mut momentum[..d], &gradient[..d]);
        for j in 0..d {
            let step = V::splat(self.0[j]) * s;
            let kicked = (step * size).fma(V::load(&g[j]), V::load(&p[j]));
            kicked.store(&mut p[j]);
            step.fma(kicked, V::load(&x[j])).store(&mut x[j]);
        }
    }
}

impl Whitening for Dense {
    #[inline(always)]
    fn kick<V: Real<Mem = Block>>(&self, s: V, gradient: &[Block], momentum: &mut [Block]) {
        let (momentum, gradient) = (&mut momentum[..self.dim()], &gradient[..self.dim()]);
        let mut column = &self.columns[..];
        for (j, p) in momentum.iter_mut().enumerate() {
            let (entries, rest) = column.split_at(j + 1);
            column = rest;
            let sum: V = dot(entries, gradient);
            sum.fma(s, V::load(p)).store(p);
        }
    }

    #[inline(always)]
    fn drift<V: Real<Mem = Block>>(&self, s: V, momentum: &[Block], position: &mut [Block]) {
        let d = self.dim();
        let (momentum, position) = (&momentum[..d], &mut position[..d]);
        let mut row = &self.rows[..];
        for (i, x) in position.iter_mut().enumerate() {
            let (entries, rest) = row.split_at(d - i);
            row = rest;
            let sum: V = dot(entries, &momentum[i..]);
            sum.fma(s, V::load(x)).store(x);
        }
    }

    #[inline(always)]
    fn force<V: Real<Mem = Block>>(&self, gradient: &[Block], force: &mut [Block]) {
        let mut column = &self.columns[..];
        for (j, f) in force.iter_mut().enumerate() {
            let (entries, rest) = column.split_at(j + 1);
            column = rest;
            dot::<V>(entries, gradient).store(f);
        }
    }
}

/// A kick of the given size from the gradient, then a drift.
struct KickDrift<'a, W> {
    whitening: &'a W,
    size: f64,
    factor: &'a Block,
    position: &'a mut [Block],
    momentum: &'a mut [Block],
    gradient: &'a [Block],
}

impl<W: Whitening> Kernel<Block> for KickDrift<'_, W> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let (size, factor) = (V::splat(self.size), V::load(self.factor));
        self.whitening.kick_drift(size, factor, self.gradient, self.momentum, self.position);
    }
}

/// The kick that closes a trajectory.
struct LastKick<'a, W> {
    whitening: &'a W,
    size: f64,
    factor: &'a Block,
    momentum: &'a mut [Block],
    gradient: &'a [Block],
}

impl<W: Whitening> Kernel<Block> for LastKick<'_, W> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        self.whitening.kick(V::load(self.factor) * V::splat(self.size), self.gradient, self.momentum);
    }
}

/// Half a kick from the force, then a drift.
struct Depart<'a, W> {
    whitening: &'a W,
    factor: &'a Block,
    position: &'a mut [Block],
    momentum: &'a mut [Block],
    force: &'a [Block],
}

impl<W: Whitening> Kernel<Block> for Depart<'_, W> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let factor = V::load(self.factor);
        let half = factor * V::splat(0.5);
        for (p, f) in self.momentum.iter_mut().zip(self.force) {
            half.fma(V::load(f), V::load(p)).store(p);
        }
        self.whitening.drift(factor, self.momentum, self.position);
    }
}

struct Force<'a, W> {
    whitening: &'a W,
    gradient: &'a [Block],
    force: &'a mut [Block],
}

impl<W: Whitening> Kernel<Block> for Force<'_, W> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        self.whitening.force::<V>(self.gradient, self.force);
    }
}

/// Half a kick from the force; adds the momenta to their sums and writes p·p / 2, in one pass.
struct Arrive<'a> {
    factor: &'a Block,
    momentum: &'a mut [Block],
    force: &'a [Block],
    sum: &'a mut [Block],
    kinetic: &'a mut Block,
}

impl Kernel<Block> for Arrive<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let half = V::load(self.factor) * V::splat(0.5);
        let mut square = V::splat(0.0);
        for ((p, f), sum) in self.momentum.iter_mut().zip(self.force).zip(&mut *self.sum) {
            let momentum = half.fma(V::load(f), V::load(p));
            momentum.store(p);
            (V::load(sum) + momentum).store(sum);
            square = momentum.fma(momentum, square);
        }
        (square * V::splat(0.5)).store(self.kinetic);
    }
}

struct Kinetic<'a> {
    momentum: &'a [Block],
    energy: &'a mut Block,
}

impl Kernel<Block> for Kinetic<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let mut square = V::splat(0.0);
        for p in self.momentum {
            let p = V::load(p);
            square = p.fma(p, square);
        }
        (square * V::splat(0.5)).store(self.energy);
    }
}
