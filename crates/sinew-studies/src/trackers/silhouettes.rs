//! `cargo xtask study silhouettes`: all methods on the same real masks, the tables of docs/evidence/experiments/real-silhouettes.md.
//!
//! The masks were made with the help of the joints that they are compared with here, so a distance to those joints says how well a body follows masks, and nothing of its accuracy in the world. Settings were chosen on frames 0–59;
//! frames 60–99 judge.

use crate::accuracy::butterworth;
use crate::support::outcome::Outcome;
use crate::support::table::header;
use clap::Args as Arguments;
use sinew::config::settings::{Settings, motion_model};
use sinew::config::{Resolved, Sources, TrackConfig, resolve};
use sinew::input::footage::{Footage, Init};
use sinew::methods::Score;
use sinew::methods::{About, AnnealedMethod, annealed, bootstrap, coarse_to_fine, hmc, hppf, partitioned};
use sinew::setup::Setup;
use sinew_setup::silhouette_overlap::SilhouetteOverlap;
use sinew_tests::evaluation::{self, LIMB_JOINTS};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Arguments of the command.
#[derive(Arguments)]
pub(crate) struct Args {
    /// Folder of the recordings; `../shared/data` beside the workspace if it is left out.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Seeds of each row.
    #[arg(long, default_value_t = 5)]
    seeds: u64,
    /// Leave limbs and trunk as thick as people usually are, whatever the masks show.
    #[arg(long)]
    usual_girth: bool,
    /// Only the rows of this method.
    #[arg(long, value_name = "NAME")]
    method: Option<String>,
    /// A motion model of h32 for the rows that need one, which are left out without (`sinew learn primitives --fps 60`).
    #[arg(long, value_name = "FILE")]
    motion_model: Option<PathBuf>,
}

const CHOSEN: Range<usize> = 0..60;
const JUDGED: Range<usize> = 60..100;
const FPS: f64 = 60.0;

/// A row of the table.
struct Row {
    method: &'static About,
    score: Score,
    /// Whether keypoints are observed, too.
    keypoints: bool,
    masks: bool,
    /// Whether images are given with the masks: edges, and colours where the score compares them.
    images: bool,
    /// Whether the motion model moves the body.
    learned: bool,
    cameras: Option<&'static [&'static str]>,
    /// Other settings than the program's.
    change: fn(&mut Settings),
    changed: &'static str,
}

const TWO: &[&str] = &["cam_01", "cam_03"];
const ONE: &[&str] = &["cam_01"];

fn rows() -> Vec<Row> {
    let masks = |method, score| Row {
        method,
        score,
        keypoints: false,
        masks: true,
        images: false,
        learned: false,
        cameras: None,
        change: |_| {},
        changed: "",
    };
    let mut rows = vec![];
    for method in [&annealed::ABOUT, &bootstrap::ABOUT, &coarse_to_fine::ABOUT] {
        for score in [Score::DeutscherReid, Score::Bidirectional, Score::CoarseToFine, Score::Parts] {
            rows.push(masks(method, score));
        }
    }
    rows.push(masks(&partitioned::ABOUT, Score::Parts));
    rows.push(masks(&partitioned::ABOUT, Score::Bidirectional));
    for learned in [false, true] {
        for images in [false, true] {
            let changed = if learned { ", motion model" } else { "" };
            rows.push(Row { images, learned, changed, ..masks(&hppf::ABOUT, Score::Parts) });
        }
    }
    rows.push(Row { cameras: Some(TWO), ..masks(&annealed::ABOUT, Score::Bidirectional) });
    rows.push(Row { cameras: Some(ONE), ..masks(&annealed::ABOUT, Score::Bidirectional) });
    let keypoints =
        |method, with_masks| Row { keypoints: true, masks: with_masks, ..masks(method, Score::Bidirectional) };
    for method in [&annealed::ABOUT, &bootstrap::ABOUT, &partitioned::ABOUT] {
        rows.push(keypoints(method, false));
        rows.push(keypoints(method, true));
    }
    rows.push(Row { score: Score::Parts, ..keypoints(&partitioned::ABOUT, true) });
    rows.push(keypoints(&hmc::ABOUT, false));
    rows.push(keypoints(&hmc::ABOUT, true));
    let plain = |settings: &mut Settings| {
        let mut annealed = AnnealedMethod::default();
        annealed.0.layers.crossover = 0.0;
        settings.method = Arc::new(annealed);
    };
    rows.push(Row { change: plain, changed: ", no crossover", ..masks(&annealed::ABOUT, Score::Bidirectional) });
    let deutscher = |settings: &mut Settings| {
        let mut annealed = AnnealedMethod::default();
        annealed.0.layers.layers = 10;
        settings.method = Arc::new(annealed);
    };
    rows.push(Row { change: deutscher, changed: ", 10 layers", ..masks(&annealed::ABOUT, Score::Bidirectional) });
    rows
}

/// Runs the command.
pub(crate) fn run(root: &Path, args: &Args) -> Outcome<()> {
    let data = args.data.clone().unwrap_or_else(|| root.join("../shared/data"));
    if !data.join("pose2sim_silhouettes").is_dir() {
        println!("skipped: no data");
        return Ok(());
    }
    tables(&data, args)
}

/// The settings of `sinew track` for the real recording.
fn config(data: &Path, row: &Row) -> Outcome<TrackConfig> {
    let single = data.join("pose2sim_single");
    let path = |path: PathBuf| path.display().to_string();
    let mut flags = vec![
        ("calibration", path(single.join("Calib.toml"))),
        ("keypoints", path(single.join("T01_BalancingTrial/pose"))),
        ("layout", "BODY_25B".to_owned()),
        ("fps", FPS.to_string()),
        ("method", row.method.name.to_owned()),
    ];
    if row.masks {
        flags.push(("silhouettes", path(data.join("pose2sim_silhouettes/silhouettes"))));
        flags.push(("mask_scale", "0.5".to_owned()));
    }
    if row.images {
        flags.push(("images", path(data.join("pose2sim_silhouettes/images"))));
    }
    if let Some(cameras) = row.cameras {
        flags.push(("cameras", cameras.join(",")));
    }
    let resolved: Resolved = resolve(&Sources { flags, environment: vec![], file: None })?;
    let config = resolved.track();
    Ok(TrackConfig { init: (!row.keypoints).then_some(Init::Keypoints), ..config })
}

fn footage(config: &TrackConfig) -> Outcome<Footage<'static>> {
    let calibration = config.calibration.as_deref().ok_or("no calibration")?;
    Ok(config.footage(calibration)?)
}

fn set_up(config: &TrackConfig, settings: &Settings, usual_girth: bool) -> Outcome<Setup> {
    let change = |setup: &mut Setup| {
        if usual_girth {
            setup.girth = None;
        }
    };
    Ok(evaluation::set_up(&mut footage(config)?, 0..CHOSEN.end as u64, settings, change)?)
}

fn tables(data: &Path, args: &Args) -> Outcome<()> {
    let seeds = args.seeds;
    let reference = butterworth(data)?;
    print!(
        "{}",
        header(
            "| method | score | observed | cameras | frames 0–59, mm | frames 60–99, mm | precision, % | recall, % | ms a frame |"
        )
    );
    let is_wanted = |row: &Row| {
        let is_named = args.method.as_deref().is_none_or(|name| row.method.name == name);
        is_named && (args.motion_model.is_some() || !row.learned)
    };
    for row in rows().into_iter().filter(is_wanted) {
        let config = config(data, &row)?;
        let mut base = Settings {
            method: row.method.usual(),
            fps: FPS,
            score: row.score.with_kappa(100.0),
            motion_model: args.motion_model.as_deref().filter(|_| row.learned).map(motion_model).transpose()?,
            ..Settings::default()
        };
        (row.change)(&mut base);
        let setup = set_up(&config, &base, args.usual_girth)?;
        if let Some(girth) = setup.girth {
            eprintln!("{}, {} cameras: {girth:?}", row.method.name, row.cameras.map_or(4, <[_]>::len));
        }
        let (mut errors, mut coverage, mut seconds) = ([vec![], vec![]], vec![], 0.0);
        for seed in 1..=seeds {
            let settings = Settings { seed, ..base.clone() };
            let clock = Instant::now();
            let filtered = evaluation::filter(&mut footage(&config)?, &setup, 0..JUDGED.end as u64, &settings)?;
            seconds += clock.elapsed().as_secs_f64();
            let track = evaluation::positions(&filtered.tree, &filtered.estimates, &LIMB_JOINTS);
            for (errors, frames) in errors.iter_mut().zip([CHOSEN, JUDGED]) {
                errors.push(1e3 * evaluation::mean_distance(&track, &reference, frames));
            }
            coverage.extend(filtered.coverage);
        }
        let share = |of: fn(&SilhouetteOverlap) -> f64| match coverage.len() {
            0 => "–".to_owned(),
            n => format!("{:.0}", 100.0 * coverage.iter().map(of).sum::<f64>() / n as f64),
        };
        println!(
            "| {}{} | {} | {} | {} | {} | {} | {} | {} | {:.0} |",
            row.method.name,
            row.changed,
            if row.masks { format!("{:?}", row.score) } else { "–".to_owned() },
            observed(&row),
            row.cameras.map_or(4, <[_]>::len),
            shown(&errors[0]),
            shown(&errors[1]),
            share(|c| c.precision),
            share(|c| c.recall),
            1e3 * seconds / (seeds as f64 * JUDGED.end as f64),
        );
    }
    Ok(())
}

/// What is observed, in words.
fn observed(row: &Row) -> String {
    let observed = [(row.keypoints, "keypoints"), (row.masks, "masks"), (row.images, "images")];
    observed.into_iter().filter(|(is_observed, _)| *is_observed).map(|(_, word)| word).collect::<Vec<_>>().join(", ")
}

/// Mean and the range over seeds.
fn shown(errors: &[f64]) -> String {
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let (least, most) = errors.iter().fold((f64::MAX, 0.0_f64), |(a, b), &x| (a.min(x), b.max(x)));
    format!("{mean:.0} ({least:.0}–{most:.0})")
}
