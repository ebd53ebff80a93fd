//! What rules read and what they find: the text of the workspace, and violations.

use crate::source::{Token, flat, literals, without_tests};
use proc_macro2::TokenStream;
use std::fs;
use std::io;
use std::path::Path;

/// A text file of the workspace.
pub struct File {
    /// Path from the root, with `/`.
    pub path: String,
    /// Whole text.
    pub text: String,
    /// Its tokens; none but of Rust.
    pub code: Vec<Token>,
    /// Its tokens outside test modules.
    pub product: Vec<Token>,
    /// What stands outside test modules, not taken apart yet.
    stream: TokenStream,
}

impl File {
    /// A file with that text.
    pub fn new(path: &str, text: &str) -> Self {
        let whole: TokenStream =
            if path.ends_with(".rs") { text.parse().unwrap_or_default() } else { Default::default() };
        let stream = without_tests(whole.clone());
        Self { path: path.into(), text: text.into(), code: flat(whole), product: flat(stream.clone()), stream }
    }

    /// Folder name of the crate whose `src` folder holds this file: `sinew-core`.
    pub fn library(&self) -> Option<&str> {
        let (name, rest) = self.path.strip_prefix("crates/")?.split_once('/')?;
        rest.starts_with("src/").then_some(name)
    }

    /// Its syntax, without test modules; none where it is no whole file of Rust.
    pub fn product_syntax(&self) -> Option<syn::File> {
        syn::parse2(self.stream.clone()).ok()
    }

    /// Its literals outside test modules and comments.
    pub fn strings(&self) -> Vec<Token> {
        literals(self.stream.clone())
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
    /// Rust files, manifests and pages.
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
    pub fn in_file(path: &str, what: impl Into<String>) -> Self {
        Self { path: path.into(), line: None, what: what.into() }
    }

    /// About a line.
    pub fn at(path: &str, line: usize, what: impl Into<String>) -> Self {
        Self { line: Some(line), ..Self::in_file(path, what) }
    }
}

/// What a rule finds.
pub type Rule = fn(&Workspace) -> Vec<Violation>;

/// Folders of the workspace that hold its own text.
const ROOTS: [&str; 6] = ["crates", "xtask", "tests", "fuzz", "docs", "."];

/// Reads the workspace.
pub fn read(root: &Path) -> io::Result<Workspace> {
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
        } else if name.ends_with(".rs") || name.ends_with(".md") || name == "Cargo.toml" {
            files.push(File::new(&path, &fs::read_to_string(entry.path())?));
        }
    }
    Ok(())
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
}
