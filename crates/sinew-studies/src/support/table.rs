//! Tables in Markdown: a header, rows, and cells with a spread.

use std::fmt::{Arguments, Write as _};

/// The header of a table with the line below it. Columns are parted as in Markdown; one whose name begins with `>` is aligned to the right.
pub(crate) fn header(columns: &str) -> String {
    let cells = columns.trim_matches('|').split('|');
    let line: String = cells.map(|cell| if cell.starts_with(" >") { "--:|" } else { "---|" }).collect();
    format!("{}\n|{line}\n", columns.replace("| >", "| "))
}

/// Adds a row whose cells are parted by ` | `; [`row!`] takes them as `format!` does.
pub(crate) fn add_row(table: &mut String, cells: Arguments<'_>) {
    // Writing to a String cannot fail.
    let _ = writeln!(table, "| {cells} |");
}

/// A row of a table.
macro_rules! row {
    ($table:expr, $($cells:tt)*) => { crate::support::table::add_row(&mut $table, format_args!($($cells)*)) };
}
pub(crate) use row;

/// A mean with its error or spread.
pub(crate) fn with_spread([mean, spread]: [f64; 2], decimals: usize) -> String {
    format!("{mean:.decimals$} ± {spread:.decimals$}")
}

/// The same of shares, in percent.
pub(crate) fn percent([share, error]: [f64; 2], decimals: usize) -> String {
    with_spread([100.0 * share, 100.0 * error], decimals)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_has_a_header_and_rows() {
        let mut table = header("| | N > 1 | >share, % | |");
        row!(table, "{} | {} | 3 |", "a", percent([0.5, 0.25], 1));
        assert_eq!(table, "| | N > 1 | share, % | |\n|---|---|--:|---|\n| a | 50.0 ± 25.0 | 3 | |\n");
    }
}
