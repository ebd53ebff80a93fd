//! Prior of one frame: a mixture, a Gaussian, or action primitives.
//!
//! It is one type, so that the choice is a value of the transition and not of the tracker.

use crate::gaussian::Gaussian;
use crate::mixture::Mixture;
use crate::primitives::density::SwitchingMixture;
use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::BlockRng;
use sinew_core::transition::FramePrior;

/// Prior of one frame.
#[derive(Clone, Debug)]
pub enum Prior {
    /// One component for each chain of the frame before.
    Mixture(Lanes<Mixture>),
    /// One Gaussian of all its draws.
    Gaussian(Lanes<Gaussian>),
    /// The three models of action primitives, for each chain of the frame before.
    Switching(Lanes<SwitchingMixture>),
}

macro_rules! either {
    ($self:expr, $p:ident => $e:expr) => {
        match $self {
            Prior::Mixture($p) => $e,
            Prior::Gaussian($p) => $e,
            Prior::Switching($p) => $e,
        }
    };
}

impl LogDensity for Prior {
    fn dim(&self) -> usize {
        either!(self, p => p.dim())
    }
    fn workspace(&self) -> usize {
        either!(self, p => p.workspace())
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        either!(self, p => p.log_density(x))
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        either!(self, p => p.log_density_block(x, ws))
    }
}

impl GradLogDensity for Prior {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        either!(self, p => p.log_density_grad(x, grad))
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        either!(self, p => p.log_density_grad_block(x, grad, ws))
    }
}

impl FramePrior for Prior {
    fn sample_block(&self, block: usize, out: &mut [Block], rng: &mut BlockRng) {
        match self {
            Self::Gaussian(p) => p.leaf.sample_block(p.isa, out, rng),
            Self::Switching(p) => p.leaf.sample_block(p.isa, block, out, rng),
            Self::Mixture(p) => {
                rng.fill_normal(p.isa, out);
                let means = p.leaf.means();
                for (j, (x, sd)) in out.iter_mut().zip(p.leaf.sd()).enumerate() {
                    for (lane, x) in x.0.iter_mut().enumerate() {
                        *x = means[(block * LANES + lane) % means.len()][j] + sd * *x;
                    }
                }
            }
        }
    }

    fn precision_diagonal(&self) -> &[f64] {
        match self {
            Self::Gaussian(p) => p.leaf.precision_diagonal(),
            Self::Mixture(p) => p.leaf.precision(),
            Self::Switching(p) => p.leaf.precision_bound(),
        }
    }

    fn precision(&self) -> Vec<f64> {
        match self {
            Self::Gaussian(p) => p.leaf.precision().to_vec(),
            Self::Switching(p) => p.leaf.precision().to_vec(),
            Self::Mixture(_) => sinew_core::transition::diagonal_matrix(self.precision_diagonal()),
        }
    }
}
