//! Who is compared: the cells of the paper's tables, the reference rows, ablations and opponents.

use crate::papers::masked_scene::{CueSet, Person, View};
use crate::papers::recorded_trials::TEST_TRIALS;
use crate::papers::seed_results::Keyed;
use sinew::dynamics::level_walk::LevelPrimitives;
use sinew_simulate::segmentation_noise::Level;

/// What tracks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// With action primitives of `length` D from at most `clusters` C clusters.
    Primitives { particles: usize, length: usize, clusters: usize, which: LevelPrimitives },
    /// As [`USUAL`] with another way of resampling, by which this share of the particles, in hundredths, survives.
    Systematic(u8),
    /// The same walk down the parts, at random.
    Walk(usize),
    /// No partitions: a bootstrap filter on the product of the parts' likelihoods.
    Bootstrap(usize),
    /// The same by action primitives of the whole body.
    WholeBody(usize),
    /// Annealed search in five layers on the same.
    Annealed(usize),
    /// Partitioned sampling on the same.
    Partitioned(usize),
    /// The fitted true pose.
    Truth,
    /// The mean training pose at the true position and heading.
    MeanPose,
    /// The pose of the first frame.
    Frozen,
}

/// Motions of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Motion {
    /// Walking, running and balancing, joined.
    Combo,
    /// One walk.
    Walk,
    /// A person and motion that training lacks: forward jumps.
    Unseen1,
    /// Another: martial arts.
    Unseen2,
    /// A test trial by itself, by its number in [`TEST_TRIALS`].
    Trial(usize),
}

/// What the paper's tables track.
pub(super) const PRINTED: [Motion; 4] = [Motion::Combo, Motion::Walk, Motion::Unseen1, Motion::Unseen2];

impl Motion {
    /// All motions of the study.
    pub(super) fn all() -> Vec<Self> {
        PRINTED.into_iter().chain((0..TEST_TRIALS.len()).map(Self::Trial)).collect()
    }

    /// Its name in tables and keys.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Combo => "CMB",
            Self::Walk => "W",
            Self::Unseen1 => "UNS 01_01",
            Self::Unseen2 => "UNS 135_06",
            Self::Trial(number) => TEST_TRIALS[number].name,
        }
    }

    /// First frame that is judged: after the longest history, so that every D has its own on the same frames; of short trials, which one D tracks, after that one's.
    pub(super) const fn first(self) -> usize {
        match self {
            Self::Trial(_) => USUAL_MODEL.0,
            _ => LENGTHS[2],
        }
    }
}

/// A method on a motion with what it sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contender {
    pub(super) method: Method,
    pub(super) motion: Motion,
    pub(super) view: View,
}

/// Cameras of Table 3.
pub(super) const SUBSETS: [&[usize]; 4] = [&[0, 1, 2], &[0, 1], &[0], &[1]];

/// Rows and columns of Table 1.
pub(super) const LENGTHS: [usize; 3] = [3, 15, 25];
pub(super) const CLUSTERS: [usize; 4] = [20, 60, 80, 100];
/// Rows of Table 2.
pub(super) const PARTICLES: [usize; 5] = [50, 100, 200, 500, 1000];

const LAYERS: usize = 5;
/// Parts, of which one body has ten and the walk judges 1 + 6 + 10.
const PARTS: usize = 10;
const WALKED: usize = 17;

/// The paper's tracker.
pub(super) const fn hppf(particles: usize, length: usize, clusters: usize) -> Method {
    Method::Primitives { particles, length, clusters, which: LevelPrimitives::Nested }
}

/// D and C of what the paper mostly uses.
pub(super) const USUAL_MODEL: (usize, usize) = (3, 80);
/// What the paper mostly uses.
pub(super) const USUAL: Method = hppf(200, USUAL_MODEL.0, USUAL_MODEL.1);
/// Other feature vectors for a level.
const OWN_PARTS: Method =
    Method::Primitives { particles: 200, length: 3, clusters: 80, which: LevelPrimitives::OwnParts };
/// Opponents at about the evaluations of [`USUAL`].
pub(super) const OPPONENTS: [Method; 5] = [
    Method::Walk(200),
    Method::WholeBody(540),
    Method::Bootstrap(540),
    Method::Annealed(108),
    Method::Partitioned(270),
];
/// Other ways of resampling.
const RESAMPLING: [Method; 2] = [Method::Systematic(80), Method::Systematic(100)];

/// A method on a motion with the usual view.
pub(super) const fn on(method: Method, motion: Motion) -> Contender {
    Contender { method, motion, view: View::USUAL }
}

/// What is seen in the ablations: other noise, other cues, and the tracker's own body as the person.
const VIEWS: [View; 5] = [
    View { level: Level::Clean, ..View::USUAL },
    View { level: Level::Hard, ..View::USUAL },
    View { cues: CueSet::Silhouette, ..View::USUAL },
    View { cues: CueSet::WithColour, ..View::USUAL },
    View { person: Person::Tracked, ..View::USUAL },
];

/// Reference rows of a motion.
pub(super) const REFERENCES: [Method; 3] = [Method::MeanPose, Method::Frozen, Method::Truth];

/// The usual setting on a motion, and what differs from it in one thing: feature vectors, resampling, what is seen.
pub(super) fn ablations(motion: Motion) -> Vec<Contender> {
    let methods = [USUAL, OWN_PARTS].into_iter().chain(RESAMPLING).map(|method| on(method, motion));
    methods.chain(VIEWS.map(|view| Contender { view, ..on(USUAL, motion) })).collect()
}

/// All that track a motion in the table of ablations: those, the opponents and the reference rows.
pub(super) fn compared(motion: Motion) -> Vec<Contender> {
    let others = OPPONENTS.into_iter().chain(REFERENCES).map(|method| on(method, motion));
    ablations(motion).into_iter().chain(others).collect()
}

/// What the table of test trials needs.
pub(super) fn trials() -> Vec<Contender> {
    (0..TEST_TRIALS.len()).flat_map(|k| compared(Motion::Trial(k))).collect()
}

/// Everything that the tables need, each once.
pub(super) fn all() -> Vec<Contender> {
    let combo = |method| on(method, Motion::Combo);
    let table_1 = LENGTHS.into_iter().flat_map(|d| CLUSTERS.map(|c| combo(hppf(200, d, c))));
    let table_2 = PARTICLES.map(|particles| combo(hppf(particles, 3, 80)));
    let table_3 = SUBSETS.map(|cameras| Contender { view: View { cameras, ..View::USUAL }, ..on(USUAL, Motion::Walk) });
    let table_4 = PRINTED
        .into_iter()
        .flat_map(|motion| [&[USUAL][..], &REFERENCES].concat().into_iter().map(move |m| on(m, motion)));
    let beside = compared(Motion::Combo);
    let mut distinct: Vec<Contender> = vec![];
    for contender in table_4.chain(table_1).chain(table_2).chain(table_3).chain(beside).chain(trials()) {
        if !distinct.contains(&contender) {
            distinct.push(contender);
        }
    }
    distinct
}

impl Method {
    /// Its name in tables and keys.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Primitives { particles, length, clusters, which } => {
                let own = if *which == LevelPrimitives::OwnParts { ", own parts" } else { "" };
                format!("hppf P = {particles}, D = {length}, C = {clusters}{own}")
            }
            Self::Systematic(share) => format!("{}, systematic of the best {share} %", USUAL.name()),
            Self::Walk(n) => format!("hppf P = {n}, random walk"),
            Self::Bootstrap(n) => format!("bootstrap {n}"),
            Self::WholeBody(n) => format!("bootstrap {n}, action primitives"),
            Self::Annealed(n) => format!("annealed {n} x {LAYERS}"),
            Self::Partitioned(n) => format!("partitioned {n}"),
            Self::Truth => "true pose".into(),
            Self::MeanPose => "mean pose".into(),
            Self::Frozen => "first pose".into(),
        }
    }

    /// Part-views and rasterised parts a frame and camera.
    pub(super) const fn evaluations(self) -> usize {
        match self {
            Self::Primitives { particles, .. } | Self::Walk(particles) => particles * (WALKED + PARTS),
            Self::Systematic(_) => USUAL.evaluations(),
            Self::Bootstrap(n) | Self::WholeBody(n) => n * PARTS,
            Self::Annealed(n) => n * PARTS * LAYERS,
            Self::Partitioned(n) => n * 2 * PARTS,
            Self::Truth | Self::MeanPose | Self::Frozen => 0,
        }
    }
}

impl Contender {
    /// The same on another motion.
    pub(super) const fn moved(self, motion: Motion) -> Self {
        Self { motion, ..self }
    }

    /// Its name in tables of one motion: the method, and the view where that is not the usual one.
    pub(super) fn name(&self) -> String {
        match self.view == View::USUAL {
            true => self.method.name(),
            false => format!("{}, {}", self.method.name(), self.view.name()),
        }
    }
}

impl Keyed for Contender {
    fn key(&self, seed: u64) -> String {
        let trial = if matches!(self.motion, Motion::Trial(_)) { "trial " } else { "" };
        format!("{trial}{}/{}/{seed}/{}", self.motion.name(), self.view.name(), self.method.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_distinguish_all() {
        let all = all();
        let mut keys: Vec<String> = all.iter().map(|contender| contender.key(1)).collect();
        keys.sort();
        keys.dedup();
        assert_eq!((keys.len(), all.len()), (286, 286));
        assert_eq!(USUAL.evaluations(), 5400);
        assert!(OPPONENTS.iter().all(|opponent| opponent.evaluations() == 5400));
    }
}
