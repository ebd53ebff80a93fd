//! How large files, functions and crates may be, in product lines.
//!
//! A product line stands outside test modules and is neither blank nor a comment alone ([`crate::source::product_lines`]).

use super::tokens::{Token, behind_bracket, tokens};
use super::workspace::{File, Violation, Workspace};
use crate::source::product_lines;
use std::collections::BTreeMap;

/// Product lines of a file at most.
const FILE: usize = 400;
/// Product lines of a function at most, its signature included.
const FUNCTION: usize = 60;
/// Product lines of a crate at most.
const CRATE: usize = 8000;

/// Checks the length of files.
pub fn check_files(workspace: &Workspace) -> Vec<Violation> {
    let counted = sources(workspace).map(|file| (file, count(&product_lines(&file.text))));
    let large = counted.filter(|(_, count)| *count > FILE);
    let what = |count| format!("has {count} product lines, {FILE} at most: split it");
    large.map(|(file, count)| Violation::in_file(&file.path, what(count))).collect()
}

/// Checks the length of functions; a violation is known by path and name.
pub fn check_functions(workspace: &Workspace) -> Vec<Violation> {
    let mut violations = Vec::new();
    for file in sources(workspace) {
        let lines = product_lines(&file.text);
        for (name, first, last) in functions(&file.product) {
            let count = count(&lines[first - 1..last.min(lines.len())]);
            if count > FUNCTION {
                let what = format!("`{name}` has {count} product lines, {FUNCTION} at most: split it");
                let violation = Violation::at(&file.path, first, what);
                violations.push(violation.known_as(&format!("{}: {name}", file.path)));
            }
        }
    }
    violations
}

/// Checks the length of crates, each with all that its `src` folder holds.
pub fn check_crates(workspace: &Workspace) -> Vec<Violation> {
    let mut crates: BTreeMap<&str, usize> = BTreeMap::new();
    for file in sources(workspace) {
        *crates.entry(folder(&file.path)).or_default() += count(&product_lines(&file.text));
    }
    let full = crates.into_iter().filter(|(_, count)| *count > CRATE);
    let what = |count| format!("has {count} product lines, {CRATE} at most: split the crate");
    full.map(|(folder, count)| Violation::in_file(folder, what(count))).collect()
}

fn count(lines: &[bool]) -> usize {
    lines.iter().filter(|is_product| **is_product).count()
}

/// The sources of the crates, of xtask and of the library of the tests.
fn sources(workspace: &Workspace) -> impl Iterator<Item = &File> {
    workspace.files.iter().filter(|file| is_source(file))
}

/// Whether a file belongs to what a crate is built from, as opposed to its tests, examples and benches.
fn is_source(file: &File) -> bool {
    let Some((_, inside)) = file.path.split_once("/src/") else { return false };
    let is_test = inside == "tests.rs" || inside.ends_with("/tests.rs") || inside.contains("tests/");
    let is_ours = file.path.starts_with("crates/") || matches!(folder(&file.path), "xtask" | "tests");
    file.is_rust() && is_ours && !is_test
}

/// Folder of the crate.
fn folder(path: &str) -> &str {
    path.split_once("/src/").map_or(path, |(folder, _)| folder)
}

/// Names of the functions of code with their first and last lines, from 1.
fn functions(code: &str) -> Vec<(&str, usize, usize)> {
    let tokens = tokens(code);
    let mut found = Vec::new();
    for (i, pair) in tokens.windows(2).enumerate() {
        if pair[0].text != "fn" || !pair[1].is_word() {
            continue;
        }
        if let Some(body) = body(&tokens, i + 2) {
            let last = tokens.get(behind_bracket(&tokens, body) - 1).map_or(pair[0].line, |token| token.line);
            found.push((pair[1].text, pair[0].line, last));
        }
    }
    found
}

/// Where the body of a function begins whose signature continues at `start`; none for a declaration.
fn body(tokens: &[Token<'_>], start: usize) -> Option<usize> {
    let mut i = start;
    while let Some(token) = tokens.get(i) {
        match token.text {
            "{" => return Some(i),
            ";" => return None,
            "(" | "[" => i = behind_bracket(tokens, i),
            _ => i += 1,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::planted;
    use super::*;

    /// A function of that many lines.
    fn function(name: &str, lines: usize) -> String {
        format!("fn {name}() {{\n{}}}\n", "    g();\n".repeat(lines - 2))
    }

    #[test]
    fn large_files_are_caught() {
        let text = |lines: usize| {
            format!("//! Doc.\n\n{}#[cfg(test)]\nmod tests {{\n\n}}\n", "const A: u8 = 1;\n".repeat(lines))
        };
        planted::check(check_files, "crates/a/src/b.rs", &text(FILE + 1), &text(FILE));
        assert_eq!(planted::violations(check_files, "crates/a/tests/b.rs", &text(FILE + 1)), []);
        assert_eq!(planted::violations(check_files, "crates/a/src/b/tests.rs", &text(FILE + 1)), []);
    }

    #[test]
    fn long_functions_are_caught() {
        let commented = function("f", FUNCTION).replacen("g();", "g();\n\n    // As before.", 1);
        planted::check(check_functions, "xtask/src/b.rs", &function("f", FUNCTION + 1), &commented);
        let tests = format!("#[cfg(test)]\nmod tests {{\n{}}}", function("f", FUNCTION + 1));
        assert_eq!(planted::violations(check_functions, "xtask/src/b.rs", &tests), []);
    }

    #[test]
    fn large_crates_are_caught() {
        let files = |count: usize| {
            let file = |i: usize| File::new(&format!("crates/a/src/b{i}.rs"), &"const A: u8 = 1;\n".repeat(FILE));
            Workspace { files: (0..count).map(file).collect(), ..Workspace::default() }
        };
        assert_eq!(check_crates(&files(CRATE / FILE)), []);
        assert_eq!(check_crates(&files(CRATE / FILE + 1)).len(), 1);
    }

    #[test]
    fn functions_are_found_with_their_lines() {
        let code = "trait T { fn a(&self) -> [u8; 3]; }\nfn b<const N: usize>(x: [u8; N]) {\n    fn c() {}\n}\ntype D = fn(u8);";
        assert_eq!(functions(code), [("b", 2, 4), ("c", 3, 3)]);
    }
}
