//! All cells of the study, with what they share: motions, models and pictures.

use super::contender::{Contender, Method, Motion, USUAL_MODEL};
use super::models::Training;
use super::motions::RATE_HZ;
use super::track;
use crate::papers::masked_scene::{Scene, Seen};
use crate::papers::recorded_trials::{Recording, TEST_TRIALS, TEST_WALK, UNSEEN};
use crate::papers::seed_results::Keyed as _;
use crate::papers::shared_values::{Shared, shared};
use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, run_all};
use sinew::core::lanes::Isa;
use sinew::dynamics::primitives::model::PrimitiveModel;
use sinew::files::{FNV_START, fnv};
use sinew_motion::follow::NamedBody;
use sinew_tests::combo::comfortable_radius_m;
use sinew_tests::recorded_motion::recorded_combo;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::PoisonError;

/// Raised with every change of what a cell computes.
const VERSION: u32 = 3;

/// Frames of a single trial that are judged at most: ten seconds.
const LONGEST: usize = 200;

/// What all cells share.
pub(super) struct Study {
    folder: PathBuf,
    pub(super) training: Training,
    /// The motions, with how well the body follows them.
    pub(super) scenes: BTreeMap<Motion, Scene>,
    /// Frames of CMB's three sets, without those before the first judged one.
    pub(super) sets: [Range<usize>; 3],
    models: Shared<PrimitiveModel>,
    seen: Shared<Seen>,
    isa: Isa,
}

impl Study {
    /// Reads what is learned from and what is tracked, and makes the body follow it.
    pub(super) fn new(data: &Path, folder: &Path, training: &[Recording], motions: &[Motion]) -> Outcome<Self> {
        let (mut scenes, mut sets) = (BTreeMap::new(), [const { 0..0 }; 3]);
        for &motion in motions {
            let recording = match motion {
                Motion::Combo => {
                    let combo =
                        recorded_combo(&data.join("cmu_amc"), RATE_HZ, |motion| comfortable_radius_m(motion, RATE_HZ))?;
                    let first = motion.first();
                    for (set, phase) in sets.iter_mut().zip(&combo.phases) {
                        *set = 0..phase.frames.end.saturating_sub(first);
                    }
                    scenes.insert(motion, Scene::new(motion.name(), NamedBody::Hppf24, combo.motion, RATE_HZ)?);
                    continue;
                }
                Motion::Walk => TEST_WALK,
                Motion::Unseen1 => UNSEEN[0],
                Motion::Unseen2 => UNSEEN[1],
                Motion::Trial(number) => TEST_TRIALS[number],
            };
            let mut joints = recording.joints(data, RATE_HZ)?;
            joints.frames.truncate(motion.first() + LONGEST);
            scenes.insert(motion, Scene::new(recording.name, NamedBody::Hppf24, joints, RATE_HZ)?);
        }
        let training = Training::new(data, training)?;
        let (models, seen) = (Shared::default(), Shared::default());
        Ok(Self { folder: folder.into(), training, scenes, sets, models, seen, isa: Isa::best() })
    }

    /// Everything that decides what a cell is.
    pub(super) fn configuration(&self) -> String {
        let states = self.scenes.values().flat_map(|scene| scene.truth.iter().flatten());
        let numbers = states.chain(self.training.sequences.iter().flatten());
        let hash = numbers.fold(FNV_START, |hash, x| fnv(hash, &x.to_bits().to_le_bytes()));
        format!("version {VERSION}, {}, {hash:016x}", self.isa.name())
    }

    /// The model of a method; others take the steps of the usual one.
    pub(super) fn model(&self, method: Method) -> Outcome<PrimitiveModel> {
        let (length, clusters) = match method {
            Method::Primitives { length, clusters, .. } => (length, clusters),
            _ => USUAL_MODEL,
        };
        let name = format!("{length} {clusters}");
        let found = shared(&self.models, &name, || self.training.model(&self.folder, length, clusters))?;
        Ok(found.get().ok_or("no model was made")?.clone())
    }

    fn run(&self, contender: &Contender, seed: u64) -> Outcome<serde_json::Value> {
        let Contender { motion, view, method } = *contender;
        let scene = &self.scenes[&motion];
        let name = format!("{motion:?} {} {seed}", view.name());
        let seen = shared(&self.seen, &name, || Seen::new(scene, &view, motion.first() - 1, seed, self.isa))?;
        let seen = seen.get().ok_or("no pictures were drawn")?;
        track::cell(scene, seen, contender, (&self.model(method)?, &self.training.mean_pose), seed)
    }

    /// Runs what is not done yet, one seed after the other and one motion after the other, so that few pictures are held.
    pub(super) fn run_all(
        &self,
        store: &mut Store,
        contenders: &[Contender],
        seeds: u64,
        threads: usize,
    ) -> Outcome<()> {
        let motions: BTreeSet<Motion> = contenders.iter().map(|contender| contender.motion).collect();
        for (seed, motion) in (1..=seeds).flat_map(|seed| motions.iter().map(move |motion| (seed, *motion))) {
            let task = |contender: &Contender| -> Task<'_> {
                let of = *contender;
                let work = of.method.evaluations() as f64 * self.scenes[&of.motion].truth.len() as f64;
                (of.key(seed), 1e4 + work, Box::new(move || self.run(&of, seed)))
            };
            let tasks = contenders.iter().filter(|contender| contender.motion == motion).map(task).collect();
            run_all(store, &format!("seed {seed}, {}", motion.name()), tasks, threads)?;
            self.seen.lock().unwrap_or_else(PoisonError::into_inner).clear();
        }
        Ok(())
    }
}
