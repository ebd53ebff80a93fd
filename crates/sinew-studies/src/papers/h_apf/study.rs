//! All cells of the study, with what they share: motions, models and pictures.

use super::contender::{Contender, Lesson, Motion, VIEW};
use super::lessons::Taught;
use super::motions::{FAST_HZ, LONGEST, PILOT, RATE_HZ, RECOVERED, RECOVERY_FRAMES, test};
use super::track;
use super::trackers::{Spaces, TUNING};
use crate::papers::masked_scene::{Scene, Seen};
use crate::papers::recorded_trials::{UNSEEN, joined};
use crate::papers::seed_results::Keyed as _;
use crate::papers::shared_values::{Shared, shared};
use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, run_all};
use sinew::core::lanes::Isa;
use sinew::files::{FNV_START, fnv};
use sinew_body::points::Trajectories;
use sinew_motion::follow::NamedBody;
use sinew_tests::combo::{Phase, comfortable_radius_m};
use sinew_tests::recorded_motion::recorded_combo;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::PoisonError;

/// Raised with every change of what a cell computes.
const VERSION: u32 = 2;

/// What all cells share.
pub(super) struct Study {
    pub(super) scenes: BTreeMap<Motion, Scene>,
    pub(super) lessons: BTreeMap<Lesson, (Taught, Spaces)>,
    /// Phases of CMB.
    pub(super) phases: Vec<Phase>,
    seen: Shared<Seen>,
    isa: Isa,
}

/// Joints of a motion.
fn joints(data: &Path, motion: Motion) -> Outcome<Trajectories> {
    Ok(match motion {
        Motion::Walk(number) | Motion::Run(number) => test(number).bent(data, RATE_HZ)?,
        Motion::FastWalk(number) => test(number).bent(data, FAST_HZ)?,
        Motion::Combo => {
            recorded_combo(&data.join("cmu_amc"), RATE_HZ, |motion| comfortable_radius_m(motion, RATE_HZ))?.motion
        }
        Motion::Unseen1 => UNSEEN[0].joints(data, RATE_HZ)?,
        Motion::Unseen2 => UNSEEN[1].joints(data, RATE_HZ)?,
        Motion::Disturbed(pair, _) => joined(&RECOVERED[pair].map(test), data, RATE_HZ)?.motion,
        Motion::Pilot => PILOT.bent(data, RATE_HZ)?,
    })
}

/// Frames of a motion at most.
fn longest(motion: Motion) -> usize {
    match motion {
        Motion::Unseen1 | Motion::Unseen2 => LONGEST,
        Motion::Disturbed(..) => RECOVERY_FRAMES,
        _ => usize::MAX,
    }
}

/// A motion, followed by the body.
pub(super) fn scene(data: &Path, motion: Motion) -> Outcome<Scene> {
    let rate_hz = if let Motion::FastWalk(_) = motion { FAST_HZ } else { RATE_HZ };
    let mut joints = joints(data, motion)?;
    joints.frames.truncate(longest(motion));
    Scene::new(&motion.name(), NamedBody::Hapf31, joints, rate_hz)
}

impl Study {
    /// Reads what is tracked, makes the body follow it, and learns what its trackers need.
    pub(super) fn new(data: &Path, folder: &Path, contenders: &[Contender]) -> Outcome<Self> {
        let isa = Isa::best();
        let motions: BTreeSet<Motion> = contenders.iter().map(|contender| contender.motion).collect();
        let lessons: BTreeSet<Lesson> = motions.iter().map(|motion| motion.lesson()).collect();
        let taught = |lesson| -> Outcome<_> {
            let taught = Taught::new(data, folder, lesson)?;
            let spaces = Spaces::new(&taught, TUNING, isa)?;
            Ok((lesson, (taught, spaces)))
        };
        let phases = if motions.contains(&Motion::Combo) {
            recorded_combo(&data.join("cmu_amc"), RATE_HZ, |motion| comfortable_radius_m(motion, RATE_HZ))?.phases
        } else {
            vec![]
        };
        Ok(Self {
            scenes: motions.into_iter().map(|motion| Ok((motion, scene(data, motion)?))).collect::<Outcome<_>>()?,
            lessons: lessons.into_iter().map(taught).collect::<Outcome<_>>()?,
            phases,
            seen: Shared::default(),
            isa,
        })
    }

    /// Everything that decides what a cell is.
    pub(super) fn configuration(&self) -> String {
        let states = self.scenes.values().flat_map(|scene| scene.truth.iter().flatten());
        let latents = |(taught, _): &(Taught, Spaces)| {
            let models = [&taught.gpdm.model, &taught.hierarchy.model];
            models.into_iter().flat_map(|model| model.nodes.iter().flat_map(|node| node.latents.clone())).collect()
        };
        let learned: Vec<Vec<f64>> = self.lessons.values().map(latents).collect();
        let hash = states.chain(learned.iter().flatten()).fold(FNV_START, |h, x| fnv(h, &x.to_bits().to_le_bytes()));
        format!("version {VERSION}, {}, {hash:016x}, {VIEW:?}, {TUNING:?}", self.isa.name())
    }

    /// Poses of a contender in all frames but the first.
    pub(super) fn poses(&self, contender: &Contender, seed: u64) -> Outcome<Vec<Vec<f64>>> {
        let (scene, (taught, spaces)) = (&self.scenes[&contender.motion], &self.lessons[&contender.motion.lesson()]);
        let seen = Seen::new(scene, &VIEW, 0, seed, self.isa)?;
        Ok(track::estimates(scene, &seen, contender, (spaces, &taught.mean_pose), seed)?.poses)
    }

    fn run(&self, contender: &Contender, seed: u64) -> Outcome<serde_json::Value> {
        let motion = contender.motion;
        let scene = &self.scenes[&motion];
        let (taught, spaces) = &self.lessons[&motion.lesson()];
        // Both disturbances are of one sequence.
        let pictured = if let Motion::Disturbed(pair, _) = motion { format!("{pair}") } else { format!("{motion:?}") };
        let seen = shared(&self.seen, &pictured, || Seen::new(scene, &VIEW, 0, seed, self.isa))?;
        let seen = seen.get().ok_or("no pictures were drawn")?;
        track::cell(scene, seen, contender, (spaces, &taught.mean_pose), seed)
    }

    /// Runs what is not done yet, one seed after the other.
    pub(super) fn run_all(
        &self,
        store: &mut Store,
        contenders: &[Contender],
        seeds: u64,
        threads: usize,
    ) -> Outcome<()> {
        for seed in 1..=seeds {
            let task = |contender: &Contender| -> Task<'_> {
                let of = *contender;
                let work = of.method.evaluations() as f64 * self.scenes[&of.motion].truth.len() as f64;
                (of.key(seed), 1e4 + work, Box::new(move || self.run(&of, seed)))
            };
            run_all(store, &format!("seed {seed}"), contenders.iter().map(task).collect(), threads)?;
            self.seen.lock().unwrap_or_else(PoisonError::into_inner).clear();
        }
        Ok(())
    }
}
