//! `cargo xtask tidy`: the rules of docs/ARCHITECTURE.md, checked from manifests and source text.
//!
//! Each rule is a function from the text of the workspace to its violations, so that a test can plant one.

mod cycles;
mod dependencies;
mod error_kinds;
mod layers;
mod leftovers;
mod links;
mod modules;
mod names;
mod pages;
mod placement;
mod purity;
mod words;
mod workspace;

use std::path::Path;
use std::process::ExitCode;
use workspace::{Rule, Violation, read};

/// Rules by name.
const RULES: [(&str, Rule); 11] = [
    ("layers", layers::check),
    ("purity", purity::check),
    ("leftovers", leftovers::check),
    ("placement", placement::check),
    ("module docs", placement::check_docs),
    ("cycles", cycles::check),
    ("names", names::check),
    ("dependencies", dependencies::check),
    ("pages", pages::check),
    ("words", words::check),
    ("error kinds", error_kinds::check),
];

/// Checks all rules and prints what does not hold.
pub fn run(root: &Path) -> ExitCode {
    let workspace = match read(root) {
        Ok(workspace) => workspace,
        Err(error) => {
            eprintln!("error: cannot read the workspace: {error}");
            return ExitCode::from(5);
        }
    };
    let mut found: Vec<(&str, Violation)> = Vec::new();
    for (rule, check) in RULES {
        found.extend(check(&workspace).into_iter().map(|violation| (rule, violation)));
    }
    let links = links::check(root).unwrap_or_else(|error| vec![Violation::in_file("docs", error.to_string())]);
    found.extend(links.into_iter().map(|violation| ("links", violation)));
    for (rule, Violation { path, line, what }) in &found {
        let line = line.map(|line| format!(":{line}")).unwrap_or_default();
        eprintln!("{path}{line}: {what} [{rule}]");
    }
    println!("tidy: {} files, {} violations", workspace.files.len(), found.len());
    ExitCode::from(u8::from(!found.is_empty()))
}

#[cfg(test)]
pub mod planted {
    //! Workspaces with one planted file, for the tests of the rules.

    use super::workspace::{File, Rule, Violation, Workspace};

    /// The violations that a rule finds in one file.
    pub fn violations(rule: Rule, path: &str, text: &str) -> Vec<Violation> {
        rule(&Workspace { top: Vec::new(), files: vec![File::new(path, text)] })
    }

    /// Asserts that a rule finds exactly one violation in the first text and none in the second.
    pub fn check(rule: Rule, path: &str, bad: &str, good: &str) {
        let found = violations(rule, path, bad);
        assert_eq!(found.len(), 1, "{path}: {bad}: {found:?}");
        assert_eq!(violations(rule, path, good), [], "{path}: {good}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_workspace_is_tidy() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        assert_eq!(run(root), ExitCode::SUCCESS, "violations are printed above");
    }
}
