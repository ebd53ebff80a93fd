//! Lines of Markdown: how long they may be.

use super::workspace::{Violation, Workspace};

/// Characters of a line at most, outside tables and lines that are long by an address.
const WIDTH: usize = 120;

/// Checks all Markdown; one violation a page, at its first wide line.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let pages = workspace.files.iter().filter(|file| file.path.ends_with(".md"));
    let wide = pages.filter_map(|page| {
        let lines = wide_lines(&page.text);
        let first = *lines.first()?;
        let what = format!("{} lines are longer than {WIDTH} characters: wrap them", lines.len());
        Some(Violation::at(&page.path, first, what))
    });
    wide.collect()
}

/// Numbers of the lines that are too long.
fn wide_lines(text: &str) -> Vec<usize> {
    let numbered = (1..).zip(text.lines());
    let wide = numbered.filter(|(_, line)| !line.trim_start().starts_with('|') && is_wide(line));
    wide.map(|(number, _)| number).collect()
}

/// Whether a line is too long even where its addresses take no room.
fn is_wide(line: &str) -> bool {
    line.chars().count() > WIDTH && without_addresses(line).chars().count() > WIDTH
}

/// A line without its addresses: bare ones and the targets of links.
fn without_addresses(line: &str) -> String {
    let mut out = String::new();
    let mut rest = line;
    loop {
        let link = rest.find("](").map(|at| (at + 2, ')'));
        let bare = ["https://", "http://"].iter().filter_map(|scheme| rest.find(scheme)).min().map(|at| (at, ' '));
        let Some((start, end)) = link.into_iter().chain(bare).min() else { break };
        out.push_str(&rest[..start]);
        let tail = &rest[start..];
        rest = &tail[tail.find(end).unwrap_or(tail.len())..];
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::super::planted;
    use super::*;

    #[test]
    fn wide_lines_are_caught_but_for_tables_and_addresses() {
        let words = |count: usize| "w ".repeat(count);
        let (wide, narrow) = (words(WIDTH / 2 + 1), words(WIDTH / 2));
        let address = format!("{narrow}https://{}", "a".repeat(99));
        let link = format!("{}[x](docs/{})", words(50), "a".repeat(99));
        let fine = format!("```sh\n{narrow}\n```\n| {wide} |\n{address}\n{link}\n{narrow}");
        planted::check(check, "docs/a.md", &format!("{narrow}\n{wide}\n{wide}"), &fine);
        assert_eq!(wide_lines(&format!("{wide}\n```\n{wide}\n```\n| {wide}")), [1, 3]);
        assert_eq!(planted::violations(check, "a.rs", &wide), []);
    }

    #[test]
    fn letters_are_counted_and_not_bytes() {
        assert!(!is_wide(&"é".repeat(WIDTH)));
        assert!(is_wide(&"é".repeat(WIDTH + 1)));
    }
}
