//! Trials below a folder: by their `sinew.toml`, or by the folder `pose` in which Pose2Sim keeps keypoints.
//!
//! A file of settings that names keypoints or silhouettes is that of a trial. Settings that it leaves out come from the folders above ([`sinew::config::file`]). A folder with keypoints in `pose` is a
//! trial without a file of its own.

use crate::Error;
use sinew::config::common::{self, KEYPOINTS, SILHOUETTES};
use sinew::config::file::{FILE_NAME, read};
use sinew::config::{Resolved, Sources, resolve};
use sinew::run::listener::Deaf;
use sinew::run::settings::with_stated_rate;
use std::collections::HashSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// File of a study with a line for each trial.
pub(super) const TASKS: &str = "tasks.jsonl";

/// Folder in which Pose2Sim keeps the keypoints of a trial.
const POSE: &str = "pose";

/// Folders in which Pose2Sim keeps the calibration of a session.
const CALIBRATION: [&str; 3] = ["calibration", "Calibration", "calib"];

/// A trial as it was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundTrial {
    /// Its folder, seen from the root, with `/` between the parts; `.` for the root itself.
    pub name: String,
    /// Whether it has a file of settings that names what is tracked.
    pub has_file: bool,
}

/// All trials, by name.
///
/// # Errors
/// A folder that cannot be read.
pub fn find(root: &Path) -> Result<Vec<FoundTrial>, Error> {
    let mut found = vec![];
    search(root, Path::new(""), &mut Searched::default(), &mut found)?;
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

/// Whether no trial lies in or below a folder of that name: inputs of trials, results, hidden folders.
fn is_passed_over(name: &str) -> bool {
    let is_input = name == POSE || name.starts_with("pose-") || name.ends_with("_json");
    is_input || name.starts_with('.') || matches!(name, "sinew-out" | "images" | "silhouettes" | "videos")
}

/// Whether a folder holds results or a study, and no trial.
pub(super) fn is_output(folder: &Path) -> bool {
    ["summary.json", TASKS].iter().any(|name| folder.join(name).is_file())
}

/// Folders that were searched, links resolved: each is searched once, however many links lead to it.
#[derive(Default)]
struct Searched {
    root: PathBuf,
    folders: HashSet<PathBuf>,
}

/// Adds the trials in and below a folder.
fn search(root: &Path, below: &Path, searched: &mut Searched, found: &mut Vec<FoundTrial>) -> Result<(), Error> {
    let folder = root.join(below);
    let failed = |error| sinew::Error::io("read", &folder)(error);
    let own = folder.canonicalize().map_err(failed)?;
    // A study may lie at the root of its trials.
    let is_root = searched.folders.is_empty();
    if !searched.folders.insert(own.clone()) || (!is_root && is_output(&folder)) {
        return Ok(());
    }
    if is_root {
        searched.root = own;
    }
    let mut folders: Vec<OsString> = vec![];
    for entry in fs::read_dir(&folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let kind = entry.file_type().map_err(failed)?;
        if kind.is_dir() || (kind.is_symlink() && leads_elsewhere(&entry.path(), &searched.root)) {
            folders.push(entry.file_name());
        }
    }
    folders.sort_unstable();
    let file = folder.join(FILE_NAME);
    // A file with mistakes may be that of a trial, which then says what they are.
    let names_input = file.is_file()
        && read(&file)
            .map_or(true, |file| [KEYPOINTS.key, SILHOUETTES.key].iter().any(|key| file.values.contains_key(key)));
    if names_input || holds_keypoints(&folder.join(POSE)) {
        found.push(FoundTrial { name: slashed(below), has_file: names_input });
    }
    for name in folders {
        if !is_passed_over(&name.to_string_lossy()) {
            search(root, &below.join(name), searched, found)?;
        }
    }
    Ok(())
}

/// Whether a link leads to a folder outside the root. Only such links are followed: links into the root would give trials twice.
fn leads_elsewhere(link: &Path, root: &Path) -> bool {
    link.canonicalize().is_ok_and(|target| target.is_dir() && !target.starts_with(root))
}

/// A path below the root with `/` between its parts.
fn slashed(below: &Path) -> String {
    let parts: Vec<_> = below.iter().map(|part| part.to_string_lossy()).collect();
    if parts.is_empty() { ".".into() } else { parts.join("/") }
}

/// Whether a folder holds keypoints of cameras.
fn holds_keypoints(folder: &Path) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.file_name()).any(|name| {
        let name = name.to_string_lossy();
        name.ends_with("_json") || name.ends_with(".json") || name.ends_with(".csv")
    })
}

impl FoundTrial {
    /// Its folder.
    #[must_use]
    pub fn folder(&self, root: &Path) -> PathBuf {
        if self.name == "." { root.to_owned() } else { root.join(&self.name) }
    }

    /// Its settings, from its own file and from those above, with `given` above all.
    ///
    /// # Errors
    /// Mistakes in the files.
    pub fn settings(&self, root: &Path, given: &[(&'static str, String)]) -> Result<Resolved, Error> {
        let folder = self.folder(root);
        let mut flags = given.to_vec();
        let file = self.has_file.then(|| folder.join(FILE_NAME));
        if !self.has_file {
            flags.push((KEYPOINTS.key, folder.join(POSE).to_string_lossy().into_owned()));
        }
        let resolved = resolve(&Sources { flags, environment: vec![], file })?;
        let resolved = with_stated_rate(resolved, &Deaf::default())?;
        let calibration = resolved.of(&common::CALIBRATION);
        match calibration.is_none().then(|| calibration_above(root, &folder)).flatten() {
            Some(found) => Ok(resolved.with_flag(&common::CALIBRATION, &found.to_string_lossy())?),
            None => Ok(resolved),
        }
    }
}

/// The calibration of a session as Pose2Sim keeps it: the one `.toml` in the nearest folder `calibration`, in the trial or above it.
fn calibration_above(root: &Path, folder: &Path) -> Option<PathBuf> {
    let above = folder.ancestors().take_while(|folder| folder.starts_with(root));
    above.flat_map(|folder| CALIBRATION.map(|name| folder.join(name))).find_map(|folder| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let mut files: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
        if files.len() == 1 { files.pop() } else { None }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(root: &Path, name: &str, text: &str) {
        let path = root.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    #[test]
    fn trials_inherit_settings_from_the_folders_above() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        write(root, "sinew.toml", "root = true\nfps = 60\ncalibration = \"Calib.toml\"\n");
        write(root, "S2/walk/sinew.toml", "keypoints = \"points\"\n");
        write(root, "S1/sinew.toml", "subject = \"S1\"\nfps = 50\n");
        write(root, "S1/run/sinew.toml", "keypoints = \"points\"\nfps = 100\n");
        write(root, "S1/jump/pose/cam1_json/cam1_0.json", "{}");
        write(root, "S1/jump/sinew-out/x/pose/c_json/c_0.json", "{}");
        write(root, "study/tasks.jsonl", "");
        write(root, "study/results/pose/c_json/c_0.json", "{}");
        let trials = find(root).unwrap();
        let names: Vec<&str> = trials.iter().map(|trial| trial.name.as_str()).collect();
        assert_eq!(names, ["S1/jump", "S1/run", "S2/walk"]);
        let settings = |index: usize| trials[index].settings(root, &[]).unwrap().track();
        assert_eq!([0, 1, 2].map(|index| settings(index).fps), [Some(50.0), Some(100.0), Some(60.0)]);
        assert_eq!(settings(0).calibration, Some(root.join("Calib.toml")));
        assert_eq!(settings(0).keypoints, Some(root.join("S1/jump/pose")));
        assert_eq!(settings(2).keypoints, Some(root.join("S2/walk/points")));
    }

    /// Links to what lies in the root would give trials twice, links to folders above would not end.
    #[cfg(unix)]
    #[test]
    fn links_lead_to_trials_elsewhere() {
        use std::os::unix::fs::symlink;
        let [root, elsewhere] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let (root, elsewhere) = (root.path(), elsewhere.path());
        write(elsewhere, "walk/pose/cam1_json/cam1_0.json", "{}");
        symlink(elsewhere, elsewhere.join("walk/again")).unwrap();
        write(root, "own/pose/cam1_json/cam1_0.json", "{}");
        symlink(root, root.join("own/above")).unwrap();
        symlink(root.join("own"), root.join("twice")).unwrap();
        symlink(elsewhere, root.join("disk")).unwrap();
        let names: Vec<String> = find(root).unwrap().into_iter().map(|trial| trial.name).collect();
        assert_eq!(names, ["disk/walk", "own"]);
    }

    /// Each of twelve folders leads to all: 12! ways through them.
    #[cfg(unix)]
    #[test]
    fn folders_that_link_to_each_other_are_searched_once() {
        use std::os::unix::fs::symlink;
        let [root, elsewhere] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let (root, elsewhere) = (root.path(), elsewhere.path());
        let folders: Vec<PathBuf> = (0..12).map(|k| elsewhere.join(format!("{k:02}"))).collect();
        for folder in &folders {
            write(folder, "pose/cam1_json/cam1_0.json", "{}");
            for (k, other) in folders.iter().enumerate() {
                symlink(other, folder.join(format!("to{k:02}"))).unwrap();
            }
        }
        symlink(&folders[0], root.join("first")).unwrap();
        symlink(&folders[0], root.join("again")).unwrap();
        let names: Vec<String> = find(root).unwrap().into_iter().map(|trial| trial.name).collect();
        assert_eq!((names.len(), names[0].as_str(), names[1].as_str()), (12, "again", "again/to01"));
    }

    #[test]
    fn a_study_may_lie_among_its_trials() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        write(root, "walk/pose/cam1_json/cam1_0.json", "{}");
        let names = || find(root).unwrap().into_iter().map(|trial| trial.name).collect::<Vec<_>>();
        for study in ["", "walk/study/"] {
            write(root, &format!("{study}tasks.jsonl"), "");
            write(root, &format!("{study}results/walk/pose/cam1_json/cam1_0.json"), "{}");
            write(root, &format!("{study}results/walk/summary.json"), "{}");
            assert_eq!(names(), ["walk"]);
        }
    }

    #[test]
    fn a_session_of_pose2sim_needs_no_settings() {
        let root = tempfile::tempdir().unwrap();
        let root = root.path();
        write(root, "session/Calibration/Calib_qualisys.toml", "");
        write(root, "session/P1/T1/pose/cam1_json/cam1_0.json", "{}");
        let trials = find(root).unwrap();
        assert_eq!(trials.len(), 1);
        let config = trials[0].settings(root, &[]).unwrap().track();
        assert_eq!(config.calibration, Some(root.join("session/Calibration/Calib_qualisys.toml")));
        write(root, "session/Calibration/other.toml", "");
        assert_eq!(trials[0].settings(root, &[]).unwrap().track().calibration, None);
    }
}
