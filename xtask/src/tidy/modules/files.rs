//! The files of a crate, found from its root by following `mod` lines.

use super::declarations;
use super::tree::{Module, Tree};
use crate::tidy::workspace::File;
use std::collections::{BTreeMap, BTreeSet};

/// Reads the crate of that root file, which becomes module 0.
pub fn read_crate(files: &BTreeMap<&str, &File>, root: &str) -> Tree {
    let mut tree = Tree { files: vec![root.to_owned()], modules: vec![Module::default()] };
    let mut open = vec![0];
    let mut seen = BTreeSet::from([root.to_owned()]);
    while let Some(module) = open.pop() {
        let path = tree.files[tree.modules[module].file].clone();
        let Some(file) = files.get(path.as_str()) else { continue };
        for (parent, name, folder) in declarations::read(&mut tree, module, &file.product) {
            let folder = format!("{}{folder}", folder_of_children(&path, path == root));
            let found = [format!("{folder}{name}.rs"), format!("{folder}{name}/mod.rs")];
            let Some(found) = found.into_iter().find(|path| files.contains_key(path.as_str())) else { continue };
            if seen.insert(found.clone()) {
                tree.files.push(found);
                let child = Module { file: tree.files.len() - 1, parent: Some(parent), ..Module::default() };
                open.push(tree.add(child, parent, &name));
            }
        }
    }
    tree
}

/// Where the files of a file's child modules are: beside a root and a `mod.rs`, else in the folder of its name.
fn folder_of_children(path: &str, is_root: bool) -> String {
    let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
    match name {
        "mod.rs" => format!("{folder}/"),
        _ if is_root => format!("{folder}/"),
        _ => format!("{}/", path.trim_end_matches(".rs")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::made_up;

    #[test]
    fn files_of_modules_are_found() {
        let tree = made_up::tree(&[
            ("lib.rs", "mod a; pub mod b; mod c { mod d; } #[cfg(test)] mod t; mod absent;"),
            ("a.rs", "mod e;"),
            ("a/e.rs", ""),
            ("b/mod.rs", "mod f;"),
            ("b/f.rs", ""),
            ("c/d.rs", ""),
            ("t.rs", ""),
            ("stray.rs", ""),
        ]);
        let mut files: Vec<&str> = tree.files.iter().map(|path| path.trim_start_matches("crates/a/src/")).collect();
        files.sort_unstable();
        assert_eq!(files, ["a.rs", "a/e.rs", "b/f.rs", "b/mod.rs", "c/d.rs", "lib.rs"]);
        assert_eq!(tree.modules.len(), 7, "an inline one too");
    }
}
