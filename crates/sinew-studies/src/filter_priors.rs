//! `cargo xtask study filter-priors`: what the HMC filter's priors between frames cost in calibration, the tables and the figure of docs/evidence/filter-priors.md.
//!
//! The measurements are functions of the test member (`sinew_tests::filter_priors`), whose exact filters judge them. The growth model and the arm are read from the data folder and left out, with a note, where there is none.

use crate::support::chart::{self, BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, Panel, bare, with_bar};
use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, rows, run_all};
use crate::support::study_options::threads;
use crate::support::table::{header, percent, row, with_spread};
use serde_json::json;
use sinew::core::random::Stage;
use sinew_tests::depth_flip::Arm;
use sinew_tests::filter_priors::{
    ArmSeries, Calibration, Length, OnGrowth, SETTINGS, Setting, few_draws, gaussian_bias, growth_model, on_arm,
    on_growth, random_walk,
};
use sinew_tests::growth::{self, Growth};
use std::path::{Path, PathBuf};
use std::time::Instant;

const RATIOS: [f64; 4] = [0.1, 0.3, 1.0, 3.0];
const DIMENSIONS: [usize; 4] = [2, 4, 10, 28];
/// Frames of the arm, and steps of its grid.
const ARM_FRAMES: usize = 6;
const ARM_POINTS: usize = 112;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// A reduced size in about a minute: fewer series, ratios and dimensions.
    #[arg(long)]
    quick: bool,
    /// Folder of tables and figure [default: target/filter-priors]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Seed of all random streams.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// A cell of the random walk's tables.
struct Cell {
    setting: Setting,
    ratio: f64,
    dim: usize,
    found: Calibration,
}

/// Independent series: many where a frame is cheap, none where the cell is left out.
fn runs(setting: Setting, dim: usize, quick: bool) -> usize {
    let full: usize = match (setting.chains, dim) {
        (1000, 28) => 0,
        (1000, _) => 3,
        (250, _) => 6,
        _ => 30,
    };
    if quick && full > 0 { full.div_ceil(5).max(2) } else { full }
}

/// Runs on the growth model and the arm.
const fn static_runs(chains: usize, args: &Args) -> usize {
    match (args.quick, chains) {
        (true, _) => 3,
        (false, 1000) => 6,
        (false, _) => 20,
    }
}

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> Outcome<()> {
    let out = args.out.clone().unwrap_or_else(|| root.join("target/filter-priors"));
    std::fs::create_dir_all(&out)?;
    let started = Instant::now();
    let mut tables = String::new();
    if let Some(growth) = Growth::stored() {
        tables += &growth_table(&growth, args);
    }
    if let Some(arm) = Arm::stored() {
        tables += &arm_table(&arm, args);
    }
    println!("{tables}");
    let cells = random_walks(args, &out)?;
    tables += &walk_tables(&cells);
    tables += &few_draws_table(args);
    println!("{tables}\n{:.0} s", started.elapsed().as_secs_f64());
    std::fs::write(out.join("tables.md"), tables)?;
    draw(&cells, &out.join("filter-priors.svg"))
}

/// All cells, cheap settings first, kept in a folder.
fn random_walks(args: &Args, folder: &Path) -> Outcome<Vec<Cell>> {
    let (ratios, dimensions): (&[f64], &[usize]) =
        if args.quick { (&RATIOS[..2], &DIMENSIONS[..3]) } else { (&RATIOS, &DIMENSIONS) };
    let mut store = Store::open(folder, &format!("random walk, seed {}", args.seed))?;
    let mut wanted: Vec<(String, Setting, f64, usize)> = vec![];
    let mut tasks: Vec<Task<'_>> = vec![];
    for setting in SETTINGS {
        for (&dim, &ratio) in dimensions.iter().flat_map(|dim| ratios.iter().map(move |ratio| (dim, ratio))) {
            let length = Length { runs: runs(setting, dim, args.quick), before: 10, frames: 10 };
            if length.runs > 0 {
                let key = format!("{}/{ratio}/{dim}/{} runs", setting.name(), length.runs);
                let task = move || {
                    let found = random_walk(setting, ratio, dim, length, args.seed);
                    let Calibration { error, variance_ratio, covered, covers_truth, poorly_mixed } = found;
                    Ok(json!([error, variance_ratio, covered, covers_truth, [poorly_mixed]]))
                };
                tasks.push((key.clone(), (setting.chains * length.runs * dim) as f64, Box::new(task)));
                wanted.push((key, setting, ratio, dim));
            }
        }
    }
    run_all(&mut store, "random walk", tasks, threads(None))?;
    let cell = |(key, setting, ratio, dim): (String, Setting, f64, usize)| -> Outcome<Cell> {
        let [a, b, c, d, e, f, g, h, poorly_mixed] = rows(store.get(&key).ok_or("a cell is missing")?).concat()[..]
        else {
            return Err(format!("{key}: another number of numbers").into());
        };
        let found =
            Calibration { error: [a, b], variance_ratio: [c, d], covered: [e, f], covers_truth: [g, h], poorly_mixed };
        Ok(Cell { setting, ratio, dim, found })
    };
    wanted.into_iter().map(cell).collect()
}

/// A cell's text.
type Shown = fn(&Calibration) -> String;

/// Four tables of the random walk: dimensions and settings down, ratios across.
fn walk_tables(cells: &[Cell]) -> String {
    let mut text = String::new();
    let kinds: [(&str, Shown); 5] = [
        ("Coverage: exact probability of the 90 % intervals, %", |c| percent(c.covered, 1)),
        ("Coverage of the true coordinates by the 90 % intervals, %", |c| percent(c.covers_truth, 1)),
        ("Error of the mean in exact standard deviations", |c| with_spread(c.error, 3)),
        ("Variance over the exact variance", |c| with_spread(c.variance_ratio, 3)),
        ("Frames whose chains disagree (split R-hat above 1.05), %", |c| format!("{:.0}", 100.0 * c.poorly_mixed)),
    ];
    let mut ratios: Vec<f64> = cells.iter().map(|cell| cell.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup();
    for (title, show) in kinds {
        let columns = ratios.iter().map(|ratio| format!("q/r = {ratio}")).collect::<Vec<_>>().join(" | ");
        text += &format!("\n{title}:\n\n{}", header(&format!("| d | prior | {columns} |")));
        for dim in DIMENSIONS {
            for setting in SETTINGS {
                let of = |ratio: f64| cells.iter().find(|c| (c.dim, c.ratio, c.setting) == (dim, ratio, setting));
                if of(ratios[0]).is_none() {
                    continue;
                }
                let cell = |&ratio: &f64| of(ratio).map_or_else(|| "–".into(), |cell| show(&cell.found));
                row!(text, "{dim} | {} | {}", setting.name(), ratios.iter().map(cell).collect::<Vec<_>>().join(" | "));
            }
        }
    }
    text
}

/// The settings of real recordings with two numbers of draws, coordinates seen alike and not.
fn few_draws_table(args: &Args) -> String {
    let mut text = "\nFew draws, q/r = 0.1 where coordinates are seen alike:\n\n".to_owned()
        + &header("| d | draws | seen | coverage, % | variance ratio | error of the mean |");
    for dim in [5, 10, 28] {
        for draws in [400, 1600] {
            for unlike in [false, true] {
                let runs = if args.quick { 4 } else { 64 };
                let found = few_draws(draws, unlike, dim, Length { runs, before: 20, frames: 30 }, args.seed);
                let (seen, Calibration { covered, variance_ratio, error, .. }) =
                    (if unlike { "unlike" } else { "alike" }, found);
                let numbers = [percent(covered, 1), with_spread(variance_ratio, 3), with_spread(error, 3)].join(" | ");
                row!(text, "{dim} | {draws} | {seen} | {numbers}");
            }
        }
    }
    text
}

fn growth_table(growth: &Growth, args: &Args) -> String {
    let mut rows: Vec<(String, OnGrowth)> = vec![];
    for setting in SETTINGS.into_iter().chain([250, 1000].map(|chains| Setting { chains, ..SETTINGS[0] })) {
        rows.push((setting.name(), on_growth(growth, setting, static_runs(setting.chains, args), args.seed)));
    }
    for particles in [1000, 5000] {
        let root = Stage::new(args.seed, "filter priors, particles").round(particles);
        let found = growth_model(static_runs(0, args), |r| growth::by_particles(growth, particles, &root.round(r)));
        rows.push((format!("bootstrap, N = {particles}"), found));
    }
    let mut text =
        format!("\nGrowth model, {} runs ({} with 1000 chains):\n\n", static_runs(0, args), static_runs(1000, args))
            + &header("| filter | mean error of P(x > 0) | largest in a run | error of log Z: mean | sd |");
    for (name, found) in &rows {
        let OnGrowth { sign, worst_sign, log_evidence: [mean, sd] } = found;
        row!(text, "{name} | {} | {worst_sign:.2} | {mean:.2} | {sd:.2}", with_spread(*sign, 3));
    }
    text
}

fn arm_table(arm: &Arm, args: &Args) -> String {
    let points = if args.quick { 64 } else { ARM_POINTS };
    let series = ArmSeries::new(arm, ARM_FRAMES, points, args.seed);
    let bias = gaussian_bias(&series, 6);
    let mut text = format!(
        "\nArm with eight depth modes, {ARM_FRAMES} frames, {} runs ({} with 1000 chains); largest error of a mode's mass:\n\n",
        static_runs(0, args),
        static_runs(1000, args)
    ) + &header("| filter | first frame | mean of the later frames | largest of all |");
    for setting in SETTINGS.into_iter().chain([250, 1000].map(|chains| Setting { chains, ..SETTINGS[0] })) {
        let found = on_arm(&series, setting, static_runs(setting.chains, args), args.seed);
        row!(
            text,
            "{} | {} | {} | {:.2}",
            setting.name(),
            with_spread(found.first, 3),
            with_spread(found.later, 3),
            found.worst
        );
    }
    let mean = bias.iter().sum::<f64>() / bias.len() as f64;
    let worst = bias.iter().copied().fold(0.0, f64::max);
    row!(text, "gaussian, exact moments and integrals | 0 | {mean:.3} | {worst:.2}");
    text
}

/// Coverage against q / r, a panel a dimension.
fn draw(cells: &[Cell], path: &Path) -> Outcome<()> {
    let panel = |dim: usize| {
        let mut lines: Vec<Line> = SETTINGS
            .into_iter()
            .zip([BLUE, ORANGE, PURPLE, GREEN])
            .map(|(setting, colour)| {
                let own = cells.iter().filter(|c| c.dim == dim && c.setting == setting);
                let point = |c: &Cell| with_bar(c.ratio.log10(), c.found.covered.map(|x| 100.0 * x));
                Line { name: setting.name(), colour, points: own.map(point).collect() }
            })
            .filter(|line| !line.points.is_empty())
            .collect();
        if !lines.is_empty() {
            let points = [RATIOS[0], RATIOS[3]].map(|ratio| bare(ratio.log10(), 90.0)).to_vec();
            lines.push(Line { name: "90 %".into(), colour: GREY, points });
        }
        let axes = ["process noise over observation noise, q / r", "exact probability, %"];
        let title = format!("90 % intervals, d = {dim}");
        Panel { title, axes, lines, in_decades: [true, false], names: Names::Beside(130) }
    };
    chart::draw(path, (1260, 640), (2, 2), &DIMENSIONS.map(panel))
}
