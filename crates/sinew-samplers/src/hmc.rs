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

mod sample;

pub use sample::{Settings, sample};

use crate::Error;
use crate::chains::ChainStat;
use crate::integrator::{End, Leapfrog, PhasePoint, check_jitter, kinetic};
use crate::metric::Metric;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};
use sinew_core::random::BlockRng;

/// An energy error above this is a divergence.
pub const DIVERGENCE: f64 = 1000.0;

/// Trajectories of fixed steps and length; fixed while chains run.
#[derive(Clone, Debug, PartialEq)]
pub struct Hmc {
    leapfrog: Leapfrog,
    leapfrog_steps: usize,
    jitter: f64,
}

impl Hmc {
    /// Steps for a metric.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the step size and each curvature are positive and finite, there is at least one coordinate and one step, and 0 ≤ jitter < 1.
    pub fn with_metric(
        step_size: f64,
        metric: &Metric,
        leapfrog_steps: usize,
        jitter: f64,
        isa: Isa,
    ) -> Result<Self, Error> {
        let leapfrog = Leapfrog::new(step_size, metric, isa)?;
        if leapfrog_steps == 0 {
            let (name, value) = ("number of leapfrog steps", 0.0);
            return Err(Error::OutOfRange { name, value, expected: "must be positive and finite" });
        }
        check_jitter(jitter)?;
        Ok(Self { leapfrog, leapfrog_steps, jitter })
    }

    /// Component steps η / √h_j for the `curvature` h.
    ///
    /// # Errors
    /// As [`Hmc::with_metric`].
    pub fn new(step_size: f64, curvature: &[f64], leapfrog_steps: usize, jitter: f64, isa: Isa) -> Result<Self, Error> {
        Self::with_metric(step_size, &Metric::Diagonal(curvature.to_vec()), leapfrog_steps, jitter, isa)
    }

    /// Dimension of the states that it moves.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.leapfrog.dim()
    }

    /// Leapfrog steps L of a trajectory.
    #[must_use]
    pub fn leapfrog_steps(&self) -> usize {
        self.leapfrog_steps
    }

    /// One trajectory, as [`Leapfrog::trajectory`].
    pub fn trajectory<T: GradLogDensity + ?Sized>(
        &self,
        target: &T,
        factor: &Block,
        point: PhasePoint<'_>,
        workspace: &mut [Block],
    ) -> End {
        self.leapfrog.trajectory(target, self.leapfrog_steps, factor, point, workspace)
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
    /// Gradients of the trajectory.
    pub leapfrog_steps: [u32; LANES],
    /// Depth of the tree, of the no-U-turn sampler; else 0.
    pub depth: [u32; LANES],
}

impl Update {
    /// What is known of the state of one lane, which now has this log density.
    pub(crate) fn stat(&self, lane: usize, log_density: f64) -> ChainStat {
        ChainStat {
            log_density,
            acceptance: self.acceptance.0[lane],
            step_factor: self.factor.0[lane],
            divergent: self.divergent[lane],
            energy: self.energy.0[lane],
            leapfrog_steps: self.leapfrog_steps[lane],
            depth: self.depth[lane],
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

/// Moves all eight chains by one trajectory.
pub fn update<T: GradLogDensity + ?Sized>(
    target: &T,
    hmc: &Hmc,
    chains: &mut Chains,
    ws: &mut Workspace,
    rng: &mut BlockRng,
) -> Update {
    let Workspace { momentum, position, gradient, target: scratch } = ws;
    let isa = hmc.leapfrog.isa();
    rng.fill_normal(isa, momentum);
    let mut uniforms = [Block::ZERO; 2];
    rng.fill_uniform(&mut uniforms);
    let mut factor = Block::splat(1.0);
    for (f, u) in factor.0.iter_mut().zip(uniforms[1].0) {
        *f += hmc.jitter * (2.0 * u - 1.0);
    }
    position.copy_from_slice(&chains.position);
    gradient.copy_from_slice(&chains.gradient);
    let kinetic = kinetic(isa, momentum);
    let end = hmc.trajectory(target, &factor, PhasePoint { position, momentum, gradient }, scratch);

    let mut taken = Block::ZERO;
    let mut update = Update {
        acceptance: Block::ZERO,
        accepted: [false; LANES],
        divergent: [false; LANES],
        energy: Block::ZERO,
        factor,
        leapfrog_steps: [hmc.leapfrog_steps as u32; LANES],
        depth: [0; LANES],
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
    dispatch(isa, Take { accepted: &taken, old: &mut chains.position, new: position });
    dispatch(isa, Take { accepted: &taken, old: &mut chains.gradient, new: gradient });
    let new = &[end.log_density];
    dispatch(isa, Take { accepted: &taken, old: std::slice::from_mut(&mut chains.log_density), new });
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
