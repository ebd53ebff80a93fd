//! What the study runs: groups of contenders with one level of noise, on images that cells share.

use super::contender::{self, Contender, Reading};
use super::results::level_name;
use super::scene::Scene;
use super::track::{self, Seen};
use crate::papers::shared_values::{Shared, shared};
use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, run_all};
use sinew::core::lanes::Isa;
use sinew::files::FNV_START;
use sinew_simulate::segmentation_noise::Level;
use std::sync::PoisonError;

/// Raised with every change of what a cell computes.
const VERSION: u32 = 2;

/// What all cells share.
pub(super) struct Study {
    pub(super) scene: Scene,
    pub(super) isa: Isa,
    /// Images of a person, level and seed.
    pub(super) drawn: Shared<Seen>,
}

impl Study {
    pub(super) fn configuration(&self) -> String {
        format!(
            "version {VERSION}, {}, {} frames, {:016x}",
            self.isa.name(),
            self.scene.truth.len(),
            self.scene.hash(FNV_START)
        )
    }

    fn task(&self, level: Level, contender: Contender, seed: u64) -> Task<'_> {
        let run = move || {
            let who = (contender.person, contender.thickness);
            let draw = || Seen::new(&self.scene, who, level, seed, self.isa);
            let drawn = shared(&self.drawn, &format!("{who:?} {level:?} {seed}"), draw)?;
            let seen = drawn.get().ok_or("images were not drawn")?;
            track::cell(&self.scene, seen, &contender, seed, self.isa)
        };
        (contender.key(level, seed), 100.0 + contender.evaluations() as f64, Box::new(run))
    }
}

/// What is run with one level of noise and the same seeds.
pub(super) struct Group {
    pub(super) level: Level,
    pub(super) what: What,
    pub(super) seeds: u64,
    pub(super) contenders: Vec<Contender>,
}

/// What a group is compared for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum What {
    /// The paper's tables, for some readings.
    Readings(Vec<Reading>),
    /// The same with opponents of as many evaluations.
    Equal(Vec<Reading>),
    /// What goes beyond the paper.
    Beside,
    /// Whether anybody is followed at all.
    Pilot,
}

impl Group {
    pub(super) fn new(level: Level, what: What, seeds: u64) -> Self {
        let contenders = match &what {
            What::Readings(readings) => contender::main(readings),
            What::Equal(readings) => contender::equal(readings),
            What::Beside => contender::beside(),
            What::Pilot => contender::pilot(),
        };
        Self { level, what, seeds, contenders }
    }

    pub(super) fn title(&self) -> String {
        let what = match self.what {
            What::Readings(_) => "",
            What::Equal(_) => ", equal evaluations",
            What::Beside => ", beyond the paper",
            What::Pilot => ", pilot on training motion",
        };
        format!("{}{what}", level_name(self.level))
    }

    /// One seed after the other.
    pub(super) fn run(&self, study: &Study, store: &mut Store, threads: usize) -> Outcome<()> {
        let each = |seed: u64| self.contenders.iter().map(move |&of| study.task(self.level, of, seed));
        let tasks = (1..=self.seeds).flat_map(each).collect();
        let done = run_all(store, &self.title(), tasks, threads);
        study.drawn.lock().unwrap_or_else(PoisonError::into_inner).clear();
        done
    }
}
