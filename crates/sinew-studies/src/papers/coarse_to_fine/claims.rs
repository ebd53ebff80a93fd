//! The paper's claims CC1–CC6, judged by criteria that were fixed before any run, on the level `normal`.
//!
//! Every reading is judged for itself. The second estimates are compared: X̂ against the weighted mean. Where a criterion says "1 SE", it is that of the paired difference over seeds.

use super::contender::{Contender, Reading};
use super::results::Estimate;
use super::scene::Scene;
use crate::papers::claim::Claim;
use crate::papers::seed_results::{Mean, Results};
use crate::support::outcome::Outcome;
use sinew_simulate::segmentation_noise::Level;

/// Level on which claims are judged.
pub(super) const LEVEL: Level = Level::Normal;

/// Least gains of the fine level, points of precision and recall.
const LEAST_GAIN: [f64; 2] = [3.0, 5.0];
/// How far below zero the bound of the difference in precision may lie, points.
const PRECISION_SLACK: f64 = 0.5;
/// Least gain in recall over the opponent, points.
const LEAST_RECALL: f64 = 3.0;
/// Least share of frames with a higher likelihood.
const LEAST_FRAMES: f64 = 0.6;

/// Differences of means over frames, one a seed.
fn paired(results: &Results<'_>, a: (&Contender, Estimate), b: (&Contender, Estimate), name: &str) -> Outcome<Mean> {
    let [a, b] = [a, b].map(|(contender, estimate)| results.means(LEVEL, contender, estimate, name));
    let differences: Vec<f64> = a?.iter().zip(&b?).map(|(a, b)| a - b).collect();
    Ok(Mean::of(&differences))
}

fn fine_level(results: &Results<'_>, reading: &Reading) -> Outcome<Claim> {
    let (mut found, mut pass) = (vec![], true);
    for setting in &reading.settings() {
        let of = |name| paired(results, (setting, Estimate::Second), (setting, Estimate::First), name);
        let gains = [of("precision")?, of("recall")?];
        pass &= gains.iter().zip(LEAST_GAIN).all(|(gain, least)| gain.value >= least);
        let [precision, recall] = gains.map(|gain| format!("{:+.1} ± {:.1}", gain.value, gain.error));
        found.push(format!("{}: {precision}, {recall}", setting.name()));
    }
    Ok(Claim {
        id: "CC1",
        paper: "the fine level improves precision (by 7.8–11.5 points) and recall (by 9.5–13.5)",
        ours: found.join("; "),
        criterion: "at least 3 points of precision and 5 of recall, for each setting",
        pass,
    })
}

fn against_condensation(results: &Results<'_>, reading: &Reading) -> Outcome<Claim> {
    let (mut found, mut pass) = (vec![], true);
    for (c2f, opponent) in &reading.pairs() {
        let of = |name| results.gap(LEVEL, [c2f, opponent], name);
        let [precision, recall] = [of("precision")?, of("recall")?];
        pass &= precision.value >= 0.0 && precision.low >= -PRECISION_SLACK && recall.value >= LEAST_RECALL;
        found.push(format!(
            "{} − {}: precision {:+.1} (bound {:+.1}), recall {:+.1} (bound {:+.1})",
            c2f.name(),
            opponent.name(),
            precision.value,
            precision.low,
            recall.value,
            recall.low
        ));
    }
    Ok(Claim {
        id: "CC2",
        paper: "better than CONDENSATION with more than twice the particles: precision by 0.2–1.7 points, recall by 10.8–12.2",
        ours: found.join("; "),
        criterion: "all three pairs: precision at least equal, its one-sided 95 % bound not below −0.5; recall at least 3 points higher",
        pass,
    })
}

fn more_particles(results: &Results<'_>, reading: &Reading) -> Outcome<Claim> {
    let [small, .., large] = &reading.settings();
    let (most, fewest) = ((large, Estimate::Second), (small, Estimate::Second));
    let gains = [paired(results, most, fewest, "precision")?, paired(results, most, fewest, "recall")?];
    Ok(Claim {
        id: "CC3",
        paper: "more particles help: 300+500 over 50+200 by 2.5 points of precision and 3.7 of recall",
        ours: format!(
            "precision {:+.2} ± {:.2}, recall {:+.2} ± {:.2}",
            gains[0].value, gains[0].error, gains[1].value, gains[1].error
        ),
        criterion: "precision and recall of 300+500 not lower by more than 1 SE",
        pass: gains.iter().all(|gain| gain.value >= -gain.error),
    })
}

fn likelihood(results: &Results<'_>, reading: &Reading) -> Outcome<Claim> {
    let found = results.gap(LEVEL, [&reading.settings()[0], &reading.pairs()[2].1], "log_likelihood")?;
    Ok(Claim {
        id: "CC4",
        paper: "a higher likelihood with 250 particles than CONDENSATION with 1500",
        ours: format!(
            "50+200 higher in {:.0} % of frames, by {:+.2} on average (bound {:+.2})",
            100.0 * found.above,
            found.value,
            found.low
        ),
        criterion: "log likelihood of the estimate higher in at least 60 % of frames, and on average",
        pass: found.above >= LEAST_FRAMES && found.value > 0.0,
    })
}

fn smoothness(results: &Results<'_>, reading: &Reading) -> Outcome<Claim> {
    let settings = reading.settings();
    let mut found = vec![];
    for setting in &settings {
        let of = Mean::of(&results.means(LEVEL, setting, Estimate::Second, "second_difference")?);
        found.push(of.shown(4));
    }
    let mut pass = true;
    for pair in settings.windows(2) {
        let rise = paired(results, (&pair[1], Estimate::Second), (&pair[0], Estimate::Second), "second_difference")?;
        pass &= rise.value <= rise.error;
    }
    Ok(Claim {
        id: "CC5",
        paper: "estimates get smoother as particles increase",
        ours: format!("50+200, 100+200, 300+200, 300+500: {}", found.join(", ")),
        criterion: "mean absolute second difference of X̂ not rising by more than 1 SE from setting to setting",
        pass,
    })
}

fn finite(results: &Results<'_>, reading: &Reading, scene: &Scene) -> Outcome<Claim> {
    let by_formula = |range: &super::scene::Range| ((range.high - range.low) / range.width).ceil();
    let counted = scene.ranges.iter().all(|range| range.axis.count() as f64 == by_formula(range));
    let mut on_centres = true;
    for setting in &reading.settings() {
        on_centres &= results.on_centres(LEVEL, setting)?;
    }
    let [least, most] = [f64::min, f64::max]
        .map(|pick: fn(f64, f64) -> f64| scene.ranges.iter().map(by_formula).reduce(pick).unwrap_or(f64::NAN));
    let states: f64 = scene.ranges.iter().map(|range| by_formula(range).log10()).sum();
    Ok(Claim {
        id: "CC6",
        paper: "the number of coarse states is finite",
        ours: format!(
            "{least:.0}–{most:.0} partitions a coordinate, 10^{states:.1} states; counts {}, particles of all frames {}",
            if counted { "equal the formula" } else { "differ" },
            if on_centres { "on centres" } else { "off centres" }
        ),
        criterion: "exactly ⌈(θ_H − θ_L)/δ⌉ partitions, and every coarse particle of every frame on centres",
        pass: counted && on_centres,
    })
}

/// Judges all for a reading.
pub(super) fn judge(results: &Results<'_>, reading: &Reading, scene: &Scene) -> Outcome<Vec<Claim>> {
    Ok(vec![
        fine_level(results, reading)?,
        against_condensation(results, reading)?,
        more_particles(results, reading)?,
        likelihood(results, reading)?,
        smoothness(results, reading)?,
        finite(results, reading, scene)?,
    ])
}
