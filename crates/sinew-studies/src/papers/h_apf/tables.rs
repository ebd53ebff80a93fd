//! The tables of the study.

use super::contender::{
    Disturbance, EQUAL, Lesson, Method, Motion, OTHERS, PILOTED, PILOTED_EQUAL, PRINTED, REFERENCES, both_rates,
    disturbed, runs, walks,
};
use super::lessons::Taught;
use super::reconstruction::reconstructions;
use super::study::Study;
use super::trackers::all_layers;
use crate::papers::seed_results::Results;
use crate::support::outcome::Outcome;
use crate::support::table::{header, row};
use sinew::body::hapf31::FREE;
use sinew::latent::space::INVERSE_STEPS;
use sinew_tests::combo::Phase;
use std::fmt::Write as _;

/// Models: rows, dimensions, what learning reached, and reconstruction.
pub(super) fn models<'a>(lessons: impl IntoIterator<Item = (Lesson, &'a Taught)>) -> Outcome<String> {
    let mut out = header(
        "| learned from | model | >N | >q | >−log p | >steps | >reconstruction of training, ° | >of held-out trials, ° | >by regression alone: training | >held out |",
    );
    for (lesson, taught) in lessons {
        let learned = [&taught.gplvm, &taught.gpdm, &taught.hierarchy, &taught.hierarchy];
        let [climbed, regressed] = [INVERSE_STEPS, 0].map(|steps| reconstructions(taught, steps));
        for ((of, plain), learned) in climbed?.iter().zip(&regressed?).zip(learned) {
            let (rows, objective) = (learned.model.rows(), learned.objective);
            row!(
                out,
                "{} | {} | {rows} | {} | {objective:.0} | {} | {:.2} | {:.2} | {:.2} | {:.2}",
                lesson.name(),
                of.name,
                of.dim,
                learned.steps,
                of.training_deg,
                of.held_out_deg,
                plain.training_deg,
                plain.held_out_deg
            );
        }
    }
    Ok(out)
}

/// The fastest step of training on every coordinate of the place, the noise of a frame, and their ratio; it is the same for every tracker.
pub(super) fn noise<'a>(lessons: impl IntoIterator<Item = (Lesson, &'a Taught)>) -> String {
    let mut out = header("| learned from | | x, y, m | z, m | heading, rad | about y, rad | about x, rad |");
    for (lesson, taught) in lessons {
        let fastest = &taught.fastest[1..FREE];
        let frame_sd: Vec<f64> = fastest.iter().map(|step| 0.5 * all_layers() * step).collect();
        let row = |values: &[f64]| values.iter().map(|x| format!("{x:.3}")).collect::<Vec<_>>().join(" | ");
        let ratios: Vec<f64> = fastest.iter().zip(&frame_sd).map(|(step, sd)| step / sd).collect();
        for (name, values) in [("fastest step", fastest), ("noise of a frame", &frame_sd), ("ratio", &ratios)] {
            row!(out, "{} | {name} | {}", lesson.name(), row(values));
        }
    }
    out
}

const HEADER: &str = "| | absolute, mm | relative, mm | limb ratio | kept | lost | first row − this, absolute, mm (one-sided 95 %) | >evaluations | >processor time a frame, ms |";

/// Methods on some motions, with the reference rows; differences are to the first method.
fn compared(results: &Results<'_>, prefix: &str, methods: &[Method], motions: &[Motion]) -> Outcome<String> {
    let mut out = String::new();
    for &method in [methods, &REFERENCES].concat().iter() {
        let [absolute, relative] = ["/absolute", "/relative"].map(|path| results.over(method, motions, path));
        let (ratio, [kept, lost, of]) = results.kept_and_lost(method, motions)?;
        let [low, value, high] = results.difference_over(methods[0], method, motions)?;
        let difference =
            if method == methods[0] { String::new() } else { format!("{value:+.1} ({low:+.1} to {high:+.1})") };
        row!(
            out,
            "{prefix}{} | {} | {} | {ratio:.2} | {kept} of {of} | {lost} of {of} | {difference} | {} | {:.0}",
            method.name(),
            absolute?.shown(0),
            relative?.shown(0),
            method.evaluations(),
            results.ms_over(method, motions)?
        );
    }
    Ok(out)
}

/// Test walks at 15 frames a second: the paper's setting with as many evaluations too, and the pilot's.
pub(super) fn on_walks(results: &Results<'_>) -> Outcome<[String; 2]> {
    let table =
        |methods: &[Method]| -> Outcome<String> { Ok(header(HEADER) + &compared(results, "", methods, &walks())?) };
    let of = [table(&[&PRINTED[..], &EQUAL].concat()), table(&[&PILOTED[..], &PILOTED_EQUAL].concat())];
    let [paper, pilot] = of;
    Ok([paper?, pilot?])
}

/// Test runs.
pub(super) fn on_runs(results: &Results<'_>) -> Outcome<String> {
    Ok(header(HEADER) + &compared(results, "", &PRINTED, &runs())?)
}

/// The same walks at both rates.
pub(super) fn rates(results: &Results<'_>, fast: &Results<'_>) -> Outcome<String> {
    let [slow_walks, fast_walks] = both_rates();
    let mut out = header(HEADER) + &compared(results, "15 Hz: ", &PRINTED[..3], &slow_walks)?;
    out += &compared(fast, "60 Hz: ", &PRINTED[..3], &fast_walks)?;
    Ok(out)
}

/// Several motions joined, and motions that training lacks.
pub(super) fn others(results: &Results<'_>) -> Outcome<String> {
    let mut out = header(HEADER);
    for motion in OTHERS {
        out += &compared(results, &format!("{}: ", motion.name()), &[&PILOTED[..], &PRINTED[..3]].concat(), &[motion])?;
    }
    Ok(out)
}

/// Absolute errors by phase of CMB.
pub(super) fn phases(results: &Results<'_>, study: &Study) -> Outcome<String> {
    let names: Vec<String> = study.phases.iter().map(|phase| format!("{}, mm", phase.name)).collect();
    let mut out = header(&format!("| | {} |", names.join(" | ")));
    for &method in [&PILOTED[..], &PRINTED[..3], &REFERENCES].concat().iter() {
        let contender = super::contender::Contender { method, motion: Motion::Combo };
        let error = |phase: &Phase| {
            let judged = phase.frames.start.saturating_sub(1)..phase.frames.end - 1;
            Ok(results.mean(&contender, "/absolute", Some(&judged))?.shown(0))
        };
        let errors = study.phases.iter().map(error).collect::<Outcome<Vec<String>>>()?;
        row!(out, "{} | {}", method.name(), errors.join(" | "));
    }
    Ok(out)
}

/// Runs that find the person again, by disturbance.
pub(super) fn recovery(results: &Results<'_>) -> Outcome<String> {
    let mut out = header(&HEADER.replace("| | absolute", "| | found again | absolute"));
    let methods = [&PILOTED[..], &PRINTED[..3]].concat();
    for by in [Disturbance::Blank, Disturbance::Displaced] {
        let rows = compared(results, &format!("{}: ", by.name()), &methods, &disturbed(by))?;
        for (&method, row) in methods.iter().chain(&REFERENCES).zip(rows.lines()) {
            let [found, of] = results.recovered(method, by)?;
            let name = format!("| {}: {} |", by.name(), method.name());
            let _ = writeln!(out, "{name} {found} of {of} |{}", row.trim_start_matches(&name));
        }
    }
    Ok(out)
}
