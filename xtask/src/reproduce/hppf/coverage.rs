//! How often the intervals of the tracker's weighted set hold the truth.
//!
//! On bodies made of numbers, where the posterior is known: a trunk of two coordinates and chains of two parts on it, all of which walk at random and are seen with independent normal errors. The likelihood is the product of its parts, so that nothing but the
//! tracker's own steps takes its set away from the posterior.

use crate::outcome::Outcome;
use crate::reproduce::interval_tally::{COLUMNS, LEVELS, Tally, summary};
use crate::store::{Store, Task, rows, run_all};
use serde_json::{Value, json};
use sinew::core::density::{LogDensity, PartLogDensity};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::part::{Part, PartTree, Partition};
use sinew::core::random::Stage;
use sinew::dynamics::level_walk::LevelWalk;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::samplers::levels::Selection;
use sinew::samplers::resample::Truncation;
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::hppf::{self, Hppf};
use std::fmt::Write as _;

/// Chains on the trunk.
const CHAINS: [usize; 3] = [0, 2, 4];
const TRUNK: usize = 2;
const FRAMES: usize = 30;
/// Standard deviations of a step, of the first frame about its centre, and of an observation.
const STEP: f64 = 0.1;
const FIRST: f64 = 0.1;
const SIGHT: f64 = 0.1;

/// Whose intervals are looked at.
#[derive(Clone, Copy, Debug)]
enum Contender {
    Bootstrap(usize),
    Hppf(usize, Truncation, f64),
}

const CONTENDERS: [(&str, Contender); 4] = [
    ("bootstrap 20 000", Contender::Bootstrap(20_000)),
    ("hppf 200", Contender::Hppf(200, Truncation::KeepOnceRefill, 0.8)),
    ("hppf 1000", Contender::Hppf(1000, Truncation::KeepOnceRefill, 0.8)),
    ("hppf 1000, systematic of all", Contender::Hppf(1000, Truncation::TruncateThenSystematic, 1.0)),
];

/// Independent observations of all coordinates.
struct Sight {
    tree: PartTree,
    seen: Vec<f64>,
}

impl Sight {
    fn log_density_of(&self, coordinates: impl Iterator<Item = usize> + Clone, x: &[Block]) -> Block {
        let square = |lane: usize, j: usize| ((x[j].0[lane] - self.seen[j]) / SIGHT).powi(2);
        Block(core::array::from_fn::<f64, LANES, _>(|lane| {
            -0.5 * coordinates.clone().map(|j| square(lane, j)).sum::<f64>()
        }))
    }
}

impl LogDensity for Sight {
    fn dim(&self) -> usize {
        self.seen.len()
    }

    fn log_density(&self, x: &[f64]) -> f64 {
        let block: Vec<Block> = x.iter().map(|&x| Block::splat(x)).collect();
        self.log_density_of(0..x.len(), &block).0[0]
    }

    fn log_density_block(&self, x: &[Block], _ws: &mut [Block]) -> Block {
        self.log_density_of(0..x.len(), x)
    }
}

impl PartLogDensity for Sight {
    fn parts(&self) -> usize {
        self.tree.parents().len()
    }

    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        for (&part, out) in parts.iter().zip(out) {
            let own = self.tree.partition().parts()[part].indices();
            *out = self.log_density_of(own.iter().copied(), x);
        }
    }
}

fn tree(chains: usize) -> Outcome<PartTree> {
    let dim = TRUNK + 2 * chains;
    let mut parts = vec![Part::new((0..TRUNK).collect(), dim)?];
    let mut parents = vec![None];
    for j in TRUNK..dim {
        parts.push(Part::new(vec![j], dim)?);
        parents.push(Some(if j < TRUNK + chains { 0 } else { parts.len() - 1 - chains }));
    }
    Ok(PartTree::new(Partition::new(parts, dim)?, parents)?)
}

/// One series: a row of [`Tally`].
fn series(tree: &PartTree, contender: Contender, stage: Stage) -> Outcome<[f64; COLUMNS]> {
    let (dim, isa) = (tree.coordinates(&(0..tree.parents().len()).collect::<Vec<_>>()).len(), Isa::best());
    let [to_draw, to_track] = stage.split(["data", "tracker"]);
    let [steps, errors] = to_draw.split(["steps", "errors"]);
    let normals = |stage: Stage| {
        let mut drawn = vec![Block::ZERO; (FRAMES * dim).div_ceil(LANES)];
        stage.whole().fill_normal(isa, &mut drawn);
        drawn.iter().flat_map(|block| block.0).collect::<Vec<f64>>()
    };
    let (steps, errors) = (normals(steps), normals(errors));
    let centre = vec![0.0; dim];
    let mut tracker: Box<dyn Tracker<Sight>> = match contender {
        Contender::Bootstrap(particles) => {
            let walk =
                RandomWalk::new(&vec![STEP; dim], 1.0, Between::Mixture, isa)?.with_initial_sd(vec![FIRST; dim])?;
            let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
            Box::new(Bootstrap::new(config, walk, centre)?)
        }
        Contender::Hppf(particles, truncation, surviving) => {
            let walk = LevelWalk::new(tree.clone(), vec![STEP; dim], vec![FIRST; dim], isa)?;
            let selection = Selection { truncation, surviving };
            let config = hppf::Config { particles, selection, ..hppf::Config::default() };
            Box::new(Hppf::new(config, walk, tree, centre)?)
        }
    };
    let (mut truth, mut mean, mut variance) = (vec![0.0; dim], vec![0.0; dim], 0.0);
    let mut tally = Tally::default();
    for frame in 0..FRAMES {
        let step = if frame == 0 { FIRST } else { STEP };
        let drawn = frame * dim..(frame + 1) * dim;
        truth.iter_mut().zip(&steps[drawn.clone()]).for_each(|(x, z)| *x += step * z);
        let seen: Vec<f64> = truth.iter().zip(&errors[drawn]).map(|(x, z)| x + SIGHT * z).collect();
        let predicted: f64 = variance + step * step;
        let gain = predicted / (predicted + SIGHT * SIGHT);
        mean.iter_mut().zip(&seen).for_each(|(mean, seen)| *mean += gain * (seen - *mean));
        variance = (1.0 - gain) * predicted;
        tracker.step(&Sight { tree: tree.clone(), seen }, to_track.round(0).at_frame(frame as u32))?;
        tally.add(&tracker.posterior(), &truth, &mean, &vec![variance.sqrt(); dim]);
    }
    Ok(tally.row())
}

fn key(name: &str, chains: usize, count: usize) -> String {
    format!("coverage/{}/{count}/{name}", TRUNK + 2 * chains)
}

/// Runs what is not done yet, `count` series a contender and size.
pub(super) fn run(store: &mut Store, count: usize, threads: usize) -> Outcome<()> {
    let mut tasks: Vec<Task<'_>> = vec![];
    for chains in CHAINS {
        for (name, contender) in CONTENDERS {
            let work = move || -> Outcome<Value> {
                let tree = tree(chains)?;
                let stage = Stage::new(1, "hppf coverage");
                let row = |run| Ok(series(&tree, contender, stage.round(run))?.to_vec());
                Ok(json!((0..count).map(row).collect::<Outcome<Vec<Vec<f64>>>>()?))
            };
            tasks.push((key(name, chains, count), 1.0, Box::new(work)));
        }
    }
    run_all(store, "coverage", tasks, threads)
}

/// Coverage and spread by number of coordinates.
pub(super) fn table(store: &Store, count: usize) -> Outcome<String> {
    let mut out = String::from("| coordinates | |");
    LEVELS.iter().for_each(|level| out += &format!(" {:.0} % |", 100.0 * level));
    out += " sd / exact | mean off, exact sd |\n|--:|---|---|---|---|---|---|---|\n";
    for chains in CHAINS {
        for (name, _) in CONTENDERS {
            let key = key(name, chains, count);
            let found = summary(&rows(store.get(&key).ok_or(format!("the cell {key} is missing"))?));
            let _ = write!(out, "| {} | {name} |", TRUNK + 2 * chains);
            for [share, error] in &found[..LEVELS.len()] {
                let _ = write!(out, " {:.1} ± {:.1} |", 100.0 * share, 100.0 * error);
            }
            let [spread, off] = [found[LEVELS.len()][0], found[LEVELS.len() + 1][0]];
            let _ = writeln!(out, " {spread:.2} | {off:.2} |");
        }
    }
    Ok(out)
}
