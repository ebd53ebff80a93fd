//! Builds the tests of the copy once, and runs those of one package with one mutant on.

use super::switches::VARIABLE;
use serde_json::Value;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A test program.
pub struct Program {
    /// Name of its package.
    pub package: String,
    /// Name of its target.
    pub target: String,
    executable: PathBuf,
    folder: PathBuf,
}

/// A line that does not compile, and why.
pub struct Fault {
    /// Path from the root of the copy.
    pub file: String,
    /// Line from 1.
    pub line: usize,
    /// What the compiler said.
    pub said: String,
}

/// What a program said with a mutant.
pub enum Answer {
    /// All tests pass.
    Passed,
    /// A test fails, the first by its name; or the program ends before its tests do.
    Failed(String),
    /// It did not end in time.
    Late,
}

/// Where copies are built, and the recordings that they do not lie beside.
pub struct Place<'a> {
    /// Root of the copy.
    pub checkout: &'a Path,
    /// Build folder.
    pub target: &'a Path,
    /// Folder of recordings.
    pub data: Option<OsString>,
}

fn messages(place: &Place<'_>, arguments: &[&str]) -> Result<Vec<Value>, String> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(arguments).args(["--workspace", "--message-format=json"]).stderr(Stdio::null());
    cargo.current_dir(place.checkout).env("CARGO_TARGET_DIR", place.target);
    let output = cargo.output().map_err(|e| format!("cargo: {e}"))?;
    Ok(String::from_utf8_lossy(&output.stdout).lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

/// What does not compile; crates above one that does not are not reached.
pub fn faults(place: &Place<'_>) -> Result<Vec<Fault>, String> {
    let fault = |message: &Value| -> Option<Fault> {
        let message = message.get("message").filter(|message| message["level"] == "error")?;
        let mut span = message["spans"].as_array()?.iter().find(|span| span["is_primary"] == true)?;
        // What a macro of others made stands where it was called.
        while !span["file_name"].as_str()?.starts_with("crates/") {
            span = span.get("expansion")?.get("span")?;
        }
        let line = usize::try_from(span["line_start"].as_u64()?).ok()?;
        Some(Fault { file: span["file_name"].as_str()?.into(), line, said: message["message"].as_str()?.into() })
    };
    Ok(messages(place, &["check", "--keep-going"])?.iter().filter_map(fault).collect())
}

/// Every test program.
pub fn build(place: &Place<'_>) -> Result<Vec<Program>, String> {
    let program = |message: &Value| -> Option<Program> {
        let executable = message["executable"].as_str().filter(|_| message["profile"]["test"] == true)?.into();
        let folder: PathBuf = Path::new(message["manifest_path"].as_str()?).parent()?.into();
        let package = match folder.file_name()?.to_str()? {
            "tests" => "sinew-tests".to_owned(),
            name => name.to_owned(),
        };
        Some(Program { package, target: message["target"]["name"].as_str()?.into(), executable, folder })
    };
    let messages = messages(place, &["test", "--tests", "--no-run"])?;
    match messages.iter().any(|message| message["reason"] == "build-finished" && message["success"] == true) {
        true => Ok(messages.iter().filter_map(program).collect()),
        false => Err("the tests of the copy do not build".into()),
    }
}

impl Program {
    /// Runs its tests whose names contain one of the `names` (all, if there are none), with the mutant of that number.
    pub fn answer(
        &self,
        place: &Place<'_>,
        names: &[&str],
        mutant: usize,
        patience: Duration,
    ) -> Result<Answer, String> {
        let path = place.target.join("said.txt");
        let failed = |e: std::io::Error| format!("{}: {e}", path.display());
        let mut run = Command::new(&self.executable);
        run.args(names).current_dir(&self.folder).stdin(Stdio::null()).stderr(Stdio::null());
        run.stdout(fs::File::create(&path).map_err(failed)?);
        run.env(VARIABLE, mutant.to_string())
            .env("CARGO_MANIFEST_DIR", &self.folder)
            .env("INSTA_FORCE_PASS", "1")
            .env("INSTA_UPDATE", "no")
            .env("INSTA_WORKSPACE_ROOT", place.checkout)
            .env("RUST_BACKTRACE", "0")
            .env("PROPTEST_RNG_SEED", "1")
            .env("PROPTEST_MAX_SHRINK_ITERS", "0");
        if let Some(data) = &place.data {
            run.env("SINEW_DATA", data);
        }
        let mut run = run.spawn().map_err(|e| format!("{}: {e}", self.executable.display()))?;
        let started = Instant::now();
        let status = loop {
            match run.try_wait().map_err(failed)? {
                Some(status) => break status,
                None if started.elapsed() > patience => {
                    run.kill().and_then(|()| run.wait()).map_err(failed)?;
                    return Ok(Answer::Late);
                }
                None => std::thread::sleep(Duration::from_millis(10)),
            }
        };
        if status.success() {
            return Ok(Answer::Passed);
        }
        let said = fs::read(&path).map_err(failed)?;
        let failed = |line: &str| Some(line.strip_prefix("test ")?.strip_suffix(" ... FAILED")?.to_owned());
        let first = String::from_utf8_lossy(&said).lines().find_map(failed);
        Ok(Answer::Failed(first.unwrap_or_else(|| "ends before its tests do".into())))
    }
}

/// Longest time that a program may take with a mutant: of one that ends, it is no test of what it computes.
pub fn patience(alone: Duration) -> Duration {
    Duration::from_secs(20) + 5 * alone
}
