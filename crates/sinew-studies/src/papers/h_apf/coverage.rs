//! How often the intervals of the trackers' sets hold the truth.
//!
//! On poses made of numbers, where the posterior is known: a place of two coordinates and limbs of two on it. Latents are the coordinates themselves, so that nothing but the tracker's own steps takes its set away from the posterior. The hierarchy has the whole pose, and below it every limb.

use crate::papers::interval_tally::COLUMNS;
use crate::papers::known_posterior::{self, Coverage, FIRST, STEP, Sight};
use crate::support::outcome::Outcome;
use sinew::core::beside::Beside;
use sinew::core::decode::{Identity, Linear};
use sinew::core::density::Lanes;
use sinew::core::hierarchy::{AnyDecode, Hierarchy, Node};
use sinew::core::lanes::Isa;
use sinew::core::part::{Part, PartTree, Partition};
use sinew::core::random::Stage;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::tracking::Tracker;
use sinew::tracking::annealed::{self, Annealed};
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::gpapf::{self, Gpapf};
use sinew::tracking::h_apf::{self, HApf};
use std::sync::Arc;

/// Coordinates of the place and of a limb.
const PLACE: usize = 2;
const LIMB: usize = 2;

/// Whose intervals are looked at.
#[derive(Clone, Copy, Debug)]
pub(super) enum Contender {
    Bootstrap(usize),
    Annealed,
    Gpapf,
    HApf,
}

const CONTENDERS: &[(&str, Contender)] = &[
    ("bootstrap 20 000", Contender::Bootstrap(20_000)),
    ("annealed 5 x 100", Contender::Annealed),
    ("gpapf 5 x 100", Contender::Gpapf),
    ("h-apf 100", Contender::HApf),
];

/// By limbs.
pub(super) const COVERAGE: Coverage<Contender> = Coverage {
    purpose: "h-apf coverage",
    sizes: [1, 2, 4],
    coordinates: |limbs| PLACE + LIMB * limbs,
    contenders: CONTENDERS,
    series,
};

/// All coordinates as one part.
fn tree(limbs: usize) -> Outcome<PartTree> {
    let dim = PLACE + LIMB * limbs;
    let all = Part::new((0..dim).collect(), dim)?;
    Ok(PartTree::new(Partition::new(vec![all], dim)?, vec![None])?)
}

/// The whole pose, and below it every limb, twice: three layers as the paper's schedule wants.
fn hierarchy(limbs: usize, isa: Isa) -> Outcome<Hierarchy> {
    let dim = LIMB * limbs;
    let node = |parent: Option<usize>, layer: usize, coordinates: Vec<usize>, above: usize| -> Outcome<Node> {
        let picks = |row: &usize| (0..above).map(|j| f64::from(u8::from(j == *row))).collect::<Vec<f64>>();
        let matrix: Vec<f64> = match layer {
            2 => coordinates.iter().flat_map(picks).collect(),
            _ => (0..coordinates.len()).collect::<Vec<_>>().iter().flat_map(picks).collect(),
        };
        let map = match parent {
            Some(_) => Some(Arc::new(Lanes { leaf: Linear::new(matrix, above)?, isa }) as Arc<AnyDecode>),
            None => None,
        };
        let (pose, step_sd) = (Arc::new(Identity(coordinates.len())), vec![0.5 * STEP; coordinates.len()]);
        Ok(Node { parent, layer, coordinates, from_parent: map, pose, step_sd })
    };
    let limb = |k: usize| (LIMB * k..LIMB * (k + 1)).collect::<Vec<usize>>();
    let mut nodes = vec![node(None, 1, (0..dim).collect(), 0)?];
    for k in 0..limbs {
        nodes.push(node(Some(0), 2, limb(k), dim)?);
    }
    for k in 0..limbs {
        nodes.push(node(Some(1 + k), 3, limb(k), LIMB)?);
    }
    Ok(Hierarchy::new(nodes)?)
}

/// One series: a row of [`known_posterior::series`]. Searches have half of a step as noise of their layers, as where steps are learned.
fn series(limbs: usize, contender: Contender, stage: Stage) -> Outcome<[f64; COLUMNS]> {
    let (tree, isa) = (tree(limbs)?, Isa::best());
    let dim = known_posterior::dim(&tree);
    let [to_draw, to_track] = stage.split(["data", "tracker"]);
    let (centre, sd) = (vec![0.0; dim], vec![0.5 * STEP; dim]);
    let walk = RandomWalk::new(&vec![STEP; dim], 1.0, Between::Mixture, isa)?.with_initial_sd(vec![FIRST; dim])?;
    let tracker: Box<dyn Tracker<Sight>> = match contender {
        Contender::Bootstrap(particles) => {
            let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
            Box::new(Bootstrap::new(config, walk, centre)?)
        }
        Contender::Annealed => Box::new(Annealed::new(annealed::Config::raskin(), walk, sd, centre, isa)?),
        Contender::Gpapf => {
            let pose = Identity(dim - PLACE);
            Box::new(Gpapf::new(gpapf::Config::default(), Beside::whole(PLACE, pose)?, walk, sd, &centre, isa)?)
        }
        Contender::HApf => {
            let spaces = Arc::new(hierarchy(limbs, isa)?);
            Box::new(HApf::new(h_apf::Config::default(), spaces, walk, &sd[..PLACE], &centre, isa)?)
        }
    };
    known_posterior::series(&tree, tracker, to_draw, to_track)
}
