//! Ranks of single degrees of freedom on the model's own motion.
//!
//! They show whose intervals are too narrow or too wide.

use super::found::Found;
use super::scene::{self, Tracker};
use crate::support::outcome::Outcome;
use crate::support::table::{header, row};
use rayon::prelude::*;
use sinew::body::Proportions;
use sinew::body::standard::h32;
use sinew::config::settings::Settings;

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
pub(super) fn measure(count: usize, seed: u64) -> Outcome<String> {
    let found = ranked(&Tracker::Hmc.settings(), count, seed)?;
    let disagreeing = 100.0 * found.disagreeing();
    Ok(format!(
        "{}\nThe chains disagree (split R-hat above 1.05) in {disagreeing:.0} % of the frames.\n",
        table(&found)
    ))
}

/// Shape of the ranks of each degree of freedom, with the probability of a larger χ².
pub(super) fn table(found: &Found) -> String {
    let names = h32(&Proportions::default()).dof_names();
    let mut text = header("| coordinate | bias | width | p |");
    for (name, (shape, p)) in names.iter().zip(found.state()) {
        row!(text, "{name} | {:+.3} | {:.2} | {p:.1e}", shape.bias, shape.width);
    }
    text
}
