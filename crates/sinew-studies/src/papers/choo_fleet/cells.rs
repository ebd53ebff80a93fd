//! What the study runs: tuning, single frames with their references, frames in a row.

use super::chains::{self, Variant};
use super::multi;
use super::problem::Model;
use super::scene::Source;
use super::single::{self, Setting};
use super::study::{
    MULTI, MULTI_FRAMES, Size, Study, cell_key, factor_key, filters, multi_key, reference_key, step_of, tuning_key,
};
use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, run_all};
use serde_json::json;
use sinew::core::random::Stage;

pub(super) fn tune(study: &Study, store: &mut Store, models: &[Model], threads: usize) -> Outcome<()> {
    let mut tasks: Vec<Task<'_>> = vec![];
    for &model in models {
        tasks.push((
            factor_key(&model),
            1.0,
            Box::new(move || Ok(json!(study.problem(Source::Recorded, 0, model)?.gradient_factor()))),
        ));
        // The long runs of the reference use the dense metric whatever is compared.
        for variant in Variant::ALL {
            let task = move || {
                let problem = study.problem(Source::Recorded, 0, model)?;
                let stage = Stage::new(study.seed, "choo-fleet tuning").split([variant.name()]);
                let [stage] = stage;
                let step = chains::tune(&problem, variant, stage)?;
                Ok(json!({ "eta": step.eta, "steps": step.steps, "acceptance": step.acceptance }))
            };
            tasks.push((tuning_key(&model, variant), 10.0, Box::new(task)));
        }
    }
    // Times are taken alone.
    let factors = tasks.extract_if(.., |(key, ..)| key.starts_with("factor")).collect();
    run_all(store, "gradient factors", factors, 1)?;
    run_all(store, "tuning", tasks, threads)
}

/// Which single frames of which parts of the body.
pub(super) struct Frames<'a> {
    pub(super) name: &'a str,
    pub(super) models: &'a [Model],
    pub(super) sources: &'a [Source],
    pub(super) frames: &'a [usize],
    /// Updates of the references by long chains.
    pub(super) reference_updates: usize,
}

/// References, then all settings.
pub(super) fn single_frames(study: &Study, store: &mut Store, what: &Frames<'_>, threads: usize) -> Outcome<()> {
    let mut references: Vec<Task<'_>> = vec![];
    let mut cells: Vec<Task<'_>> = vec![];
    let Size { runs, reference_parts, .. } = study.size;
    let reference_updates = what.reference_updates;
    for &source in what.sources {
        for &frame in what.frames {
            for &model in what.models {
                let dense = step_of(store, &model, Variant::Dense)?;
                let most = model.particles << study.size.doublings.last().copied().unwrap_or(0);
                let work = if model.dim <= single::WEIGHABLE {
                    most * reference_parts
                } else {
                    64 * 2 * reference_updates * dense.steps
                };
                let reference = move || {
                    let stage = Stage::new(study.seed, "choo-fleet reference").at_frame(frame as u32);
                    let problem = study.problem(source, frame, model)?;
                    single::reference(&problem, most, reference_parts, reference_updates, &dense, stage)
                };
                references.push((reference_key(source, frame, &model), work as f64, Box::new(reference)));
                for setting in study.settings(&model) {
                    let step = match setting {
                        Setting::Updates(variant, _) => Some(step_of(store, &model, variant)?),
                        Setting::Particles(_) => None,
                    };
                    let work = match (setting, &step) {
                        (Setting::Particles(count), _) => count,
                        (Setting::Updates(_, updates), Some(step)) => 2 * 16 * updates * step.steps,
                        _ => 0,
                    };
                    let cell = move || {
                        let stage = Stage::new(study.seed, "choo-fleet single").at_frame(frame as u32);
                        let [stage] = stage.split([setting.name().as_str()]);
                        single::cell(&study.problem(source, frame, model)?, setting, step.as_ref(), runs, &stage)
                    };
                    cells.push((cell_key(source, frame, &model, &setting), (work * runs) as f64, Box::new(cell)));
                }
            }
        }
    }
    run_all(store, &format!("references of {}", what.name), references, threads)?;
    run_all(store, what.name, cells, threads)
}

pub(super) fn multi_frames(study: &Study, store: &mut Store, threads: usize) -> Outcome<()> {
    let mut tasks: Vec<Task<'_>> = vec![];
    for index in 0..MULTI.len() {
        let (model, both) = filters(store, index)?;
        let each = study.size.sources.iter().flat_map(|&source| both.map(|filter| (source, filter)));
        for (source, filter) in each {
            for noise in 0..study.size.noises {
                let seed = study.seed.wrapping_mul(1000).wrapping_add(noise as u64) as usize;
                let task = move || {
                    let motion = &study.motions["07_01"];
                    multi::run(motion, source, &model, &filter, MULTI_FRAMES, seed, study.isa)
                };
                tasks.push((multi_key(source, &model, &filter, noise), model.particles as f64, Box::new(task)));
            }
        }
    }
    run_all(store, "frames in a row", tasks, threads)
}
