//! Trackers where the posterior is known. Coordinates walk at random, each is seen with an independent normal error, and so every one has its own Kalman filter.

use super::interval_tally::{COLUMNS, LEVELS, Tally, summary};
use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, rows, run_all};
use crate::support::table::{header, percent, row};
use serde_json::{Value, json};
use sinew::core::density::{LogDensity, PartLogDensity};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::part::PartTree;
use sinew::core::random::Stage;
use sinew::tracking::Tracker;

const FRAMES: usize = 30;
/// Standard deviations of a step, of the first frame about its centre, 0, and of an observation.
pub(super) const STEP: f64 = 0.1;
pub(super) const FIRST: f64 = 0.1;
const SIGHT: f64 = 0.1;

/// Independent observations of all coordinates.
pub(super) struct Sight {
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

/// Number of coordinates of all parts.
pub(super) fn dim(tree: &PartTree) -> usize {
    tree.coordinates(&(0..tree.parents().len()).collect::<Vec<_>>()).len()
}

/// One series of a tracker of the coordinates of a tree: a row of [`Tally`].
pub(super) fn series(
    tree: &PartTree,
    mut tracker: Box<dyn Tracker<Sight>>,
    to_draw: Stage,
    to_track: Stage,
) -> Outcome<[f64; COLUMNS]> {
    let (dim, isa) = (dim(tree), Isa::best());
    let [steps, errors] = to_draw.split(["steps", "errors"]);
    let normals = |stage: Stage| {
        let mut drawn = vec![Block::ZERO; (FRAMES * dim).div_ceil(LANES)];
        stage.whole().fill_normal(isa, &mut drawn);
        drawn.iter().flat_map(|block| block.0).collect::<Vec<f64>>()
    };
    let (steps, errors) = (normals(steps), normals(errors));
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

/// A study of how often intervals hold the truth: trackers on bodies of several sizes.
pub(super) struct Coverage<C: 'static> {
    /// Of the random streams.
    pub(super) purpose: &'static str,
    /// Sizes of bodies, and how many coordinates a size has.
    pub(super) sizes: [usize; 3],
    pub(super) coordinates: fn(usize) -> usize,
    pub(super) contenders: &'static [(&'static str, C)],
    /// One series on a body of a size: a row of [`series`].
    pub(super) series: fn(usize, C, Stage) -> Outcome<[f64; COLUMNS]>,
}

impl<C: Copy + Send + Sync> Coverage<C> {
    fn key(&self, name: &str, size: usize, count: usize) -> String {
        format!("coverage/{}/{count}/{name}", (self.coordinates)(size))
    }

    /// Runs what is not done yet, `count` series a contender and size.
    pub(super) fn run(&self, store: &mut Store, count: usize, threads: usize) -> Outcome<()> {
        let mut tasks: Vec<Task<'_>> = vec![];
        for size in self.sizes {
            for &(name, contender) in self.contenders {
                let work = move || -> Outcome<Value> {
                    let stage = Stage::new(1, self.purpose);
                    let row = |run| Ok((self.series)(size, contender, stage.round(run))?.to_vec());
                    Ok(json!((0..count).map(row).collect::<Outcome<Vec<Vec<f64>>>>()?))
                };
                tasks.push((self.key(name, size, count), 1.0, Box::new(work)));
            }
        }
        run_all(store, "coverage", tasks, threads)
    }

    /// Coverage and spread by number of coordinates.
    pub(super) fn table(&self, store: &Store, count: usize) -> Outcome<String> {
        let levels = LEVELS.map(|level| format!("{:.0} %", 100.0 * level)).join(" | ");
        let mut out = header(&format!("| >coordinates | | {levels} | sd / exact | mean off, exact sd |"));
        for size in self.sizes {
            for (name, _) in self.contenders {
                let key = self.key(name, size, count);
                let found = summary(&rows(store.get(&key).ok_or(format!("the cell {key} is missing"))?));
                let shares: Vec<String> = found[..LEVELS.len()].iter().map(|share| percent(*share, 1)).collect();
                let [spread, off] = [found[LEVELS.len()][0], found[LEVELS.len() + 1][0]];
                let coordinates = (self.coordinates)(size);
                row!(out, "{coordinates} | {name} | {} | {spread:.2} | {off:.2}", shares.join(" | "));
            }
        }
        Ok(out)
    }
}
