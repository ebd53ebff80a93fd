//! Where things are: the top level holds what docs/ARCHITECTURE.md lists, and every module opens with a `//!` line.

use super::workspace::{Violation, Workspace};

const TOP: [&str; 19] = [
    ".cargo",
    ".ci",
    ".github",
    ".gitignore",
    "CHANGELOG.md",
    "CITATION.cff",
    "CONTRIBUTING.md",
    "Cargo.lock",
    "Cargo.toml",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "README.md",
    "book.toml",
    "crates",
    "docs",
    "fuzz",
    "rustfmt.toml",
    "tests",
    "xtask",
];

/// Checks the names at the top level.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let stray = workspace.top.iter().filter(|name| !TOP.contains(&name.as_str()));
    stray.map(|name| Violation::in_file(name, "does not belong at the top level")).collect()
}

/// Checks that every Rust file opens with its module documentation.
pub fn check_docs(workspace: &Workspace) -> Vec<Violation> {
    let undocumented = workspace.files.iter().filter(|file| {
        let opening = file.text.lines().find(|line| {
            let line = line.trim();
            !line.is_empty() && !line.starts_with("#![")
        });
        // A library's page may be its README.
        let has_page = file.text.starts_with("#![doc = include_str!(\"../README.md\")]");
        file.is_rust() && !has_page && !opening.is_some_and(|line| line.starts_with("//! ") && line.len() > 8)
    });
    undocumented.map(|file| Violation::in_file(&file.path, "has no `//!` line that says what it is")).collect()
}

#[cfg(test)]
mod tests {
    use super::super::planted;
    use super::*;

    #[test]
    fn strays_at_the_top_level_are_caught() {
        let top = ["Cargo.toml", "crates", "notes.txt", "xtask"].map(String::from).to_vec();
        let found = check(&Workspace { top, files: Vec::new() });
        assert_eq!(found.iter().map(|v| v.path.as_str()).collect::<Vec<_>>(), ["notes.txt"]);
    }

    #[test]
    fn modules_without_docs_are_caught() {
        let path = "crates/sinew-core/src/x.rs";
        planted::check(check_docs, path, "use std::fmt;\n//! Late.", "\n//! What it computes.\nuse std::fmt;");
        planted::check(check_docs, path, "", "#![no_main]\n//! What it computes.");
        assert_eq!(planted::violations(check_docs, "Cargo.toml", ""), []);
    }
}
