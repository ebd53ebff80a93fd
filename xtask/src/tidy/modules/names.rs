//! Where a path leads: through modules, imports and re-exports to the file that defines the item.

use super::tree::{Meaning, Tree};
use std::collections::BTreeSet;

/// What a path stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// A module.
    Module(usize),
    /// An item of that name, defined in a module.
    Item(usize, String),
}

/// Follows a path from a module; none for what other crates define.
pub fn resolve(tree: &Tree, module: usize, path: &[String]) -> Option<Found> {
    Walk { tree, seen: BTreeSet::new() }.resolve(module, path)
}

struct Walk<'a> {
    tree: &'a Tree,
    /// Names that are being looked up, each in its module, so that a circle of imports ends.
    seen: BTreeSet<(usize, String, bool)>,
}

impl Walk<'_> {
    fn resolve(&mut self, module: usize, path: &[String]) -> Option<Found> {
        let (mut at, mut start) = (module, 0);
        for (i, segment) in path.iter().enumerate() {
            match segment.as_str() {
                "crate" => at = 0,
                "self" => {}
                "super" => at = self.tree.modules[at].parent?,
                _ => break,
            }
            start = i + 1;
        }
        for (i, name) in path.iter().enumerate().skip(start) {
            let is_last = i + 1 == path.len();
            match self.look_up(at, name, !is_last) {
                Some(Found::Module(next)) => at = next,
                Some(item) => return Some(item),
                // Of another crate, or an item that a macro makes.
                None if i == 0 => return None,
                None => return Some(Found::Item(at, name.clone())),
            }
        }
        (!path.is_empty()).then_some(Found::Module(at))
    }

    fn look_up(&mut self, module: usize, name: &str, as_module: bool) -> Option<Found> {
        let key = (module, name.to_owned(), as_module);
        if !self.seen.insert(key.clone()) {
            return None;
        }
        let found = self.among_names(module, name, as_module).or_else(|| self.among_globs(module, name, as_module));
        self.seen.remove(&key);
        found
    }

    /// Modules before items where more segments follow, items before modules where none do.
    fn among_names(&mut self, module: usize, name: &str, as_module: bool) -> Option<Found> {
        let tree = self.tree;
        let meanings = tree.modules[module].names.get(name)?;
        let mut found: Vec<Found> = Vec::new();
        for meaning in meanings {
            match meaning {
                Meaning::Module(number) => found.push(Found::Module(*number)),
                Meaning::Item => found.push(Found::Item(module, name.to_owned())),
                Meaning::Alias(path) => found.extend(self.resolve(module, path)),
            }
        }
        let is_module = |found: &Found| matches!(found, Found::Module(_));
        let wanted = found.iter().position(|found| is_module(found) == as_module).unwrap_or(0);
        found.into_iter().nth(wanted)
    }

    fn among_globs(&mut self, module: usize, name: &str, as_module: bool) -> Option<Found> {
        let tree = self.tree;
        tree.modules[module].globs.iter().find_map(|path| match self.resolve(module, path)? {
            Found::Module(other) => self.look_up(other, name, as_module),
            Found::Item(..) => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::made_up;
    use super::*;

    /// The file and the name of the item that a path from the module of `from` leads to.
    fn led(texts: &[(&str, &str)], from: &str, path: &str) -> Option<(String, String)> {
        let tree = made_up::tree(texts);
        let is_from = |file: &String| file.ends_with(&format!("src/{from}"));
        let file = tree.files.iter().position(is_from).unwrap();
        let module = tree.modules.iter().position(|module| module.file == file).unwrap();
        let path: Vec<String> = path.split("::").map(str::to_owned).collect();
        let (module, name) = match resolve(&tree, module, &path)? {
            Found::Module(module) => (module, String::new()),
            Found::Item(module, name) => (module, name),
        };
        let file = &tree.files[tree.modules[module].file];
        Some((file.trim_start_matches("crates/a/src/").into(), name))
    }

    fn expect(file: &str, name: &str) -> Option<(String, String)> {
        Some((file.into(), name.into()))
    }

    const CRATE: [(&str, &str); 5] = [
        ("lib.rs", "pub mod a; pub mod b; pub use a::x::Deep as Renamed;"),
        ("a.rs", "mod x; mod y; pub use x::{Deep, wide}; use std::fmt; pub use y::*; pub fn own() {}"),
        ("a/x.rs", "pub struct Deep; pub fn wide() {} use super::z;"),
        ("a/y.rs", "pub fn z() {} pub use super::*;"),
        ("b.rs", "use crate::a as other;"),
    ];

    #[test]
    fn re_exports_lead_to_the_file_of_the_item() {
        assert_eq!(led(&CRATE, "b.rs", "crate::Renamed"), expect("a/x.rs", "Deep"));
        assert_eq!(led(&CRATE, "b.rs", "other::Deep::new"), expect("a/x.rs", "Deep"));
        assert_eq!(led(&CRATE, "a/y.rs", "super::wide"), expect("a/x.rs", "wide"));
        assert_eq!(led(&CRATE, "a/x.rs", "super::own"), expect("a.rs", "own"));
    }

    #[test]
    fn globs_are_followed_and_circles_of_them_end() {
        assert_eq!(led(&CRATE, "a/x.rs", "super::z"), expect("a/y.rs", "z"));
        assert_eq!(led(&CRATE, "a/x.rs", "super::nothing"), expect("a.rs", "nothing"));
        assert_eq!(led(&CRATE, "a/y.rs", "nothing"), None);
    }

    #[test]
    fn other_crates_and_bare_modules_are_distinguished() {
        assert_eq!(led(&CRATE, "a.rs", "fmt::Display"), None);
        assert_eq!(led(&CRATE, "b.rs", "std::fmt"), None);
        assert_eq!(led(&CRATE, "b.rs", "other"), expect("a.rs", ""));
        assert_eq!(led(&CRATE, "a/x.rs", "super::super::b"), expect("b.rs", ""));
    }
}
