//! How often the intervals of the tracker's weighted set hold the truth.
//!
//! On bodies made of numbers, where the posterior is known: a trunk of two coordinates and chains of two parts on it, all of which walk at random and are seen with independent normal errors. The likelihood is the product of its parts, so that nothing but the
//! tracker's own steps takes its set away from the posterior.

use crate::papers::interval_tally::COLUMNS;
use crate::papers::known_posterior::{self, Coverage, FIRST, STEP, Sight};
use crate::support::outcome::Outcome;
use sinew::core::lanes::Isa;
use sinew::core::part::{Part, PartTree, Partition};
use sinew::core::random::Stage;
use sinew::dynamics::level_walk::LevelWalk;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::samplers::levels::Selection;
use sinew::samplers::resample::Truncation;
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::hppf::{self, Hppf};

const TRUNK: usize = 2;

/// Whose intervals are looked at.
#[derive(Clone, Copy, Debug)]
pub(super) enum Contender {
    Bootstrap(usize),
    Hppf(usize, Truncation, f64),
}

const CONTENDERS: &[(&str, Contender)] = &[
    ("bootstrap 20 000", Contender::Bootstrap(20_000)),
    ("hppf 200", Contender::Hppf(200, Truncation::KeepOnceRefill, 0.8)),
    ("hppf 1000", Contender::Hppf(1000, Truncation::KeepOnceRefill, 0.8)),
    ("hppf 1000, systematic of all", Contender::Hppf(1000, Truncation::TruncateThenSystematic, 1.0)),
];

/// By chains on the trunk.
pub(super) const COVERAGE: Coverage<Contender> = Coverage {
    purpose: "hppf coverage",
    sizes: [0, 2, 4],
    coordinates: |chains| TRUNK + 2 * chains,
    contenders: CONTENDERS,
    series,
};

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

/// One series: a row of [`known_posterior::series`].
fn series(chains: usize, contender: Contender, stage: Stage) -> Outcome<[f64; COLUMNS]> {
    let (tree, isa) = (tree(chains)?, Isa::best());
    let dim = known_posterior::dim(&tree);
    let [to_draw, to_track] = stage.split(["data", "tracker"]);
    let centre = vec![0.0; dim];
    let tracker: Box<dyn Tracker<Sight>> = match contender {
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
            Box::new(Hppf::new(config, walk, &tree, centre)?)
        }
    };
    known_posterior::series(&tree, tracker, to_draw, to_track)
}
