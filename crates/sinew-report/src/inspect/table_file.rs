//! What a table of a result folder holds.

use super::facts::{Facts, shortened};
use crate::Error;
use sinew::files;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::tidy_csv::{self, Cells};
use sinew_results::result_table::{MOTION_FILES, ResultTable};
use std::collections::BTreeSet;
use std::path::Path;

/// Facts of a CSV file that is a table of results; `None` for a motion.
pub(super) fn facts(path: &Path) -> Result<Option<Facts>, Error> {
    let text = files::read_text(path, MAX_TEXT_BYTES)?;
    let Some(table) = ResultTable::of(&text) else { return Ok(None) };
    let cells = tidy_csv::read_cells(&path.display().to_string(), &text)?;
    let mut facts = Facts::new(format!("{}: table of results, {}", path.display(), table.describe()));
    facts.row("rows", cells.rows.len().to_string());
    facts.row("columns", format!("{}: {}", cells.columns.len(), shortened(&cells.columns)));
    if table.has_frames() {
        let times = distinct(&cells, "time_s");
        let frames = distinct(&cells, "frame");
        let numbers: BTreeSet<u64> = frames.iter().filter_map(|frame| frame.parse().ok()).collect();
        facts.row(
            "frames",
            match (numbers.first(), numbers.last()) {
                (Some(first), Some(last)) => format!("{} ({first}..{})", numbers.len(), last.saturating_add(1)),
                _ => times.len().to_string(),
            },
        );
    }
    if let Some(column) = table.name_column() {
        let names = distinct(&cells, column);
        facts.row(column, format!("{}: {}", names.len(), shortened(&names)));
    }
    facts.row("motion", format!("in {MOTION_FILES}"));
    Ok(Some(facts))
}

/// Cells of a column, each once, in the order in which they come.
fn distinct(cells: &Cells, column: &str) -> Vec<String> {
    let Some(index) = cells.columns.iter().position(|name| name == column) else { return Vec::new() };
    let mut seen = BTreeSet::new();
    let all = cells.rows.iter().filter_map(|(_, row)| row.get(index));
    all.filter(|cell| seen.insert(cell.as_str())).cloned().collect()
}
