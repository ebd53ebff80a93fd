//! No cycle of modules in any crate: arrows between files, from who names an item to who defines it.
//!
//! A `mod` line alone is no arrow. A parent that uses or re-exports its child points at the child; a child that uses what its parent file defines points at the parent.
//! A path through re-exports points at the file where the item lives; where another room re-exports it, at the room too. The root and the modules around may be passed through.

use super::modules::{Found, Mention, Module, Tree, read_crate, resolve};
use super::workspace::{File, Violation, Workspace};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Names that tie a file to another, for each pair of files.
type Arrows = BTreeMap<usize, BTreeMap<usize, BTreeSet<String>>>;

/// Names of an arrow that a message lists.
const LISTED_NAMES: usize = 3;

/// Checks every crate of the workspace.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let files: BTreeMap<&str, &File> = workspace.files.iter().map(|file| (file.path.as_str(), file)).collect();
    let mut violations = Vec::new();
    for root in files.keys().filter(|path| is_root(path)) {
        violations.extend(cycles(&read_crate(&files, root)));
    }
    violations
}

/// Whether a file is the root of a crate that is built from a `src` folder.
fn is_root(path: &str) -> bool {
    let Some((folder, file)) = path.split_once("/src/") else { return false };
    let is_ours = folder.starts_with("crates/") || folder == "xtask" || folder == "tests";
    is_ours && (matches!(file, "lib.rs" | "main.rs") || file.starts_with("bin/") && file.matches('/').count() == 1)
}

/// One violation for each knot of files.
fn cycles(tree: &Tree) -> Vec<Violation> {
    let arrows = arrows(tree);
    let knots = knots(&arrows, tree.files.len());
    knots.iter().map(|knot| Violation::in_file(&tree.files[knot[0]], message(tree, &arrows, knot))).collect()
}

fn message(tree: &Tree, arrows: &Arrows, knot: &[usize]) -> String {
    let cycle = shortest(arrows, knot);
    let short = |file: usize| tree.files[file].split_once("/src/").map_or(tree.files[file].as_str(), |(_, path)| path);
    let mut text = format!("cycle of modules: {}", short(cycle[0]));
    for (i, from) in cycle.iter().enumerate() {
        let to = cycle[(i + 1) % cycle.len()];
        let names = &arrows[from][&to];
        let mut listed: Vec<&str> = names.iter().take(LISTED_NAMES).map(String::as_str).collect();
        if names.len() > LISTED_NAMES {
            listed.push("…");
        }
        text += &format!(" → ({}) {}", listed.join(", "), short(to));
    }
    if knot.len() > cycle.len() {
        let all: Vec<&str> = knot.iter().map(|file| short(*file)).collect();
        text += &format!("; {} files are tied together: {}", knot.len(), all.join(", "));
    }
    text
}

fn arrows(tree: &Tree) -> Arrows {
    let mut arrows = Arrows::new();
    for (number, module) in tree.modules.iter().enumerate() {
        let mut tie = |to: usize, name: &str| {
            let to = tree.modules[to].file;
            if to != module.file {
                arrows.entry(module.file).or_default().entry(to).or_default().insert(name.to_owned());
            }
        };
        // A word alone may be a variable: it counts for what imports of all names bring.
        let counts = |mention: &&Mention| match &mention.path[..] {
            [word] if !mention.is_import => !module.globs.is_empty() && !module.names.contains_key(word),
            _ => true,
        };
        for mention in module.mentions.iter().filter(counts) {
            match resolve(tree, number, &mention.path) {
                Some(Found::Item(at, name)) => {
                    tie(at, &name);
                    room(tree, number, &mention.path).into_iter().for_each(|room| tie(room, &name));
                }
                Some(Found::Module(at)) if !is_taken_further(tree, number, mention, at) => {
                    tie(at, mention.path.last().map_or("", String::as_str));
                }
                _ => {}
            }
        }
    }
    arrows
}

/// The module that a path names before its last segment, where it is another room: not the root, nor around the module that names it.
fn room(tree: &Tree, module: usize, path: &[String]) -> Option<usize> {
    let (_, before) = path.split_last().filter(|(_, before)| !before.is_empty())?;
    let Some(Found::Module(room)) = resolve(tree, module, before) else { return None };
    let around = std::iter::successors(Some(module), |&inner| tree.modules[inner].parent);
    (room != 0 && around.into_iter().all(|module| module != room)).then_some(room)
}

/// Whether a private import of a module is only the beginning of other paths, which count for themselves.
fn is_taken_further(tree: &Tree, module: usize, mention: &Mention, imported: usize) -> bool {
    let is_same_file = |other: &&Module| other.file == tree.modules[module].file;
    let goes_through = |other: &Mention| {
        let first = other.path.first().filter(|_| other.path.len() > 1).into_iter().cloned().collect::<Vec<_>>();
        !first.is_empty() && resolve(tree, module, &first) == Some(Found::Module(imported))
    };
    let is_glob = tree.modules[module].globs.contains(&mention.path);
    mention.is_import
        && (is_glob || tree.modules.iter().filter(is_same_file).any(|other| other.mentions.iter().any(goes_through)))
}

/// Files that reach each other, in sets of two and more.
fn knots(arrows: &Arrows, files: usize) -> Vec<Vec<usize>> {
    let reached: Vec<BTreeSet<usize>> = (0..files).map(|file| reachable(arrows, file)).collect();
    let mut knots: Vec<Vec<usize>> = Vec::new();
    for file in 0..files {
        if reached[file].contains(&file) && !knots.iter().any(|knot| knot.contains(&file)) {
            knots.push(
                (0..files).filter(|&other| reached[file].contains(&other) && reached[other].contains(&file)).collect(),
            );
        }
    }
    knots
}

fn reachable(arrows: &Arrows, from: usize) -> BTreeSet<usize> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(file) = open.pop() {
        for &next in arrows.get(&file).into_iter().flat_map(BTreeMap::keys) {
            if found.insert(next) {
                open.push(next);
            }
        }
    }
    found
}

/// The shortest cycle through a knot.
fn shortest(arrows: &Arrows, knot: &[usize]) -> Vec<usize> {
    let cycles = knot.iter().filter_map(|&start| shortest_from(arrows, start));
    cycles.min_by_key(Vec::len).unwrap_or_default()
}

fn shortest_from(arrows: &Arrows, start: usize) -> Option<Vec<usize>> {
    let mut before: BTreeMap<usize, usize> = BTreeMap::new();
    let mut open = VecDeque::from([start]);
    while let Some(file) = open.pop_front() {
        for &next in arrows.get(&file).into_iter().flat_map(BTreeMap::keys) {
            if next == start {
                let mut cycle = vec![file];
                while let Some(&file) = cycle.last().filter(|file| **file != start).and_then(|file| before.get(file)) {
                    cycle.push(file);
                }
                cycle.reverse();
                return Some(cycle);
            }
            if next != start && !before.contains_key(&next) {
                before.insert(next, file);
                open.push_back(next);
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::modules::made_up;
    use super::*;

    /// Messages about a made-up crate.
    fn messages(texts: &[(&str, &str)]) -> Vec<String> {
        let workspace = Workspace { files: made_up::files(texts), ..Workspace::default() };
        check(&workspace).into_iter().map(|violation| violation.what).collect()
    }

    #[test]
    fn two_files_that_import_each_other_are_a_cycle() {
        let texts = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "use crate::b::B; pub struct A;"),
            ("b.rs", "pub struct B; pub fn f(a: super::a::A) {}"),
        ];
        assert_eq!(messages(&texts), ["cycle of modules: a.rs → (B) b.rs → (A) a.rs"]);
    }

    #[test]
    fn a_child_may_be_used_by_its_parent_or_use_it_but_not_both() {
        let both = [
            ("lib.rs", "mod a;"),
            ("a.rs", "mod x; pub use x::X; pub struct A;"),
            ("a/x.rs", "pub struct X(super::A);"),
        ];
        assert_eq!(messages(&both), ["cycle of modules: a.rs → (X) a/x.rs → (A) a.rs"]);
        let up = [("lib.rs", "mod a;"), ("a.rs", "mod x; pub struct A;"), ("a/x.rs", "pub struct X(super::A);")];
        assert_eq!(messages(&up), [""; 0]);
        let down = [("lib.rs", "mod a;"), ("a.rs", "mod x; pub use x::X; pub struct A;"), ("a/x.rs", "pub struct X;")];
        assert_eq!(messages(&down), [""; 0]);
    }

    #[test]
    fn siblings_may_meet_through_what_their_parent_re_exports() {
        let texts = |y: &'static str| {
            [
                ("lib.rs", "mod a;"),
                ("a.rs", "mod x; mod y; pub use x::X; pub use y::Y;"),
                ("a/x.rs", "use super::Y; pub struct X(Y);"),
                ("a/y.rs", y),
            ]
        };
        assert_eq!(messages(&texts("pub struct Y;")), [""; 0]);
        let found = messages(&texts("pub struct Y(crate::a::X);"));
        assert_eq!(found, ["cycle of modules: a/x.rs → (Y) a/y.rs → (X) a/x.rs"]);
    }

    #[test]
    fn imported_modules_count_for_what_is_used_of_them() {
        let texts = |b: &'static str| {
            [
                ("lib.rs", "mod a; mod b;"),
                ("a.rs", "mod x; pub mod y; pub use crate::b::g;"),
                ("a/x.rs", ""),
                ("a/y.rs", "pub fn f() {}"),
                ("b.rs", b),
            ]
        };
        assert_eq!(messages(&texts("use crate::a::y; pub fn g() { y::f() }")), [""; 0]);
        assert_eq!(messages(&texts("use crate::a; pub fn g() { a::g() }")).len(), 1);
    }

    #[test]
    fn a_re_export_ties_to_the_room_that_hands_it_on() {
        let texts = |error: &'static str| {
            [
                ("lib.rs", "mod a; mod error; pub use error::Error;"),
                ("a.rs", "pub mod error; use crate::Error; pub use error::AError; pub fn f() -> Error {}"),
                ("a/error.rs", "pub struct AError;"),
                ("error.rs", error),
            ]
        };
        assert_eq!(messages(&texts("use crate::a::error::AError; pub struct Error(AError);")), [""; 0]);
        let found = messages(&texts("use crate::a::AError; pub struct Error(AError);"));
        assert_eq!(found, ["cycle of modules: a.rs → (Error) error.rs → (AError) a.rs"]);
    }

    #[test]
    fn globs_tie_by_the_words_that_they_bring() {
        let texts =
            |x: &'static str| [("lib.rs", "mod a;"), ("a.rs", "mod x; use x::X; pub fn f(x: X) {}"), ("a/x.rs", x)];
        assert_eq!(messages(&texts("use super::*; pub struct X; fn g() { h() }")), [""; 0]);
        let found = messages(&texts("use super::*; pub struct X; fn g() { f(X) }"));
        assert_eq!(found, ["cycle of modules: a.rs → (X) a/x.rs → (f) a.rs"]);
    }

    #[test]
    fn tests_and_comments_do_not_count() {
        let texts = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "use crate::b::B; pub struct A;"),
            ("b.rs", "/// As [`crate::a::A`].\npub struct B;\n#[cfg(test)]\nmod tests { use crate::a::A; }"),
        ];
        assert_eq!(messages(&texts), [""; 0]);
    }

    #[test]
    fn the_shortest_cycle_stands_for_a_knot() {
        let texts = [
            ("lib.rs", "mod a; mod b; mod c; mod d;"),
            ("a.rs", "pub struct A(crate::b::B);"),
            ("b.rs", "pub struct B(crate::c::C);"),
            ("c.rs", "pub struct C(crate::a::A, crate::d::D);"),
            ("d.rs", "pub fn f() {} pub fn g() {} pub fn h() {} pub struct D(crate::c::C);"),
        ];
        let found = messages(&texts);
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("c.rs → (D) d.rs → (C) c.rs; 4 files are tied together"), "{}", found[0]);
    }

    #[test]
    fn libraries_and_programs_are_crates_of_their_own() {
        let texts = [
            ("lib.rs", "pub mod a;"),
            ("main.rs", "mod b;"),
            ("a.rs", "pub struct A;"),
            ("b.rs", "use a::a::A; use crate::c;"),
        ];
        assert_eq!(messages(&texts), [""; 0]);
    }
}
