//! Hybrid (Hamiltonian) Monte Carlo over a block of eight chains in lockstep.
//!
//! With the potential E(s) = −log p(s), component steps ε_j = η / √h_j (Choo & Fleet 2001, eq. 17) and unit-variance momenta (Duane et al. 1987; Neal 2011), one update is
//!
//! 1. p ~ N(0, I), H₀ = E(s) + p·p / 2;
//! 2. L leapfrog steps: p_j −= ε_j / 2 ∂E/∂s_j; s_j += ε_j p_j; p_j −= ε_j / 2 ∂E/∂s_j (eqs. 13–15), adjacent half steps fused;
//! 3. accept with probability min(1, exp(H₀ − H₁)) (eq. 16), else keep the old state, which counts again as a draw.
//!
//! This equals a mass matrix diag(η² / ε_j²) with the unit step η. The curvature h must not depend on the state. With `jitter` a > 0 the steps of one trajectory are multiplied by a number uniform in
//! (1 − a, 1 + a), one for each chain; it does not depend on the state either, so the target stays invariant.
//!
//! A trajectory that meets a log density or gradient that is not finite, or ends with H₁ − H₀ > 1000, is rejected and counted as divergent. State, log density and gradient of the current states are cached
//! in [`Chains`], so that an update costs L gradients; it allocates nothing.

use crate::Error;
use crate::metric::{Dense, Metric};
use crate::triangular::dot;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};
use sinew_core::random::BlockRng;

/// An energy error above this is a divergence.
pub const DIVERGENCE: f64 = 1000.0;

/// Steps of the integrator; fixed while chains run.
#[derive(Clone, Debug, PartialEq)]
pub struct Hmc {
    steps: Steps,
    leapfrog_steps: usize,
    jitter: f64,
    isa: Isa,
}

/// The matrix η A of the metric in use.
#[derive(Clone, Debug, PartialEq)]
enum Steps {
    Components(Vec<f64>),
    Dense(Dense),
}

impl Hmc {
    /// Steps for a metric.
    ///
    /// # Errors
    /// As [`Hmc::new`].
    pub fn with_metric(
        step_size: f64,
        metric: &Metric,
        leapfrog_steps: usize,
        jitter: f64,
        isa: Isa,
    ) -> Result<Self, Error> {
        match metric {
            Metric::Diagonal(curvature) => Self::new(step_size, curvature, leapfrog_steps, jitter, isa),
            Metric::Dense(dense) => {
                let unit = Self::new(step_size, &[1.0], leapfrog_steps, jitter, isa)?;
                Ok(Self { steps: Steps::Dense(dense.clone().scaled(step_size)), ..unit })
            }
        }
    }

    /// Component steps η / √h_j for the `curvature` h.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the step size and each curvature are positive and finite, there is at least one curvature and one step, and 0 ≤ jitter < 1.
    pub fn new(step_size: f64, curvature: &[f64], leapfrog_steps: usize, jitter: f64, isa: Isa) -> Result<Self, Error> {
        let positive = |name, value: f64| {
            let expected = "must be positive and finite";
            if value > 0.0 && value.is_finite() { Ok(()) } else { Err(Error::OutOfRange { name, value, expected }) }
        };
        positive("step size", step_size)?;
        positive("number of leapfrog steps", leapfrog_steps as f64)?;
        positive("number of curvatures", curvature.len() as f64)?;
        for &h in curvature {
            positive("curvature", h)?;
        }
        if !(0.0..1.0).contains(&jitter) {
            return Err(Error::OutOfRange { name: "jitter", value: jitter, expected: "must be in [0, 1)" });
        }
        let steps = Steps::Components(curvature.iter().map(|h| step_size / h.sqrt()).collect());
        Ok(Self { steps, leapfrog_steps, jitter, isa })
    }

    /// Dimension of the states that it moves.
    #[must_use]
    pub fn dim(&self) -> usize {
        match &self.steps {
            Steps::Components(steps) => steps.len(),
            Steps::Dense(dense) => dense.dim(),
        }
    }

    /// Leapfrog steps L of a trajectory.
    #[must_use]
    pub fn leapfrog_steps(&self) -> usize {
        self.leapfrog_steps
    }
}

/// Eight chains: their states with the log densities and gradients there.
#[derive(Clone, Debug, PartialEq)]
pub struct Chains {
    /// States, one block a dimension.
    pub position: Vec<Block>,
    /// Log density of each state.
    pub log_density: Block,
    /// Its gradient.
    pub gradient: Vec<Block>,
}

impl Chains {
    /// Evaluates the target at the starting states.
    ///
    /// # Errors
    /// [`Error::BadStart`] where the log density is not finite.
    pub fn new<T: GradLogDensity + ?Sized>(target: &T, position: Vec<Block>) -> Result<Self, Error> {
        let mut gradient = vec![Block::ZERO; position.len()];
        let log_density =
            target.log_density_grad_block(&position, &mut gradient, &mut vec![Block::ZERO; target.workspace()]);
        match log_density.0.iter().position(|l| !l.is_finite()) {
            Some(lane) => Err(Error::BadStart { lane, value: log_density.0[lane] }),
            None => Ok(Self { position, log_density, gradient }),
        }
    }
}

/// Scratch of [`update`].
#[derive(Clone, Debug)]
pub struct Workspace {
    momentum: Vec<Block>,
    position: Vec<Block>,
    gradient: Vec<Block>,
    target: Vec<Block>,
}

impl Workspace {
    /// Scratch for a target.
    #[must_use]
    pub fn new<T: GradLogDensity + ?Sized>(target: &T) -> Self {
        let blocks = vec![Block::ZERO; target.dim()];
        let workspace = vec![Block::ZERO; target.workspace()];
        Self { momentum: blocks.clone(), position: blocks.clone(), gradient: blocks, target: workspace }
    }
}

/// What happened to each chain in one [`update`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update {
    /// Probability min(1, exp(H₀ − H₁)) with which the proposal was accepted; 0 where it diverged.
    pub acceptance: Block,
    /// Whether it was.
    pub accepted: [bool; LANES],
    /// Whether the trajectory diverged.
    pub divergent: [bool; LANES],
    /// Hamiltonian of the resulting state with the momentum that brought or left it there.
    pub energy: Block,
    /// Factor of the component steps (jitter).
    pub factor: Block,
}

struct KickDrift<'a> {
    steps: &'a [f64],
    factor: &'a Block,
    kick: f64,
    position: &'a mut [Block],
    momentum: &'a mut [Block],
    gradient: &'a [Block],
}

/// The same with a dense metric.
struct DenseKickDrift<'a> {
    steps: &'a Dense,
    factor: &'a Block,
    kick: f64,
    position: &'a mut [Block],
    momentum: &'a mut [Block],
    gradient: &'a [Block],
}

/// p + kick · Aᵀ g, coordinate by coordinate.
#[inline(always)]
fn dense_kick<V: Real<Mem = Block>>(steps: &Dense, kick: V, momentum: &mut [Block], gradient: &[Block]) {
    let mut column = &steps.columns[..];
    for (j, p) in momentum.iter_mut().enumerate() {
        let (entries, rest) = column.split_at(j + 1);
        column = rest;
        let sum: V = dot(entries, gradient);
        sum.fma(kick, V::load(p)).store(p);
    }
}

impl Kernel<Block> for DenseKickDrift<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.steps.dim();
        let (x, p, g) = (&mut self.position[..d], &mut self.momentum[..d], &self.gradient[..d]);
        let factor = V::load(self.factor);
        dense_kick(self.steps, factor * V::splat(self.kick), p, g);
        let mut row = &self.steps.rows[..];
        for (i, x) in x.iter_mut().enumerate() {
            let (entries, rest) = row.split_at(d - i);
            row = rest;
            let sum: V = dot(entries, &p[i..]);
            sum.fma(factor, V::load(x)).store(x);
        }
    }
}

/// The closing half step with a dense metric.
struct DenseKick<'a> {
    steps: &'a Dense,
    factor: &'a Block,
    kick: f64,
    momentum: &'a mut [Block],
    gradient: &'a [Block],
}

impl Kernel<Block> for DenseKick<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.steps.dim();
        let kick = V::load(self.factor) * V::splat(self.kick);
        dense_kick(self.steps, kick, &mut self.momentum[..d], &self.gradient[..d]);
    }
}

/// p·p / 2.
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

impl Kernel<Block> for KickDrift<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.steps.len();
        let (x, p, g) = (&mut self.position[..d], &mut self.momentum[..d], &self.gradient[..d]);
        let factor = V::load(self.factor);
        let kick = V::splat(self.kick);
        for j in 0..d {
            let step = V::splat(self.steps[j]) * factor;
            let momentum = (step * kick).fma(V::load(&g[j]), V::load(&p[j]));
            momentum.store(&mut p[j]);
            step.fma(momentum, V::load(&x[j])).store(&mut x[j]);
        }
    }
}

/// The closing half step.
struct LastKick<'a> {
    steps: &'a [f64],
    factor: &'a Block,
    kick: f64,
    momentum: &'a mut [Block],
    gradient: &'a [Block],
}

impl Kernel<Block> for LastKick<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.steps.len();
        let (p, g) = (&mut self.momentum[..d], &self.gradient[..d]);
        let kick = V::load(self.factor) * V::splat(self.kick);
        for j in 0..d {
            let momentum = (V::splat(self.steps[j]) * kick).fma(V::load(&g[j]), V::load(&p[j]));
            momentum.store(&mut p[j]);
        }
    }
}

/// Takes the new values where `accepted` is 1.
struct Take<'a> {
    accepted: &'a Block,
    old: &'a mut [Block],
    new: &'a [Block],
}

impl Kernel<Block> for Take<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let accepted = V::load(self.accepted);
        for (old, new) in self.old.iter_mut().zip(self.new) {
            accepted.select_gt(0.5, V::load(new), V::load(old)).store(old);
        }
    }
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

/// One trajectory of leapfrog steps. `gradient` holds the gradient of the log density at `position` on entry and on return; `workspace` is the target's.
///
/// # Panics
/// When the metric has another dimension than the states: coordinates without a step would never move.
pub fn leapfrog<T: GradLogDensity + ?Sized>(
    target: &T,
    hmc: &Hmc,
    factor: &Block,
    position: &mut [Block],
    momentum: &mut [Block],
    gradient: &mut [Block],
    workspace: &mut [Block],
) -> End {
    assert_eq!(hmc.dim(), position.len(), "dimension of the metric and of the states");
    let mut log_density = Block::ZERO;
    let mut broken = Block::ZERO;
    for step in 0..hmc.leapfrog_steps {
        let kick = if step == 0 { 0.5 } else { 1.0 };
        match &hmc.steps {
            Steps::Components(steps) => {
                dispatch(hmc.isa, KickDrift { steps, factor, kick, position, momentum, gradient });
            }
            Steps::Dense(steps) => {
                dispatch(hmc.isa, DenseKickDrift { steps, factor, kick, position, momentum, gradient });
            }
        }
        log_density = target.log_density_grad_block(position, gradient, workspace);
        for (b, l) in broken.0.iter_mut().zip(log_density.0) {
            *b += 0.0 * l;
        }
    }
    match &hmc.steps {
        Steps::Components(steps) => dispatch(hmc.isa, LastKick { steps, factor, kick: 0.5, momentum, gradient }),
        Steps::Dense(steps) => dispatch(hmc.isa, DenseKick { steps, factor, kick: 0.5, momentum, gradient }),
    }
    let mut kinetic = Block::ZERO;
    dispatch(hmc.isa, Kinetic { momentum, energy: &mut kinetic });
    End { log_density, kinetic, broken }
}

/// Moves all eight chains by one trajectory.
pub fn update<T: GradLogDensity + ?Sized>(
    target: &T,
    hmc: &Hmc,
    chains: &mut Chains,
    ws: &mut Workspace,
    rng: &mut BlockRng,
) -> Update {
    let Workspace { momentum, position, gradient, target: scratch } = ws;
    rng.fill_normal(hmc.isa, momentum);
    let mut uniforms = [Block::ZERO; 2];
    rng.fill_uniform(&mut uniforms);
    let mut factor = Block::splat(1.0);
    for (f, u) in factor.0.iter_mut().zip(uniforms[1].0) {
        *f += hmc.jitter * (2.0 * u - 1.0);
    }
    position.copy_from_slice(&chains.position);
    gradient.copy_from_slice(&chains.gradient);
    let mut kinetic = Block::ZERO;
    dispatch(hmc.isa, Kinetic { momentum, energy: &mut kinetic });
    let end = leapfrog(target, hmc, &factor, position, momentum, gradient, scratch);

    let mut taken = Block::ZERO;
    let mut update = Update {
        acceptance: Block::ZERO,
        accepted: [false; LANES],
        divergent: [false; LANES],
        energy: Block::ZERO,
        factor,
    };
    for lane in 0..LANES {
        let before = kinetic.0[lane] - chains.log_density.0[lane];
        let after = end.kinetic.0[lane] - end.log_density.0[lane] + end.broken.0[lane];
        let error = after - before;
        let divergent = error.is_nan() || error > DIVERGENCE;
        let acceptance = if divergent { 0.0 } else { (-error).exp().min(1.0) };
        let accepted = uniforms[0].0[lane] < acceptance;
        update.divergent[lane] = divergent;
        update.acceptance.0[lane] = acceptance;
        update.accepted[lane] = accepted;
        update.energy.0[lane] = if accepted { after } else { before };
        taken.0[lane] = f64::from(u8::from(accepted));
    }
    dispatch(hmc.isa, Take { accepted: &taken, old: &mut chains.position, new: position });
    dispatch(hmc.isa, Take { accepted: &taken, old: &mut chains.gradient, new: gradient });
    let new = &[end.log_density];
    dispatch(hmc.isa, Take { accepted: &taken, old: std::slice::from_mut(&mut chains.log_density), new });
    update
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::{Lanes, LogDensity};
    use sinew_core::random::Stage;
    use sinew_core::toy::Quadratic;

    /// A standard normal left of a cliff, with a region of NaN far left.
    struct Cliff;
    impl LogDensity for Cliff {
        fn dim(&self) -> usize {
            1
        }
        fn log_density(&self, x: &[f64]) -> f64 {
            self.log_density_grad(x, &mut [0.0])
        }
    }
    impl GradLogDensity for Cliff {
        fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
            grad[0] = if x[0] < -2.0 { f64::NAN } else { -x[0] };
            if x[0] > 1.0 { f64::NEG_INFINITY } else { -0.5 * x[0] * x[0] }
        }
    }

    #[test]
    fn chains_never_stand_on_a_point_that_is_not_finite() {
        let hmc = Hmc::new(0.5, &[1.0], 3, 0.2, Isa::best()).expect("valid");
        let mut chains = Chains::new(&Cliff, vec![Block::ZERO]).expect("finite");
        let mut ws = Workspace::new(&Cliff);
        let mut rng = Stage::new(3, "cliff").whole();
        let mut divergent = 0;
        for _ in 0..2000 {
            let update = update(&Cliff, &hmc, &mut chains, &mut ws, &mut rng);
            divergent += update.divergent.iter().filter(|&&d| d).count();
            for lane in 0..LANES {
                assert!(chains.position[0].0[lane] <= 1.0 && chains.log_density.0[lane].is_finite());
                assert!(chains.gradient[0].0[lane].is_finite() && update.energy.0[lane].is_finite());
            }
        }
        assert!(divergent > 100, "{divergent}");
    }

    /// A step ten times beyond the stable one: energies are finite and far off.
    #[test]
    fn a_trajectory_whose_energy_explodes_is_a_divergence() {
        let target = Lanes { leaf: Quadratic { centre: vec![0.0], precision: vec![100.0] }, isa: Isa::best() };
        let hmc = Hmc::new(2.0, &[1.0], 4, 0.0, Isa::best()).expect("valid");
        let mut chains = Chains::new(&target, vec![Block::splat(0.1)]).expect("finite");
        let mut ws = Workspace::new(&target);
        let update = update(&target, &hmc, &mut chains, &mut ws, &mut Stage::new(4, "explode").whole());
        assert_eq!((update.divergent, update.accepted), ([true; LANES], [false; LANES]));
        assert_eq!(update.acceptance, Block::ZERO);
    }

    #[test]
    fn cached_values_belong_to_the_state() {
        let target = Lanes {
            leaf: Quadratic { centre: vec![0.0, 1.0, -1.0], precision: vec![1.0, 4.0, 0.25] },
            isa: Isa::best(),
        };
        let hmc = Hmc::new(1.2, &[1.0, 4.0, 0.25], 5, 0.0, Isa::best()).expect("valid");
        let mut chains = Chains::new(&target, vec![Block::splat(0.4); 3]).expect("finite");
        let mut ws = Workspace::new(&target);
        let mut rng = Stage::new(2, "cache").whole();
        let mut accepted = 0;
        for _ in 0..50 {
            let u = update(&target, &hmc, &mut chains, &mut ws, &mut rng);
            accepted += u.accepted.iter().filter(|&&a| a).count();
            assert_eq!(Chains::new(&target, chains.position.clone()).expect("finite"), chains);
        }
        assert!((200..400).contains(&accepted), "{accepted} of 400 accepted");
    }

    #[test]
    fn bad_settings_and_starts_are_refused() {
        for (eta, h, steps, jitter) in
            [(0.0, 1.0, 1, 0.0), (f64::NAN, 1.0, 1, 0.0), (1.0, -1.0, 1, 0.0), (1.0, 1.0, 0, 0.0), (1.0, 1.0, 1, 1.0)]
        {
            let refused = Hmc::new(eta, &[h], steps, jitter, Isa::best());
            assert!(matches!(refused, Err(Error::OutOfRange { .. })), "{refused:?}");
        }
        let start = Chains::new(&Cliff, vec![Block::splat(3.0)]);
        assert_eq!(start, Err(Error::BadStart { lane: 0, value: f64::NEG_INFINITY }));
    }
}
