//! The lines of a live run's answer, each one JSON object.
//!
//! ```text
//! {"begin": {…}}      names and units, once
//! {"frame": 12, …}    what is known of a frame
//! {"line": 7, "refused": "…"}
//! {"end": {…}}        what the run came to
//! ```

use crate::angles::AngleMarginal;
use serde_json::{Value, json};
use sinew_results::Summary;
use sinew_results::estimate::{FrameEstimate, PointMarginal, RunInfo};
use std::fmt::Write as _;

fn line(value: &Value) -> String {
    format!("{value}\n")
}

/// What is the same in all frames.
pub(super) fn begin(info: &RunInfo) -> String {
    let points: Vec<&str> = info.body.points().iter().map(|point| point.name.as_str()).collect();
    let cameras: Vec<&str> = info.cameras.iter().map(|camera| camera.name.as_str()).collect();
    line(&json!({"begin": {
        "first_frame": info.first_frame,
        "fps": info.fps,
        "kind": info.kind.name(),
        "method": info.method,
        "cameras": cameras,
        "points": points,
        "angles": info.angles.names(),
        "units": {"time": "s", "points": "m", "angles": "rad"},
    }}))
}

/// A frame, with the number of frames skipped so far.
pub(super) fn frame(estimate: &FrameEstimate, skipped: u64) -> String {
    let mut text = String::with_capacity(1 << 13);
    let FrameEstimate { number, time_s, observed, restarted, quality, .. } = estimate;
    let _ = write!(
        text,
        r#"{{"frame":{number},"time_s":{time_s},"observed":{observed},"quality":{},"restarted":{restarted},"skipped":{skipped}"#,
        *quality as u8
    );
    let diagnostics = [
        ("ess", Some(estimate.ess)),
        ("r_hat", estimate.r_hat),
        ("log_evidence", estimate.log_evidence),
        ("acceptance", estimate.acceptance),
    ];
    for (name, value) in diagnostics {
        let _ = write!(text, r#","{name}":"#);
        number_text(&mut text, value.unwrap_or(f64::NAN), 4);
    }
    type PointValues = fn(&PointMarginal) -> &[f64; 3];
    let point_lists: [(&str, PointValues); 4] =
        [("mean", |p| &p.mean), ("sd", |p| &p.sd), ("q05", |p| &p.q05), ("q95", |p| &p.q95)];
    text.push_str(r#","points":{"#);
    for (index, (name, values)) in point_lists.into_iter().enumerate() {
        let _ = write!(text, r#"{}"{name}":["#, if index > 0 { "," } else { "" });
        for (index, point) in estimate.points.iter().enumerate() {
            text.push_str(if index > 0 { "," } else { "" });
            list(&mut text, values(point).iter().copied());
        }
        text.push(']');
    }
    type AngleValue = fn(&AngleMarginal) -> f64;
    let angle_lists: [(&str, AngleValue); 3] = [("mean", |a| a.mean), ("q05", |a| a.q05), ("q95", |a| a.q95)];
    text.push_str(r#"},"angles":{"#);
    for (index, (name, value)) in angle_lists.into_iter().enumerate() {
        let _ = write!(text, r#"{}"{name}":"#, if index > 0 { "," } else { "" });
        list(&mut text, estimate.angles.iter().map(value));
    }
    text.push_str("}}\n");
    text
}

fn list(text: &mut String, numbers: impl Iterator<Item = f64>) {
    text.push('[');
    for (index, number) in numbers.enumerate() {
        text.push_str(if index > 0 { "," } else { "" });
        number_text(text, number, 5);
    }
    text.push(']');
}

/// A number with some decimals; what is not finite is `null`.
fn number_text(text: &mut String, number: f64, decimals: usize) {
    let _ = if number.is_finite() { write!(text, "{number:.decimals$}") } else { write!(text, "null") };
}

/// A line that is refused, by its number, with the number of the frame if that is known.
pub(super) fn refused(number: u64, frame: Option<u64>, why: &str) -> String {
    line(&match frame {
        Some(frame) => json!({"line": number, "frame": frame, "refused": why}),
        None => json!({"line": number, "refused": why}),
    })
}

/// What the run came to.
pub(super) fn end(summary: &Summary, skipped: u64, dropped: u64) -> String {
    line(&json!({"end": {
        "complete": summary.complete,
        "frames": summary.frame_count,
        "skipped": skipped,
        "answers_dropped": dropped,
        "failed_diagnostics": summary.failed_diagnostics,
    }}))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each number of a frame under its own name.
    #[test]
    fn a_line_says_of_each_number_which_one_it_is() {
        let point = PointMarginal {
            mean: [1.0, 2.0, 3.0],
            sd: [0.4, 0.5, 0.6],
            sd_within: [0.1, 0.2, 0.3],
            q05: [0.5, 1.5, 2.5],
            q95: [1.5, 2.5, 3.5],
        };
        let angle = AngleMarginal { pose: 0.9, mean: 0.8, q05: 0.7, q95: 1.1, rate: None };
        let estimate = FrameEstimate {
            number: 7,
            time_s: 0.25,
            ess: 40.0,
            points: vec![point],
            angles: vec![angle],
            ..FrameEstimate::default()
        };
        let found: Value = serde_json::from_str(&frame(&estimate, 2)).unwrap();
        let points = json!({
            "mean": [[1.0, 2.0, 3.0]],
            "sd": [[0.4, 0.5, 0.6]],
            "q05": [[0.5, 1.5, 2.5]],
            "q95": [[1.5, 2.5, 3.5]],
        });
        assert_eq!(found["points"], points);
        assert_eq!(found["angles"], json!({ "mean": [0.8], "q05": [0.7], "q95": [1.1] }));
        assert_eq!((&found["frame"], &found["time_s"], &found["skipped"]), (&json!(7), &json!(0.25), &json!(2)));
        assert_eq!((&found["ess"], &found["r_hat"]), (&json!(40.0), &Value::Null));
    }
}
