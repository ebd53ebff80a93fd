//! Reads the files of a crate into its modules, from its root along the `mod` lines.

use super::tree::{Meaning, Mention, Module, Tree};
use crate::source::{Token, flat};
use crate::tidy::workspace::File;
use std::collections::{BTreeMap, BTreeSet};
use syn::visit::{self, Visit};
use syn::{Item, UseTree, Visibility};

/// Reads the crate of that root file, which becomes module 0.
pub fn read_crate(files: &BTreeMap<&str, &File>, root: &str) -> Tree {
    let mut tree = Tree { files: vec![root.to_owned()], modules: vec![Module::default()] };
    let mut open = vec![0];
    let mut seen = BTreeSet::from([root.to_owned()]);
    while let Some(module) = open.pop() {
        let path = tree.files[tree.modules[module].file].clone();
        let Some(syntax) = files.get(path.as_str()).and_then(|file| file.product_syntax()) else { continue };
        let mut reader =
            Reader { tree: &mut tree, module, folder: String::new(), is_local: false, children: Vec::new() };
        reader.visit_file(&syntax);
        for (parent, name, folder) in reader.children {
            let folder = format!("{}{folder}", folder_of_children(&path, path == root));
            let found = [format!("{folder}{name}.rs"), format!("{folder}{name}/mod.rs")];
            let Some(found) = found.into_iter().find(|path| files.contains_key(path.as_str())) else { continue };
            if seen.insert(found.clone()) {
                tree.files.push(found);
                open.push(tree.add(tree.files.len() - 1, parent, &name));
            }
        }
    }
    tree
}

/// Where the files of a file's child modules are: beside a root and a `mod.rs`, else in the folder of its name.
fn folder_of_children(path: &str, is_root: bool) -> String {
    match path.rsplit_once('/') {
        Some((folder, name)) if is_root || name == "mod.rs" => format!("{folder}/"),
        _ => format!("{}/", path.trim_end_matches(".rs")),
    }
}

/// What is read of a file.
struct Reader<'a> {
    tree: &'a mut Tree,
    /// The module that is read.
    module: usize,
    /// Folders of the inline modules around.
    folder: String,
    /// Whether this is inside a body, whose items are no names of the module.
    is_local: bool,
    /// Child modules in files: the module that declares each, its name, and the folders of inline modules between.
    children: Vec<(usize, String, String)>,
}

impl Reader<'_> {
    fn name(&mut self, name: String, meaning: Meaning) {
        let meanings = self.tree.modules[self.module].names.entry(name).or_default();
        if !meanings.contains(&meaning) {
            meanings.push(meaning);
        }
    }

    fn mention(&mut self, path: Vec<String>, is_import: bool) {
        self.tree.modules[self.module].mentions.push(Mention { path, is_import });
    }

    /// An exported macro is an item of the root, defined elsewhere.
    fn export_macro(&mut self, name: String) {
        let mut path = vec![name.clone()];
        let mut at = self.module;
        while let Some(parent) = self.tree.modules[at].parent {
            let names = &self.tree.modules[parent].names;
            path.extend(names.iter().find(|(_, m)| m.contains(&Meaning::Module(at))).map(|(name, _)| name.clone()));
            at = parent;
        }
        path.push("crate".into());
        path.reverse();
        self.tree.modules[0].names.entry(name).or_default().push(Meaning::Alias(path));
    }
}

/// The paths of a tree of imports after that path, each with its name here; a path of which all names are imported has none.
pub fn imports(tree: &UseTree, mut path: Vec<String>) -> Vec<(Option<String>, Vec<String>)> {
    let (last, name) = match tree {
        UseTree::Path(inner) => {
            path.push(inner.ident.to_string());
            return imports(&inner.tree, path);
        }
        UseTree::Group(group) => return group.items.iter().flat_map(|inner| imports(inner, path.clone())).collect(),
        UseTree::Glob(_) => return vec![(None, path)],
        UseTree::Name(leaf) => (&leaf.ident, None),
        UseTree::Rename(leaf) => (&leaf.ident, Some(leaf.rename.to_string())),
    };
    if last != "self" {
        path.push(last.to_string());
    }
    vec![(name.or_else(|| path.last().cloned()), path)]
}

/// Name of an item, but of modules, imports and macros.
fn name_of(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::TraitAlias(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(name.to_string())
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if let Some(name) = name_of(item).filter(|_| !self.is_local) {
            self.name(name, Meaning::Item);
        }
        visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        let name = item.ident.to_string();
        let Some((_, items)) = &item.content else {
            return self.children.push((self.module, name, self.folder.clone()));
        };
        let (around, folder) = (self.module, format!("{}{name}/", self.folder));
        self.module = self.tree.add(self.tree.modules[around].file, around, &name);
        let folder = std::mem::replace(&mut self.folder, folder);
        items.iter().for_each(|item| self.visit_item(item));
        (self.module, self.folder) = (around, folder);
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        for (name, path) in imports(&item.tree, Vec::new()) {
            match name {
                Some(name) => self.name(name, Meaning::Alias(path.clone())),
                None => self.tree.modules[self.module].globs.push(path.clone()),
            }
            self.mention(path, matches!(item.vis, Visibility::Inherited));
        }
    }

    fn visit_item_macro(&mut self, item: &'ast syn::ItemMacro) {
        if let Some(name) = &item.ident {
            self.name(name.to_string(), Meaning::Item);
            if self.module != 0 && item.attrs.iter().any(|attribute| attribute.path().is_ident("macro_export")) {
                self.export_macro(name.to_string());
            }
        }
        visit::visit_item_macro(self, item);
    }

    fn visit_block(&mut self, block: &'ast syn::Block) {
        let was_local = std::mem::replace(&mut self.is_local, true);
        visit::visit_block(self, block);
        self.is_local = was_local;
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.mention(path.segments.iter().map(|segment| segment.ident.to_string()).collect(), false);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, called: &'ast syn::Macro) {
        visit::visit_macro(self, called);
        paths(&flat(called.tokens.clone())).into_iter().for_each(|path| self.mention(path, false));
    }

    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}

/// Paths among the tokens of a macro.
fn paths(tokens: &[Token]) -> Vec<Vec<String>> {
    let is_word = |text: &str| text.starts_with(|c: char| c.is_alphabetic() || c == '_');
    let mut found: Vec<Vec<String>> = Vec::new();
    let mut before = "";
    for token in tokens {
        match (before, found.last_mut()) {
            ("::", Some(path)) if is_word(&token.text) => path.push(token.text.clone()),
            // A field or a method.
            (".", _) => {}
            _ if is_word(&token.text) => found.push(vec![token.text.clone()]),
            _ => {}
        }
        before = &token.text;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::made_up;
    use super::*;

    fn words(path: &str) -> Vec<String> {
        path.split("::").map(str::to_owned).collect()
    }

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

    #[test]
    fn imports_are_taken_apart() {
        let tree = made_up::tree(&[("lib.rs", "use a::{self as x, b::{C, D as E}, f::*}; pub(crate) use g::{self};")]);
        let names = &tree.modules[0].names;
        for (name, path) in [("x", "a"), ("C", "a::b::C"), ("E", "a::b::D"), ("g", "g")] {
            assert_eq!(names[name], [Meaning::Alias(words(path))], "{name}");
        }
        assert_eq!(names.len(), 4);
        assert_eq!(tree.modules[0].globs, [words("a::f")]);
        let imports: Vec<bool> = tree.modules[0].mentions.iter().map(|mention| mention.is_import).collect();
        assert_eq!(imports, [true, true, true, true, false]);
    }

    #[test]
    fn items_of_the_module_are_names_and_local_ones_are_not() {
        let text = "pub struct A { b: C }\nimpl A { const D: u8 = 1; fn e() { fn f() {} } }\nconst fn g() {}\nmacro_rules! h { () => {} }";
        let tree = made_up::tree(&[("lib.rs", text)]);
        assert_eq!(tree.modules[0].names.keys().collect::<Vec<_>>(), ["A", "g", "h"]);
    }

    #[test]
    fn paths_in_code_are_mentioned_wherever_they_stand() {
        let text = "pub(in crate::a) fn f(x: &crate::a::B) -> c::D { x.e::<u8>(); vec![super::f::g(x.k, 1)] }\n#[crate::h::i]\nstruct S;";
        let tree = made_up::tree(&[("lib.rs", text)]);
        let found = tree.modules[0].mentions.iter().filter(|mention| mention.path.len() > 1);
        let found: Vec<String> = found.map(|mention| mention.path.join("::")).collect();
        assert_eq!(found, ["crate::a::B", "c::D", "super::f::g"]);
    }

    #[test]
    fn inline_modules_have_names_of_their_own() {
        let tree = made_up::tree(&[("lib.rs", "mod a { use b::C; fn f() {} }\nfn g() { super::x() }")]);
        assert_eq!(tree.modules[1].names.keys().collect::<Vec<_>>(), ["C", "f"]);
        assert_eq!(tree.modules[0].names.keys().collect::<Vec<_>>(), ["a", "g"]);
        assert_eq!(tree.modules[0].mentions.len(), 1);
    }

    #[test]
    fn exported_macros_are_items_of_the_root() {
        let tree = made_up::tree(&[("lib.rs", "mod a;"), ("a.rs", "#[macro_export]\nmacro_rules! m { () => {} }")]);
        assert_eq!(tree.modules[0].names["m"], [Meaning::Alias(words("crate::a::m"))]);
    }
}
