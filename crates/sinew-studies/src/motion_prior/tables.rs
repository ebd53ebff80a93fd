//! What stored series come to: means, and the judgement by criteria that were set before.

use super::scene::{CONTENDERS, Contender, Known, LEVELS, SCENES, Scene, Series};
use crate::support::table::{header, row, with_spread};
use sinew_tests::finding::mean_and_error;

/// One-sided 95 % of a normal distribution, in standard errors.
const ONE_SIDED: f64 = 1.645;
/// How far the coverage of 90 % intervals may be off.
const COVERAGE_OFF: f64 = 0.05;
/// Share of frames whose chains may disagree: what the program itself takes.
const DISAGREEING: f64 = 0.05;

/// Series of a scene and contender: walk after walk, seed after seed, of some contenders fewer seeds.
pub(super) type Found<'a> = dyn Fn(Scene, Contender) -> Vec<Series> + 'a;

fn shown(values: &[f64], factor: f64, decimals: usize) -> String {
    with_spread(mean_and_error(values).map(|x| factor * x), decimals)
}

fn of(series: &[Series], value: impl Fn(&Series) -> f64) -> Vec<f64> {
    series.iter().map(value).collect()
}

/// Means over walks and seeds, with standard errors.
pub(super) fn measured(found: &Found<'_>) -> String {
    let mut text = header(
        "| scene | prior | series | error, mm | covered by 50 % | covered by 90 % | frames above 1.05, % | median R-hat | ms a frame | runs that doubt |",
    );
    for scene in SCENES {
        for contender in CONTENDERS {
            let all = found(scene, contender);
            if all.is_empty() {
                continue;
            }
            let covered: Vec<String> =
                (0..LEVELS.len()).map(|level| shown(&of(&all, |s| s.covered[level]), 100.0, 1)).collect();
            row!(
                text,
                "{} | {} | {} | {} | {} | {} | {} | {} | {}",
                scene.name(),
                contender.name(),
                all.len(),
                shown(&of(&all, |s| s.error_mm), 1.0, 1),
                covered.join(" | "),
                shown(&of(&all, |s| s.disagreeing), 100.0, 0),
                shown(&of(&all, |s| s.r_hat), 1.0, 2),
                shown(&of(&all, |s| s.ms), 1.0, 0),
                all.iter().filter(|s| s.is_doubted).count(),
            );
        }
    }
    text
}

/// Whether a learned prior helps where: error below that of the walk with the same form, intervals right, chains in agreement.
pub(super) fn judged(found: &Found<'_>) -> String {
    let mut text = header(
        "| scene | learned prior | error less the walk's, mm | lower error | 90 % intervals | chains agree | all three |",
    );
    for scene in SCENES {
        for contender in CONTENDERS.into_iter().filter(|contender| contender.known != Known::Walk) {
            let (own, walk) = (found(scene, contender), found(scene, contender.baseline()));
            if own.is_empty() {
                continue;
            }
            let pairs: Vec<f64> = own.iter().zip(&walk).map(|(own, walk)| own.error_mm - walk.error_mm).collect();
            let [difference, error] = mean_and_error(&pairs);
            let covered = mean_and_error(&of(&own, |s| s.covered[1]))[0];
            let disagreeing = mean_and_error(&of(&own, |s| s.disagreeing))[0];
            let passed = [
                difference + ONE_SIDED * error < 0.0,
                (covered - LEVELS[1]).abs() <= COVERAGE_OFF,
                disagreeing <= DISAGREEING,
            ];
            let words = |passed: bool| if passed { "yes" } else { "no" };
            row!(
                text,
                "{} | {} | {difference:.2} ± {error:.2} | {} | {}",
                scene.name(),
                contender.name(),
                passed.map(words).join(" | "),
                words(passed.iter().all(|passed| *passed))
            );
        }
    }
    text
}
