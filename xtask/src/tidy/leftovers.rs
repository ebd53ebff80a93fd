//! What is written in passing and must not stay.
//!
//! Notes to oneself, both sides of a merge, tests that do not run or do not say what they expect. Empty stand-ins are denied by lints of the workspace.

use super::workspace::{File, Violation, Workspace};
use crate::source::lines_with;

/// Notes, found anywhere.
const NOTES: [&str; 4] =
    [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("X", "XX"), concat!("//! Place", "holder")];

/// Attributes of tests, found in code.
const ATTRIBUTES: [(&str, &str); 2] = [
    ("# [ ignore", "a test that does not run proves nothing; hide a slow one behind an environment variable"),
    ("# [ should_panic", "assert the error's value instead of a panic"),
];

/// What a merge writes around the two sides of a conflict, at the beginning of a line.
const SIDES: [&str; 2] = [concat!("<<<<", "<<< "), concat!(">>>>", ">>> ")];

/// Lines of a file with both sides of a merge.
fn both_sides(file: &File) -> impl Iterator<Item = Violation> + '_ {
    let marked = (1..).zip(file.text.lines()).filter(|(_, line)| SIDES.iter().any(|side| line.starts_with(side)));
    marked.map(|(number, _)| Violation::at(&file.path, number, "both sides of a merge; keep one"))
}

/// Checks Rust files, and all files for sides of a merge.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let mut violations: Vec<Violation> = workspace.files.iter().flat_map(both_sides).collect();
    for file in workspace.files.iter().filter(|file| file.is_rust()) {
        for (line, text) in (1..).zip(file.text.lines()) {
            for note in NOTES.iter().filter(|note| text.contains(*note)) {
                violations.push(Violation::at(&file.path, line, format!("`{note}`: do it or open an issue")));
            }
        }
        for (attribute, why) in ATTRIBUTES {
            let lines = lines_with(&file.code, attribute).into_iter();
            violations.extend(lines.map(|line| Violation::at(&file.path, line, format!("`{attribute}`: {why}"))));
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::super::planted;
    use super::*;

    #[test]
    fn leftovers_are_caught() {
        for words in NOTES {
            planted::check(check, "tests/tests/x.rs", &format!("// {words}\n"), "// done");
        }
    }

    #[test]
    fn both_sides_of_a_merge_are_caught() {
        for side in SIDES {
            planted::check(check, "docs/a.md", &format!("a\n{side}HEAD\n"), &format!("a {side}HEAD\n=======\n"));
        }
    }

    #[test]
    fn tests_that_do_not_count_are_caught() {
        for (words, _) in ATTRIBUTES {
            planted::check(
                check,
                "crates/sinew-core/tests/x.rs",
                &format!("#[test]\n{words}]\nfn f() {{}}"),
                "#[test]",
            );
        }
    }
}
