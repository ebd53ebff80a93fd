//! Who is compared, on what.

use super::motions::{BOTH_RATES, RECOVERED, TEST_RUNS, TEST_WALKS, test};
use crate::papers::masked_scene::View;
use crate::papers::seed_results::Keyed;
use sinew::observe::silhouettes::image_score::ImageScore;

/// What tracks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// CONDENSATION.
    Bootstrap(usize),
    /// Annealing in the space of poses, particles a layer.
    Annealed(usize),
    /// In a latent space.
    Gpapf(usize),
    /// In a hierarchy of them, particles a node.
    HApf(usize),
    /// The fitted true pose.
    Truth,
    /// The mean training pose at the true position and heading.
    MeanPose,
    /// The pose of the first frame.
    Frozen,
}

/// What a model learned from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Lesson {
    Walks,
    Several,
    FastWalks,
}

/// What goes wrong in a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Disturbance {
    /// Nobody is seen for half a second.
    Blank,
    /// The tracker is put 1 m and 60° aside.
    Displaced,
}

/// Motions of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Motion {
    /// A test walk by its number among the test trials.
    Walk(usize),
    /// The same at 60 frames a second.
    FastWalk(usize),
    /// A test run.
    Run(usize),
    /// Walking, running and balancing, joined.
    Combo,
    /// A person and motion that training lacks: forward jumps.
    Unseen1,
    /// Another: martial arts.
    Unseen2,
    /// Two test walks joined, disturbed in the first.
    Disturbed(usize, Disturbance),
    /// A walk of training.
    Pilot,
}

/// The paper's settings, all with as many particles a layer.
pub(super) const PRINTED: [Method; 4] =
    [Method::HApf(100), Method::Gpapf(100), Method::Annealed(100), Method::Bootstrap(500)];
/// As many evaluations a frame as the hierarchy makes.
pub(super) const EQUAL: [Method; 2] = [Method::Gpapf(360), Method::Annealed(360)];
/// The setting in which the pilot's latent trackers keep the person: 1000 particles a layer or node.
pub(super) const PILOTED: [Method; 3] = [Method::HApf(1000), Method::Gpapf(1000), Method::Annealed(1000)];
/// As many evaluations a frame as its GPAPF and APF make, 5000: a hierarchy with fewer particles, and CONDENSATION.
pub(super) const PILOTED_EQUAL: [Method; 2] = [Method::HApf(278), Method::Bootstrap(5000)];
/// Reference rows of a motion.
pub(super) const REFERENCES: [Method; 3] = [Method::MeanPose, Method::Frozen, Method::Truth];

/// Layers of annealing, and node visits of the hierarchy with the weighing of whole poses.
pub(super) const LAYERS: usize = 5;
const WEIGHED: usize = 18;

/// Factor of the likelihood. Annealing finds its own exponents: only CONDENSATION sees it, and was better off in the pilot than with 100.
const KAPPA: f64 = 10.0;

/// What trackers see and how they compare, as the pilot settled it.
pub(super) const VIEW: View =
    View { score: ImageScore::DeutscherReid { kappa: KAPPA, bidirectional: Some(0.5) }, ..View::USUAL };

/// A method on a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Contender {
    pub(super) method: Method,
    pub(super) motion: Motion,
}

/// The motions by table.
pub(super) fn walks() -> Vec<Motion> {
    TEST_WALKS.map(Motion::Walk).collect()
}
pub(super) fn runs() -> Vec<Motion> {
    TEST_RUNS.map(Motion::Run).collect()
}
pub(super) fn both_rates() -> [Vec<Motion>; 2] {
    [BOTH_RATES.map(Motion::Walk).to_vec(), BOTH_RATES.map(Motion::FastWalk).to_vec()]
}
pub(super) const OTHERS: [Motion; 3] = [Motion::Combo, Motion::Unseen1, Motion::Unseen2];
pub(super) fn disturbed(by: Disturbance) -> Vec<Motion> {
    (0..RECOVERED.len()).map(|k| Motion::Disturbed(k, by)).collect()
}

/// Everything that the tables need, what is judged on most trials first.
pub(super) fn all() -> Vec<Contender> {
    let latent = &PRINTED[..3];
    let with_references = |methods: &[Method]| [methods, &REFERENCES].concat();
    let disturbed = [Disturbance::Blank, Disturbance::Displaced].map(disturbed).concat();
    let groups = [
        (walks(), with_references(&[&PRINTED[..], &EQUAL, &PILOTED, &PILOTED_EQUAL].concat())),
        (both_rates()[1].clone(), with_references(latent)),
        (OTHERS.to_vec(), with_references(&[latent, &PILOTED].concat())),
        (disturbed, with_references(&[latent, &PILOTED].concat())),
        (runs(), with_references(&PRINTED)),
    ];
    let on = |(motions, methods): (Vec<Motion>, Vec<Method>)| {
        let of = move |motion| methods.clone().into_iter().map(move |method| Contender { method, motion });
        motions.into_iter().flat_map(of).collect::<Vec<_>>()
    };
    groups.into_iter().flat_map(on).collect()
}

impl Method {
    /// Its name in tables and keys.
    pub(super) fn name(self) -> String {
        match self {
            Self::Bootstrap(n) => format!("bootstrap {n}"),
            Self::Annealed(n) => format!("annealed {LAYERS} x {n}"),
            Self::Gpapf(n) => format!("gpapf {LAYERS} x {n}"),
            Self::HApf(n) => format!("h-apf {n}"),
            Self::Truth => "true pose".into(),
            Self::MeanPose => "mean pose".into(),
            Self::Frozen => "first pose".into(),
        }
    }

    /// Likelihood evaluations a frame.
    pub(super) const fn evaluations(self) -> usize {
        match self {
            Self::Bootstrap(n) => n,
            Self::Annealed(n) | Self::Gpapf(n) => LAYERS * n,
            Self::HApf(n) => WEIGHED * n,
            Self::Truth | Self::MeanPose | Self::Frozen => 0,
        }
    }
}

impl Motion {
    /// Its name in tables and keys.
    pub(super) fn name(self) -> String {
        match self {
            Self::Walk(number) | Self::Run(number) => test(number).name.into(),
            Self::FastWalk(number) => format!("{}, 60 Hz", test(number).name),
            Self::Combo => "CMB".into(),
            Self::Unseen1 => "UNS 01_01".into(),
            Self::Unseen2 => "UNS 135_06".into(),
            Self::Disturbed(pair, by) => {
                let [first, second] = RECOVERED[pair].map(|number| test(number).name);
                format!("{first} and {second}, {}", by.name())
            }
            Self::Pilot => "pilot".into(),
        }
    }

    /// What the models that track it have learned from.
    pub(super) const fn lesson(self) -> Lesson {
        match self {
            Self::Walk(_) | Self::Disturbed(..) | Self::Pilot => Lesson::Walks,
            Self::FastWalk(_) => Lesson::FastWalks,
            Self::Run(_) | Self::Combo | Self::Unseen1 | Self::Unseen2 => Lesson::Several,
        }
    }
}

impl Lesson {
    /// Its name in tables.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Walks => "walks, 15 Hz",
            Self::Several => "several motions, 15 Hz",
            Self::FastWalks => "walks, 60 Hz",
        }
    }
}

impl Disturbance {
    /// Its name in tables and keys.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Blank => "blank",
            Self::Displaced => "displaced",
        }
    }
}

impl Keyed for Contender {
    fn key(&self, seed: u64) -> String {
        format!("{}/{seed}/{}", self.motion.name(), self.method.name())
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
        assert_eq!((keys.len(), all.len()), (8 * 14 + 4 * 6 + 3 * 9 + 8 * 9 + 5 * 7, keys.len()));
        assert_eq!(PRINTED.map(Method::evaluations), [1800, 500, 500, 500]);
        assert!(EQUAL.iter().all(|method| method.evaluations() == 1800));
        assert_eq!(PILOTED_EQUAL.map(Method::evaluations), [5004, 5000]);
    }
}
