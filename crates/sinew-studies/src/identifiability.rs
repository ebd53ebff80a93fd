//! `cargo xtask study identifiability`: how far data tell the constants of a set-up apart, the tables of docs/evidence/identifiability.md.
//!
//! The measurement is a function of the test member (`sinew_tests::identifiability`).

use crate::support::outcome::Outcome;
use crate::support::table::{header, row};
use sinew_tests::identifiability::{Pair, Scene, pairs};
use std::path::{Path, PathBuf};

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Recordings of each scene.
    #[arg(long, default_value_t = 5)]
    seeds: u64,
    /// Folder of the tables [default: target/identifiability]
    #[arg(long)]
    out: Option<PathBuf>,
}

/// First seed.
const FIRST: u64 = 1;

const WALK_S: f64 = 6.0;
const STAND_S: f64 = 1.0;

/// The scenes, one table each.
const SCENES: [(&str, Scene); 4] = [
    ("four cameras, a walk", Scene { cameras: 4, duration_s: WALK_S }),
    ("four cameras, standing", Scene { cameras: 4, duration_s: STAND_S }),
    ("two cameras, a walk", Scene { cameras: 2, duration_s: WALK_S }),
    ("one camera, a walk", Scene { cameras: 1, duration_s: WALK_S }),
];

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> Outcome<()> {
    let out = args.out.clone().unwrap_or_else(|| root.join("target/identifiability"));
    std::fs::create_dir_all(&out)?;
    let mut tables = String::new();
    for (name, scene) in SCENES {
        let seeds = FIRST..FIRST + args.seeds;
        let found = seeds.map(|seed| pairs(scene, seed)).collect::<Outcome<Vec<Vec<Pair>>>>()?;
        let table = table(name, &found)?;
        println!("{table}");
        tables += &table;
    }
    std::fs::write(out.join("tables.md"), tables)?;
    Ok(())
}

/// A scene's table; `found` are the pairs of each seed.
fn table(name: &str, found: &[Vec<Pair>]) -> Outcome<String> {
    let mut text = format!("## {name}\n\n") + &header("| pair | first | second | sum | correlation |");
    for (index, pair) in found.first().into_iter().flatten().enumerate() {
        let of = |what: &dyn Fn(&Pair) -> f64| shown(found.iter().filter_map(|pairs| pairs.get(index)).map(what));
        let left = [0, 1, 2].map(|k: usize| of(&|pair| pair.left[k]));
        let correlation = of(&|pair| pair.correlation);
        // Where there is no second, the sum is the first.
        let sum = if left[1].is_empty() { "" } else { &left[2] };
        row!(text, "{} | {} | {} | {sum} | {correlation}", pair.name, left[0], left[1]);
    }
    Ok(text + "\n")
}

/// Mean and standard deviation over the seeds; nothing where there is no number.
fn shown(numbers: impl Iterator<Item = f64>) -> String {
    let numbers: Vec<f64> = numbers.collect();
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let sd = (numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt();
    if mean.is_nan() { String::new() } else { format!("{mean:.2} ± {sd:.2}") }
}
