//! The program `sinew`, run as a user runs it.

use crate::support::outcome::Outcome;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The program, and the folder that it works in.
pub(crate) struct Program {
    pub(crate) path: PathBuf,
    pub(crate) folder: PathBuf,
}

/// Exit codes of a run that has written its results: done, and done with diagnostics that failed.
const WRITTEN: [i32; 2] = [0, 4];

/// The program, built for release.
pub(crate) fn built(root: &Path) -> Outcome<PathBuf> {
    let status = Command::new("cargo").args(["build", "--release", "-p", "sinew-cli"]).current_dir(root).status()?;
    if !status.success() {
        return Err("the program does not build".into());
    }
    Ok(root.join("target/release/sinew"))
}

pub(crate) fn shown(path: &Path) -> String {
    path.display().to_string()
}

/// Writes a recording: its calibration, and files of keypoints in a folder of that name.
pub(crate) fn write_recording(
    folder: &Path,
    calibration: &str,
    keypoints: &str,
    files: impl IntoIterator<Item = (String, String)>,
) -> Outcome<()> {
    for (name, text) in files {
        let path = folder.join(keypoints).join(name);
        std::fs::create_dir_all(path.parent().unwrap_or(folder))?;
        std::fs::write(path, text)?;
    }
    Ok(std::fs::write(folder.join("Calib.toml"), calibration)?)
}

impl Program {
    /// Runs a command, and gives its answer; another exit code is an error.
    pub(crate) fn run(&self, flags: &[String], codes: &[i32]) -> Outcome<String> {
        let output = Command::new(&self.path).args(flags).output()?;
        if output.status.code().is_some_and(|code| codes.contains(&code)) {
            return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
        }
        let said = String::from_utf8_lossy(&output.stderr);
        Err(format!("sinew {}: {:?}\n{said}", flags.join(" "), output.status.code()).into())
    }

    /// Tracks one person into a folder, unless `--people` is among the flags. Diagnostics that fail are no error here: the tables say how good the results are.
    pub(crate) fn track(&self, flags: &[String], out: &Path) -> Outcome<()> {
        let one = ["--people", "1"].map(str::to_owned);
        let who = if flags.contains(&one[0]) { &[][..] } else { &one[..] };
        let all = [&["track".to_owned()], flags, who, &["-o".to_owned(), shown(out)]].concat();
        self.run(&all, &WRITTEN)?;
        if out.join("summary.json").is_file() { Ok(()) } else { Err(format!("nothing in {}", shown(out)).into()) }
    }
}
