//! What accuracy and coverage of `hmc` cost, by chains, updates and the prior between frames.
//!
//! On recorded motion, with keypoints of the fitted body. Chains of a frame that disagree continue with four times the updates, as in `sinew track`; the gradients printed leave that out.
//!
//! Of the settings whose coverage lies in 90 ± 3 % and whose error is within two standard errors of that of the most expensive one, the cheapest is enough for these recordings; docs/evidence/accuracy.md says why the default is dearer.

use super::virtual_cameras::{CMU_RATE_HZ, Motion, Tally, film, share};
use crate::support::chart::{self, BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, Panel, bare, with_bar};
use crate::support::outcome::Outcome;
use crate::support::statistics::mean;
use crate::support::table::header;
use plotters::prelude::*;
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::config::settings::Settings;
use sinew::dynamics::random_walk::Between;
use sinew::methods::HmcMethod;
use sinew::tracking::hmc_filter::Config;
use sinew_tests::evaluation;
use std::path::Path;
use std::sync::Arc;

/// Updates a frame; a quarter of them is discarded.
const UPDATES: [usize; 8] = [4, 8, 12, 16, 24, 32, 48, 96];
const CHAINS: [usize; 3] = [8, 16, 32];
/// Chains for the comparison of the priors, with this number of updates.
const PRIOR_CHAINS: [usize; 5] = [8, 16, 32, 64, 128];
const PRIOR_UPDATES: usize = 24;

/// What a setting came to.
struct Found {
    hmc: Config,
    between: Between,
    gradients: f64,
    error_mm: [f64; 2],
    coverage: [f64; 2],
    poorly_mixed: f64,
}

fn config(chains: usize, updates: usize) -> Config {
    Config { chains, updates, burn_in: updates / 4, ..HmcMethod::default().0 }
}

fn measure(motions: &[Motion], hmc: &HmcMethod, between: Between, seeds: u64) -> Outcome<Found> {
    let mut tally = Tally::default();
    let (mut gradients, mut mixed, mut frames) = (vec![], 0, 0);
    for motion in motions {
        for seed in 1..=seeds {
            let method = Arc::new(hmc.clone());
            let settings = Settings { method, between, seed, fps: CMU_RATE_HZ, ..Settings::default() };
            let (mut film, all) = film(motion, &motion.fitted.points, seed)?;
            let run = evaluation::run(&mut film, all.clone(), all, &settings, None)?;
            let length = run.setup.leapfrog_steps.unwrap_or(0) as usize;
            gradients.push((hmc.0.chains * hmc.0.updates * length) as f64);
            mixed += run.filtered.iter().filter(|e| e.r_hat.is_some_and(|r| r > 1.05)).count();
            frames += run.filtered.len();
            tally.add(&run, &run.filtered, &motion.fitted.points);
        }
    }
    let share = share(&tally.covered, 0..EVALUATION_JOINTS.len());
    Ok(Found {
        hmc: hmc.0.clone(),
        between,
        gradients: mean(&gradients),
        error_mm: [mean(&tally.millimetres), deviation(&tally.millimetres, seeds)],
        coverage: share,
        poorly_mixed: 100.0 * mixed as f64 / frames as f64,
    })
}

/// Standard error of the mean over all runs, from the scatter between the seeds of each motion.
fn deviation(values: &[f64], seeds: u64) -> f64 {
    let square = |group: &[f64]| group.iter().map(|x| (x - mean(group)).powi(2)).sum::<f64>();
    let groups = values.chunks(seeds as usize);
    let freedom = values.len() - groups.len();
    (groups.map(square).sum::<f64>() / freedom.max(1) as f64 / values.len() as f64).sqrt()
}

fn print(found: &Found) {
    let Found { hmc: s, between, gradients, error_mm: [error, error_se], coverage: [share, share_se], poorly_mixed } =
        found;
    println!(
        "| {} | {} | {} | {gradients:.0} | {error:.2} ± {error_se:.2} | {share:.1} ± {share_se:.1} | {poorly_mixed:.1} |",
        prior_name(*between),
        s.chains,
        s.updates
    );
}

const fn prior_name(between: Between) -> &'static str {
    match between {
        Between::Gaussian => "gaussian",
        Between::Mixture => "mixture",
    }
}

fn line(
    name: String,
    colour: RGBColor,
    found: &[&Found],
    x: impl Fn(&Found) -> f64,
    y: impl Fn(&Found) -> [f64; 2],
) -> Line {
    let point = |f: &&Found| with_bar(x(f).log10(), y(f));
    Line { name, colour, points: found.iter().map(point).collect() }
}

/// Runs all settings, prints the table and draws the curves.
pub fn run(motions: &[Motion], seeds: u64, picture: &Path) -> Outcome<()> {
    println!("\nFitted body, sizes from the set-up, {seeds} seeds of each motion; ± one standard error.\n");
    print!(
        "{}",
        header(
            "| prior | chains | updates | gradients a frame | error, mm | coverage, % | frames with R-hat above 1.05, % |"
        )
    );
    let mut effort = vec![];
    for chains in CHAINS {
        for updates in UPDATES {
            let found = measure(motions, &HmcMethod(config(chains, updates)), Between::Gaussian, seeds)?;
            print(&found);
            effort.push(found);
        }
    }
    let mut priors = vec![];
    for between in [Between::Gaussian, Between::Mixture] {
        for chains in PRIOR_CHAINS {
            let found = measure(motions, &HmcMethod(config(chains, PRIOR_UPDATES)), between, seeds)?;
            print(&found);
            priors.push(found);
        }
    }
    draw(&effort, &priors, picture)
}

fn draw(effort: &[Found], priors: &[Found], path: &Path) -> Outcome<()> {
    let by_chains = |y: &dyn Fn(&Found) -> [f64; 2]| -> Vec<Line> {
        let of = |(chains, colour): (usize, RGBColor)| {
            let own: Vec<&Found> = effort.iter().filter(|f| f.hmc.chains == chains).collect();
            line(format!("{chains} chains"), colour, &own, |f| f.gradients, y)
        };
        CHAINS.into_iter().zip([ORANGE, BLUE, GREEN]).map(of).collect()
    };
    let cost = "gradients a frame";
    let panel = |title: &str, axes, lines| Panel {
        title: title.into(),
        axes,
        lines,
        in_decades: [true, false],
        names: Names::Beside(76),
    };
    let coverage = "coverage of 90 % intervals, %";
    let mut lines = by_chains(&|f| f.coverage);
    let ends = |lines: &[Line]| {
        let all = lines.iter().flat_map(|line| line.points.iter().map(|p| p[0]));
        all.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
    };
    let target = |(low, high): (f64, f64)| {
        let line = |y| Line { name: format!("{y} %"), colour: GREY, points: vec![bare(low, y), bare(high, y)] };
        [87.0, 93.0].map(line)
    };
    lines.extend(target(ends(&lines)));
    let distances = panel("mean distance from the truth", [cost, "mm"], by_chains(&|f| f.error_mm));
    let covered = panel("coverage", [cost, coverage], lines);
    let mut lines: Vec<Line> = [(Between::Gaussian, BLUE), (Between::Mixture, PURPLE)]
        .into_iter()
        .map(|(between, colour)| {
            let own: Vec<&Found> = priors.iter().filter(|f| f.between == between).collect();
            line(prior_name(between).into(), colour, &own, |f| f.hmc.chains as f64, |f| f.coverage)
        })
        .collect();
    lines.extend(target(ends(&lines)));
    let title = format!("priors between frames, {PRIOR_UPDATES} updates");
    chart::draw(path, (1260, 330), (1, 3), &[distances, covered, panel(&title, ["chains", coverage], lines)])
}
