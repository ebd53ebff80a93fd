//! The list of planted bugs: TOML files in `tests/planted/`, one a subject.
//!
//! ```toml
//! [[bug]]
//! name = "metropolis-test-missing"
//! what = "Every trajectory is accepted."
//! file = "crates/sinew-samplers/src/hmc/kernel.rs"
//! find = "let accepted = uniforms[0].0[lane] < acceptance;"
//! replace = "let accepted = !divergent;"
//! caught_by = [{ package = "sinew-samplers", target = "exact_start", test = "name_of_the_test" }]
//! ```
//!
//! `find` must occur in the file once. `target` is `lib`, or the name of a test program: of a file in the package's `tests` folder, or of a folder there, whose tests are named with their module.

use std::fs;
use std::path::Path;

/// A bug to plant.
#[derive(Debug, PartialEq, Eq)]
pub struct Bug {
    /// Unique name.
    pub name: String,
    /// What is wrong with it, in one sentence.
    pub what: String,
    /// File from the root.
    pub file: String,
    /// Text to replace, found once in the file.
    pub find: String,
    /// What replaces it.
    pub replace: String,
    /// Tests that must fail.
    pub caught_by: Vec<Test>,
}

/// A test.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Test {
    /// Package.
    pub package: String,
    /// `lib`, or the name of a test program.
    pub target: String,
    /// Path of the function in the target.
    pub test: String,
}

fn text(table: &toml::Table, key: &str) -> Result<String, String> {
    match table.get(key) {
        Some(toml::Value::String(text)) if !text.is_empty() => Ok(text.clone()),
        _ => Err(format!("`{key}` must be a text that is not empty")),
    }
}

fn tables(table: &toml::Table, key: &str) -> Result<Vec<toml::Table>, String> {
    let Some(toml::Value::Array(array)) = table.get(key) else { return Err(format!("`{key}` must be a list")) };
    array.iter().map(|v| v.as_table().cloned().ok_or_else(|| format!("`{key}` must be a list of tables"))).collect()
}

/// The bugs of one file.
pub fn parse(content: &str) -> Result<Vec<Bug>, String> {
    let file: toml::Table = content.parse().map_err(|e: toml::de::Error| e.to_string())?;
    let test =
        |t: &toml::Table| Ok(Test { package: text(t, "package")?, target: text(t, "target")?, test: text(t, "test")? });
    let bug = |b: &toml::Table| -> Result<Bug, String> {
        let caught_by = tables(b, "caught_by")?.iter().map(test).collect::<Result<Vec<_>, String>>()?;
        if caught_by.is_empty() {
            return Err("`caught_by` names no test".into());
        }
        let replace = b.get("replace").and_then(toml::Value::as_str).ok_or("`replace` must be a text")?.to_owned();
        let [name, what, file, find] = ["name", "what", "file", "find"].map(|key| text(b, key));
        Ok(Bug { name: name?, what: what?, file: file?, find: find?, replace, caught_by })
    };
    tables(&file, "bug")?.iter().map(|b| bug(b).map_err(|e| format!("{e}, in {b}"))).collect()
}

/// All bugs, file by file in the order of their names.
pub fn read(root: &Path) -> Result<Vec<Bug>, String> {
    let folder = root.join("tests/planted");
    let listed = fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut paths: Vec<_> = listed.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    let mut bugs = Vec::new();
    for path in paths {
        let content = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        bugs.extend(parse(&content).map_err(|e| format!("{}: {e}", path.display()))?);
    }
    Ok(bugs)
}

/// The file's text with the bug.
pub fn applied(bug: &Bug, code: &str) -> Result<String, String> {
    match code.matches(&bug.find).count() {
        1 if bug.find != bug.replace => Ok(code.replacen(&bug.find, &bug.replace, 1)),
        1 => Err(format!("{}: replaces a text by itself", bug.name)),
        count => Err(format!("{}: its text occurs {count} times in {}", bug.name, bug.file)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::PathBuf;

    fn root() -> &'static Path {
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace")
    }

    /// The file of a target: of a library or a folder of tests, that of the test's module.
    fn file_of(package: &str, target: &str, test: &str) -> PathBuf {
        let folder = root().join(if package == "sinew-tests" { "tests".into() } else { format!("crates/{package}") });
        if target != "lib" {
            let program = folder.join("tests").join(target);
            return match test.split_once("::") {
                Some((module, _)) if program.join("main.rs").exists() => program.join(format!("{module}.rs")),
                _ => program.with_extension("rs"),
            };
        }
        let module = test.split("::tests::").next().unwrap_or(test).replace("::", "/");
        let of_their_own = folder.join(format!("src/{module}/tests.rs"));
        if of_their_own.exists() { of_their_own } else { folder.join(format!("src/{module}.rs")) }
    }

    #[test]
    fn every_bug_applies_to_the_code_of_today() {
        let bugs = read(root()).expect("well formed");
        assert!(bugs.len() >= 25, "{}", bugs.len());
        let names: BTreeSet<_> = bugs.iter().map(|bug| &bug.name).collect();
        assert_eq!(names.len(), bugs.len(), "names are unique");
        for bug in &bugs {
            let code = fs::read_to_string(root().join(&bug.file)).expect("the file is there");
            if let Err(what) = applied(bug, &code) {
                panic!("{what}");
            }
            assert!(bug.file.starts_with("crates/") && !bug.what.is_empty(), "{} is in shipped code", bug.name);
        }
    }

    #[test]
    fn every_named_test_exists() {
        for bug in read(root()).expect("well formed") {
            for Test { package, target, test } in &bug.caught_by {
                let code = fs::read_to_string(file_of(package, target, test)).unwrap_or_default();
                let function = test.rsplit("::").next().unwrap_or(test);
                assert!(code.contains(&format!("fn {function}(")), "{}: {package} {target} has no {test}", bug.name);
            }
        }
    }

    #[test]
    fn a_list_that_is_not_well_formed_is_refused() {
        let good = "[[bug]]\nname = 'a'\nwhat = 'b'\nfile = 'c'\nfind = 'd'\nreplace = ''\ncaught_by = [{ package = 'p', target = 'lib', test = 't' }]";
        let bugs = parse(good).expect("well formed");
        assert_eq!((bugs.len(), bugs[0].caught_by[0].test.as_str()), (1, "t"));
        for (old, new) in [("find = 'd'", "find = ''"), ("what = 'b'", ""), ("[{ package", "[] #"), ("'t' }", "5 }")] {
            assert!(parse(&good.replace(old, new)).is_err(), "{new}");
        }
        assert!(applied(&bugs[0], "no").is_err() && applied(&bugs[0], "d and d").is_err());
        assert_eq!(applied(&bugs[0], "a d").as_deref(), Ok("a "));
    }
}
