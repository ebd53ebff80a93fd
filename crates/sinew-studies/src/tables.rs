//! `cargo xtask tables`: puts tables into the pages of docs, from the code and from what commands have written.
//!
//! A page marks where a table stands. Tables of the code have a name; tables of reports have the file that a command writes and their number in it:
//!
//! ```text
//! <!-- table: methods -->                          <!-- table: target/coverage/tables.md 3 -->
//! | method | …                                     | joint | …
//! <!-- end -->                                     <!-- end -->
//! ```
//!
//! A report that is not there leaves its tables as they are; one whose header differs is an error, so that a table cannot slip into the place of another.

mod code;

use crate::support::outcome::Outcome;
use std::fs;
use std::io;
use std::path::Path;

const OPENING: &str = "<!-- table: ";
const CLOSING: &str = "<!-- end -->";

/// Runs the command.
pub fn run(root: &Path) -> Outcome<()> {
    let report = |path: &str| fs::read_to_string(root.join(path)).ok();
    for (path, text) in pages(root)? {
        let new = filled(&text, &report).map_err(|what| format!("{path}: {what}"))?;
        if new != text {
            fs::write(root.join(&path), new)?;
            println!("written {path}");
        }
    }
    Ok(())
}

/// All pages below `docs`, by path.
fn pages(root: &Path) -> io::Result<Vec<(String, String)>> {
    let mut folders = vec!["docs".to_owned()];
    let mut found = vec![];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root.join(&folder))? {
            let entry = entry?;
            let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
            if entry.file_type()?.is_dir() {
                folders.push(path);
            } else if path.ends_with(".md") {
                let text = fs::read_to_string(entry.path())?;
                found.push((path, text));
            }
        }
    }
    found.sort();
    Ok(found)
}

/// A page with its tables as they are now.
fn filled(page: &str, report: &dyn Fn(&str) -> Option<String>) -> Result<String, String> {
    let mut out = String::new();
    let mut rest = page;
    while let Some(start) = rest.find(OPENING) {
        let name_end = start + rest[start..].find(" -->").ok_or("a marker is not closed")?;
        let name = &rest[start + OPENING.len()..name_end];
        let body = name_end + " -->".len();
        let end = body + rest[body..].find(CLOSING).ok_or_else(|| format!("`{name}` has no `{CLOSING}`"))?;
        out.push_str(&rest[..body]);
        match table(name, report)? {
            Some(table) => {
                let known = header(&rest[body..end]);
                if known.is_some() && known != header(&table) {
                    return Err(format!("the header of `{name}` is {:?}, on the page it is {known:?}", header(&table)));
                }
                out.push_str(&format!("\n\n{}\n\n", table.trim()));
            }
            None => out.push_str(&rest[body..end]),
        }
        rest = &rest[end..];
    }
    Ok(out + rest)
}

/// First row of a table.
fn header(text: &str) -> Option<&str> {
    text.lines().map(str::trim).find(|line| line.starts_with('|'))
}

/// A table by the name in its marker; `None` where no report has been written.
fn table(name: &str, report: &dyn Fn(&str) -> Option<String>) -> Result<Option<String>, String> {
    let Some((path, number)) = name.split_once(' ').filter(|(path, _)| path.starts_with("target/")) else {
        return code::table(name).map(Some).ok_or_else(|| format!("no table has the name `{name}`"));
    };
    let number: usize = number.parse().map_err(|_| format!("`{name}`: `{number}` is not the number of a table"))?;
    let Some(report) = report(path) else { return Ok(None) };
    let found = number.checked_sub(1).and_then(|number| tables(&report).into_iter().nth(number));
    found.map(Some).ok_or_else(|| format!("{path} has no table {number}"))
}

/// The tables of a report, in order.
fn tables(report: &str) -> Vec<String> {
    let mut found: Vec<String> = vec![];
    let mut inside = false;
    for line in report.lines() {
        let row = line.starts_with('|');
        if row && !inside {
            found.push(String::new());
        }
        if let (true, Some(table)) = (row, found.last_mut()) {
            table.push_str(line);
            table.push('\n');
        }
        inside = row;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPORT: &str = "A:\n\n| a | b |\n|---|---|\n| 1 | 2 |\n\nB:\n\n| c |\n|---|\n| 3 |\n";

    fn report(path: &str) -> Option<String> {
        (path == "target/r.md").then(|| REPORT.into())
    }

    #[test]
    fn tables_of_reports_take_their_places() {
        let page = "x\n<!-- table: target/r.md 2 -->\n\n| c |\n|---|\n| 0 |\n\n<!-- end -->\ny";
        assert_eq!(filled(page, &report).unwrap(), page.replace('0', "3"));
        let unwritten = page.replace("r.md", "none.md");
        assert_eq!(filled(&unwritten, &report).unwrap(), unwritten);
    }

    #[test]
    fn a_table_cannot_take_the_place_of_another() {
        for bad in ["target/r.md 1", "target/r.md 3", "target/r.md 0", "target/r.md x", "nothing"] {
            let page = format!("<!-- table: {bad} -->\n\n| c |\n|---|\n\n<!-- end -->");
            assert!(filled(&page, &report).is_err(), "{bad}");
        }
        assert!(filled("<!-- table: target/r.md 1 -->\n| a |", &report).is_err());
    }

    #[test]
    fn tables_of_the_code_match_the_pages() {
        let root = crate::support::root();
        let mut marked = 0;
        for (path, text) in pages(root).unwrap() {
            marked += text.matches(OPENING).count();
            let now = filled(&text, &|_| None).unwrap_or_else(|what| panic!("{path}: {what}"));
            assert!(now == text, "{path}: a table is not that of the code; `cargo xtask tables` writes it");
        }
        assert!(marked > 10, "{marked}");
    }
}
