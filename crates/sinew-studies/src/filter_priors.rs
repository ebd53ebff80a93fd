//! `cargo xtask study filter-priors`: what the HMC filter's priors between frames cost in calibration, the tables and the figure of docs/evidence/filter-priors.md.
//!
//! The measurements are functions of the test member (`sinew_tests::filter_priors`), whose exact filters judge them. The growth model and the arm are read from the data folder and left out, with a note, where there is none.

use crate::support::chart::{BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, finish, panel_with};
use crate::support::outcome::{Outcome, exit_code};
use plotters::prelude::*;
use serde_json::{Value, json};
use sinew::core::random::Stage;
use sinew_tests::depth_flip::Arm;
use sinew_tests::filter_priors::{
    ArmSeries, Calibration, Length, OnGrowth, SETTINGS, Setting, few_draws, gaussian_bias, growth_model, on_arm,
    on_growth, random_walk,
};
use sinew_tests::growth::{self, Growth};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
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
    runs: usize,
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
pub fn run(root: &Path, args: &Args) -> ExitCode {
    let out = args.out.clone().unwrap_or_else(|| root.join("target/filter-priors"));
    exit_code(all(&out, args))
}

fn all(out: &Path, args: &Args) -> Outcome<()> {
    std::fs::create_dir_all(out)?;
    let started = Instant::now();
    let mut record = json!({ "seed": args.seed, "quick": args.quick });
    let mut tables = String::new();
    if let Some(growth) = Growth::stored() {
        tables += &growth_table(&growth, args, &mut record)?;
    }
    if let Some(arm) = Arm::stored() {
        tables += &arm_table(&arm, args, &mut record)?;
    }
    println!("{tables}");
    let cells = random_walks(args, &out.join("random-walk.csv"))?;
    record["random_walk"] = cells.iter().map(as_json).collect();
    tables += &walk_tables(&cells)?;
    tables += &few_draws_table(args, &mut record)?;
    println!("{tables}\n{:.0} s", started.elapsed().as_secs_f64());
    record["seconds"] = json!(started.elapsed().as_secs_f64());
    std::fs::write(out.join("tables.md"), tables)?;
    std::fs::write(out.join("filter-priors.json"), serde_json::to_string_pretty(&record)?)?;
    draw(&cells, &out.join("filter-priors.svg"))
}

/// All cells, cheap settings first. What is finished is written after each, and not measured again by the next run into the same folder with the same seed and size.
fn random_walks(args: &Args, finished: &Path) -> Outcome<Vec<Cell>> {
    let (ratios, dimensions): (&[f64], &[usize]) =
        if args.quick { (&RATIOS[..2], &DIMENSIONS[..3]) } else { (&RATIOS, &DIMENSIONS) };
    let known = std::fs::read_to_string(finished).unwrap_or_default();
    let mut cells = vec![];
    for setting in SETTINGS {
        for &dim in dimensions {
            for &ratio in ratios {
                let length = Length { runs: runs(setting, dim, args.quick), before: 10, frames: 10 };
                if length.runs == 0 {
                    continue;
                }
                let key = key(args.seed, length.runs, setting, ratio, dim);
                let found = match known.lines().find_map(|line| line.strip_prefix(&key)) {
                    Some(numbers) => parsed(numbers)?,
                    None => {
                        let started = Instant::now();
                        let found = random_walk(setting, ratio, dim, length, args.seed);
                        let (seconds, share) = (started.elapsed().as_secs_f64(), 100.0 * found.covered[0]);
                        eprintln!("d = {dim}, q/r = {ratio}, {}: {seconds:.0} s, {share:.1} % covered", setting.name());
                        found
                    }
                };
                cells.push(Cell { setting, ratio, dim, found, runs: length.runs });
                std::fs::write(finished, csv(args.seed, &cells)?)?;
            }
        }
    }
    Ok(cells)
}

/// How the line of a cell begins.
fn key(seed: u64, runs: usize, setting: Setting, ratio: f64, dim: usize) -> String {
    let prior = format!("{:?}", setting.between).to_lowercase();
    format!("{seed},{runs},{prior},{},{ratio},{dim},", setting.chains)
}

/// The numbers after the key.
fn parsed(numbers: &str) -> Outcome<Calibration> {
    let numbers = numbers.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let [a, b, c, d, e, f, g, h, poorly_mixed] = numbers[..] else {
        return Err("a line of random-walk.csv has another number of columns".into());
    };
    Ok(Calibration { error: [a, b], variance_ratio: [c, d], covered: [e, f], covers_truth: [g, h], poorly_mixed })
}

/// A cell's text.
type Shown = fn(&Calibration) -> String;

/// Four tables of the random walk: dimensions and settings down, ratios across.
fn walk_tables(cells: &[Cell]) -> Outcome<String> {
    let mut text = String::new();
    let kinds: [(&str, Shown); 5] = [
        ("Coverage: exact probability of the 90 % intervals, %", |c| percent(c.covered)),
        ("Coverage of the true coordinates by the 90 % intervals, %", |c| percent(c.covers_truth)),
        ("Error of the mean in exact standard deviations", |c| number(c.error)),
        ("Variance over the exact variance", |c| number(c.variance_ratio)),
        ("Frames whose chains disagree (split R-hat above 1.05), %", |c| format!("{:.0}", 100.0 * c.poorly_mixed)),
    ];
    let mut ratios: Vec<f64> = cells.iter().map(|cell| cell.ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup();
    for (title, show) in kinds {
        write!(text, "\n{title}:\n\n| d | prior |")?;
        ratios.iter().try_for_each(|ratio| write!(text, " q/r = {ratio} |"))?;
        write!(text, "\n|---|---|{}", "---|".repeat(ratios.len()))?;
        for dim in DIMENSIONS {
            for setting in SETTINGS {
                let of = |ratio: f64| cells.iter().find(|c| (c.dim, c.ratio, c.setting) == (dim, ratio, setting));
                if of(ratios[0]).is_none() {
                    continue;
                }
                write!(text, "\n| {dim} | {} |", setting.name())?;
                for &ratio in &ratios {
                    write!(text, " {} |", of(ratio).map_or_else(|| "–".into(), |cell| show(&cell.found)))?;
                }
            }
        }
        text.push('\n');
    }
    Ok(text)
}

/// The settings of real recordings with two numbers of draws, coordinates seen alike and not.
fn few_draws_table(args: &Args, record: &mut Value) -> Outcome<String> {
    let mut text = String::from(
        "\nFew draws, q/r = 0.1 where coordinates are seen alike:\n\n| d | draws | seen | coverage, % | variance ratio | error of the mean |\n|---|---|---|---|---|---|\n",
    );
    let mut kept = vec![];
    for dim in [5, 10, 28] {
        for draws in [400, 1600] {
            for unlike in [false, true] {
                let runs = if args.quick { 4 } else { 64 };
                let found = few_draws(draws, unlike, dim, Length { runs, before: 20, frames: 30 }, args.seed);
                let (seen, Calibration { covered, variance_ratio, error, .. }) =
                    (if unlike { "unlike" } else { "alike" }, found);
                let numbers = [percent(covered), number(variance_ratio), number(error)].join(" | ");
                writeln!(text, "| {dim} | {draws} | {seen} | {numbers} |")?;
                kept.push(json!({ "dim": dim, "draws": draws, "seen": seen, "covered": covered, "variance_ratio": variance_ratio, "error": error }));
            }
        }
    }
    record["few_draws"] = json!(kept);
    Ok(text)
}

fn percent([value, error]: [f64; 2]) -> String {
    format!("{:.1} ± {:.1}", 100.0 * value, 100.0 * error)
}

fn number([value, error]: [f64; 2]) -> String {
    format!("{value:.3} ± {error:.3}")
}

fn as_json(cell: &Cell) -> Value {
    let Calibration { error, variance_ratio, covered, covers_truth, poorly_mixed } = cell.found;
    json!({
        "prior": cell.setting.name(), "chains": cell.setting.chains, "ratio": cell.ratio, "dim": cell.dim, "error": error,
        "variance_ratio": variance_ratio, "covered": covered, "covers_truth": covers_truth, "poorly_mixed": poorly_mixed, "runs": cell.runs,
    })
}

fn csv(seed: u64, cells: &[Cell]) -> Outcome<String> {
    let mut text = String::from(
        "seed,runs,prior,chains,ratio,dim,error,error_se,variance_ratio,variance_ratio_se,covered,covered_se,covers_truth,covers_truth_se,poorly_mixed\n",
    );
    for Cell { setting, ratio, dim, found, runs } in cells {
        text += &key(seed, *runs, *setting, *ratio, *dim);
        for [value, error] in [found.error, found.variance_ratio, found.covered, found.covers_truth] {
            write!(text, "{value},{error},")?;
        }
        writeln!(text, "{}", found.poorly_mixed)?;
    }
    Ok(text)
}

fn growth_table(growth: &Growth, args: &Args, record: &mut Value) -> Outcome<String> {
    let mut rows: Vec<(String, OnGrowth)> = vec![];
    for setting in SETTINGS.into_iter().chain([250, 1000].map(|chains| Setting { chains, ..SETTINGS[0] })) {
        rows.push((setting.name(), on_growth(growth, setting, static_runs(setting.chains, args), args.seed)));
    }
    for particles in [1000, 5000] {
        let root = Stage::new(args.seed, "filter priors, particles").round(particles);
        let found = growth_model(static_runs(0, args), |r| growth::by_particles(growth, particles, &root.round(r)));
        rows.push((format!("bootstrap, N = {particles}"), found));
    }
    let mut text = format!(
        "\nGrowth model, {} runs ({} with 1000 chains):\n\n| filter | mean error of P(x > 0) | largest in a run | error of log Z: mean | sd |\n|---|---|---|---|---|\n",
        static_runs(0, args),
        static_runs(1000, args)
    );
    for (name, found) in &rows {
        let OnGrowth { sign, worst_sign, log_evidence: [mean, sd] } = found;
        writeln!(text, "| {name} | {} | {worst_sign:.2} | {mean:.2} | {sd:.2} |", number(*sign))?;
    }
    let of = |(name, f): &(String, OnGrowth)| json!({ "filter": name, "sign": f.sign, "worst_sign": f.worst_sign, "log_evidence": f.log_evidence });
    record["growth"] = rows.iter().map(of).collect();
    Ok(text)
}

fn arm_table(arm: &Arm, args: &Args, record: &mut Value) -> Outcome<String> {
    let points = if args.quick { 64 } else { ARM_POINTS };
    let series = ArmSeries::new(arm, ARM_FRAMES, points, args.seed);
    let bias = gaussian_bias(&series, 6);
    let mut text = format!(
        "\nArm with eight depth modes, {ARM_FRAMES} frames, {} runs ({} with 1000 chains); largest error of a mode's mass:\n\n| filter | first frame | mean of the later frames | largest of all |\n|---|---|---|---|\n",
        static_runs(0, args),
        static_runs(1000, args)
    );
    let mut kept = vec![];
    for setting in SETTINGS.into_iter().chain([250, 1000].map(|chains| Setting { chains, ..SETTINGS[0] })) {
        let found = on_arm(&series, setting, static_runs(setting.chains, args), args.seed);
        writeln!(
            text,
            "| {} | {} | {} | {:.2} |",
            setting.name(),
            number(found.first),
            number(found.later),
            found.worst
        )?;
        kept.push(
            json!({ "filter": setting.name(), "first": found.first, "later": found.later, "worst": found.worst }),
        );
    }
    let mean = bias.iter().sum::<f64>() / bias.len() as f64;
    let worst = bias.iter().copied().fold(0.0, f64::max);
    writeln!(text, "| gaussian, exact moments and integrals | 0 | {mean:.3} | {worst:.2} |")?;
    record["arm"] = json!({ "filters": kept, "gaussian_bias": bias });
    Ok(text)
}

/// Coverage against q / r, a panel a dimension.
fn draw(cells: &[Cell], path: &Path) -> Outcome<()> {
    let root = SVGBackend::new(path, (1260, 640)).into_drawing_area();
    root.fill(&WHITE).map_err(|error| error.to_string())?;
    let areas = root.split_evenly((2, 2));
    for (dim, area) in DIMENSIONS.into_iter().zip(&areas) {
        let mut lines: Vec<Line> = SETTINGS
            .into_iter()
            .zip([BLUE, ORANGE, PURPLE, GREEN])
            .map(|(setting, colour)| {
                let own = cells.iter().filter(|c| c.dim == dim && c.setting == setting);
                let point = |c: &Cell| {
                    let [value, error] = c.found.covered.map(|x| 100.0 * x);
                    [c.ratio.log10(), value, value - 2.0 * error, value + 2.0 * error]
                };
                Line { name: setting.name(), colour, points: own.map(point).collect() }
            })
            .filter(|line| !line.points.is_empty())
            .collect();
        if lines.is_empty() {
            continue;
        }
        let (low, high) = (RATIOS[0].log10(), RATIOS[3].log10());
        let points = vec![[low, 90.0, 90.0, 90.0], [high, 90.0, 90.0, 90.0]];
        lines.push(Line { name: "90 %".into(), colour: GREY, points });
        let axes = ["process noise over observation noise, q / r", "exact probability, %"];
        panel_with(area, &format!("90 % intervals, d = {dim}"), axes, &lines, [true, false], Names::Beside(130))?;
    }
    finish(&root)
}
