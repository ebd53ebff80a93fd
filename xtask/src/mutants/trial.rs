//! Runs named tests in the copy, with a bug or without.

use super::list::{Bug, Test, applied};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Longest run of the named tests of one target.
const PATIENCE: Duration = Duration::from_secs(900);

/// The copy, and how to run cargo in it.
pub struct Trial {
    checkout: PathBuf,
    target: PathBuf,
    /// Folder of shared recordings, which the copy does not lie beside.
    data: Option<OsString>,
}

/// What became of a bug.
pub enum Outcome {
    /// The tests that failed, and what they said first.
    Caught(Vec<(String, String)>),
    /// Why it does not count as caught.
    Missed(String),
}

/// A test program, and the folder of its package.
struct Program {
    executable: PathBuf,
    folder: PathBuf,
}

/// What one test did.
#[derive(Debug, PartialEq, Eq)]
enum Verdict {
    Passed,
    /// Panic in test code, with its first line.
    Failed(String),
    /// Panic elsewhere, or no result.
    Broke(String),
}

impl Trial {
    /// Of a workspace's copy.
    pub fn new(root: &Path, checkout: &Path) -> Self {
        let beside = root.parent().map(|p| p.join("shared/data")).filter(|p| p.is_dir());
        Self {
            checkout: checkout.into(),
            target: root.join("target/mutants/build"),
            data: std::env::var_os("SINEW_DATA").or_else(|| beside.map(Into::into)),
        }
    }

    /// The first of the tests that does not pass without a bug.
    pub fn failing(&self, tests: &BTreeSet<&Test>) -> Result<Option<String>, String> {
        for ((package, target), names) in by_target(tests.iter().copied()) {
            let program = self.build(package, target)?;
            for (name, verdict) in names.iter().zip(self.test(&program, &names)?) {
                if verdict != Verdict::Passed {
                    return Ok(Some(format!("{package} {target} {name}: {verdict:?}")));
                }
            }
        }
        Ok(None)
    }

    /// Plants a bug, runs its tests and takes it back.
    pub fn with_bug(&self, bug: &Bug) -> Result<Outcome, String> {
        let path = self.checkout.join(&bug.file);
        let place = |e: std::io::Error| format!("{}: {e}", path.display());
        let code = fs::read_to_string(&path).map_err(place)?;
        let changed = match applied(bug, &code) {
            Ok(changed) => changed,
            Err(what) => return Ok(Outcome::Missed(what)),
        };
        fs::write(&path, changed).map_err(place)?;
        let outcome = self.judge(bug);
        fs::write(&path, code).map_err(place)?;
        outcome
    }

    fn judge(&self, bug: &Bug) -> Result<Outcome, String> {
        let mut caught = Vec::new();
        for ((package, target), names) in by_target(&bug.caught_by) {
            let program = match self.build(package, target) {
                Ok(program) => program,
                Err(what) => return Ok(Outcome::Missed(format!("does not build: {what}"))),
            };
            for (name, verdict) in names.iter().zip(self.test(&program, &names)?) {
                match verdict {
                    Verdict::Failed(said) => caught.push((format!("{package} {target} `{name}`"), said)),
                    Verdict::Passed => return Ok(Outcome::Missed(format!("{package} {target} {name} passes"))),
                    Verdict::Broke(how) => return Ok(Outcome::Missed(format!("{package} {target} {name}: {how}"))),
                }
            }
        }
        Ok(Outcome::Caught(caught))
    }

    /// Builds a test program.
    fn build(&self, package: &str, target: &str) -> Result<Program, String> {
        let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        cargo.args(["test", "--quiet", "--no-run", "--message-format=json-render-diagnostics", "--package", package]);
        cargo.args(selected(target)).current_dir(&self.checkout).env("CARGO_TARGET_DIR", &self.target);
        let output = cargo.output().map_err(|e| format!("cargo: {e}"))?;
        let program = |line: &str| -> Option<Program> {
            let message: Value = serde_json::from_str(line).ok()?;
            let executable = message["executable"].as_str().filter(|_| message["profile"]["test"] == true)?.into();
            Some(Program { executable, folder: Path::new(message["manifest_path"].as_str()?).parent()?.into() })
        };
        match String::from_utf8_lossy(&output.stdout).lines().find_map(program) {
            Some(program) if output.status.success() => Ok(program),
            _ => {
                let said = String::from_utf8_lossy(&output.stderr);
                Err(said.lines().find(|line| line.starts_with("error")).unwrap_or("no reason given").into())
            }
        }
    }

    fn test(&self, program: &Program, names: &[&str]) -> Result<Vec<Verdict>, String> {
        let path = self.target.join("said.txt");
        let place = |e: std::io::Error| format!("{}: {e}", path.display());
        let mut run = Command::new(&program.executable);
        run.args(["--exact", "--show-output"]).args(names).current_dir(&program.folder);
        run.env("CARGO_MANIFEST_DIR", &program.folder)
            .env("RUST_BACKTRACE", "0")
            .env("PROPTEST_RNG_SEED", "1")
            .env("PROPTEST_MAX_SHRINK_ITERS", "0");
        if let Some(data) = &self.data {
            run.env("SINEW_DATA", data);
        }
        run.stdin(Stdio::null()).stdout(fs::File::create(&path).map_err(place)?).stderr(Stdio::null());
        let mut run = run.spawn().map_err(|e| format!("{}: {e}", program.executable.display()))?;
        let started = Instant::now();
        while run.try_wait().map_err(place)?.is_none() {
            if started.elapsed() > PATIENCE {
                run.kill().and_then(|()| run.wait()).map_err(place)?;
                break;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        let said = fs::read(&path).map_err(place)?;
        let said = String::from_utf8_lossy(&said);
        let read = |path: &str| fs::read_to_string(self.checkout.join(path)).ok();
        Ok(names.iter().map(|name| verdict(&said, name, &read)).collect())
    }
}

fn selected(target: &str) -> Vec<&str> {
    if target == "lib" { vec!["--lib"] } else { vec!["--test", target] }
}

fn by_target<'a>(tests: impl IntoIterator<Item = &'a Test>) -> BTreeMap<(&'a str, &'a str), Vec<&'a str>> {
    let mut groups = BTreeMap::<_, Vec<_>>::new();
    for Test { package, target, test } in tests {
        groups.entry((package.as_str(), target.as_str())).or_default().push(test.as_str());
    }
    groups
}

/// What the output of a test program says of one test; `read` gives a source file's text.
fn verdict(said: &str, name: &str, read: &dyn Fn(&str) -> Option<String>) -> Verdict {
    let result = said.lines().find_map(|line| line.strip_prefix(&format!("test {name} ... ")));
    match result {
        Some(result) if result.starts_with("ok") && said.contains("skipped: no data") => {
            Verdict::Broke("skipped: no data".into())
        }
        Some(result) if result.starts_with("ok") => Verdict::Passed,
        Some(result) if result.starts_with("FAILED") => panic_of(said, name, read),
        _ => Verdict::Broke("gave no result".into()),
    }
}

/// Where a failed test panicked, and what it said.
fn panic_of(said: &str, name: &str, read: &dyn Fn(&str) -> Option<String>) -> Verdict {
    let section = said.split_once(&format!("---- {name} stdout ----")).map_or("", |(_, after)| after);
    let mut lines =
        section.lines().skip_while(|line| !line.contains("' panicked at ") && !line.contains(") panicked at "));
    let Some((_, place)) = lines.next().and_then(|line| line.rsplit_once(" panicked at ")) else {
        return Verdict::Broke("failed without a panic".into());
    };
    let mut parts = place.trim_end_matches(':').rsplitn(3, ':');
    let (_column, line, path) = (parts.next(), parts.next(), parts.next().unwrap_or(""));
    let line: usize = line.and_then(|l| l.parse().ok()).unwrap_or(0);
    let message = lines.next().unwrap_or("").trim().to_owned();
    // A snapshot that differs panics in the library of snapshots.
    let is_test = path.contains("tests/")
        || path.contains("/insta-")
        || read(path).is_some_and(|code| code.lines().take(line).any(|l| l.trim() == "#[cfg(test)]"));
    if is_test { Verdict::Failed(message) } else { Verdict::Broke(format!("panics in {path}, line {line}: {message}")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAID: &str = "running 5 tests
test a ... ok
test b ... FAILED
test tests::c ... FAILED
test d ... FAILED
test f ... FAILED

failures:

---- b stdout ----

thread 'b' (7) panicked at crates/x/tests/y.rs:9:5:
z = 7, bound 4.5

---- tests::c stdout ----

thread 'tests::c' panicked at crates/x/src/c.rs:3:5:
assertion failed: false

---- d stdout ----

thread 'd' panicked at crates/x/src/c.rs:1:5:
attempt to subtract with overflow

---- f stdout ----

thread 'f' panicked at /registry/insta-1.49.0/src/runtime.rs:7:9:
snapshot assertion for 'f' failed
";

    #[test]
    fn only_a_panic_in_test_code_counts() {
        let read =
            |path: &str| (path == "crates/x/src/c.rs").then(|| "fn f() {}\n#[cfg(test)]\nmod tests {}".to_owned());
        let of = |name: &str| verdict(SAID, name, &read);
        assert_eq!(of("a"), Verdict::Passed);
        assert_eq!(of("b"), Verdict::Failed("z = 7, bound 4.5".into()));
        assert_eq!(of("tests::c"), Verdict::Failed("assertion failed: false".into()));
        assert!(matches!(of("d"), Verdict::Broke(how) if how.contains("overflow")));
        assert_eq!(of("f"), Verdict::Failed("snapshot assertion for 'f' failed".into()));
        assert_eq!(of("e"), Verdict::Broke("gave no result".into()));
        let skipped = verdict("test a ... ok\n---- a stdout ----\nskipped: no data\n", "a", &read);
        assert_eq!(skipped, Verdict::Broke("skipped: no data".into()));
    }
}
