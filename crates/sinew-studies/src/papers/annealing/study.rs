//! The sweeps of the study: how much is run, the cells, and what they hold.

use super::film::{Film, Method, Row, SCORES};
use super::{coverage, partitions, schemes};
use crate::papers::interval_tally;
use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, rows, run_all};
use clap::ValueEnum;
use serde_json::Value;
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;

/// Parts of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Part {
    /// Coverage of intervals on linear-Gaussian series.
    Coverage,
    /// Particles against the number of parts.
    Partitions,
    /// Variance of resampling schemes.
    Schemes,
    /// Sweeps on silhouettes of a walk.
    Film,
}

/// How much is run.
#[derive(Clone, Debug)]
pub(super) struct Size {
    /// Series of each dimension, and particles of the bootstrap filter.
    pub(super) series: usize,
    pub(super) particles: usize,
    pub(super) dims: Vec<usize>,
    /// Runs a number of parts, and the largest number of parts.
    pub(super) part_runs: usize,
    pub(super) most_parts: usize,
    /// Weighted sets or runs of the schemes.
    pub(super) repeats: usize,
    /// Frames and seeds of the film, and the sweeps that are run on it.
    pub(super) frames: usize,
    pub(super) seeds: usize,
    pub(super) sweeps: &'static [&'static str],
}

impl Size {
    pub(super) fn full() -> Self {
        Self {
            series: 40,
            particles: 20_000,
            dims: coverage::DIMS.to_vec(),
            part_runs: 20,
            most_parts: 8,
            repeats: 400,
            frames: 41,
            seeds: 5,
            sweeps: &["survival rate", "layers", "variants", "presets", "filters"],
        }
    }

    pub(super) fn quick() -> Self {
        Self {
            series: 8,
            particles: 3000,
            dims: vec![2, 6],
            part_runs: 10,
            most_parts: 4,
            repeats: 60,
            frames: 5,
            seeds: 1,
            sweeps: &["presets"],
        }
    }
}

/// Raised with every change of what a cell computes.
pub(super) const VERSION: u32 = 1;

/// What runs, and what was found of it.
pub(super) struct Study {
    pub(super) size: Size,
    pub(super) seed: u64,
    pub(super) isa: Isa,
    pub(super) rows: Vec<Row>,
    /// Cells of the series and of the film.
    pub(super) store: Store,
    pub(super) film: Store,
    pub(super) only: Vec<Part>,
}

pub(super) fn film_key(score: &str, method: &Method, index: usize) -> String {
    format!("film/{score}/{method:?}/{index}")
}

impl Study {
    pub(super) fn wanted(&self, part: Part) -> bool {
        self.only.is_empty() || self.only.contains(&part)
    }

    pub(super) fn contenders(&self) -> Vec<(String, coverage::Contender)> {
        coverage::contenders(self.size.particles)
    }

    /// Survival rates with their numbers of parts.
    pub(super) fn rates(&self) -> Vec<(f64, usize)> {
        partitions::RATES.into_iter().map(|(rate, most)| (rate, most.min(self.size.most_parts))).collect()
    }

    pub(super) fn value(&self, key: &str) -> Outcome<&Value> {
        self.store.get(key).or_else(|| self.film.get(key)).ok_or_else(|| format!("{key} is missing").into())
    }

    /// Means with errors of the columns of [`coverage`].
    pub(super) fn covered(&self, name: &str, dim: usize) -> Outcome<Vec<[f64; 2]>> {
        Ok(interval_tally::summary(&rows(self.value(&format!("coverage/{dim}/{name}"))?)))
    }

    /// Particles and evaluations of parts that are needed for 1, 2, … parts, `at_once` or `apart`.
    pub(super) fn needed(&self, rate: f64, most: usize, how: &str) -> Outcome<Vec<[f64; 2]>> {
        let of = |dim: usize| {
            let value = &self.value(&format!("partitions/{rate}/{dim}"))?[how];
            Ok([0, 1].map(|k: usize| value[k].as_f64().unwrap_or(f64::NAN)))
        };
        (1..=most).map(of).collect()
    }

    pub(super) fn scheme_rows(&self, case: usize) -> Outcome<Vec<Vec<f64>>> {
        Ok(rows(self.value(&format!("schemes/{case}"))?))
    }

    /// The cells of a row of the film, seed by seed.
    pub(super) fn filmed(&self, score: &str, method: &Method) -> Outcome<Vec<&Value>> {
        (0..self.size.seeds).map(|index| self.value(&film_key(score, method, index))).collect()
    }
}

/// Runs what is missing of the parts without pictures.
pub(super) fn run_series(study: &mut Study, threads: usize) -> Outcome<()> {
    let (seed, isa) = (study.seed, study.isa);
    let mut tasks: Vec<Task<'_>> = vec![];
    if study.wanted(Part::Coverage) {
        for (name, contender) in study.contenders() {
            for &dim in &study.size.dims {
                let (contender, series) = (contender.clone(), study.size.series);
                let task = move || coverage::cell(&contender, dim, series, seed, isa);
                tasks.push((format!("coverage/{dim}/{name}"), 1.0, Box::new(task)));
            }
        }
    }
    if study.wanted(Part::Partitions) {
        for (rate, most) in study.rates() {
            for dim in 1..=most {
                let runs = study.size.part_runs;
                let task = move || {
                    let stage = Stage::new(seed, "annealing partitions").round(dim);
                    partitions::cell(rate, dim, runs, &stage)
                };
                tasks.push((format!("partitions/{rate}/{dim}"), rate.powi(-(dim as i32)) / 1e3, Box::new(task)));
            }
        }
    }
    if study.wanted(Part::Schemes) {
        for case in 0..schemes::CASES.len() {
            let repeats = study.size.repeats;
            let task = move || schemes::cell(case, repeats, &Stage::new(seed, "annealing schemes").round(case));
            tasks.push((format!("schemes/{case}"), 1.0, Box::new(task)));
        }
    }
    run_all(&mut study.store, "series", tasks, threads)
}

/// Runs what is missing of the film, seed by seed, so that a run that is stopped has whole seeds.
pub(super) fn run_film(study: &mut Study, film: &Film<'_>, threads: usize) -> Outcome<()> {
    let mut tasks: Vec<Task<'_>> = vec![];
    for index in 0..film.seeds() {
        for (score, bidirectional) in SCORES {
            for Row { method, .. } in study.rows.iter().filter(|row| row.is_run_with(score)) {
                let (key, method) = (film_key(score, method, index), method.clone());
                if tasks.iter().all(|(other, ..)| *other != key) {
                    let task = move || film.cell(&method, bidirectional, index);
                    tasks.push((key, 1.0, Box::new(task)));
                }
            }
        }
    }
    run_all(&mut study.film, "film", tasks, threads)
}
