//! `cargo xtask tidy`: the rules of docs/ARCHITECTURE.md, checked from manifests and source text.
//!
//! Each rule is a function from the text of the workspace to its violations, so that a test can plant one.

mod cycles;
mod dependencies;
mod exceptions;
mod layers;
mod leftovers;
mod links;
mod modules;
mod names;
mod opening;
mod pages;
mod placement;
mod purity;
mod sizes;
mod tokens;
mod words;
mod workspace;

use exceptions::Exception;
use std::path::Path;
use std::process::ExitCode;
use workspace::{Rule, Violation, read};

/// Rules by name, each with what is excepted from it for now.
const RULES: [(&str, Rule, &[Exception]); 13] = [
    ("layers", layers::check, &[]),
    ("purity", purity::check, &[]),
    ("leftovers", leftovers::check, &[]),
    ("placement", placement::check, &[]),
    ("module docs", placement::check_docs, &[]),
    ("cycles", cycles::check, &[]),
    ("files", sizes::check_files, exceptions::LARGE_FILES),
    ("functions", sizes::check_functions, &[]),
    ("crates", sizes::check_crates, exceptions::LARGE_CRATES),
    ("names", names::check, &[]),
    ("pages", pages::check, &[]),
    ("openings", opening::check, &[]),
    ("words", words::check, exceptions::ODD_WORDS),
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
    let mut count = 0;
    let mut report = |rule: &str, violations: Vec<Violation>| {
        count += violations.len();
        for Violation { path, line, what, .. } in violations {
            let line = line.map(|line| format!(":{line}")).unwrap_or_default();
            eprintln!("{path}{line}: {what} [{rule}]");
        }
    };
    for (rule, check, excepted) in RULES {
        report(rule, exceptions::apply(excepted, check(&workspace)));
    }
    match links::check(root) {
        Ok(violations) => report("links", violations),
        Err(error) => report("links", vec![Violation::in_file("docs", error.to_string())]),
    }
    match dependencies::library_packages(root) {
        Ok(packages) => {
            println!("the library builds {} packages", packages.len());
            report("dependencies", dependencies::check(packages.len()));
        }
        Err(what) => report("dependencies", vec![Violation::in_file("Cargo.lock", what)]),
    }
    println!("tidy: {} files, {count} violations", workspace.files.len());
    ExitCode::from(u8::from(count > 0))
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
