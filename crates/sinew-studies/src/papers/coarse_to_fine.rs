//! The coarse-to-fine particle filter with bottom-up aggregation of body parts, against CONDENSATION.
//!
//! One camera, 330 frames; CONDENSATION has more than twice the particles.
//!
//! | file | what |
//! |---|---|
//! | [`scene`] | sequence, body, true poses, grid |
//! | [`girth`] | how thick the tracker's body is |
//! | [`contender`] | who is compared |
//! | [`track`], [`study`] | one run and what its estimates are worth; all of them |
//! | [`results`] | means, errors, paired differences |
//! | [`claims`] | the paper's claims and what became of them |
//! | [`tables`], [`figures`] | numbers as files, the figure |
//!
//! Claims are judged for two readings of how the best parts are chosen and for two girths of the tracker's body. No setting was chosen on the test sequence: they are the paper's, or the specification's where the paper is silent.

mod claims;
mod contender;
mod figures;
mod girth;
mod results;
mod scene;
mod study;
mod tables;
mod track;

use super::seed_results::{Mean, Results};
use super::shared_values::Shared;
use crate::support::outcome::Outcome;
use crate::support::store::Store;
use crate::support::study_options::{StudyOptions, no_recordings};
use contender::{Contender, READINGS, Reading};
use results::{BLOCK, Estimate};
use scene::{FRAMES, Scene, Tracked};
use sinew::core::lanes::Isa;
use sinew_simulate::segmentation_noise::Level;
use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use study::{Group, Study, What};

/// Reproduces the tables and the figure of the coarse-to-fine particle filter.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A reduced size in a minute, which only checks CC6 and that the true pose is the most precise
    #[arg(long)]
    quick: bool,
    /// Seeds from 1 on, each another person, other noise and other particles, for the level `normal`, on which claims are judged
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    /// Follow the training motion instead, with three seeds, to see whether anybody is followed at all
    #[arg(long, conflicts_with = "quick")]
    pilot: bool,
    /// Seeds for the girth that is fitted to masks, and for opponents of as many evaluations
    #[arg(long, default_value_t = 10)]
    other_seeds: u64,
    /// Seeds for the levels `clean` and `hard`
    #[arg(long, default_value_t = 10)]
    level_seeds: u64,
    /// Seeds for what goes beyond the paper
    #[arg(long, default_value_t = 3)]
    beside_seeds: u64,
    #[command(flatten)]
    options: StudyOptions,
}

/// Tables, figure and claims into the folder and onto the terminal; returns whether what a reduced run asserts holds.
fn report(study: &Study, store: &Store, groups: &[Group], folder: &Path) -> Outcome<bool> {
    let (mut text, mut judged) = (String::new(), vec![]);
    for group in groups {
        let results = Results { store, seeds: group.seeds, block: BLOCK };
        let _ = writeln!(text, "## {}, {} seeds\n", group.title(), group.seeds);
        let _ = write!(text, "{}", paper_tables(&results, group)?);
        let _ = writeln!(text, "{}", tables::all(&results, group.level, &group.contenders)?);
        if let (claims::LEVEL, What::Readings(readings)) = (group.level, &group.what) {
            for reading in readings {
                judged.push((*reading, claims::judge(&results, reading, &study.scene)?));
            }
            if readings.contains(&READINGS[0]) {
                figures::draw(&results, &READINGS[0], &folder.join("likelihood.svg"))?;
            }
        }
    }
    let json = tables::json(&store.config, &study.scene, groups);
    let mut claims = String::new();
    for (reading, judged) in &judged {
        let _ = writeln!(claims, "## {}\n\n{}", reading.title(), super::claim::table(judged));
    }
    std::fs::write(folder.join("tables.md"), &text)?;
    std::fs::write(folder.join("results.json"), serde_json::to_string_pretty(&json)?)?;
    std::fs::write(folder.join("claims.md"), &claims)?;
    println!("{text}\n{claims}");
    let finite = judged.iter().flat_map(|(_, claims)| claims).all(|claim| claim.pass || claim.id != "CC6");
    Ok(finite && groups.first().map_or(Ok(true), |group| truth_is_most_precise(store, group))?)
}

/// The paper's tables of each reading of a group.
fn paper_tables(results: &Results<'_>, group: &Group) -> Outcome<String> {
    let mut text = String::new();
    match &group.what {
        What::Readings(readings) => {
            for reading in readings {
                let levels = tables::levels(results, reading, group.level)?;
                let pairs = tables::pairs(results, &reading.pairs(), group.level)?;
                let _ = writeln!(text, "{}:\n\n{levels}\n{pairs}", reading.title());
            }
        }
        What::Equal(readings) => {
            for reading in readings {
                let pairs = tables::pairs(results, &reading.equal_pairs(), group.level)?;
                let _ = writeln!(text, "{}:\n\n{pairs}", reading.title());
            }
        }
        What::Beside | What::Pilot => {}
    }
    Ok(text)
}

/// Whether the true pose is more precise about the silhouette without errors than what any method reports, on average over frames: it is not if images and body do not belong together.
fn truth_is_most_precise(store: &Store, group: &Group) -> Outcome<bool> {
    let results = Results { store, seeds: group.seeds, block: BLOCK };
    let precision = |contender: &Contender| -> Outcome<f64> {
        Ok(Mean::of(&results.means(group.level, contender, Estimate::Second, "clean_precision")?).value)
    };
    let truth = precision(&contender::TRUTH)?;
    let others = group.contenders.iter().filter(|of| of.thickness == contender::TRUTH.thickness && !of.is_reference());
    Ok(others.map(precision).collect::<Outcome<Vec<f64>>>()?.into_iter().all(|other| other < truth))
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let clock = Instant::now();
    let data = args.options.data(root);
    let folder = data.join("cmu_amc");
    let recordings = folder.is_dir().then_some(folder.as_path());
    if recordings.is_none() {
        println!("{}", no_recordings(&data));
    }
    let (name, which) = match (args.quick, args.pilot) {
        (true, _) => ("reproduce/coarse-to-fine-quick", Tracked::Test),
        (_, true) => ("reproduce/coarse-to-fine-pilot", Tracked::Training),
        _ => ("reproduce/coarse-to-fine", Tracked::Test),
    };
    let folder = args.options.folder(root, name)?;
    let frames = if args.quick { 24 } else { FRAMES };
    let scene = Scene::new(recordings, frames, which)?;
    let study = Study { scene, isa: Isa::best(), drawn: Shared::default() };
    let mut store = Store::open(&folder, &study.configuration())?;
    let threads = args.options.threads();
    let groups = groups(args);
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

/// Seeds of the pilot.
const PILOT_SEEDS: u64 = 3;

/// What the options ask for.
fn groups(args: &Args) -> Vec<Group> {
    let [decoupled, whole, .., fitted_whole] = READINGS;
    let readings = |of: &[Reading]| What::Readings(of.to_vec());
    if args.quick {
        return vec![Group::new(claims::LEVEL, readings(&[decoupled]), 1)];
    }
    if args.pilot {
        return [Level::Clean, claims::LEVEL].map(|level| Group::new(level, What::Pilot, PILOT_SEEDS)).into();
    }
    let all = [
        Group::new(claims::LEVEL, readings(&[decoupled, whole]), args.seeds),
        Group::new(claims::LEVEL, readings(&[READINGS[2], fitted_whole]), args.other_seeds),
        Group::new(claims::LEVEL, What::Equal(vec![decoupled, whole]), args.other_seeds),
        Group::new(Level::Clean, readings(&[decoupled]), args.level_seeds),
        Group::new(Level::Hard, readings(&[decoupled]), args.level_seeds),
        Group::new(claims::LEVEL, What::Beside, args.beside_seeds),
    ];
    all.into_iter().filter(|group| group.seeds > 0).collect()
}

#[cfg(test)]
mod tests {
    use crate::papers::reduced_size;

    /// The whole command in a reduced size: files are written, the true pose is the most precise, and coarse particles stand on their grid.
    #[test]
    fn the_reduced_study_holds() {
        reduced_size::holds(
            "coarse-to-fine",
            &["cells.jsonl", "tables.md", "claims.md", "results.json", "likelihood.svg"],
        );
    }
}
