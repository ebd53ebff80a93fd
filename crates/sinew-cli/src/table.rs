//! The answer of a run as a table of two columns.

use sinew::setup::{MeasuredColours, MeasuredGirth, PartColours};
use sinew::track::job::Outcome;
use sinew_results::CameraSummary;
use std::collections::BTreeSet;
use std::path::Path;

/// What a run came to.
pub(crate) fn table(outcome: &Outcome, out: &Path) -> String {
    let summary = &outcome.summary;
    let [first, end] = summary.frames;
    let mut rows: Vec<(String, String)> = vec![
        ("frames".into(), format!("{} ({first}..{end}), {} observed", summary.frame_count, summary.observed_frames)),
        ("method".into(), format!("{}, {}, seed {}, {}", summary.method, summary.kind, summary.seed, summary.isa)),
        ("speed".into(), format!("{:.1} ms per frame", outcome.ms_per_frame)),
    ];
    let diagnostics = &summary.diagnostics;
    if let Some(r_hat) = diagnostics.r_hat {
        rows.push((
            "R-hat".into(),
            format!("median {:.3}, 95 % {:.3}, {} frames above 1.05", r_hat.median, r_hat.p95, r_hat.frames_above_1_05),
        ));
    }
    if let Some(ess) = diagnostics.ess_median {
        rows.push(("effective size".into(), format!("median {ess:.0}")));
    }
    rows.extend(summary.cameras.iter().map(|camera| (camera.name.clone(), seen_by(camera))));
    rows.extend(outcome.girth.map(|girth| ("girth".into(), girth_of(girth))));
    rows.extend(outcome.colours.as_ref().map(|colours| ("colours".into(), colours_of(colours))));
    rows.extend(summary.uncertainty.as_ref().map(|found| ("uncertainty".into(), found.words.clone())));
    rows.push(("results".into(), out.display().to_string()));
    aligned(&rows)
}

/// Girths with what they gained.
fn girth_of(MeasuredGirth { trunk, arms, legs, held_out_iou }: MeasuredGirth) -> String {
    let [before, after] = held_out_iou.map(|iou| 100.0 * iou);
    format!(
        "trunk × {trunk:.2}, arms × {arms:.2}, legs × {legs:.2}: intersection over union with held-out masks \
         {after:.0} %, {before:.0} % without"
    )
}

/// Where the colours of the parts come from.
fn colours_of(MeasuredColours { frames, part, .. }: &MeasuredColours) -> String {
    let distinct = |name: fn(&PartColours) -> &String| part.iter().map(name).collect::<BTreeSet<_>>().len();
    let (parts, cameras) = (distinct(|part| &part.name), distinct(|part| &part.camera));
    let listed: Vec<String> = frames.iter().map(u64::to_string).collect();
    format!("{parts} parts in {cameras} cameras, from images of the frames {}", listed.join(", "))
}

/// How well the tracked body fits what a camera saw.
fn seen_by(camera: &CameraSummary) -> String {
    let [u, v] = camera.offset_px;
    let keypoints = camera
        .residual_px
        .map(|residual| format!("residual {residual:.1} px, offset {u:+.1} {v:+.1} px, {} frames", camera.frames));
    let masks = camera.silhouettes.filter(|masks| masks.frames > 0).map(|masks| {
        let [precision, recall] = [masks.precision, masks.recall].map(|share| 100.0 * share);
        format!("{precision:.0} % of the body in {recall:.0} % of the mask, {} masks", masks.frames)
    });
    let parts: Vec<String> = keypoints.into_iter().chain(masks).collect();
    if parts.is_empty() { format!("no observation, offset {u:+.1} {v:+.1} px, 0 frames") } else { parts.join("; ") }
}

/// A table with heads: the first column to the left, numbers to the right.
pub(crate) fn columns(heads: &[String], rows: &[Vec<String>]) -> String {
    let all = || std::iter::once(heads).chain(rows.iter().map(Vec::as_slice));
    let width = |column: usize| {
        all().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or_default()
    };
    let widths: Vec<usize> = (0..heads.len()).map(width).collect();
    let line = |row: &[String]| {
        let cell = |(column, (cell, width)): (usize, (&String, &usize))| match column {
            0 => format!("{cell:width$}"),
            _ => format!("  {cell:>width$}"),
        };
        row.iter().zip(&widths).enumerate().map(cell).collect::<String>().trim_end().to_owned() + "\n"
    };
    all().map(line).collect()
}

/// Two columns.
pub(crate) fn aligned(rows: &[(String, String)]) -> String {
    let width = rows.iter().map(|(left, _)| left.chars().count()).max().unwrap_or_default();
    rows.iter().map(|(left, right)| format!("{left:width$}  {right}\n")).collect()
}
