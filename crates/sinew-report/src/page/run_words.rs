//! What a run says of itself in words: its title and its diagnostics.

use super::html::{escaped, table};
use super::recorded::Recorded;
use serde_json::Value;

/// R-hat above which chains of a frame disagree.
const R_HAT_NOTED: f64 = 1.05;

/// Frames, cameras, method.
pub(super) fn subtitle(recorded: &Recorded) -> String {
    let summary = &recorded.summary;
    let seconds = recorded.numbers.len() as f64 / recorded.fps();
    let cameras = recorded.setup.camera.len();
    let (frames, fps) = (recorded.numbers.len(), recorded.fps());
    let kind = summary["kind"].as_str().unwrap_or_default();
    let method = escaped(summary["method"].as_str().unwrap_or_default());
    let cameras = if cameras == 1 { "one camera".to_owned() } else { format!("{cameras} cameras") };
    format!("{frames} frames, {seconds:.1} s at {fps} per second · {cameras} · {method}, {}", escaped(kind))
}

/// What is said where not every frame is shown.
pub(super) fn left_out(every: usize) -> String {
    match every {
        1 => String::new(),
        2 => {
            "Every second frame is shown: all of them would make this page too large. The files of the folder have all."
                .into()
        }
        _ => format!(
            "One frame in {every} is shown: all of them would make this page too large. The files of the folder have all."
        ),
    }
}

/// Numbers by which a run is judged.
pub(super) fn diagnostics(recorded: &Recorded) -> String {
    let found = &recorded.summary["diagnostics"];
    let number = |value: &Value, digits: usize| value.as_f64().map(|x| format!("{x:.digits$}"));
    let count =
        |is_counted: &dyn Fn(f64) -> bool, of: &[f64]| of.iter().filter(|x| is_counted(**x)).count().to_string();
    let quality = |wanted: f64| Some(count(&|x| x == wanted, &recorded.quality));
    let all: [(&str, Option<String>); 13] = [
        ("frames seen by two cameras or more", quality(2.0)),
        ("frames seen by one camera", quality(1.0)),
        ("frames from the motion prior alone", quality(0.0)),
        (
            "frames where tracking began again",
            Some(count(&|x| x == 1.0, recorded.restarted.get(1..).unwrap_or_default())),
        ),
        (
            "frames with R-hat above 1.05",
            found["r_hat"].is_object().then(|| count(&|x| x > R_HAT_NOTED, &recorded.r_hat)),
        ),
        ("R-hat, median", number(&found["r_hat"]["median"], 3)),
        ("R-hat, 95 % below", number(&found["r_hat"]["p95"], 3)),
        ("acceptance", number(&found["acceptance"], 2)),
        ("effective sample size, median", number(&found["ess_median"], 0)),
        ("effective sample size, least", number(&found["ess_least"], 0)),
        ("energy fraction (E-BFMI), median", number(&found["energy_fraction"], 2)),
        ("trajectories that diverged", number(&found["divergences"], 0)),
        ("particles off the learned poses", number(&found["off_manifold"], 2)),
    ];
    let rows: Vec<Vec<String>> =
        all.into_iter().filter_map(|(name, value)| Some(vec![name.to_owned(), value?])).collect();
    table("Diagnostics", &[], &rows)
}
