//! The tables of docs/evidence/latent.md.

use super::contenders::{Latent, words};
use super::pilot::{FOLDS, LIMBS, Pilot, Score, Scores};
use crate::support::statistics::mean_and_error;
use crate::support::table::{header, row, with_spread};
use sinew_tests::missing_limbs::latent::{INTERVALS, Rows};
use std::fmt::Write as _;

/// What was published, and the nearest neighbours of the test sequence: cumulative error and RMS of leg and body.
const PUBLISHED: [(&str, [f64; 4]); 5] = [
    ("nearest neighbour (raw)", [14.01, 4.11, 30.89, 3.20]),
    ("nearest neighbour (scaled)", [13.50, 4.44, 20.86, 2.62]),
    ("GP-LVM, q = 3 (Lawrence 2007)", [11.4, 3.40, 16.9, 2.49]),
    ("GP-LVM, q = 4 (Lawrence 2007)", [9.7, 3.38, 20.7, 2.72]),
    ("GP-LVM, q = 5 (Lawrence 2007)", [13.4, 4.25, 23.4, 2.78]),
];

fn limb_errors(scores: &Scores, limb: usize) -> String {
    let values: Vec<f64> = scores.iter().flatten().map(|limbs| limbs[limb].rms_deg).collect();
    let [mean, error] = mean_and_error(&values);
    with_spread([mean, error * (values.len() as f64).sqrt()], 2)
}

/// How often every interval holds the truth, mean over sequences, %.
fn coverage(scores: &Scores, limb: usize) -> String {
    let all: Vec<&Score> = scores.iter().flatten().map(|limbs| &limbs[limb]).collect();
    if all.iter().any(|score| score.covered.is_empty()) {
        return "–".into();
    }
    let share = |k: usize| 100.0 * all.iter().map(|score| score.covered[k]).sum::<f64>() / all.len() as f64;
    (0..INTERVALS.len()).map(|k| format!("{:.0}", share(k))).collect::<Vec<_>>().join(" / ")
}

/// All contenders on the sequences that were left out, and the best of them sequence by sequence.
pub(super) fn pilot(pilot: &Pilot) -> String {
    let mut text = "\n".to_owned()
        + &header("| model | latents | leg RMS° | body RMS° | over neighbours | leg, % in 50/80/90/95 | body |");
    let mut rows: Vec<(&str, String, &Scores)> =
        pilot.references.iter().map(|(name, scores)| (*name, "–".into(), scores)).collect();
    rows.extend(pilot.latent.iter().map(|(model, way, scores)| (model.name, words(*way), scores)));
    for (name, way, scores) in &rows {
        let [leg, body] = [0, 1].map(|limb| limb_errors(scores, limb));
        let [leg_in, body_in] = [0, 1].map(|limb| coverage(scores, limb));
        let ratio = pilot.ratio(scores);
        row!(text, "{name} | {way} | {leg} | {body} | {ratio:.3} | {leg_in} | {body_in}");
    }
    let best = pilot.latent.iter().min_by(|a, b| pilot.ratio(&a.2).total_cmp(&pilot.ratio(&b.2)));
    let Some((model, way, own)) = best else { return text };
    let _ = write!(text, "\n{}, {}, by sequence; leg / body RMS°:\n\n", model.name, words(*way));
    let numbers = FOLDS.concat().iter().map(usize::to_string).collect::<Vec<_>>().join(" | ");
    text += &header(&format!("| sequence | {numbers} |"));
    let shown = pilot.references.iter().map(|(name, scores)| (*name, scores)).chain([(model.name, own)]);
    for (name, scores) in shown {
        let cell = |[leg, body]: &[Score; 2]| format!("{:.2} / {:.2}", leg.rms_deg, body.rms_deg);
        row!(text, "{name} | {}", scores.iter().flatten().map(cell).collect::<Vec<_>>().join(" | "));
    }
    text
}

/// The test sequence.
pub(super) fn test(model: &Latent, way: Rows, found: &[Score; 2]) -> String {
    let mut text = "\n".to_owned() + &header("| model | leg cum. | leg RMS° | body cum. | body RMS° |");
    for (name, [leg, leg_deg, body, body_deg]) in PUBLISHED {
        row!(text, "{name} | {leg} | {leg_deg:.2} | {body} | {body_deg:.2}");
    }
    let [leg, body] = found;
    row!(
        text,
        "**ours: {}, {}** | {:.2} | {:.2} | {:.2} | {:.2}",
        model.name,
        words(way),
        leg.cumulative,
        leg.rms_deg,
        body.cumulative,
        body.rms_deg
    );
    for ((name, _), score) in LIMBS.iter().zip(found) {
        let shares: Vec<String> = score.covered.iter().map(|share| format!("{:.0}", 100.0 * share)).collect();
        let _ = writeln!(text, "\n{name}: 50 / 80 / 90 / 95 % intervals hold {} % of the truth.", shares.join(" / "));
    }
    text
}
