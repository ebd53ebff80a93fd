//! `cargo xtask tidy`: the rules of docs/ARCHITECTURE.md, checked from manifests and source text.
//!
//! Each rule is a function from the text of the workspace to its violations, so that a test can plant one.

mod dependencies;
mod layers;
mod leftovers;
mod links;
mod placement;
mod purity;

use crate::source;
use std::fs;
use std::io;
use std::path::Path;
use std::process::ExitCode;

/// A text file of the workspace.
pub struct File {
    /// Path from the root, with `/`.
    pub path: String,
    /// Whole text.
    pub text: String,
    /// Text without comments and strings; empty but for Rust.
    pub code: String,
    /// Code without test modules.
    pub product: String,
}

impl File {
    /// A file with that text.
    pub fn new(path: &str, text: &str) -> Self {
        let code = if path.ends_with(".rs") { source::code(text) } else { String::new() };
        Self { path: path.into(), text: text.into(), product: source::without_tests(&code), code }
    }

    /// Folder name of the crate whose `src` folder holds this file: `sinew-core`.
    pub fn library(&self) -> Option<&str> {
        let (name, rest) = self.path.strip_prefix("crates/")?.split_once('/')?;
        rest.starts_with("src/").then_some(name)
    }

    /// Whether this is Rust.
    pub fn is_rust(&self) -> bool {
        self.path.ends_with(".rs")
    }
}

/// The text of the workspace.
#[derive(Default)]
pub struct Workspace {
    /// Names at the top level, without what git ignores.
    pub top: Vec<String>,
    /// Rust files and manifests.
    pub files: Vec<File>,
}

/// A rule that does not hold.
#[derive(Debug, PartialEq, Eq)]
pub struct Violation {
    /// Path from the root.
    pub path: String,
    /// Line from 1, if it is about one.
    pub line: Option<usize>,
    /// What is wrong and what to do.
    pub what: String,
}

impl Violation {
    /// About a whole file.
    pub fn of_file(path: &str, what: impl Into<String>) -> Self {
        Self { path: path.into(), line: None, what: what.into() }
    }

    /// About a line.
    pub fn at(path: &str, line: usize, what: impl Into<String>) -> Self {
        Self { path: path.into(), line: Some(line), what: what.into() }
    }
}

/// What a rule finds.
pub type Rule = fn(&Workspace) -> Vec<Violation>;

const RULES: [(&str, Rule); 5] = [
    ("layers", layers::check),
    ("purity", purity::check),
    ("leftovers", leftovers::check),
    ("placement", placement::check),
    ("module docs", placement::check_docs),
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
        for Violation { path, line, what } in violations {
            let line = line.map(|line| format!(":{line}")).unwrap_or_default();
            eprintln!("{path}{line}: {what} [{rule}]");
        }
    };
    for (rule, check) in RULES {
        report(rule, check(&workspace));
    }
    match links::check(root) {
        Ok(violations) => report("links", violations),
        Err(error) => report("links", vec![Violation::of_file("docs", error.to_string())]),
    }
    match dependencies::of_facade(root) {
        Ok(packages) => {
            println!("the facade builds {} packages", packages.len());
            report("dependencies", dependencies::check(packages.len()));
        }
        Err(what) => report("dependencies", vec![Violation::of_file("Cargo.lock", what)]),
    }
    println!("tidy: {} files, {count} violations", workspace.files.len());
    ExitCode::from(u8::from(count > 0))
}

/// Folders of the workspace that hold its own text.
const ROOTS: [&str; 5] = ["crates", "xtask", "tests", "fuzz", "."];

fn read(root: &Path) -> io::Result<Workspace> {
    let ignored = fs::read_to_string(root.join(".gitignore")).unwrap_or_default();
    let ignored: Vec<&str> = ignored.lines().filter_map(|line| line.strip_prefix('/')).collect();
    let mut workspace = Workspace::default();
    for entry in fs::read_dir(root)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name != ".git" && !ignored.contains(&name.as_str()) {
            workspace.top.push(name);
        }
    }
    workspace.top.sort();
    for folder in ROOTS {
        walk(root, folder, &mut workspace.files)?;
    }
    workspace.files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(workspace)
}

fn walk(root: &Path, folder: &str, files: &mut Vec<File>) -> io::Result<()> {
    let Ok(entries) = fs::read_dir(root.join(folder)) else { return Ok(()) };
    for entry in entries {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = if folder == "." { name.clone() } else { format!("{folder}/{name}") };
        if entry.file_type()?.is_dir() {
            if folder != "." && !matches!(name.as_str(), "target" | "corpus" | "artifacts") {
                walk(root, &path, files)?;
            }
        } else if name.ends_with(".rs") || name == "Cargo.toml" {
            files.push(File::new(&path, &fs::read_to_string(entry.path())?));
        }
    }
    Ok(())
}

#[cfg(test)]
pub mod planted {
    //! Workspaces with one planted file, for the tests of the rules.

    use super::{File, Rule, Violation, Workspace};

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
    fn this_workspace_is_read() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let workspace = read(root).unwrap();
        assert!(workspace.top.iter().any(|name| name == "Cargo.toml"));
        assert!(!workspace.top.iter().any(|name| name == "target"));
        assert!(workspace.files.iter().any(|file| file.path == "xtask/src/tidy.rs"));
        assert!(workspace.files.iter().any(|file| file.library() == Some("sinew-core")));
    }

    #[test]
    fn this_workspace_is_tidy() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        assert_eq!(run(root), ExitCode::SUCCESS, "violations are printed above");
    }
}
