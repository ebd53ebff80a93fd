//! `cargo xtask study checksums`: what the program writes and says at fixed seeds, as one checksum a file.
//!
//! It runs the steps of `checksums.txt`, and holds every file that they write, and every answer, against `tests/checksums.tsv`. A rebuilding changes none of them, but for what it names.
//! Sums are of one instruction set (AVX2) and of one operating system: libraries of C differ in last digits.

use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::study_options::ProgramOptions;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Holds results at fixed seeds against stored checksums.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Store what was found as what is to come
    #[arg(long)]
    write: bool,
    /// Only steps whose names begin so, and those named `model` and `people`, which others need
    #[arg(long)]
    only: Option<String>,
    #[command(flatten)]
    options: ProgramOptions,
}

/// `name codes: arguments`, one step a line.
const STEPS: &str = include_str!("checksums.txt");
const STORED: &str = "tests/checksums.tsv";
/// The one file of a result that differs from run to run.
const TIMES: &str = "timings.json";
/// Exit codes of a step that has written its results.
const WRITTEN: [i32; 2] = [0, 4];

/// FNV-1a, 64 bits.
fn sum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Bytes in which folders of this machine have a name.
fn placed(bytes: Vec<u8>, folders: &[(String, &str)]) -> Vec<u8> {
    folders.iter().fold(bytes, |bytes, (folder, name)| {
        let (mut placed, mut rest) = (Vec::with_capacity(bytes.len()), &bytes[..]);
        while let Some(at) = rest.windows(folder.len()).position(|window| window == folder.as_bytes()) {
            placed.extend_from_slice(&rest[..at]);
            placed.extend_from_slice(name.as_bytes());
            rest = &rest[at + folder.len()..];
        }
        placed.extend_from_slice(rest);
        placed
    })
}

/// Sums of files, those of a store or of a numbered series as one: `masks/left_1.png` and `masks/left_2.png` are `masks/*`.
fn grouped(of_files: &BTreeMap<String, u64>) -> BTreeMap<String, String> {
    let mut texts: BTreeMap<String, (String, u64)> = BTreeMap::new();
    for (place, own) in of_files {
        let is_number =
            |part: &str| part.split('.').next().is_some_and(|stem| stem.ends_with(|c: char| c.is_ascii_digit()));
        let parts: Vec<&str> = place.split('/').collect();
        let store = parts.iter().position(|part| part.ends_with(".zarr"));
        let named = store.or(parts.iter().rposition(|part| !is_number(part))).map_or(0, |last| last + 1);
        let series = if named < parts.len() { format!("{}/*", parts[..named].join("/")) } else { place.clone() };
        let group = texts.entry(series).or_default();
        *group = (format!("{}{place} {own:016x}\n", group.0), *own);
    }
    let one = |(text, own): (String, u64)| if text.lines().count() == 1 { own } else { sum(text.as_bytes()) };
    texts.into_iter().map(|(series, group)| (series, format!("{:016x}", one(group)))).collect()
}

/// All files below a path, or the file that it is.
fn files_below(path: &Path, found: &mut Vec<PathBuf>) -> Outcome<()> {
    if path.is_file() {
        found.push(path.to_owned());
    } else if path.is_dir() {
        for entry in fs::read_dir(path)? {
            files_below(&entry?.path(), found)?;
        }
    }
    Ok(())
}

/// Sums by step and file.
fn found(program: &Program, data: &Path, only: Option<&str>) -> Outcome<BTreeMap<String, String>> {
    let folder = &program.folder;
    let folders = [(shown(folder), "OUT"), (shown(data), "DATA")];
    let mut sums = BTreeMap::new();
    for line in STEPS.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let (name, arguments) = line.split_once(": ").ok_or_else(|| format!("no arguments: {line}"))?;
        let needed = |begin: &str| name.starts_with(begin) || ["model", "people"].iter().any(|n| name.starts_with(n));
        if only.is_some_and(|begin| !needed(begin)) {
            continue;
        }
        let arguments = arguments.replace("DATA", &folders[1].0).replace("OUT", &folders[0].0);
        let ran = Command::new(&program.path)
            .args(arguments.split_whitespace())
            .args(["--force", "--no-progress", "--threads", "2"])
            .current_dir(folder)
            .env("SINEW_SIMD", "avx2")
            .output()?;
        let code = ran.status.code().unwrap_or(-1);
        if !WRITTEN.contains(&code) {
            eprintln!("sinew {arguments}\n{}", String::from_utf8_lossy(&ran.stderr));
        }
        eprintln!("{name}: exit code {code}");
        sums.insert(format!("{name}\texit code"), code.to_string());
        // What tracking and learning say has times in it.
        if !["track ", "demo ", "learn "].iter().any(|timed| arguments.starts_with(timed)) {
            let said = placed(ran.stdout, &folders);
            sums.insert(format!("{name}\tanswer"), format!("{:016x}", sum(&said)));
        }
        let mut files = vec![];
        let own =
            |path: &Path| path.file_name().is_some_and(|file| file.to_string_lossy().split('.').next() == Some(name));
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if own(&path) {
                files_below(&path, &mut files)?;
            }
        }
        let mut of_files = BTreeMap::new();
        for file in files.iter().filter(|file| !file.ends_with(TIMES)) {
            let bytes = placed(fs::read(file)?, &folders);
            of_files.insert(shown(file.strip_prefix(folder)?), sum(&bytes));
        }
        sums.extend(grouped(&of_files).into_iter().map(|(place, sum)| (format!("{name}\t{place}"), sum)));
    }
    Ok(sums)
}

pub(crate) fn run(root: &Path, args: &Args) -> Outcome<()> {
    fs::remove_dir_all(args.options.folder(root, "checksums")?)?;
    let data = fs::canonicalize(args.options.data(root))?;
    let Program { path, folder } = args.options.program(root, "checksums")?;
    let program = Program { path: fs::canonicalize(path)?, folder: fs::canonicalize(folder)? };
    let sums = found(&program, &data, args.only.as_deref())?;
    if args.write {
        let lines: String = sums.iter().map(|(place, sum)| format!("{place}\t{sum}\n")).collect();
        fs::write(root.join(STORED), lines)?;
        return Ok(());
    }
    let stored = fs::read_to_string(root.join(STORED))?;
    let stored: BTreeMap<&str, &str> = stored.lines().filter_map(|line| line.rsplit_once('\t')).collect();
    let mut changed = vec![];
    for (place, sum) in &sums {
        match stored.get(place.as_str()) {
            Some(known) if known == sum => {}
            Some(_) => changed.push(format!("changed\t{place}")),
            None => changed.push(format!("new\t{place}")),
        }
    }
    let ran = |place: &str| sums.contains_key(&format!("{}\texit code", place.split('\t').next().unwrap_or("")));
    changed.extend(stored.keys().filter(|p| ran(p) && !sums.contains_key(**p)).map(|place| format!("gone\t{place}")));
    println!("{} of {} as stored", sums.len() - changed.iter().filter(|c| !c.starts_with("gone")).count(), sums.len());
    changed.iter().for_each(|line| println!("{line}"));
    if changed.is_empty() { Ok(()) } else { Err(format!("{} checksums differ", changed.len()).into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_have_names_and_the_rest_stays() {
        let folders = [("/a/b".to_owned(), "OUT")];
        assert_eq!(placed(b"x /a/b/c /a/b".to_vec(), &folders), b"x OUT/c OUT");
        assert_eq!(sum(b"a"), 0xaf63_dc4c_8601_ec8c);
        let files =
            ["a/c/0_1.png", "a/c/0_2.png", "a/b.csv", "a/d.zarr/e/zarr.json"].map(|file| (file.to_owned(), 1)).into();
        assert_eq!(grouped(&files).into_keys().collect::<Vec<_>>(), ["a/b.csv", "a/c/*", "a/d.zarr/*"]);
    }
}
