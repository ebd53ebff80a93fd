//! What is written in passing and must not stay.
//!
//! Notes to oneself, placeholders, tests that do not run or do not say what they expect.

use super::workspace::{Violation, Workspace};
use crate::source::lines_with;

/// Macros, found in code.
const MACROS: [&str; 3] = [concat!("to", "do!"), concat!("unimpl", "emented!"), concat!("d", "bg!")];

/// Notes, found anywhere.
const NOTES: [&str; 4] =
    [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("X", "XX"), concat!("//! Place", "holder")];

/// Attributes of tests, found in code.
const ATTRIBUTES: [(&str, &str); 2] = [
    (
        concat!("#[ig", "nore"),
        "a test that does not run proves nothing; hide a slow one behind an environment variable",
    ),
    (concat!("should_", "panic"), "assert the error's value instead of a panic"),
];

/// Checks all Rust files.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let mut violations = Vec::new();
    for file in workspace.files.iter().filter(|file| file.is_rust()) {
        let mut complain = |text: &str, words: &str, why: &str| {
            for line in lines_with(text, words) {
                violations.push(Violation::at(&file.path, line, format!("`{words}`: {why}")));
            }
        };
        for words in MACROS {
            complain(&file.code, words, "a leftover");
        }
        for words in NOTES {
            complain(&file.text, words, "a leftover; do it or open an issue");
        }
        for (words, why) in ATTRIBUTES {
            complain(&file.code, words, why);
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
        for words in MACROS {
            planted::check(check, "crates/sinew-core/src/x.rs", &format!("{words}(1)"), &format!("// {words}"));
        }
        for words in NOTES {
            planted::check(check, "tests/tests/x.rs", &format!("// {words}\n"), "// done");
        }
    }

    #[test]
    fn tests_that_do_not_count_are_caught() {
        for (words, _) in ATTRIBUTES {
            planted::check(check, "crates/sinew-core/tests/x.rs", &format!("#[test]\n{words}]"), "#[test]");
        }
    }
}
