//! `cargo xtask study coverage`: how often the intervals of tracked people hold the truth.
//!
//! And where the truth falls among the draws: the tables and figures of docs/evidence/coverage.md.
//!
//! | file | what |
//! |---|---|
//! | [`people`] | who moves |
//! | [`scene`] | one series: film, set-up, track, rank |
//! | [`found`] | what the series of a scene come to |
//! | [`coordinates`] | which degrees of freedom are calibrated |
//! | [`tables`], [`figures`] | as files |
//!
//! A series is independent of the others in its noise, its stretch of motion and its random streams, so that standard errors and χ² rest on series, never on the frames and joints of one.

mod coordinates;
mod figures;
mod found;
mod people;
mod scene;
mod tables;

use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, run_all};
use crate::support::study_options::StudyOptions;
use found::Found;
use people::Person;
use scene::{FEW, LONG, Length, PARTICLES, SHORT, Scene, Series, Sizes, Tracker, Wrong, seeds};
use serde_json::Value;
use sinew::config::settings::Settings;
use sinew::core::lanes::Isa;
use sinew_tests::evaluation::ranks::LEVELS;
use std::ops::Range;
use std::path::Path;
use std::time::Instant;

/// Measures how often intervals hold the truth of simulated people.
#[derive(clap::Args)]
pub struct Args {
    /// A tenth of the series, in minutes
    #[arg(long)]
    quick: bool,
    /// Only the coverage of the main scene, in a minute or two
    #[arg(long)]
    main: bool,
    /// Only the ranks of each degree of freedom on the model's own motion, from this number of series
    #[arg(long, value_name = "SERIES")]
    coordinates: Option<usize>,
    /// Only scenes whose key holds this text, such as `exchanged`; tables show what has been run so far
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Seed of the first series
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    options: StudyOptions,
}

/// How much is run: numbers of series.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Of the scenes whose ranks are drawn.
    pub ranked: usize,
    /// Of the other scenes; half as many of `bootstrap`.
    pub others: usize,
    /// Recordings that warnings are counted on.
    pub recordings: usize,
}

impl Size {
    /// What docs/evidence/coverage.md shows.
    const FULL: Self = Self { ranked: 500, others: 40, recordings: 10 };
    const QUICK: Self = Self { ranked: 50, others: 10, recordings: 5 };
    /// About a minute on one core: the main scene alone.
    pub const NIGHTLY: Self = Self { ranked: 150, others: 0, recordings: 0 };
}

/// Coverage of the main scene.
#[derive(Clone, Copy, Debug)]
pub struct Checked {
    /// Promised coverages, 0 to 1.
    pub promised: [f64; LEVELS.len()],
    /// Found ones.
    pub coverage: [f64; LEVELS.len()],
    /// Their standard errors, from a bootstrap of whole series.
    pub error: [f64; LEVELS.len()],
    /// Series.
    pub series: usize,
}

/// Default settings, four cameras, sizes of the set-up, noise as assumed.
const MAIN: Scene = Scene::Person { cameras: 4, tracker: Tracker::Hmc, sizes: Sizes::Fitted, wrong: Wrong::Right };

/// Coverage of the main scene, with recorded motion where there is some: target 90 ± 3 % at level 0.9.
///
/// # Errors
/// Errors of the files and the tracker.
pub fn check(root: &Path, seed: u64, size: Size) -> Outcome<Checked> {
    let people = people::all(&StudyOptions::default().data(root))?;
    let all = series(&MAIN, &people, SHORT, 0..size.ranked, seed)?;
    let found = Found::of(&all);
    Ok(Checked {
        promised: LEVELS,
        coverage: LEVELS.map(|level| found.pooled_at(level)[0]),
        error: LEVELS.map(|level| found.pooled_at(level)[1]),
        series: all.len(),
    })
}

/// The degree of freedom whose ranks are least uniform on the model's own motion, over a number of series: its name, their width, and a probability (Bonferroni).
///
/// # Errors
/// Errors of the tracker.
pub fn worst_coordinate(series: usize, seed: u64) -> Outcome<(String, f64, f64)> {
    coordinates::worst(series, seed)
}

/// Some of the series of a scene.
fn series(scene: &Scene, people: &[Person], length: Length, numbers: Range<usize>, seed: u64) -> Outcome<Vec<Series>> {
    seeds(numbers, seed).into_iter().map(|seed| scene::series(scene, people, length, seed)).collect()
}

/// Scenes whose ranks are drawn.
const RANKED: [Scene; 4] = [
    MAIN,
    Scene::OwnModel { tracker: Tracker::Hmc },
    Scene::Person { cameras: 4, tracker: FEW, sizes: Sizes::Fitted, wrong: Wrong::Right },
    Scene::OwnModel { tracker: PARTICLES },
];

/// Cameras and sizes with the noise as assumed, less what is ranked. With one camera only sizes of the set-up: it finds others again, and would take them for certain.
fn as_assumed() -> Vec<Scene> {
    let mut scenes = vec![];
    for tracker in [Tracker::Hmc, PARTICLES] {
        for cameras in [4, 2, 1] {
            for sizes in [Sizes::Known, Sizes::Fitted, Sizes::Limbs, Sizes::Other] {
                let scene = Scene::Person { cameras, tracker, sizes, wrong: Wrong::Right };
                let wanted = tracker == Tracker::Hmc || matches!(sizes, Sizes::Known | Sizes::Fitted) || cameras == 4;
                let wanted = wanted && (cameras > 1 || sizes == Sizes::Fitted);
                if wanted && !RANKED.contains(&scene) {
                    scenes.push(scene);
                }
            }
        }
    }
    scenes
}

/// Errors of fixed size that real recordings have, each alone and all together: with any number of cameras.
const RECORDED_ERRORS: [Wrong; 6] = [
    Wrong::Recorded,
    Wrong::Calibration,
    Wrong::Biased(scene::BIAS_PX),
    Wrong::Swapped(0.02),
    Wrong::Swapped(0.1),
    Wrong::All,
];

/// Every way of being wrong about the keypoints.
fn otherwise() -> Vec<Scene> {
    let four = [
        Wrong::Offset(3.0),
        Wrong::Offset(6.0),
        Wrong::Moved(3.0),
        Wrong::Moved(6.0),
        Wrong::Outliers(0.05),
        Wrong::Outliers(0.02),
        Wrong::Outliers(0.0),
        Wrong::Persistent,
        Wrong::Understated,
    ];
    let scene = |cameras, wrong| Scene::Person { cameras, tracker: Tracker::Hmc, sizes: Sizes::Fitted, wrong };
    let with_four = four.into_iter().map(|wrong| scene(4, wrong));
    with_four
        .chain([4, 2, 1].into_iter().flat_map(|cameras| RECORDED_ERRORS.map(|wrong| scene(cameras, wrong))))
        .collect()
}

/// Scenes whose warnings are counted: all but the model's own, by `hmc`.
fn warned() -> Vec<Scene> {
    let people = |scene: &Scene| matches!(scene, Scene::Person { tracker: Tracker::Hmc, .. });
    let all = [RANKED.to_vec(), as_assumed(), otherwise()].concat();
    all.into_iter().filter(people).collect()
}

/// Raised with every change of what a cell computes.
const VERSION: u32 = 3;

fn configuration(args: &Args, people: &[Person]) -> String {
    let names: Vec<String> = people.iter().map(|p| format!("{} {:?}", p.subject, p.proportions)).collect();
    format!(
        "version {VERSION}, {}, seed {}, {SHORT:?}, {LONG:?}, {:?}, {}",
        Isa::best().name(),
        args.seed,
        Settings::default(),
        names.join("; ")
    )
}

/// Series of a cell: a stopped run resumes from the last of these.
const CELL: usize = 10;

/// A kind of experiment on some scenes.
struct Kind {
    /// Name in keys.
    name: &'static str,
    length: Length,
    scenes: Vec<Scene>,
    /// Series of each scene.
    count: usize,
}

impl Kind {
    fn of(&self, scene: &Scene) -> usize {
        // Particles cost more than chains.
        if scene.tracker() == PARTICLES && self.scenes.len() > RANKED.len() { self.count / 2 } else { self.count }
    }

    fn keys(&self, scene: &Scene) -> impl Iterator<Item = (Range<usize>, String)> {
        let (count, start) = (self.of(scene), format!("{}/{}", self.name, scene.key()));
        let numbers = (0..count).step_by(CELL).map(move |first| first..(first + CELL).min(count));
        numbers.map(move |numbers| (numbers.clone(), format!("{start}/{}-{}", numbers.start, numbers.end)))
    }

    fn tasks<'a>(&self, people: &'a [Person], seed: u64) -> Vec<Task<'a>> {
        let length = self.length;
        let of = |&scene: &Scene| {
            let task = move |(numbers, key): (Range<usize>, String)| -> Task<'a> {
                let work = if scene.tracker() == PARTICLES { 3.0 } else { 1.0 };
                let work = work * (numbers.len() * (length.tracked + length.seen)) as f64;
                let run = move || -> Outcome<Value> {
                    let all = series(&scene, people, length, numbers.clone(), seed)?;
                    Ok(Value::Array(all.iter().map(Series::to_json).collect()))
                };
                (key, work, Box::new(run))
            };
            self.keys(&scene).map(task).collect::<Vec<_>>()
        };
        self.scenes.iter().flat_map(of).collect()
    }

    fn found(&self, store: &Store) -> Vec<(Scene, Found)> {
        let of = |scene: &Scene| {
            let cells = self.keys(scene).filter_map(|(_, key)| store.get(&key)?.as_array());
            (*scene, Found::of(&cells.flatten().map(Series::from_json).collect::<Vec<_>>()))
        };
        self.scenes.iter().map(of).filter(|(_, found)| found.series > 0).collect()
    }
}

fn measure(root: &Path, args: &Args) -> Outcome<()> {
    let clock = Instant::now();
    let people = people::all(&args.options.data(root))?;
    let size = if args.quick { Size::QUICK } else { Size::FULL };
    let folder = args.options.folder(root, if args.quick { "coverage-quick" } else { "coverage" })?;
    let mut store = Store::open(&folder, &configuration(args, &people))?;
    let has_recorded = people.iter().all(|person| person.recorded.is_some());
    let possible = |scenes: Vec<Scene>| -> Vec<Scene> {
        let needs = |scene: &Scene| matches!(scene, Scene::Person { wrong: Wrong::Recorded | Wrong::All, .. });
        scenes.into_iter().filter(|scene| has_recorded || !needs(scene)).collect()
    };
    let kind = |name, length, scenes, count| Kind { name, length, scenes: possible(scenes), count };
    let ranked = kind("series", SHORT, RANKED.to_vec(), size.ranked);
    let others = kind("series", SHORT, [as_assumed(), otherwise()].concat(), size.others);
    let recordings = kind("recordings", LONG, warned(), size.recordings);
    let mut cells = vec![];
    for kind in [&others, &recordings, &ranked] {
        cells.extend(kind.tasks(&people, args.seed));
    }
    if let Some(only) = &args.only {
        cells.retain(|(key, ..)| key.contains(only));
    }
    run_all(&mut store, "coverage", cells, args.options.threads())?;
    let series = [ranked.found(&store), others.found(&store)].concat();
    let recordings = recordings.found(&store);
    let text = tables::markdown(&series, &recordings, &RANKED);
    std::fs::write(folder.join("tables.md"), &text)?;
    if args.only.is_none() {
        let pictures = if args.quick { folder.clone() } else { root.join("docs/evidence/images") };
        figures::draw(&series, &RANKED, &pictures)?;
    }
    println!("{text}\n{:.0} s; cells and tables in {}", clock.elapsed().as_secs_f64(), folder.display());
    Ok(())
}

fn main_scene(root: &Path, seed: u64) -> Outcome<()> {
    let found = check(root, seed, Size::NIGHTLY)?;
    println!("{} series, seed {seed}", found.series);
    for ((promised, coverage), error) in found.promised.iter().zip(found.coverage).zip(found.error) {
        println!("promised {promised}, found {coverage:.4} ± {error:.4}");
    }
    Ok(())
}

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> Outcome<()> {
    match args.coordinates {
        Some(count) => coordinates::measure(count, args.seed).map(|table| print!("{table}")),
        None if args.main => main_scene(root, args.seed),
        None => measure(root, args),
    }
}
