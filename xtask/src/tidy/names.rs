//! No two public types of one name, but for the few that are read with their module.

use super::workspace::{File, Violation, Workspace};
use std::collections::BTreeMap;

/// Names that several modules share on purpose, since they are written with the module in front.
const WITH_MODULE: [(&str, &str); 2] = [
    ("Config", "the settings of the algorithm of its file: `hmc::Config`"),
    ("Error", "one for each crate: `formats::Error`"),
];

/// Keywords of types.
const KINDS: [&str; 5] = ["struct", "enum", "union", "trait", "type"];

/// Checks the libraries of the crates.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let mut homes: BTreeMap<&str, Vec<&File>> = BTreeMap::new();
    for file in workspace.files.iter().filter(|file| file.library().is_some_and(|name| name != "sinew-studies")) {
        for name in public_types(file) {
            homes.entry(name).or_default().push(file);
        }
    }
    let meant = |name: &str| WITH_MODULE.iter().any(|(other, _)| *other == name);
    let doubled = homes.into_iter().filter(|(name, homes)| homes.len() > 1 && !meant(name));
    let violation = |(name, homes): (&str, Vec<&File>)| {
        let others: Vec<&str> = homes[1..].iter().map(|file| file.path.as_str()).collect();
        let what = format!("`{name}` is also a public type in {}: give each a name of its own", others.join(", "));
        Violation::in_file(&homes[0].path, what)
    };
    doubled.map(violation).collect()
}

/// Names of the types that a file declares `pub`.
fn public_types(file: &File) -> Vec<&str> {
    let words: Vec<&str> = file.product.iter().map(|token| token.text.as_str()).collect();
    let declared = words.windows(3).filter(|words| words[0] == "pub" && KINDS.contains(&words[1]));
    let mut names: Vec<&str> = declared.map(|words| words[2]).collect();
    names.sort_unstable();
    names.dedup();
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(texts: &[(&str, &str)]) -> Vec<String> {
        let files = texts.iter().map(|(path, text)| File::new(path, text)).collect();
        check(&Workspace { files, ..Workspace::default() }).into_iter().map(|violation| violation.what).collect()
    }

    #[test]
    fn two_public_types_of_one_name_are_caught() {
        let a = "crates/a/src/x.rs";
        let one = (a, "pub struct Made; pub struct Config;");
        let messages = found(&[one, ("crates/b/src/y.rs", "pub enum Made {} pub struct Config;")]);
        assert_eq!(messages, ["`Made` is also a public type in crates/b/src/y.rs: give each a name of its own"]);
        assert_eq!(found(&[one, ("crates/b/src/y.rs", "pub(crate) enum Made {} struct Made;")]), [""; 0]);
        assert_eq!(found(&[one, ("crates/b/tests/y.rs", "pub enum Made {}")]), [""; 0]);
        assert_eq!(found(&[one, ("crates/b/src/y.rs", "#[cfg(test)]\nmod tests { pub struct Made; }")]), [""; 0]);
    }
}
