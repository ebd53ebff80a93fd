//! The study of Choo & Fleet: its size, its frames, and the names of its cells.

use super::chains::{Step, Variant};
use super::multi;
use super::problem::{self, MODELS, Model, Problem};
use super::scene::{self, Motion, Source};
use super::single::Setting;
use crate::support::outcome::Outcome;
use crate::support::store::{Store, numbers};
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::files::FNV_START;
use sinew::observe::ObservationModel as _;
use std::collections::BTreeMap;

/// Frames of the single-frame study: motion and number from 1 at 120 frames a second. The first one is for tuning.
pub(super) const FRAMES: [(&str, usize); 6] =
    [("07_01", 60), ("07_01", 160), ("07_01", 260), ("131_04", 200), ("131_04", 500), ("131_04", 900)];

/// How much is run.
#[derive(Clone, Debug)]
pub(super) struct Size {
    /// Frames of [`FRAMES`].
    pub(super) frames: Vec<usize>,
    /// Independent runs a cell.
    pub(super) runs: usize,
    /// Doublings of the settings of Table 1.
    pub(super) doublings: Vec<u32>,
    /// Parts of the reference of 4-D and 10-D.
    pub(super) reference_parts: usize,
    /// Updates of the reference of 28-D.
    pub(super) reference_updates: usize,
    pub(super) variants: Vec<Variant>,
    pub(super) sources: Vec<Source>,
    /// Noise draws of the multi-frame study.
    pub(super) noises: usize,
}

impl Size {
    pub(super) fn full() -> Self {
        Self {
            frames: (0..6).collect(),
            runs: 50,
            doublings: (0..7).collect(),
            reference_parts: 50,
            reference_updates: 20_000,
            variants: Variant::ALL.to_vec(),
            sources: vec![Source::Recorded, Source::Fitted],
            noises: 50,
        }
    }

    pub(super) fn quick() -> Self {
        Self {
            frames: vec![0, 4],
            runs: 20,
            doublings: vec![0, 2],
            reference_parts: 10,
            reference_updates: 500,
            variants: vec![Variant::Paper],
            sources: vec![Source::Recorded],
            noises: 0,
        }
    }
}

/// Everything that cells need.
pub(super) struct Study {
    pub(super) isa: Isa,
    pub(super) seed: u64,
    pub(super) size: Size,
    pub(super) motions: BTreeMap<&'static str, Motion>,
}

/// Raised with every change of what a cell computes.
pub(super) const VERSION: u32 = 3;

impl Study {
    /// Everything that the numbers of a cell depend on, the motion included.
    pub(super) fn configuration(&self) -> String {
        let motion = self.motions.values().fold(FNV_START, |hash, motion| motion.hash(hash));
        format!(
            "version {VERSION}, {}, seed {}, {:?}, {:?}, {MODELS:?}, {:?}, {MULTI:?}, {MULTI_UPDATES}, {MULTI_FRAMES}, {motion:016x}",
            self.isa.name(),
            self.seed,
            self.size,
            FRAMES,
            problem::nested(),
        )
    }

    /// The problem of a frame; its observation is fixed by the seed.
    pub(super) fn problem(&self, source: Source, frame: usize, model: Model) -> Outcome<Problem> {
        let (name, number) = FRAMES[frame];
        let motion = &self.motions[name];
        let camera = motion.camera(number, self.isa);
        let found = motion.frame(number, source)?;
        let stage = Stage::new(self.seed, "choo-fleet observation").at_frame(frame as u32);
        let seen = scene::seen(&camera, &found.markers, stage);
        Problem::new(model, &found, Box::new(camera.bind(&seen)), self.isa)
    }

    pub(super) fn settings(&self, model: &Model) -> Vec<Setting> {
        let doubled = |base: usize| self.size.doublings.iter().map(move |&k| base << k);
        let updates = |&variant| doubled(8).map(move |updates| Setting::Updates(variant, updates));
        let wanted = |variant: &&Variant| model.is_of_paper() || **variant != Variant::Paper;
        let chains = self.size.variants.iter().filter(wanted).flat_map(updates);
        doubled(model.particles).map(Setting::Particles).chain(chains).collect()
    }
}

/// Name of a frame for tables.
pub(super) fn frame_name(frame: usize) -> String {
    let (name, number) = FRAMES[frame];
    format!("{} {number}", if name == "07_01" { "walking" } else { "dancing" })
}

pub(super) fn tuning_key(model: &Model, variant: Variant) -> String {
    format!("tuning/{}/{}", model.name(), variant.name())
}

pub(super) fn cell_key(source: Source, frame: usize, model: &Model, setting: &Setting) -> String {
    format!("single/{}/{}/{}/{}", source.name(), frame_name(frame), model.name(), setting.name())
}

pub(super) fn factor_key(model: &Model) -> String {
    format!("factor/{}", model.name())
}

pub(super) fn reference_key(source: Source, frame: usize, model: &Model) -> String {
    format!("reference/{}/{}/{}", source.name(), frame_name(frame), model.name())
}

pub(super) fn step_of(store: &Store, model: &Model, variant: Variant) -> Outcome<Step> {
    tuned_step(store, &tuning_key(model, variant))
}

/// A step that was tuned, by its key.
pub(super) fn tuned_step(store: &Store, key: &str) -> Outcome<Step> {
    let value = store.get(key).ok_or("a step was not tuned")?;
    let number = |name: &str| value[name].as_f64().ok_or("a step was not stored");
    Ok(Step { eta: number("eta")?, steps: number("steps")? as usize, acceptance: number("acceptance")? })
}

/// Models and particle numbers of the multi-frame study, at the cost of R = 32.
pub(super) const MULTI: [(usize, usize); 2] = [(1, 23_000), (2, 108_000)];
/// Updates there.
pub(super) const MULTI_UPDATES: usize = 32;
/// Frames there.
pub(super) const MULTI_FRAMES: usize = 25;

pub(super) fn multi_key(source: Source, model: &Model, filter: &multi::Filter, noise: usize) -> String {
    format!("multi/{}/{}/{}/{noise}", source.name(), model.dim, filter.name())
}

/// The two filters of a model in the multi-frame study.
pub(super) fn filters(store: &Store, index: usize) -> Outcome<(Model, [multi::Filter; 2])> {
    let (model, particles) = MULTI[index];
    let model = MODELS[model];
    let step = step_of(store, &model, Variant::Paper)?;
    Ok((model, [multi::Filter::Hmc(MULTI_UPDATES, step), multi::Filter::Particles(particles)]))
}

/// A series of each noise draw for both filters of a model: hmc, then particles.
pub(super) fn series(
    study: &Study,
    store: &Store,
    source: Source,
    index: usize,
    name: &str,
) -> Outcome<[Vec<Vec<f64>>; 2]> {
    let (model, both) = filters(store, index)?;
    let of = |filter: &multi::Filter| -> Outcome<Vec<Vec<f64>>> {
        let run = |noise| {
            let key = multi_key(source, &model, filter, noise);
            Ok(numbers(&store.get(&key).ok_or(format!("the cell {key} is missing"))?[name]))
        };
        (0..study.size.noises).map(run).collect()
    };
    Ok([of(&both[0])?, of(&both[1])?])
}
