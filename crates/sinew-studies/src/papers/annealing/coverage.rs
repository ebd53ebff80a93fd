//! How often the truth lies in the intervals of a weighted set.
//!
//! On linear-Gaussian series, where the posterior is proper and known.
//!
//! A series is simulated from the model with which it is tracked, so that a tracker whose draws come from the posterior covers what it says. For each coordinate and frame the truth's place u = Σ W_i 1(s_i < truth) among
//! the weighted draws is taken; the central interval of level p holds it where |u − ½| < p / 2. Beside it stand the standard deviations of the set over the exact ones, and the distance of its mean from the exact mean in
//! exact standard deviations. Errors are over series.

use super::film::annealed;
use crate::papers::interval_tally::Tally;
use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::tracking::annealed::{self, Annealed};
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::hmc_filter::HmcFilter;
use sinew::tracking::{Error, Tracker};
use sinew_tests::linear_series::{Series, Sight, chains_on_series, deviations};

/// Dimensions of the state.
pub(super) const DIMS: [usize; 3] = [2, 6, 10];
/// Frames of a series.
const FRAMES: usize = 30;

/// Whose intervals are looked at.
#[derive(Clone, Debug)]
pub(super) enum Contender {
    Bootstrap(usize),
    Hmc,
    Annealed(annealed::Config),
}

/// Number of contenders that the figure shows.
pub(super) const SHOWN: usize = 6;
/// Number of the first search.
pub(super) const SEARCHES: usize = 2;

/// All, by name; the ones in the figure first, and the searches from [`SEARCHES`] on. The bootstrap filter has `particles` particles.
pub(super) fn contenders(particles: usize) -> Vec<(String, Contender)> {
    let of = |name: &str, config| (name.to_owned(), Contender::Annealed(config));
    let mut all = vec![
        ("bootstrap".to_owned(), Contender::Bootstrap(particles)),
        ("hmc".to_owned(), Contender::Hmc),
        of("annealed, 10 × 200", annealed::Config::default()),
        of("annealed, Deutscher & Reid", annealed::Config::deutscher_reid()),
        of("annealed, Balan 5 × 200", annealed::Config::balan()),
        of("annealed, 5 × 100", annealed::Config::raskin()),
    ];
    for (layers, particles) in [(1, 1000), (3, 333)] {
        all.push(of(&format!("annealed, {layers} × {particles}"), annealed(layers, particles, 0.5)));
    }
    for survival in [0.2, 0.8] {
        all.push(of(&format!("annealed, 10 × 200, α = {survival}"), annealed(10, 200, survival)));
    }
    all
}

/// One series: shares inside at each level, spread over the exact one, distance of the mean from the exact one.
fn one(series: &Series, tracker: &mut impl Tracker<Sight>, stage: &Stage) -> Result<[f64; 6], Error> {
    let mut tally = Tally::default();
    for ((frame, truth), exact) in series.truth.iter().enumerate().zip(series.kalman()) {
        tracker.step(&series.sight(frame), stage.round(0).at_frame(frame as u32))?;
        tally.add(&tracker.posterior(), truth, &exact.filtered.mean, &deviations(&exact.filtered));
    }
    Ok(tally.row())
}

/// One contender on all series of a dimension: a row a series.
pub(super) fn cell(contender: &Contender, dim: usize, runs: usize, seed: u64, isa: Isa) -> Outcome<Value> {
    let mut rows = vec![];
    for run in 0..runs {
        let [data, stage] = Stage::new(seed, "annealing coverage").round(run).split(["data", "filter"]);
        let series = Series::simulated(dim, FRAMES, &data);
        let (model, centre) = (series.model(), series.m0.clone());
        let row = match contender {
            Contender::Bootstrap(particles) => {
                let config = bootstrap::Config { particles: *particles, ..bootstrap::Config::default() };
                one(&series, &mut Bootstrap::new(config, model, centre)?, &stage)
            }
            Contender::Hmc => one(&series, &mut HmcFilter::new(chains_on_series(), model, centre, isa)?, &stage),
            Contender::Annealed(config) => {
                let sd = (0..dim).map(|j| series.q[j * (dim + 1)].sqrt()).collect();
                one(&series, &mut Annealed::new(config.clone(), model, sd, centre, isa)?, &stage)
            }
        }?;
        rows.push(row.to_vec());
    }
    Ok(json!(rows))
}
