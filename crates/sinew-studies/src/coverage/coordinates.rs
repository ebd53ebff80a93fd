//! Ranks of single degrees of freedom on the model's own motion.
//!
//! They show whose intervals are too narrow or too wide, and whether more draws mend it.

use super::found::Found;
use super::scene::{self, Tracker};
use crate::support::outcome::Outcome;
use rayon::prelude::*;
use sinew::body::Proportions;
use sinew::body::standard::h32;
use sinew::config::settings::Settings;
use sinew::methods::HmcMethod;
use sinew::tracking::hmc_filter;
use std::fmt::Write as _;
use std::sync::Arc;

/// What of the chains differs from the default.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Chains {
    /// Updates of each chain, with --coordinates
    #[arg(long, requires = "coordinates")]
    updates: Option<usize>,
    /// Draws of each chain that are discarded, with --coordinates
    #[arg(long, requires = "coordinates")]
    burn_in: Option<usize>,
}

/// The degree of freedom whose ranks are least uniform over `count` series: its name, the width of its ranks, and the probability of a larger χ² times the number of degrees of freedom.
pub(super) fn worst(count: usize, seed: u64) -> Outcome<(String, f64, f64)> {
    let found = ranked(&Tracker::Hmc.settings(), count, seed)?.state();
    let number = found.len() as f64;
    let all = h32(&Proportions::default()).dof_names().into_iter().zip(found);
    let worst = all.min_by(|(_, a), (_, b)| a.1.total_cmp(&b.1)).ok_or("no series")?;
    Ok((worst.0, worst.1.0.width, (number * worst.1.1).min(1.0)))
}

fn ranked(settings: &Settings, count: usize, seed: u64) -> Outcome<Found> {
    let seeds = scene::seeds(0..count, seed);
    let series = seeds.into_par_iter().map(|seed| scene::own(settings, seed)).collect::<Outcome<Vec<_>>>()?;
    Ok(Found::of(&series))
}

/// The table of a number of series; Markdown.
pub(super) fn measure(count: usize, chains: Chains, seed: u64) -> Outcome<String> {
    let usual = HmcMethod::default().0;
    let hmc = HmcMethod(hmc_filter::Config {
        updates: chains.updates.unwrap_or(usual.updates),
        burn_in: chains.burn_in.unwrap_or(usual.burn_in),
        ..usual
    });
    let settings = Settings { method: Arc::new(hmc), ..Tracker::Hmc.settings() };
    let found = ranked(&settings, count, seed)?;
    let disagreeing = 100.0 * found.disagreeing();
    Ok(format!(
        "{}\nThe chains disagree (split R-hat above 1.05) in {disagreeing:.0} % of the frames.\n",
        table(&found)
    ))
}

/// Shape of the ranks of each degree of freedom, with the probability of a larger χ².
pub(super) fn table(found: &Found) -> String {
    let names = h32(&Proportions::default()).dof_names();
    let mut text = String::from("| coordinate | bias | width | p |\n|---|---|---|---|\n");
    for (name, (shape, p)) in names.iter().zip(found.state()) {
        let _ = writeln!(text, "| {name} | {:+.3} | {:.2} | {p:.1e} |", shape.bias, shape.width);
    }
    text
}
