//! `cargo xtask drawn-mutants`: draws mutants of the crates above the samplers, puts all of them behind switches into a copy of the workspace, builds it once, and asks which tests see each.
//!
//! 1. Candidates are found in the code (`candidates.rs`), and drawn with a fixed seed, from each crate in proportion to how many it has.
//! 2. They are written into a copy (`switches.rs`); those that do not compile are left out and not replaced.
//! 3. With each, the tests of its own crate run; with those that are left, the tests of the program that stand for all at the door ([`DOOR`]). Snapshots always pass. Who does not end in time is not caught.
//!
//! A line for each is added to `target/mutants/drawn.tsv`; the same command goes on from there.

mod candidates;
mod programs;
mod switches;

use crate::checkout;
use candidates::Mutant;
use programs::{Answer, Place, Program, patience};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Crates whose code is mutated: all above the samplers that compute, read or write what users read.
const CRATES: [&str; 16] = [
    "sinew",
    "sinew-analysis",
    "sinew-angles",
    "sinew-batch",
    "sinew-cli",
    "sinew-formats",
    "sinew-input",
    "sinew-latent",
    "sinew-markers",
    "sinew-motion",
    "sinew-report",
    "sinew-results",
    "sinew-setup",
    "sinew-simulate",
    "sinew-tracking",
    "sinew-words",
];

/// Tests of the program whose expected numbers come from elsewhere, or which hold what it promises of files; a minute together.
const DOOR: [&str; 8] = [
    "known_files",
    "known_camera",
    "result_folder",
    "gait",
    "motion_files",
    "calibrations",
    "files_of_others",
    "known_world",
];

/// Longest time of a test program that is run for each mutant of its crate.
const LONGEST: Duration = Duration::from_secs(90);

/// Options of the command.
#[derive(clap::Args)]
pub struct Args {
    /// How many to draw.
    #[arg(long, value_name = "N", default_value_t = 400)]
    count: usize,
    /// Which draw.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Print what is drawn and judge nothing.
    #[arg(long)]
    list: bool,
    /// Judge again only those of these numbers.
    #[arg(long, value_name = "N")]
    only: Vec<usize>,
}

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> ExitCode {
    match judge(root, args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(what) => {
            eprintln!("error: {what}");
            ExitCode::from(5)
        }
    }
}

/// Random numbers by SplitMix64 (Steele, Lea and Flood 2014).
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
    found.sort();
}

/// Mutants that are drawn; the place in the list is their number.
fn draw(root: &Path, count: usize, seed: u64) -> Result<Vec<Mutant>, String> {
    let mut texts = Vec::new();
    for name in CRATES {
        let mut paths = Vec::new();
        sources(&root.join("crates").join(name).join("src"), &mut paths);
        for path in paths {
            let text = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
            let file = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            texts.push((name, file, text));
        }
    }
    let defaults: BTreeSet<String> =
        texts.iter().flat_map(|(_, _, text)| candidates::types_with_defaults(text)).collect();
    let mut of_crates = BTreeMap::<&str, Vec<Mutant>>::new();
    for (name, file, text) in &texts {
        of_crates.entry(name).or_default().extend(candidates::find(file, text, &defaults));
    }
    let all: usize = of_crates.values().map(Vec::len).sum();
    let mut state = seed;
    let mut drawn: Vec<Mutant> = Vec::new();
    for mut of_crate in of_crates.into_values() {
        let share = (of_crate.len() * count).div_ceil(all);
        let first = drawn.len();
        while drawn.len() - first < share && !of_crate.is_empty() {
            let mutant = of_crate.swap_remove((next(&mut state) % of_crate.len() as u64) as usize);
            if !drawn[first..].iter().any(|other| other.file == mutant.file && switches::collide(other, &mutant)) {
                drawn.push(mutant);
            }
        }
    }
    Ok(drawn)
}

fn crate_of(mutant: &Mutant) -> &str {
    mutant.file.split('/').nth(1).unwrap_or_default()
}

/// The file that a crate is compiled from.
fn root_file(root: &Path, name: &str) -> Result<String, String> {
    let files = ["lib.rs", "main.rs"].map(|file| format!("crates/{name}/src/{file}"));
    files.into_iter().find(|file| root.join(file).exists()).ok_or_else(|| format!("{name} has no root"))
}

/// Writes the files of the copy with the mutants of these numbers; the lines of each.
fn write(
    root: &Path,
    checkout: &Path,
    drawn: &[Mutant],
    kept: &BTreeSet<usize>,
) -> Result<BTreeMap<String, switches::Switched>, String> {
    let mut written = BTreeMap::new();
    let files: BTreeSet<&String> = drawn.iter().map(|mutant| &mutant.file).collect();
    for name in CRATES {
        let root_file = root_file(root, name)?;
        let of_crate = files.iter().filter(|file| file.split('/').nth(1) == Some(name)).map(|file| (*file).clone());
        for file in of_crate.chain([root_file.clone()]).collect::<BTreeSet<_>>() {
            let text = fs::read_to_string(root.join(&file)).map_err(|e| format!("{file}: {e}"))?;
            let here = |k: &&usize| drawn[**k].file == file;
            let mutants = kept.iter().filter(here).map(|k| (*k, &drawn[*k])).collect();
            let mut switched = switches::switched(&text, &mutants);
            if file == root_file {
                switched.code += switches::FUNCTION;
            }
            let to = checkout.join(&file);
            checkout::write_if_new(&to, switched.code.as_bytes()).map_err(|e| format!("{file}: {e}"))?;
            written.insert(file, switched);
        }
    }
    Ok(written)
}

/// The mutants that compile, written into the copy.
fn compiling_mutants(
    root: &Path,
    place: &Place<'_>,
    drawn: &[Mutant],
    mut kept: BTreeSet<usize>,
) -> Result<BTreeSet<usize>, String> {
    loop {
        let written = write(root, place.checkout, drawn, &kept)?;
        let faults = programs::faults(place)?;
        if faults.is_empty() {
            return Ok(kept);
        }
        let before = kept.len();
        for fault in &faults {
            let lines = written.get(&fault.file).map(|file| &file.lines);
            let of_fault = lines.into_iter().flatten().filter(|(_, lines)| lines.contains(&fault.line));
            for (number, _) in of_fault {
                kept.remove(number);
            }
        }
        if let (true, Some(first)) = (kept.len() == before, faults.first()) {
            return Err(format!("{}:{}: {}", first.file, first.line, first.said));
        }
    }
}

/// Tests of a program whose names contain one text, and the time that they take without a mutant.
struct Timed<'a> {
    program: &'a Program,
    names: &'a [&'a str],
    alone: Duration,
}

/// Runs tests without a mutant.
fn timed<'a>(place: &Place<'_>, program: &'a Program, names: &'a [&'a str]) -> Result<Timed<'a>, String> {
    let started = Instant::now();
    let what = || format!("{} {} {}", program.package, program.target, names.join(" "));
    match program.answer(place, names, usize::MAX, Duration::from_secs(1200))? {
        Answer::Passed => Ok(Timed { program, names, alone: started.elapsed() }),
        Answer::Failed(test) => Err(format!("{} fails without a mutant: {test}", what())),
        Answer::Late => Err(format!("{} does not end", what())),
    }
}

fn is_door(program: &Program) -> bool {
    program.package == "sinew-cli" && program.target == "program"
}

/// The tests of a crate, the quickest program first.
fn own<'a>(place: &Place<'_>, programs: &'a [Program], package: &str) -> Result<Vec<Timed<'a>>, String> {
    let of_package = programs.iter().filter(|program| program.package == package && !is_door(program));
    let mut own = of_package.map(|program| timed(place, program, &[])).collect::<Result<Vec<_>, _>>()?;
    own.retain(|timed| timed.alone < LONGEST);
    own.sort_by_key(|timed| timed.alone);
    Ok(own)
}

/// Which tests see a mutant; `late` where none does and some do not end.
fn seen_by(place: &Place<'_>, tests: &[Timed<'_>], mutant: usize) -> Result<String, String> {
    let mut verdict = "missed\t".to_owned();
    for Timed { program, names, alone } in tests {
        match program.answer(place, names, mutant, patience(*alone))? {
            Answer::Passed => {}
            Answer::Failed(test) => return Ok(format!("caught\t{} {test}", program.target)),
            Answer::Late => verdict = "late\t".into(),
        }
    }
    Ok(verdict)
}

fn judge(root: &Path, args: &Args) -> Result<(), String> {
    let drawn = draw(root, args.count, args.seed)?;
    let line =
        |k: usize| format!("{k}\t{}:{}\t{}", drawn[k].file, drawn[k].line, drawn[k].what.replace(['\n', '\t'], " "));
    if args.list {
        (0..drawn.len()).for_each(|k| println!("{}", line(k)));
        return Ok(());
    }
    let (checkout, target) = (root.join("target/mutants/drawn"), root.join("target/mutants/build"));
    let roots = CRATES.iter().map(|name| root_file(root, name)).collect::<Result<Vec<_>, _>>()?;
    checkout::copy(root, &checkout, &drawn.iter().map(|mutant| mutant.file.clone()).chain(roots).collect())?;
    let beside = root.parent().map(|p| p.join("shared/data")).filter(|p| p.is_dir());
    let data = std::env::var_os("SINEW_DATA").or_else(|| beside.map(Into::into));
    let place = Place { checkout: &checkout, target: &target, data };
    let mut record = Record::open(&root.join("target/mutants/drawn.tsv"), &args.only)?;
    let built = |k: usize| format!("{}\tbuild", line(k));
    let tried: BTreeSet<usize> = (0..drawn.len()).filter(|k| !record.judged.contains_key(&built(*k))).collect();
    let kept = compiling_mutants(root, &place, &drawn, tried.clone())?;
    for k in tried.difference(&kept) {
        record.add(&built(*k), "does not compile\t".into())?;
    }
    println!("{} mutants drawn, {} compile", drawn.len(), kept.len());
    let programs = programs::build(&place)?;
    let mut of_crates = BTreeMap::<&str, Vec<Timed<'_>>>::new();
    let mut left = Vec::new();
    for k in kept {
        let (key, name) = (format!("{}\town", line(k)), crate_of(&drawn[k]));
        if record.lacks(&key, k) {
            if !of_crates.contains_key(name) {
                of_crates.insert(name, own(&place, &programs, name)?);
            }
            record.add(&key, seen_by(&place, &of_crates[name], k)?)?;
        }
        if !record.says_caught(&key) {
            left.push(k);
        }
    }
    println!("{} are left to the door", left.len());
    // In random order, so that those judged so far are a sample.
    let mut state = args.seed;
    left.sort_by_cached_key(|_| next(&mut state));
    let mut door = Vec::new();
    for k in left {
        let key = format!("{}\tdoor", line(k));
        if record.lacks(&key, k) {
            if door.is_empty() {
                let program = programs.iter().find(|program| is_door(program)).ok_or("there is no door")?;
                let timed = DOOR.iter().map(|name| timed(&place, program, std::slice::from_ref(name)));
                door = timed.collect::<Result<Vec<_>, _>>()?;
            }
            record.add(&key, seen_by(&place, &door, k)?)?;
        }
    }
    Ok(())
}

/// The table of verdicts: what was judged and by whom, and what came of it.
struct Record<'a> {
    path: PathBuf,
    file: fs::File,
    judged: BTreeMap<String, String>,
    only: &'a [usize],
}

impl<'a> Record<'a> {
    fn open(path: &Path, only: &'a [usize]) -> Result<Self, String> {
        let before = fs::read_to_string(path).unwrap_or_default();
        let file = fs::File::options().create(true).append(true).open(path);
        let file = file.map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Self { path: path.into(), file, judged: before.lines().filter_map(parted).collect(), only })
    }

    fn lacks(&self, key: &str, mutant: usize) -> bool {
        self.only.contains(&mutant) || self.only.is_empty() && !self.judged.contains_key(key)
    }

    fn add(&mut self, key: &str, verdict: String) -> Result<(), String> {
        println!("{key}\t{verdict}");
        writeln!(self.file, "{key}\t{verdict}").map_err(|e| format!("{}: {e}", self.path.display()))?;
        self.judged.insert(key.into(), verdict);
        Ok(())
    }

    fn says_caught(&self, key: &str) -> bool {
        self.judged.get(key).is_some_and(|verdict| verdict.starts_with("caught"))
    }
}

/// A line of the table of verdicts: what was judged and by whom, and the verdict.
fn parted(line: &str) -> Option<(String, String)> {
    let (at, _) = line.match_indices('\t').nth(3)?;
    Some((line[..at].into(), line[at + 1..].into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_draw_is_of_every_crate_and_none_collides() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace");
        let [drawn, other] = [1, 2].map(|seed| draw(root, 400, seed).expect("the code is read"));
        assert!(drawn != other && (400..420).contains(&drawn.len()), "{}", drawn.len());
        assert_eq!(drawn.iter().map(crate_of).collect::<BTreeSet<_>>(), CRATES.into_iter().collect());
        let collide = |k: usize| drawn[..k].iter().any(|m| m.file == drawn[k].file && switches::collide(m, &drawn[k]));
        assert!(!(0..drawn.len()).any(collide));
    }

    #[test]
    fn verdicts_are_read_back() {
        let line = "3\tsrc/a.rs:5\t+ → - in f\town\tcaught\tlib a::tests::b";
        let expected = ("3\tsrc/a.rs:5\t+ → - in f\town".to_owned(), "caught\tlib a::tests::b".to_owned());
        assert_eq!(parted(line), Some(expected));
    }
}
