//! What the uncertainty of each joint comes from, as bars.

use super::html::{escaped, with_code};
use serde_json::Value;
use std::fmt::Write as _;

/// Sources by their keys, with the words of the legend.
const SOURCES: [(&str, &str); 6] = [
    ("frames", "each frame’s own noise"),
    ("cameras", "cameras"),
    ("lags", "lags of clocks"),
    ("places", "places of keypoints"),
    ("lengths", "lengths of the body"),
    ("biases", "biases of detectors"),
];

/// Words, help and a bar for each joint; a sentence where the summary does not know.
pub(super) fn bars(summary: &Value) -> String {
    let uncertainty = &summary["uncertainty"];
    let joints = uncertainty["joints"].as_array().map_or(&[][..], Vec::as_slice);
    if joints.is_empty() {
        return "<p>The set-up of this run does not say what its intervals come from.</p>\n".into();
    }
    let mut out = format!(
        "<p>Of the variance of all points: {}.</p>\n",
        escaped(uncertainty["words"].as_str().unwrap_or_default())
    );
    let help: Vec<String> =
        uncertainty["help"].as_array().into_iter().flatten().filter_map(Value::as_str).map(with_code).collect();
    if !help.is_empty() {
        let _ = writeln!(out, "<ul>{}</ul>", help.iter().map(|words| format!("<li>{words}.</li>")).collect::<String>());
    }
    out.push_str("<details><summary>Joint by joint</summary>\n<p class=\"legend\" aria-hidden=\"true\">");
    for (index, (_, words)) in SOURCES.iter().enumerate() {
        let _ = write!(out, "<span><i class=\"s{index}\"></i>{words}</span> ");
    }
    out.push_str("</p>\n<div class=\"wide\"><table class=\"bars\"><caption>Standard deviation and shares of its variance</caption><tbody>\n");
    joints.iter().for_each(|joint| out.push_str(&bar(joint)));
    out.push_str("</tbody></table></div></details>\n");
    out
}

/// The row of a joint. Sources that take away what others bring have no length.
fn bar(joint: &Value) -> String {
    let share = |key: &str| joint[key].as_f64().filter(|x| x.is_finite()).map_or(0.0, |x| x.max(0.0));
    let total: f64 = SOURCES.iter().map(|(key, _)| share(key)).sum();
    let percent = |key: &str| if total > 0.0 { 100.0 * share(key) / total } else { 0.0 };
    let pieces = SOURCES
        .iter()
        .enumerate()
        .map(|(index, (key, _))| format!("<i class=\"s{index}\" style=\"width:{:.1}%\"></i>", percent(key)));
    let words: Vec<String> = SOURCES.iter().map(|(key, words)| format!("{words} {:.0} %", percent(key))).collect();
    let name = escaped(joint["joint"].as_str().unwrap_or_default());
    let sd_mm = joint["sd_m"].as_f64().map_or("–".into(), |sd| format!("{:.0} mm", 1e3 * sd));
    format!(
        "<tr><th scope=\"row\">{name}</th><td>{sd_mm}</td><td class=\"bar\" role=\"img\" aria-label=\"{0}\" title=\"{0}\">{1}</td></tr>\n",
        words.join(", "),
        pieces.collect::<String>()
    )
}
