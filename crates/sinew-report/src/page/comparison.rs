//! The run beside a reference, where `sinew compare` has left what it found in the folder.

use super::html::{escaped, table, with_code};
use super::packed::base64;
use crate::Error;
use serde_json::Value;
use sinew::files::read_text;
use sinew_formats::json_text;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_results::{COMPARISON_NAMES, ReadError};
use std::path::Path;

/// The part of the page, and the link to it; both empty without a comparison.
pub(super) fn section(folder: &Path) -> Result<[String; 2], Error> {
    let [_, values, picture] = COMPARISON_NAMES.map(|name| folder.join(name));
    if !values.exists() {
        return Ok([String::new(), String::new()]);
    }
    let found: Value = json_text::parse(&values.display().to_string(), &read_text(&values, MAX_TEXT_BYTES)?)?;
    if !found["rows"].is_array() {
        return Err(ReadError::NoFile { folder: folder.to_owned(), file: COMPARISON_NAMES[1] }.into());
    }
    let drawn = if picture.exists() {
        // As an image, of which nothing runs, whatever is in the file.
        let picture = base64(read_text(&picture, MAX_TEXT_BYTES)?.as_bytes());
        format!(
            "<details><summary>Bland–Altman pictures</summary><div class=\"wide\"><img alt=\"Differences over means, with \
             limits of agreement\" src=\"data:image/svg+xml;base64,{picture}\"></div></details>\n"
        )
    } else {
        String::new()
    };
    let text = format!(
        "<section id=\"reference\"><h2>Beside a reference</h2>\n<p>{}</p>\n{}{drawn}</section>\n",
        sentences(&found),
        rows(&found)
    );
    Ok([text, "<a href=\"#reference\">Reference</a>".into()])
}

fn number(value: &Value, factor: f64, digits: usize) -> String {
    value.as_f64().map_or_else(|| "–".into(), |value| format!("{:.digits$}", factor * value).replace('-', "−"))
}

/// How clocks and worlds were aligned, and what has no counterpart.
fn sentences(found: &Value) -> String {
    let alignment = &found["alignment"];
    let mut said = vec![format!("Both have {} s in common.", number(&alignment["overlap_s"], 1.0, 1))];
    if alignment["time"] == true {
        let (offset, sd) = (number(&alignment["offset_s"], 1e3, 1), number(&alignment["offset_sd_s"], 1e3, 1));
        said.push(format!("The reference's time is the run's plus {offset} ± {sd} ms (found by least misfit)."));
    }
    if alignment["space"] == true {
        said.push("Its world was turned and shifted to the run's, so that what all points share is no error.".into());
    }
    if let Some(distance) = found["mean_distance_m"].as_f64() {
        said.push(format!("Points are {:.1} mm apart in the mean.", 1e3 * distance));
    }
    let names = |key: &str| -> Vec<String> {
        let all = found["unmatched"][key].as_array().into_iter().flatten();
        all.filter_map(Value::as_str).map(escaped).collect()
    };
    let alone = names("result");
    if !alone.is_empty() {
        said.push(format!("Not compared: {}.", alone.join(", ")));
    }
    let warnings = found["warnings"].as_array().into_iter().flatten().filter_map(Value::as_str);
    said.extend(warnings.map(|warning| format!("{}.", with_code(warning))));
    said.push(
        "Limits of agreement hold 95 % of the differences. The last columns say how often the run's intervals of 50, 90 \
         and 95 % hold the reference, which has errors of its own."
            .into(),
    );
    said.join(" ")
}

fn rows(found: &Value) -> String {
    let is_of_points = found["of"] == "points";
    let (factor, unit) = if is_of_points { (1e3, "mm") } else { (1.0, "°") };
    let [bias, sd, limits] = ["bias", "sd", "limits of agreement"].map(|name| format!("{name}, {unit}"));
    let heads = [if is_of_points { "point" } else { "angle" }, &bias, &sd, &limits, "in 50 %", "in 90 %", "in 95 %"];
    let row = |row: &Value| {
        let axis = row["axis"].as_str().map_or_else(String::new, |axis| format!(" {}", escaped(axis)));
        let mut cells = vec![
            escaped(row["name"].as_str().unwrap_or("–")) + &axis,
            number(&row["bias"], factor, 1),
            number(&row["sd"], factor, 1),
            format!("{} to {}", number(&row["limits"][0], factor, 1), number(&row["limits"][1], factor, 1)),
        ];
        cells.extend([0, 1, 2].map(|level: usize| format!("{} %", number(&row["inside"][level], 100.0, 0))));
        cells
    };
    let rows: Vec<Vec<String>> = found["rows"].as_array().into_iter().flatten().map(row).collect();
    table("Run less reference", &heads, &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_without_a_comparison_has_no_part_of_it() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(section(folder.path()).unwrap(), [String::new(), String::new()]);
    }

    #[test]
    fn a_comparison_is_shown_and_nothing_of_it_runs() {
        let folder = tempfile::tempdir().unwrap();
        let values = serde_json::json!({
            "of": "points",
            "alignment": { "time": true, "space": true, "offset_s": -0.1234, "offset_sd_s": 0.0021, "overlap_s": 4.0 },
            "mean_distance_m": 0.0213,
            "rows": [{ "name": "<b>Knee", "axis": "x", "bias": -0.0123, "sd": 0.004, "limits": [-0.02, -0.005], "inside": [0.4, 0.85, 0.9] }],
            "unmatched": { "result": ["Nose"], "reference": [] },
            "warnings": ["look at `this`"],
        });
        std::fs::write(folder.path().join("comparison.json"), values.to_string()).unwrap();
        std::fs::write(folder.path().join("bland_altman.svg"), "<svg><script>alert(1)</script></svg>").unwrap();
        let [text, link] = section(folder.path()).unwrap();
        for shown in [
            "−123.4 ± 2.1 ms",
            "21.3 mm apart",
            "&lt;b&gt;Knee x",
            "−12.3",
            "−20.0 to −5.0",
            "85 %",
            "Not compared: Nose",
        ] {
            assert!(text.contains(shown), "{shown}: {text}");
        }
        assert!(!text.contains("<script") && !text.contains("<b>Knee") && link.contains("#reference"));
        std::fs::write(folder.path().join("comparison.json"), "{}").unwrap();
        assert!(section(folder.path()).is_err());
    }
}
