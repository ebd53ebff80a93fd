//! Modules of a crate: their files, the names that each declares, and the paths that each mentions.
//!
//! Paths in macros count, names that macros make do not. Test modules are no part of it.

mod names;
mod reader;
mod tree;

pub use names::{Found, resolve};
pub use reader::{imports, read_crate};
pub use tree::{Mention, Module, Tree};

#[cfg(test)]
pub mod made_up {
    //! Small made-up crates for tests.

    use super::{Tree, read_crate};
    use crate::tidy::workspace::File;
    use std::collections::BTreeMap;

    /// Files under `crates/a/src/`.
    pub fn files(texts: &[(&str, &str)]) -> Vec<File> {
        texts.iter().map(|(path, text)| File::new(&format!("crates/a/src/{path}"), text)).collect()
    }

    /// The crate of `lib.rs`.
    pub fn tree(texts: &[(&str, &str)]) -> Tree {
        let files = files(texts);
        let by_path: BTreeMap<&str, &File> = files.iter().map(|file| (file.path.as_str(), file)).collect();
        read_crate(&by_path, "crates/a/src/lib.rs")
    }
}
