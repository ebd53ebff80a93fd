//! Proposals that have seen the observation, one about each particle: the particle filter's best step, linearised.
//!
//! Where a state moves by x_t = f(x_{t−1}) + N(0, Q) and log p(z | x) is quadratic with curvature A about m, the mode of p(z | x) p(x | x̄) for the step from the particles' middle x̄, the density of x_t given its own previous state and z is
//!
//! ```text
//! q_i = N(m + K (x_i − x̄), P)      P = (Q⁻¹ + A)⁻¹      K = P Q⁻¹
//! ```
//!
//! if a step moves neighbours alike (Doucet, Godsill & Andrieu 2000, §II.B and §II.D). One search for the mode and one factor serve all particles. The weights p(z | x) p(x | x_i) / q_i(x) make it exact whatever the approximation ([`crate::importance`], with its tails).

use crate::Error;
use crate::importance::Tails;
use crate::laplace::Laplace;
use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch};
use sinew_core::random::BlockRng;

/// The proposals of one frame.
#[derive(Clone, Debug)]
pub struct Guide {
    laplace: Laplace,
    tails: Tails,
    /// K, row after row.
    gain: Vec<f64>,
    middle: Vec<f64>,
    isa: Isa,
}

impl Guide {
    /// About the Laplace approximation of a step from `middle`, whose precision is Q⁻¹, d × d.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for ν = 0.
    pub fn new(laplace: Laplace, precision: &[f64], middle: Vec<f64>, tails: Tails, isa: Isa) -> Result<Self, Error> {
        tails.check()?;
        let d = middle.len();
        let mut gain = vec![0.0; d * d];
        for (j, column) in precision.chunks_exact(d).enumerate() {
            // Q⁻¹ is symmetric: its row is its column.
            for (i, entry) in laplace.metric.solve(column).into_iter().enumerate() {
                gain[i * d + j] = entry;
            }
        }
        Ok(Self { laplace, tails, gain, middle, isa })
    }

    /// Draws the next state of each of eight particles and returns the log densities of the proposals.
    pub fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) -> Block {
        let log_density = self.tails.sample_block(&self.laplace, self.isa, next, rng);
        dispatch(self.isa, Follow { gain: &self.gain, middle: &self.middle, previous, next });
        log_density
    }
}

/// next += K (previous − middle).
struct Follow<'a> {
    gain: &'a [f64],
    middle: &'a [f64],
    previous: &'a [Block],
    next: &'a mut [Block],
}

impl Kernel<Block> for Follow<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.middle.len();
        let (previous, next) = (&self.previous[..d], &mut self.next[..d]);
        for (row, next) in self.gain.chunks_exact(d).zip(next) {
            let mut sum = V::load(next);
            for ((x, &k), &m) in previous.iter().zip(row).zip(self.middle) {
                sum = (V::load(x) - V::splat(m)).fma(V::splat(k), sum);
            }
            sum.store(next);
        }
    }
}
