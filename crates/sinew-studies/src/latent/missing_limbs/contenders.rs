//! Who fills in missing limbs.

use crate::support::outcome::Outcome;
use sinew_tests::missing_limbs::latent::{Config, Rows};
use sinew_tests::missing_limbs::task::{Row, Task};
use sinew_tests::missing_limbs::{mixture, neighbours, process};

/// A reference without latents.
#[derive(Clone, Copy)]
pub(super) enum Contender {
    /// The nearest training row, by columns as they are or in standard deviations.
    Neighbours { is_scaled: bool },
    /// Gaussian-process regression on every third row.
    Process,
    /// The mean of a Gaussian mixture.
    Mixture(usize),
}

/// References, the nearest neighbours first.
pub(super) const REFERENCES: [Contender; 4] = [
    Contender::Neighbours { is_scaled: false },
    Contender::Neighbours { is_scaled: true },
    Contender::Process,
    Contender::Mixture(10),
];

impl Contender {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Neighbours { is_scaled: false } => "nearest neighbour (raw)",
            Self::Neighbours { is_scaled: true } => "nearest neighbour (scaled)",
            Self::Process => "Gaussian-process regression",
            Self::Mixture(_) => "Gaussian mixture, 10 components",
        }
    }

    pub(super) fn fill(self, task: &Task<'_>) -> Outcome<Vec<Row>> {
        match self {
            Self::Neighbours { is_scaled } => Ok(neighbours::fill(task, is_scaled)),
            Self::Process => process::fill(task, &process::Config { inverse_width: 0.3, white: 0.01, every: 3 }),
            Self::Mixture(components) => mixture::fill(task, components),
        }
    }
}

/// A latent model and the ways to find latents under it.
#[derive(Debug)]
pub(super) struct Latent {
    pub(super) name: &'static str,
    pub(super) config: Config,
    pub(super) ways: &'static [Rows],
}

impl Latent {
    /// Work of a cell in multiples of a reference's.
    pub(super) fn work(&self) -> f64 {
        let rows = 3.0 / self.config.every as f64;
        10.0 * rows * rows * (2 + self.ways.len()) as f64
    }
}

const GPLVM: Config = Config { dim: 3, weights: false, dynamics: false, back: None, every: 3, steps: 60 };
const SCALED: Config = Config { weights: true, ..GPLVM };
const GPDM: Config = Config { dynamics: true, ..SCALED };
const WAYS: &[Rows] = &[Rows::Mode, Rows::Walk(5.0)];
const ALL_WAYS: &[Rows] = &[Rows::Mode, Rows::Posterior, Rows::Walk(5.0), Rows::Dynamics(5.0), Rows::Dynamics(20.0)];

/// The latent models.
pub(super) const LATENT: [Latent; 10] = [
    Latent { name: "GPLVM, q = 3", config: GPLVM, ways: WAYS },
    Latent { name: "GPLVM, q = 5", config: Config { dim: 5, ..GPLVM }, ways: WAYS },
    Latent { name: "GPLVM with W, q = 3", config: SCALED, ways: WAYS },
    Latent { name: "GPLVM, back, q = 5", config: Config { dim: 5, back: Some(1.0), ..GPLVM }, ways: WAYS },
    Latent { name: "GPDM, q = 2", config: Config { dim: 2, ..GPDM }, ways: WAYS },
    Latent { name: "GPDM, q = 3", config: GPDM, ways: ALL_WAYS },
    Latent { name: "GPDM, q = 4", config: Config { dim: 4, ..GPDM }, ways: WAYS },
    Latent { name: "GPDM, q = 5", config: Config { dim: 5, ..GPDM }, ways: WAYS },
    Latent { name: "GPDM, back, q = 3", config: Config { back: Some(1.0), ..GPDM }, ways: WAYS },
    Latent { name: "GPDM, q = 3, every 2nd row", config: Config { every: 2, ..GPDM }, ways: WAYS },
];

/// A way to find latents, in words.
pub(super) fn words(rows: Rows) -> String {
    match rows {
        Rows::Mode => "row by row, mode".into(),
        Rows::Posterior => "row by row, posterior".into(),
        Rows::Walk(balance) => format!("sequence, random walk × {balance}"),
        Rows::Dynamics(balance) => format!("sequence, dynamics × {balance}"),
    }
}
