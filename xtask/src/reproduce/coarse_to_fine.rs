//! The coarse-to-fine particle filter with bottom-up aggregation of body parts, against CONDENSATION.
//!
//! One camera, 330 frames; CONDENSATION has more than twice the particles.
//!
//! | file | what |
//! |---|---|
//! | [`scene`] | sequence, body, true poses, grid |
//! | [`contender`] | who is compared |
//! | [`condensation`] | the opponent |
//! | [`track`], [`study`] | one run and what its estimates are worth; all of them |
//! | [`results`] | means, errors, paired differences |
//! | [`claims`] | the paper's claims and what became of them |
//! | [`tables`], [`figures`] | numbers as files, the figure |
//!
//! No setting was chosen on the test sequence: they are the paper's, or the specification's where the paper is silent.

mod claims;
mod condensation;
mod contender;
mod figures;
mod results;
mod scene;
mod study;
mod tables;
mod track;

use crate::outcome::Outcome;
use crate::store::Store;
use contender::Contender;
use results::{Estimate, Results, mean};
use scene::{FRAMES, Scene};
use sinew::core::lanes::Isa;
use sinew_simulate::segmentation_noise::Level;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::time::Instant;
use study::{Group, Study};

/// Reproduces the tables and the figure of the coarse-to-fine particle filter.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A reduced size in a minute, which only checks CC6 and that the true pose is the most precise
    #[arg(long)]
    quick: bool,
    /// Seeds from 1 on, each another person, other noise and other particles, for the level `normal`, on which claims are judged
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    /// Seeds for the levels `clean` and `hard`
    #[arg(long, default_value_t = 10)]
    level_seeds: u64,
    /// Seeds for what goes beyond the paper
    #[arg(long, default_value_t = 3)]
    beside_seeds: u64,
    /// Folder for cells, tables and figures [default: target/reproduce/coarse-to-fine]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    threads: Option<usize>,
    /// Folder of the shared recordings [default: $SINEW_DATA, else shared/data beside the workspace]; without it the synthetic sequence is used
    #[arg(long, env = "SINEW_DATA")]
    data: Option<PathBuf>,
}

/// Tables, figure and claims into the folder and onto the terminal; returns whether what a reduced run asserts holds.
fn report(study: &Study, store: &Store, groups: &[Group], folder: &Path) -> Outcome<bool> {
    let (mut text, mut csv, mut judged) = (String::new(), String::from(tables::CSV), vec![]);
    for group in groups {
        let results = Results { store, seeds: &group.seeds };
        let _ = writeln!(text, "## {}, {} seeds\n", group.title(), group.seeds.len());
        if !group.beside {
            let pairs = tables::pairs(&results, group.level)?;
            let _ = writeln!(text, "{}\n{pairs}", tables::levels(&results, group.level)?);
        }
        let _ = writeln!(text, "{}", tables::all(&results, group.level, &group.contenders)?);
        csv.push_str(&tables::csv(&results, group.level, &group.contenders)?);
        if group.level == claims::LEVEL && !group.beside {
            judged = claims::judge(&results, &study.scene)?;
            figures::draw(&results, &folder.join("likelihood.svg"))?;
        }
    }
    let (claims, json) = (super::claim::table(&judged), tables::json(&store.config, &study.scene, &judged, groups));
    std::fs::write(folder.join("tables.md"), &text)?;
    std::fs::write(folder.join("tables.csv"), csv)?;
    std::fs::write(folder.join("results.json"), serde_json::to_string_pretty(&json)?)?;
    std::fs::write(folder.join("claims.md"), &claims)?;
    println!("{text}\n{claims}");
    let finite = judged.iter().all(|claim| claim.pass || claim.id != "CC6");
    Ok(finite
        && groups.iter().find(|group| !group.beside).map_or(Ok(true), |group| truth_is_most_precise(store, group))?)
}

/// Whether the true pose is more precise about the silhouette without errors than what any method reports, on average over frames: it is not if images and body do not belong together.
fn truth_is_most_precise(store: &Store, group: &Group) -> Outcome<bool> {
    let results = Results { store, seeds: &group.seeds };
    let precision = |contender: &Contender| -> Outcome<f64> {
        Ok(mean(&results.means(group.level, contender, Estimate::Second, "clean_precision")?).value)
    };
    let truth = precision(&contender::TRUTH)?;
    let others = group.contenders.iter().filter(|of| **of != contender::TRUTH);
    Ok(others.map(precision).collect::<Outcome<Vec<f64>>>()?.into_iter().all(|other| other < truth))
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let clock = Instant::now();
    let data = args.data.clone().unwrap_or_else(|| root.join("../shared/data")).join("cmu_amc");
    let recordings = data.is_dir().then_some(data.as_path());
    if recordings.is_none() {
        println!("no recordings in {}: the synthetic sequence is used", data.display());
    }
    let name = if args.quick { "coarse-to-fine-quick" } else { "coarse-to-fine" };
    let folder = args.out.clone().unwrap_or_else(|| root.join("target/reproduce").join(name));
    let frames = if args.quick { 24 } else { FRAMES };
    let study = Study { scene: Scene::new(recordings, frames)?, isa: Isa::best(), drawn: Mutex::default() };
    let mut store = Store::open(&folder, &study.configuration())?;
    let threads = args.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |n| n.get()));
    let groups = if args.quick {
        vec![Group::new(claims::LEVEL, false, 1)]
    } else {
        let levels = [Level::Normal, Level::Clean, Level::Hard].into_iter();
        let seeds = |level| if level == claims::LEVEL { args.seeds } else { args.level_seeds };
        let main = levels.map(|level| Group::new(level, false, seeds(level)));
        let all = main.chain([Group::new(claims::LEVEL, true, args.beside_seeds)]);
        all.filter(|group| !group.seeds.is_empty()).collect()
    };
    for group in &groups {
        group.run(&study, &mut store, threads)?;
    }
    let holds = report(&study, &store, &groups, &folder)?;
    if args.quick {
        println!(
            "reduced size: verdicts need the full run; asserted are CC6, and that the true pose is the most precise"
        );
    }
    println!(
        "{}: {} frames; {:.0} s; cells, tables and the figure in {}",
        study.scene.name,
        study.scene.truth.len(),
        clock.elapsed().as_secs_f64(),
        folder.display()
    );
    Ok(if args.quick && !holds { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The whole command in a reduced size: files are written, the true pose is the most precise, and coarse particles stand on their grid.
    #[test]
    fn the_reduced_study_holds() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let out = std::env::temp_dir().join(format!("sinew-coarse-to-fine-{}", std::process::id()));
        let args = Args {
            quick: true,
            seeds: 1,
            level_seeds: 0,
            beside_seeds: 0,
            out: Some(out.clone()),
            threads: None,
            data: std::env::var_os("SINEW_DATA").map(PathBuf::from),
        };
        assert_eq!(run(root, &args).unwrap(), ExitCode::SUCCESS, "what was found is printed above");
        for file in ["cells.jsonl", "tables.md", "tables.csv", "claims.md", "results.json", "likelihood.svg"] {
            assert!(out.join(file).is_file(), "{file}");
        }
        std::fs::remove_dir_all(&out).unwrap();
    }
}
