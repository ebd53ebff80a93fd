//! `sinew compare`: a result beside a laboratory's markers or another program's angles.

use super::args::General;
use super::compare_args::{AlignedParts, CompareArgs};
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use super::table::{aligned, columns};
use serde_json::json;
use sinew_analysis::compare::{
    AlignedWorlds, Alignment, Comparison, ComparisonRequest, LEVELS, as_json, compare, comparison_files,
};
use sinew_results::{COMPARISON_NAMES, Occupied, list_derived, write_whole};
use std::path::{Path, PathBuf};

/// Runs the command.
pub(crate) fn run(args: &CompareArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    if args.scale && !matches!(args.align, AlignedParts::Both | AlignedParts::Space) {
        return Err(Error::ScaleWithoutSpace);
    }
    let out = general.out.as_ref().map_or_else(|| args.results.clone(), PathBuf::from);
    if out.is_file() {
        return Err(sinew_results::Error::OutputExists { path: out, found: Occupied::NotAFolder }.into());
    }
    if let Some(path) = COMPARISON_NAMES.map(|name| out.join(name)).into_iter().find(|path| path.exists())
        && !general.force
    {
        return Err(sinew_results::Error::OutputExists { path, found: Occupied::File }.into());
    }
    let parts = args.align.parts(args.scale);
    let request = ComparisonRequest { reference: args.reference.clone(), names: args.names.clone(), parts };
    let found = compare(&args.results, &request)?;
    let title = args.reference.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let files = comparison_files(&found, &format!("beside {title}"))?;
    std::fs::create_dir_all(&out).map_err(sinew::Error::io("create", &out))?;
    for (name, text) in files {
        write_whole(&out.join(name), text.as_bytes())?;
    }
    list_derived(&out, &COMPARISON_NAMES)?;
    report.warnings(&found.warnings);
    if args.answer.json {
        let mut answer = as_json(&found);
        answer["out"] = json!(out.to_string_lossy());
        report::answer_json(&answer)?;
    } else {
        report::answer(&(aligned(&head(&found, &out)) + "\n" + &table(&found)))?;
    }
    Ok(Ended::Done)
}

/// ± a standard deviation, if there is one.
fn give_or_take(sd: Option<f64>, factor: f64, digits: usize) -> String {
    sd.map_or_else(|| " ± ?".to_owned(), |sd| format!(" ± {:.digits$}", factor * sd))
}

fn clocks(found: &Alignment) -> String {
    let overlap = format!("{:.1} s in common", found.overlap_s);
    if !found.parts.time {
        return format!("taken as equal; {overlap}");
    }
    let sd = give_or_take(found.offset_sd_s, 1000.0, 1);
    format!("the reference's time is the result's {:+.1}{sd} ms; {overlap}", 1000.0 * found.offset_s)
}

fn worlds(found: &Alignment, worlds: &AlignedWorlds) -> String {
    if !found.parts.space {
        return "taken as equal".to_owned();
    }
    let largest = |sds: Option<[f64; 3]>| sds.map(|sds| sds.into_iter().fold(0.0, f64::max));
    let [tilt, heading] = worlds.motion.tilt_and_heading_deg();
    let turn = give_or_take(largest(worlds.turn_sd_deg), 1.0, 2);
    let place = give_or_take(largest(worlds.place_sd_m), 1000.0, 1);
    let scale = if found.parts.scale {
        format!(", scale {:.4}{}", worlds.motion.scale, give_or_take(worlds.scale_sd, 1.0, 4))
    } else {
        String::new()
    };
    format!("turned by {heading:.1}°, tilted by {tilt:.1}° (each{turn}°); placed to{place} mm{scale}")
}

fn head(found: &Comparison, out: &Path) -> Vec<(String, String)> {
    let alignment = &found.alignment;
    let mut rows = vec![("clocks".to_owned(), clocks(alignment))];
    if let Some(worlds_found) = &alignment.worlds {
        rows.push(("worlds".into(), worlds(alignment, worlds_found)));
    }
    if let Some(distance_m) = found.mean_distance_m {
        let rms = 1000.0 * alignment.rms;
        rows.push((
            "distance".into(),
            format!("{:.1} mm in the mean, {rms:.1} mm root mean square", 1000.0 * distance_m),
        ));
    } else {
        rows.push(("difference".into(), format!("{:.1}° root mean square, without biases", alignment.rms)));
    }
    for (words, names) in ["not compared", "not used of the reference"].iter().zip(&found.unmatched) {
        if !names.is_empty() {
            rows.push(((*words).to_owned(), listed(names)));
        }
    }
    rows.push(("files".into(), COMPARISON_NAMES.map(|name| out.join(name).display().to_string()).join(", ")));
    rows
}

/// Names that are listed in the answer, at most.
const SHOWN: usize = 24;

fn listed(names: &[String]) -> String {
    let shown = names.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN { format!("{shown} and {} more", names.len() - SHOWN) } else { shown }
}

/// A row for each point and axis, or angle.
fn table(found: &Comparison) -> String {
    let (factor, unit) = if found.is_of_points() { (1000.0, "mm") } else { (1.0, "°") };
    let mut heads: Vec<String> = ["", "bias", "sd", "rms", "limits of agreement"]
        .map(|head| if head.is_empty() { String::new() } else { format!("{head}, {unit}") })
        .to_vec();
    heads.extend(LEVELS.map(|level| format!("in {:.0} %", 100.0 * level)));
    if found.is_of_points() {
        heads.push("90 % within".into());
    }
    let series = found.series.iter().map(|series| (series.name.as_str(), series.axis)).zip(&found.agreements);
    let all = found.all.iter().map(|(axis, agreement)| (("all", *axis), agreement));
    let row = |((name, axis), agreement): ((&str, Option<&str>), &sinew_analysis::compare::Agreement)| {
        let limits = &agreement.limits;
        let percent = |share: f64| if share.is_finite() { format!("{:.0}", 100.0 * share) } else { "–".to_owned() };
        let mut cells = vec![
            axis.map_or_else(|| name.to_owned(), |axis| format!("{name} {axis}")),
            format!("{:+.1}", factor * limits.bias),
            format!("{:.1}", factor * limits.sd),
            format!("{:.1}", factor * agreement.rms),
            format!("{:.1} to {:.1}", factor * limits.limits[0], factor * limits.limits[1]),
        ];
        cells.extend(agreement.inside.map(percent));
        if found.is_of_points() {
            cells.push(percent(agreement.inside_within[1]));
        }
        cells
    };
    columns(&heads, &series.chain(all).map(row).collect::<Vec<_>>())
}
