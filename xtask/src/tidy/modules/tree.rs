//! A crate as rules about modules see it: its files, its modules, and what each declares and mentions.

use std::collections::BTreeMap;

/// The modules that are reached from a root file; the root is number 0.
#[derive(Debug, Default)]
pub struct Tree {
    /// Paths of the files.
    pub files: Vec<String>,
    /// All modules, inline ones too.
    pub modules: Vec<Module>,
}

/// A module: a file, or an inline one.
#[derive(Debug, Default)]
pub struct Module {
    /// Number of its file.
    pub file: usize,
    /// The module around it; none for the root.
    pub parent: Option<usize>,
    /// What each name stands for.
    pub names: BTreeMap<String, Vec<Meaning>>,
    /// Paths of which all names are imported.
    pub globs: Vec<Vec<String>>,
    /// Paths that it mentions.
    pub mentions: Vec<Mention>,
}

/// What a name in a module stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// A module declared there, by number.
    Module(usize),
    /// An item defined there.
    Item,
    /// What a `use` there imports.
    Alias(Vec<String>),
}

/// A path in code or in a `use`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mention {
    /// Its segments.
    pub path: Vec<String>,
    /// Whether it stands in a `use` for this module alone.
    pub is_import: bool,
}

impl Tree {
    /// Adds a module that another declares; returns its number.
    pub fn add(&mut self, file: usize, parent: usize, name: &str) -> usize {
        self.modules.push(Module { file, parent: Some(parent), ..Module::default() });
        let number = self.modules.len() - 1;
        self.modules[parent].names.entry(name.to_owned()).or_default().push(Meaning::Module(number));
        number
    }
}
