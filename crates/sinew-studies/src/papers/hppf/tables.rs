//! The paper's four tables and those beside them.

use super::contender::{
    CLUSTERS, Contender, LENGTHS, Method, Motion, PARTICLES, PRINTED, REFERENCES, SUBSETS, USUAL, compared, hppf, on,
};
use super::study::Study;
use crate::papers::masked_scene::View;
use crate::papers::seed_results::Results;
use crate::support::outcome::Outcome;
use crate::support::table::{header, row};

/// Least number of clusters over the feature vectors of a model, and its windows.
pub(super) fn clusters(study: &Study, method: Method) -> Outcome<(usize, usize)> {
    let model = study.model(method)?;
    let least = model.primitives.iter().map(|primitives| primitives.clusters.len()).min().unwrap_or_default();
    Ok((least, model.primitives.first().map_or(0, |primitives| primitives.windows())))
}

/// Share of its clusters that a cell needs to be realised.
const REALISED: f64 = 0.9;

/// Whether the model of a cell has enough of its clusters.
pub(super) fn is_realised(study: &Study, method: Method) -> Outcome<bool> {
    let Method::Primitives { clusters: asked, .. } = method else { return Ok(true) };
    Ok(clusters(study, method)?.0 as f64 >= REALISED * asked as f64)
}

/// Clusters and windows of a cell's model, and whether it is realised, as they are printed.
fn realisation(study: &Study, method: Method) -> Outcome<[String; 2]> {
    let (least, windows) = clusters(study, method)?;
    let realised = if is_realised(study, method)? { "" } else { "not realised" };
    Ok([format!("{least}, {windows}"), realised.into()])
}

/// Relative errors of the three sets.
fn sets(results: &Results<'_>, study: &Study, contender: &Contender) -> Outcome<String> {
    let shown = study.sets.iter().map(|frames| Ok(results.mean(contender, "/relative", Some(frames))?.shown(0)));
    Ok(shown.collect::<Outcome<Vec<String>>>()?.join(" | "))
}

/// Table 1: relative error by D and C.
pub(super) fn table_1(results: &Results<'_>, study: &Study) -> Outcome<String> {
    let mut out = header("| >D | >C | clusters, windows | Set 1, mm | Set 2 | Set 3 | |");
    for length in LENGTHS {
        for count in CLUSTERS {
            let method = hppf(200, length, count);
            let [learned, realised] = realisation(study, method)?;
            let row = sets(results, study, &on(method, Motion::Combo))?;
            row!(out, "{length} | {count} | {learned} | {row} | {realised}");
        }
    }
    for method in REFERENCES {
        let row = sets(results, study, &on(method, Motion::Combo))?;
        row!(out, "{} | | | {row} |", method.name());
    }
    Ok(out)
}

/// Table 2: relative error by P.
pub(super) fn table_2(results: &Results<'_>, study: &Study) -> Outcome<String> {
    let mut out = header("| >P | clusters, windows | Set 1, mm | Set 2 | Set 3 | |");
    for particles in PARTICLES {
        let method = hppf(particles, 3, 80);
        let [learned, realised] = realisation(study, method)?;
        let row = sets(results, study, &on(method, Motion::Combo))?;
        row!(out, "{particles} | {learned} | {row} | {realised}");
    }
    for method in REFERENCES {
        let row = sets(results, study, &on(method, Motion::Combo))?;
        row!(out, "{} | | {row} |", method.name());
    }
    Ok(out)
}

/// Table 3: fewer cameras.
pub(super) fn table_3(results: &Results<'_>) -> Outcome<String> {
    let mut out = header(
        "| cameras | relative, mm | absolute, mm | first camera, relative, px | absolute | second camera, relative | absolute |",
    );
    let tracked = SUBSETS.map(|cameras| {
        let names: Vec<String> = cameras.iter().map(|camera| format!("C{}", camera + 1)).collect();
        (names.join(", "), Contender { view: View { cameras, ..View::USUAL }, ..on(USUAL, Motion::Walk) })
    });
    let references = REFERENCES.map(|method| (method.name(), on(method, Motion::Walk)));
    for (name, contender) in tracked.into_iter().chain(references) {
        let shown =
            |(path, decimals): (&str, usize)| match path.contains("pixels/1") && contender.view.cameras.len() < 2 {
                true => Ok(String::new()),
                false => Ok(results.mean(&contender, path, None)?.shown(decimals)),
            };
        let cells = [
            ("/relative", 0),
            ("/absolute", 0),
            ("/pixels/0/relative", 1),
            ("/pixels/0/absolute", 1),
            ("/pixels/1/relative", 1),
            ("/pixels/1/absolute", 1),
        ];
        row!(out, "{name} | {}", cells.into_iter().map(shown).collect::<Outcome<Vec<String>>>()?.join(" | "));
    }
    Ok(out)
}

/// Columns of tables of whole motions.
const WHOLE: &str = "| | relative, mm | absolute, mm | limb ratio | kept | C1, px | C2, px | evaluations | processor time a frame, ms |";

fn whole(results: &Results<'_>, name: &str, contender: &Contender) -> Outcome<String> {
    let mean = |path: &str, decimals| -> Outcome<String> { Ok(results.mean(contender, path, None)?.shown(decimals)) };
    let (ratio, all) = results.kept(contender)?;
    let cells: [String; 8] = [
        mean("/relative", 0)?,
        mean("/absolute", 0)?,
        ratio.shown(2),
        format!("{all} of {}", results.seeds),
        mean("/pixels/0/absolute", 1)?,
        mean("/pixels/1/absolute", 1)?,
        contender.method.evaluations().to_string(),
        format!("{:.1}", results.ms(contender)?.value),
    ];
    Ok(format!("| {name} | {} |\n", cells.join(" | ")))
}

/// Table 4: the usual setting on all motions, with the reference rows.
pub(super) fn table_4(results: &Results<'_>) -> Outcome<String> {
    let mut out = header(WHOLE);
    for motion in PRINTED {
        for method in [&[USUAL][..], &REFERENCES].concat() {
            out += &whole(results, &format!("{}: {}", motion.name(), method.name()), &on(method, motion))?;
        }
    }
    Ok(out)
}

/// Ablations, opponents at equal evaluations, and the reference rows, on CMB.
pub(super) fn beside(results: &Results<'_>) -> Outcome<String> {
    let mut out = header(WHOLE);
    for contender in compared(Motion::Combo) {
        out += &whole(results, &contender.name(), &contender)?;
    }
    Ok(out)
}

/// The same on the test trials: means over trials, errors over trials.
pub(super) fn trials(results: &Results<'_>) -> Outcome<String> {
    let mut out = header(
        "| | relative, mm | absolute, mm | kept runs | usual − this, relative, mm (one-sided 95 %) | processor time a frame, ms |",
    );
    let usual = on(USUAL, Motion::Trial(0));
    for contender in compared(Motion::Trial(0)) {
        let [relative, absolute] = ["/relative", "/absolute"].map(|path| results.over_trials(&contender, path));
        let [kept, of] = results.trials_kept(&contender)?;
        let [value, reach] = results.difference_over_trials(&usual, &contender)?;
        let difference = if contender == usual { String::new() } else { format!("{value:+.1} ± {reach:.1}") };
        row!(
            out,
            "{} | {} | {} | {kept} of {of} | {difference} | {:.1}",
            contender.name(),
            relative?.shown(0),
            absolute?.shown(0),
            results.ms_over_trials(&contender)?.value
        );
    }
    Ok(out)
}
