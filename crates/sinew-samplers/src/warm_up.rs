//! Warm-up of no-U-turn and Hamiltonian chains from scattered starts.
//!
//! 1. Every start climbs into the bulk ([`crate::ascent`]).
//! 2. In each window all chains make no-U-turn transitions with one metric, but each chain with a step size of its own ([`crate::dual_averaging`]), as Stan's chains have: one step size for all is that of whichever chain is worst off,
//!    and where some stand far out it moves none of the others.
//! 3. The second half of a window gives the metric of the next ([`crate::learned`]), without chains that lag behind: those whose mean log density is below the median of the chains' by more than d and by more than 10.
//! 4. The last window learns no metric. The median of the chains' step sizes there is the step size for this acceptance.
//!
//! Chains that lag are left where they are: to replace them would hide that they disagree. All draws are thrown away; metric and step size are fixed before the first one that is kept.

use crate::ascent::ascend;
use crate::chains::{ChainDraws, Schedule};
use crate::dual_averaging::DualAveraging;
use crate::metric::Metric;
use crate::nuts::draws;
use crate::nuts::transition::{MAX_DEPTH, Nuts};
use crate::{Error, learned};
use sinew_core::density::GradLogDensity;
use sinew_core::estimators::median;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;

/// Settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Gradients of eight states that the climb of a block may take.
    pub climb: usize,
    /// Transitions of each chain in the windows from which a metric is learned.
    pub windows: Vec<usize>,
    /// Transitions in the last window.
    pub last_window: usize,
    /// Acceptance to aim at.
    pub acceptance: f64,
    /// Step size η that each window begins with: the first one, in units of the state, and the others, in units of the learned metric.
    pub first_step_sizes: [f64; 2],
    /// Greatest depth of a tree.
    pub max_depth: usize,
    /// Whether the draws of the windows are kept.
    pub keep_draws: bool,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            climb: 1000,
            windows: vec![50, 100, 200, 400],
            last_window: 100,
            acceptance: 0.8,
            first_step_sizes: [0.1, 0.5],
            max_depth: MAX_DEPTH,
            keep_draws: false,
        }
    }
}

/// Fewest transitions of [`Config::with_length`].
pub const SHORTEST: usize = 170;

impl Config {
    /// As many transitions in all: four windows, each twice as long as the one before, and a last one of at least two seventeenths.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for fewer than [`SHORTEST`], of which no metric can be learned.
    pub fn with_length(transitions: usize) -> Result<Self, Error> {
        if transitions < SHORTEST {
            let (name, value) = ("number of warm-up transitions", transitions as f64);
            return Err(Error::OutOfRange { name, value, expected: "must be at least 170" });
        }
        let part = transitions / 17;
        let windows = vec![part, 2 * part, 4 * part, 8 * part];
        Ok(Self { last_window: transitions - 15 * part, windows, ..Self::default() })
    }
}

/// What a warm-up leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct WarmedUp {
    /// Metric of the target.
    pub metric: Metric,
    /// Where the chains stand, blocks of the target's dimension.
    pub states: Vec<Block>,
    /// Step size η with which no-U-turn transitions have the configured acceptance.
    pub step_size: f64,
    /// The windows' draws, where they are kept.
    pub draws: Vec<ChainDraws>,
}

/// Takes `chains` chains from `starts` (blocks of the target's dimension; every lane must hold a state of finite log density and gradient, idle ones too) into the bulk of the target.
///
/// # Errors
/// [`Error::BadStart`], [`Error::Empty`], [`Error::OutOfRange`] for settings; [`Error::Metric`] where a coordinate does not vary in a window.
pub fn warm_up<T: GradLogDensity + ?Sized>(
    target: &T,
    starts: &[Block],
    chains: usize,
    config: &Config,
    isa: Isa,
    stage: &Stage,
) -> Result<WarmedUp, Error> {
    let mut states = starts.to_vec();
    ascend(target, &mut states, config.climb)?;
    let mut metric = Metric::Diagonal(vec![1.0; target.dim()]);
    let mut step_size = config.first_step_sizes[0];
    let mut draws = Vec::new();
    let windows = config.windows.iter().chain([&config.last_window]);
    for (window, &updates) in windows.enumerate() {
        let nuts = Nuts::with_metric(1.0, &metric, config.max_depth, 0.0, isa)?;
        let second_half = updates.div_ceil(2);
        let schedule = Schedule { updates, burn_in: if config.keep_draws { 1.min(updates) } else { second_half } };
        let first = config.first_step_sizes[window.min(1)];
        let search = DualAveraging::new(first, config.acceptance);
        let (run, step_sizes) = draws::adapt(target, &nuts, &states, chains, schedule, search, &stage.round(window))?;
        states.clone_from(&run.draws.last);
        if window < config.windows.len() {
            let second_half = run.draws.select(&(0..chains).collect::<Vec<_>>(), second_half - schedule.burn_in);
            let bulk = second_half.select(&in_the_bulk(&second_half), 0);
            if bulk.stats.len() < LANES {
                let (name, value) = ("number of draws in a warm-up window", bulk.stats.len() as f64);
                return Err(Error::OutOfRange {
                    name,
                    value,
                    expected: "must be at least 8; warm up longer or more chains",
                });
            }
            metric = learned::metric(target, &bulk, bulk.least_effective(), isa)?;
        }
        step_size = median(&mut step_sizes.clone());
        if config.keep_draws {
            draws.push(run.draws);
        }
    }
    Ok(WarmedUp { metric, states, step_size, draws })
}

/// The chains that do not lag behind.
fn in_the_bulk(draws: &ChainDraws) -> Vec<usize> {
    let count = (draws.stats.len() / draws.chains) as f64;
    let mean = |chain: usize| {
        draws.stats.iter().skip(chain).step_by(draws.chains).map(|stat| stat.log_density).sum::<f64>() / count
    };
    let means: Vec<f64> = (0..draws.chains).map(mean).collect();
    let least = median(&mut means.clone()) - f64::max(draws.dim as f64, 10.0);
    (0..draws.chains).filter(|&chain| means[chain] >= least).collect()
}
