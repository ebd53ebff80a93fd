//! `comparison.csv` and `comparison.json`.

use super::agreement::{Agreement, LEVELS};
use super::outcome::{Alignment, Comparison};
use serde_json::{Value, json};
use sinew_formats::tidy_csv::{Cell, write_header, write_row};

/// Columns behind name and axis whose name ends with the unit, and those without one.
const WITH_UNIT: [&str; 13] = [
    "bias",
    "bias_low",
    "bias_high",
    "sd",
    "rms",
    "limit_low",
    "limit_low_low",
    "limit_low_high",
    "limit_high",
    "limit_high_low",
    "limit_high_high",
    "mean_ours",
    "mean_reference",
];

/// Name of the rows of all together.
pub(super) const ALL: &str = "all";

/// Rounded so that digits beyond are noise of the processor; a number that is none is an empty cell.
fn rounded(value: f64) -> Cell<'static> {
    if value.is_finite() { Cell::Number((value * 1e6).round() / 1e6) } else { Cell::Empty }
}

/// A row for each point and axis, or angle, then `all`.
///
/// # Errors
/// None but of memory.
pub fn comparison_table(found: &Comparison) -> Result<String, sinew::Error> {
    let unit = if found.is_of_points() { "m" } else { "deg" };
    let columns = ["name", "axis", "count", "worth"].map(str::to_owned).into_iter();
    let columns = columns.chain(WITH_UNIT.iter().map(|name| format!("{name}_{unit}")));
    let percent = |level: &f64| (100.0 * level).round();
    let shares = LEVELS.iter().map(|level| format!("inside_{:.0}", percent(level)));
    let within = LEVELS.iter().map(|level| format!("inside_within_{:.0}", percent(level)));
    let columns: Vec<String> = columns.chain(shares).chain(within).collect();
    let mean = |values: &mut dyn Iterator<Item = f64>, count: usize| values.sum::<f64>() / count as f64;
    let mut bytes = vec![];
    let mut write = || {
        write_header(&mut bytes, &columns)?;
        for (series, agreement) in found.series.iter().zip(&found.agreements) {
            let means = [
                mean(&mut series.pairs.iter().map(|pair| pair.ours), series.pairs.len()),
                mean(&mut series.pairs.iter().map(|pair| pair.reference), series.pairs.len()),
            ];
            write_row(&mut bytes, &row(&series.name, series.axis, agreement, means))?;
        }
        found.all.iter().try_for_each(|(axis, all)| write_row(&mut bytes, &row(ALL, *axis, all, [f64::NAN; 2])))
    };
    write().map_err(sinew::Error::io("write", "a table of a comparison"))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Cells of a row; intervals of all together are left out, since joints hang together.
fn row<'a>(name: &'a str, axis: Option<&'a str>, found: &Agreement, means: [f64; 2]) -> Vec<Cell<'a>> {
    let limits = &found.limits;
    let interval = |ends: [f64; 2]| if name == ALL { [f64::NAN; 2] } else { ends };
    let [[bias_low, bias_high], low, high] =
        [limits.bias_interval, limits.limit_intervals[0], limits.limit_intervals[1]].map(interval);
    let numbers = [
        limits.bias,
        bias_low,
        bias_high,
        limits.sd,
        found.rms,
        limits.limits[0],
        low[0],
        low[1],
        limits.limits[1],
        high[0],
        high[1],
        means[0],
        means[1],
    ];
    let worth = if name == ALL { Cell::Empty } else { rounded(found.worth) };
    let head = [Cell::Text(name), axis.map_or(Cell::Empty, Cell::Text), Cell::Integer(found.count as i64), worth];
    let shares = found.inside.iter().chain(&found.inside_within);
    head.into_iter().chain(numbers.iter().chain(shares).map(|value| rounded(*value))).collect()
}

/// Everything for programs: metres, degrees, seconds.
#[must_use]
pub fn as_json(found: &Comparison) -> Value {
    let series = found.series.iter().zip(&found.agreements);
    let rows = series.map(|(series, agreement)| agreement_json(&series.name, series.axis, agreement));
    let all = found.all.iter().map(|(axis, agreement)| agreement_json(ALL, *axis, agreement));
    json!({
        "of": if found.is_of_points() { "points" } else { "angles" },
        "unit": if found.is_of_points() { "m" } else { "deg" },
        "alignment": alignment_json(&found.alignment),
        "mean_distance_m": found.mean_distance_m,
        "rows": rows.chain(all).collect::<Vec<_>>(),
        "unmatched": { "result": found.unmatched[0], "reference": found.unmatched[1] },
        "warnings": found.warnings,
    })
}

fn alignment_json(found: &Alignment) -> Value {
    let worlds = found.worlds.map(|worlds| {
        let rotation: Vec<Vec<f64>> =
            (0..3).map(|row| worlds.motion.rotation.row(row).iter().copied().collect()).collect();
        json!({
            "scale": worlds.motion.scale,
            "scale_sd": worlds.scale_sd,
            "rotation": rotation,
            "shift_m": worlds.motion.shift.as_slice(),
            "tilt_and_heading_deg": worlds.motion.tilt_and_heading_deg(),
            "turn_sd_deg": worlds.turn_sd_deg,
            "place_sd_m": worlds.place_sd_m,
        })
    });
    let rival = found.rival.map(|rival| json!({ "offset_s": rival.offset_s, "misfit_ratio": rival.ratio }));
    json!({
        "time": found.parts.time,
        "space": found.parts.space,
        "scaled": found.parts.scale,
        "offset_s": found.offset_s,
        "offset_sd_s": found.offset_sd_s,
        "rival": rival,
        "overlap_s": found.overlap_s,
        "rms": found.rms,
        "worlds": worlds,
    })
}

fn agreement_json(name: &str, axis: Option<&str>, found: &Agreement) -> Value {
    let limits = &found.limits;
    json!({
        "name": name,
        "axis": axis,
        "count": found.count,
        "worth": found.worth,
        "bias": limits.bias,
        "bias_interval": limits.bias_interval,
        "sd": limits.sd,
        "rms": found.rms,
        "limits": limits.limits,
        "limit_intervals": limits.limit_intervals,
        "inside": found.inside,
        "inside_within": found.inside_within,
    })
}
