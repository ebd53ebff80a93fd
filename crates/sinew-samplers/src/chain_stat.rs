//! What is known of one draw of a chain.

/// What is known of one draw of a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChainStat {
    /// Log density of the target.
    pub log_density: f64,
    /// Probability with which the trajectory was accepted; 1 for a start.
    pub acceptance: f64,
    /// Factor of the step size in this trajectory (jitter).
    pub step_factor: f64,
    /// Whether it diverged.
    pub divergent: bool,
    /// Hamiltonian of the draw; of a start its potential.
    pub energy: f64,
    /// Gradients that the trajectory took; 0 for a start.
    pub leapfrog_steps: u32,
    /// Doublings of a no-U-turn tree that were kept; 0 elsewhere.
    pub depth: u32,
}
