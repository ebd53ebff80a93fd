//! What speaks against a run as a standing trial, in words.

use serde_json::Value;
use sinew_body::KinematicTree;
use std::f64::consts::TAU;

/// Span of an angle over the trial, between its 5 % and 95 % quantiles, above which nobody stands still.
const MOST_MOVED_DEG: f64 = 5.0;
/// Zero above which angles of one joint mix where it is subtracted.
const LARGEST_ZERO_DEG: f64 = 20.0;
/// Difference of the lengths of two bodies over their sum, above which they are hardly of one person.
const MOST_LONGER: f64 = 0.04;

/// Doubts about a trial: its summary, and the directions of angles with these names in each of its frames, radians.
pub(super) fn doubts(summary: &Value, names: &[String], over_time: &[Vec<f64>], unseen: &[String]) -> Vec<String> {
    let mut found = vec![];
    if summary["kind"] != "smoothed" {
        found.push(
            "it is filtered, and the mean over its frames is surer of itself than it is right: track it with `--smooth`"
                .to_owned(),
        );
    }
    if let Some(failed) = summary["failed_diagnostics"].as_array().and_then(|all| all.first()?.as_str()) {
        found.push(format!("its diagnostics failed ({failed}): so may its zero"));
    }
    if !unseen.is_empty() {
        let unseen = unseen.join(", ");
        found.push(format!("its keypoints do not show {unseen}: no zero is taken off these"));
    }
    let over_frames = |angle: usize| over_time.iter().map(move |directions| directions[angle]);
    let middles: Vec<f64> = (0..names.len())
        .map(|angle| over_frames(angle).map(f64::sin).sum::<f64>().atan2(over_frames(angle).map(f64::cos).sum()))
        .collect();
    let spans = (0..names.len()).map(|angle| span_deg(over_frames(angle), middles[angle]));
    if let Some(words) = above(names, spans, MOST_MOVED_DEG) {
        found.push(format!(
            "angles move by more than {MOST_MOVED_DEG}° over it ({words}): choose frames in which the person stands still, \
             `--frames A..B`"
        ));
    }
    if let Some(words) = above(names, middles.iter().map(|x| x.abs().to_degrees()), LARGEST_ZERO_DEG) {
        found.push(format!(
            "zeros are above {LARGEST_ZERO_DEG}° ({words}): angles are subtracted, not rotations, and angles of \
             one joint mix; does the person stand upright and look ahead, with hanging arms?"
        ));
    }
    found.into_iter().map(|words| format!("standing trial: {words}")).collect()
}

/// Distance between the 5 % and 95 % quantiles about a direction, degrees.
fn span_deg(directions: impl Iterator<Item = f64>, middle: f64) -> f64 {
    let mut apart: Vec<f64> = directions.map(|x| x - middle).map(|x| x - TAU * (x / TAU).round()).collect();
    apart.sort_by(f64::total_cmp);
    let at = |share: f64| apart.get((share * (apart.len().max(1) - 1) as f64).round() as usize).copied();
    at(0.95).zip(at(0.05)).map_or(0.0, |(high, low)| (high - low).to_degrees())
}

/// The largest of the values above a limit with its name, and how many others there are.
fn above(names: &[String], values: impl Iterator<Item = f64>, limit: f64) -> Option<String> {
    let all: Vec<(&String, f64)> = names.iter().zip(values).filter(|(_, value)| *value > limit).collect();
    let (name, value) = all.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let others = match all.len() - 1 {
        0 => String::new(),
        1 => ", and one other".into(),
        others => format!(", and {others} others"),
    };
    Some(format!("`{name}` {value:.0}°{others}"))
}

/// What is said where the lengths of two bodies with the same links differ.
pub(super) fn other_sizes(trial: &KinematicTree, run: &KinematicTree) -> Option<String> {
    let length = |offset: &[f64; 3]| offset.iter().map(|x| x * x).sum::<f64>().sqrt();
    let pairs: Vec<[f64; 2]> =
        trial.links().iter().zip(run.links()).map(|(a, b)| [&a.offset, &b.offset].map(length)).collect();
    let apart: f64 = pairs.iter().map(|[a, b]| (a - b).abs()).sum();
    let share = apart / pairs.iter().map(|[_, b]| b).sum::<f64>().max(f64::MIN_POSITIVE);
    (share > MOST_LONGER).then(|| {
        format!(
            "standing trial: the sizes of its body differ from this run's by {:.0} %: is it the same person? Take its \
             set-up for both, `--setup TRIAL/setup.toml`",
            100.0 * share
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use sinew_body::{Proportions, standard};

    fn names() -> Vec<String> {
        ["knee_angle_r", "ankle_angle_r"].map(str::to_owned).into()
    }

    #[test]
    fn a_still_smoothed_trial_with_small_zeros_has_no_doubts() {
        let still = vec![vec![0.1, -0.1]; 20];
        assert!(doubts(&json!({ "kind": "smoothed", "failed_diagnostics": [] }), &names(), &still, &[]).is_empty());
    }

    /// Half a turn from zero, where directions jump from the one end of the circle to the other.
    #[test]
    fn all_that_is_wrong_with_a_trial_is_said() {
        let moving: Vec<Vec<f64>> = (0..41).map(|k| vec![3.1 + 0.005 * f64::from(k), 0.01]).collect();
        let summary = json!({ "kind": "filtered", "failed_diagnostics": ["R-hat"] });
        let found = doubts(&summary, &names(), &moving, &["head_rz".to_owned()]);
        let wanted = [
            "track it with `--smooth`",
            "(R-hat)",
            "do not show head_rz",
            "over it (`knee_angle_r` 10°)",
            "zeros are above 20° (`knee_angle_r`",
        ];
        assert_eq!(found.len(), wanted.len(), "{found:#?}");
        for (found, wanted) in found.iter().zip(wanted) {
            assert!(found.starts_with("standing trial: ") && found.contains(wanted), "{found}");
        }
    }

    #[test]
    fn sizes_of_another_person_are_said() {
        let body = |factor: f64| {
            let usual = Proportions::default();
            standard::h32(&Proportions { thigh: factor * usual.thigh, shin: factor * usual.shin, ..usual })
        };
        assert_eq!(other_sizes(&body(1.0), &body(1.03)), None);
        let found = other_sizes(&body(1.2), &body(1.0)).unwrap();
        assert!(found.starts_with("standing trial: the sizes"), "{found}");
    }
}
