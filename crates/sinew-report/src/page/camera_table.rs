//! Every camera's residual, offset, noise and lag, as a table.

use super::html::{escaped, table};
use super::recorded::Recorded;
use serde_json::Value;

const HEADS: [&str; 8] = [
    "camera",
    "frames",
    "residual, px",
    "offset u, v, px",
    "noise, px",
    "later than all, ms",
    "sides exchanged, %",
    "somebody else’s, %",
];

/// The table of a run.
pub(super) fn camera_table(recorded: &Recorded) -> String {
    let known = recorded.setup.lasting.as_ref().filter(|_| recorded.setup.problems().is_empty());
    let summaries = recorded.summary["cameras"].as_array().map_or(&[][..], Vec::as_slice);
    let row = |(index, camera): (usize, &sinew::setup::CameraSetup)| {
        let summary = summaries.iter().find(|found| found["name"] == camera.name.as_str()).unwrap_or(&Value::Null);
        let [u, v] = camera.offset_px;
        let lag = known.and_then(|known| known.lag_between(index));
        vec![
            escaped(&camera.name),
            summary["frames"].as_u64().map_or("–".into(), |frames| frames.to_string()),
            summary["residual_px"].as_f64().map_or("–".into(), |residual| format!("{residual:.1}")),
            minus(format!("{u:+.1}, {v:+.1}")),
            format!("{:.1}", camera.sigma_px),
            lag.map_or("–".into(), |lag| minus(format!("{:+.1} ± {:.1}", 1e3 * lag.mean, 1e3 * lag.sd))),
            format!("{:.1}", 100.0 * camera.exchanged),
            format!("{:.1}", 100.0 * camera.elsewhere),
        ]
    };
    let rows: Vec<Vec<String>> = recorded.setup.camera.iter().enumerate().map(row).collect();
    table("What each camera shows", &HEADS, &rows)
}

/// Numbers with the sign of print.
fn minus(numbers: String) -> String {
    numbers.replace('-', "−")
}
