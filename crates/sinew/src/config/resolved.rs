//! Every setting with its value, found by asking the sources in the order of their strength.

use super::common::{
    INIT, KEYPOINTS, LAG_FRAMES, LATENT, MOTION_MODEL, OUT, PERSON, SETUP, SILHOUETTES, SMOOTH, STATIC, SUBJECT,
};
use super::file;
use super::setting::{AnySetting as _, Origin, Setting, SettingType, SettingValues, Typed, Value};
use super::table::{self, METHOD, is_local};
use super::value::{from_text, to_json, to_toml};
use crate::Error;
use crate::methods::{About, LatentUse};
use sinew_formats::nearest::nearest;
use sinew_input::Problems;
use sinew_input::flag::typed;
use sinew_input::recording::given::GivenRecording;
use sinew_input::recording::read_frames::ReadFrames;
use sinew_setup::KnownSetup;
use sinew_setup::shared_cameras::SharedCameras;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Settings by name, as they are typed.
pub type Given = Vec<(&'static str, String)>;

/// What the program was started with.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// Settings on the command line, as typed.
    pub flags: Given,
    /// Environment variables.
    pub environment: Vec<(String, String)>,
    /// `--config`.
    pub file: Option<PathBuf>,
}

/// Every setting that has a value.
#[derive(Clone, Debug, Default)]
pub struct Resolved {
    pub(super) values: SettingValues,
    /// Cameras and keypoints in memory, in place of the ones that settings name.
    pub given: Option<Arc<GivenRecording>>,
    /// What the passes of a run have read of keypoints.
    pub read_before: Arc<ReadFrames>,
    /// What the file of the setting `setup` holds, where it was read before.
    pub known_setup: Option<Arc<KnownSetup>>,
    /// Cameras that other recordings share, beside what the frames of this one say of them.
    pub shared_cameras: Option<Arc<SharedCameras>>,
    /// Variables that look like settings and are none.
    pub warnings: Vec<String>,
}

/// Variables of ours that are no settings.
const OTHER_VARIABLES: [&str; 3] = ["SINEW_DATA", "SINEW_REQUIRE_DATA", "SINEW_PYTHON"];

/// Settings from all their sources: given by name, then `SINEW_…` of the environment, then files.
///
/// # Errors
/// As [`resolve`].
pub fn settings(given: &[(&'static str, String)], file: Option<&Path>) -> Result<Resolved, Error> {
    let text = |(name, value): (OsString, OsString)| Some((name.into_string().ok()?, value.into_string().ok()?));
    let mut environment: Vec<(String, String)> = std::env::vars_os().filter_map(text).collect();
    environment.retain(|(name, _)| name.starts_with("SINEW_"));
    environment.sort();
    resolve(&Sources { flags: given.to_vec(), environment, file: file.map(PathBuf::from) })
}

/// Finds every setting.
///
/// # Errors
/// [`sinew_input::Error::Config`] with all problems of a source, and a file that cannot be read.
pub fn resolve(sources: &Sources) -> Result<Resolved, Error> {
    let here = Path::new("");
    let mut resolved = Resolved::default();
    let flags = sources.flags.iter().filter_map(|(key, text)| Some((table::find(key)?, text)));
    let problems = flags.filter_map(|(setting, text)| resolved.take(setting, text, Origin::Flag).err());
    refuse("the command line", problems.collect())?;
    let mut problems = Vec::new();
    for (name, text) in &sources.environment {
        let Some(key) = name.strip_prefix("SINEW_").map(str::to_lowercase) else { continue };
        match table::find(&key) {
            Some(setting) => {
                let problem = resolved.take(setting, text, Origin::Environment).err();
                problems.extend(problem.map(|problem| format!("{name}: {problem}")));
            }
            None if OTHER_VARIABLES.contains(&name.as_str()) => {}
            None => {
                let meant = nearest(&key, table::settings().iter().map(|setting| setting.key));
                let meant =
                    meant.map(|key| format!("; did you mean `SINEW_{}`?", key.to_uppercase())).unwrap_or_default();
                resolved.warnings.push(format!("the environment variable `{name}` is no setting{meant}"));
            }
        }
    }
    refuse("the environment", problems)?;

    let mut folder = resolved.trial_folder().unwrap_or_else(|| here.to_owned());
    let mut search = true;
    if let Some(path) = &sources.file {
        let file = file::read(path)?;
        let parent = path.parent().unwrap_or(here);
        let parent = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
        folder = normal(&std::path::absolute(parent).map_err(Error::io("read", parent))?.join(".."));
        search = !file.is_root;
        resolved.add(file);
    }
    if search {
        for file in file::search(&folder)? {
            resolved.add(file);
        }
    }
    for setting in table::settings() {
        if let Some(default) = &setting.default {
            resolved.values.by_key.entry(setting.key).or_insert_with(|| (default.clone(), Origin::Default));
        }
    }
    resolved.check()?;
    Ok(resolved)
}

fn refuse(source: &str, problems: Vec<String>) -> Result<(), Error> {
    if problems.is_empty() { Ok(()) } else { Err(Problems { file: source.into(), problems }.into()) }
}

/// The path without `..`, by its text.
fn normal(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            std::path::Component::ParentDir if out.file_name().is_some() => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}

impl Resolved {
    /// A value as it is typed, where no stronger source gave one.
    fn take(&mut self, setting: &Setting, text: &str, origin: Origin) -> Result<(), String> {
        let value = from_text(setting, text, Path::new(""))?;
        self.values.by_key.entry(setting.key).or_insert((value, origin));
        Ok(())
    }

    /// Value of a setting.
    #[must_use]
    pub fn of<T: SettingType>(&self, setting: &Typed<T>) -> T {
        self.values.of(setting)
    }

    /// The method that was chosen.
    #[must_use]
    pub fn method(&self) -> &'static About {
        self.of(&METHOD)
    }

    fn check(&self) -> Result<(), Error> {
        let (smooth, lagged) = (self.of(&SMOOTH), self.of(&LAG_FRAMES) > 0);
        let back = if smooth { Some(SMOOTH.key) } else { lagged.then_some(LAG_FRAMES.key) };
        let learned = self.of(&MOTION_MODEL).is_some();
        let in_latent = self.method().latent != LatentUse::No && self.of(&LATENT).is_some();
        let clash = match back {
            Some(_) if smooth && lagged => {
                Some("`lag_frames` sees some frames ahead, `smooth` all; leave one of them out".to_owned())
            }
            Some(name) if learned => {
                Some(format!("`{name}` goes back over a random walk; leave it or `motion_model` out"))
            }
            Some(name) if in_latent => {
                Some(format!("`{name}` goes back over a random walk of poses; leave it or `latent` out"))
            }
            None if in_latent && learned => {
                let why = "`motion_model` moves poses, and a latent model has a motion of its own";
                Some(format!("{why}; leave it or `latent` out"))
            }
            _ => None,
        };
        let problem = (self.method().mistake)(&self.values).or(clash);
        refuse("the configuration", problem.into_iter().collect())
    }

    fn add(&mut self, file: file::ConfigFile) {
        for (key, value) in file.values {
            self.values.by_key.entry(key).or_insert_with(|| (value, Origin::File(file.path.clone())));
        }
    }

    /// The folder that holds the keypoint folder, or that of the masks.
    pub(super) fn trial_folder(&self) -> Option<PathBuf> {
        let input = self.of(&KEYPOINTS).or_else(|| self.of(&SILHOUETTES))?;
        normal(&std::path::absolute(input).ok()?).parent().map(Path::to_owned)
    }

    /// Settings with their origins, one line each, as TOML with comments.
    #[must_use]
    pub fn describe(&self) -> String {
        let mut lines: Vec<(String, String)> = Vec::new();
        for setting in table::settings() {
            lines.push(match self.values.by_key.get(setting.key) {
                Some((value, origin)) => (format!("{} = {}", setting.key, to_toml(value)), origin.describe()),
                None => (format!("# {}", setting.key), format!("not set: {}", setting.help)),
            });
        }
        let width = lines.iter().map(|(left, _)| left.chars().count()).filter(|&n| n <= 44).max().unwrap_or_default();
        lines.iter().fold(String::new(), |mut out, (left, right)| {
            let _ = writeln!(out, "{left:width$}  # {right}");
            out
        })
    }

    /// A configuration that repeats the run; threads and places for output are left out.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let again = typed("config");
        let mut out =
            format!("# Settings in force. Repeat the run with: sinew track {again} config.toml\nroot = true\n");
        for setting in table::settings().iter().filter(|setting| !is_local(setting.key)) {
            let value = match self.get(setting.key) {
                Some(Value::Path(path)) => {
                    Value::Path(normal(&std::path::absolute(path).unwrap_or_else(|_| path.clone())))
                }
                Some(other) => other.clone(),
                None => continue,
            };
            let _ = writeln!(out, "{} = {}", setting.key, to_toml(&value));
        }
        out
    }

    /// Settings with origins, as JSON; threads and paths are left out, and a file is named without its folder: the same run is described in the same words wherever
    /// it happens.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        let of = |setting: &Setting| {
            let (value, origin) = self.values.by_key.get(setting.key)?;
            let origin = match origin {
                Origin::File(path) => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
                other => other.describe(),
            };
            let is_reported = !is_local(setting.key) && !matches!(value, Value::Path(_));
            is_reported
                .then(|| (setting.key.to_owned(), serde_json::json!({ "value": to_json(value), "origin": origin })))
        };
        table::settings().iter().filter_map(of).collect::<serde_json::Map<_, _>>().into()
    }

    /// Files that settings name, by setting.
    #[must_use]
    pub fn files(&self) -> BTreeMap<&'static str, PathBuf> {
        let file = |(key, (value, _)): (&&'static str, &(Value, Origin))| match value {
            Value::Path(path) if path.is_file() => Some((*key, path.clone())),
            // Its summary knows what it was made from.
            Value::Path(path) if *key == STATIC.key => Some((*key, path.join("summary.json"))),
            _ => None,
        };
        self.values.by_key.iter().filter_map(file).collect()
    }

    /// Settings that change numbers, as they stand in a file; files that settings name are distinguished by their content ([`Resolved::files`]).
    #[must_use]
    pub fn numeric_settings(&self) -> BTreeMap<String, String> {
        self.numeric().map(|(key, value)| (key.to_owned(), value)).collect()
    }

    fn numeric(&self) -> impl Iterator<Item = (&'static str, String)> + '_ {
        table::settings().iter().filter(|setting| setting.hashed).filter_map(|setting| match self.get(setting.key)? {
            Value::Path(_) => None,
            value => Some((setting.key, to_toml(value))),
        })
    }

    /// Settings of [`Resolved::to_json`] that change numbers, here or in another run's summary, in the words of JSON.
    #[must_use]
    pub fn numeric_settings_in(settings: &serde_json::Value) -> BTreeMap<String, String> {
        let value = |setting: &&Setting| settings[setting.key].get("value").map(ToString::to_string);
        let of = |setting: &Setting| Some((setting.key.to_owned(), value(&setting)?));
        table::settings().iter().filter(|setting| setting.hashed).filter_map(of).collect()
    }

    /// Hash of the settings that change numbers: FNV-1a, 64 bits, over `key = value` lines in the order of [`table::settings`].
    #[must_use]
    pub fn hash(&self) -> String {
        let lines = self.numeric().map(|(key, value)| format!("{key} = {value}\n"));
        let hash = lines.fold(crate::files::FNV_START, |hash, line| crate::files::fnv(hash, line.as_bytes()));
        format!("{hash:016x}")
    }

    /// Whether a setting has a value that somebody gave.
    #[must_use]
    pub fn is_given(&self, key: &str) -> bool {
        self.values.by_key.get(key).is_some_and(|(_, origin)| *origin != Origin::Default)
    }

    /// The same with another default of a setting.
    #[must_use]
    pub fn with_default<T: SettingType>(mut self, setting: &Typed<T>, value: T) -> Self {
        if !self.is_given(setting.key) {
            self.values.set(setting, value, Origin::Default);
        }
        self
    }

    /// The same with a setting as though it had been typed.
    ///
    /// # Errors
    /// As [`resolve`] for a flag.
    pub fn with_flag<T: SettingType>(mut self, setting: &Typed<T>, text: &str) -> Result<Self, Error> {
        self.values.by_key.remove(setting.key);
        let problem = self.take(&setting.row(), text, Origin::Flag).err();
        refuse("the command line", problem.into_iter().collect()).map(|()| self)
    }

    /// The same with a setting as though nobody had given it.
    #[must_use]
    pub fn without<T: SettingType>(mut self, setting: &Typed<T>) -> Self {
        self.values.by_key.remove(setting.key);
        self
    }

    /// The same run into another folder.
    #[must_use]
    pub fn into_folder(&self, folder: &Path) -> Self {
        let mut other = self.clone();
        other.values.set(&OUT, Some(folder.to_owned()), Origin::Flag);
        other
    }

    /// The run of one of several people, by their number, into a folder of their own.
    #[must_use]
    pub fn for_person(&self, number: usize, folder: &Path) -> Self {
        let mut other = self.into_folder(folder);
        other.values.set(&PERSON, Some(number), Origin::Flag);
        other
    }

    /// The setting, if any, whose value is of one person: a set-up, a standing trial, masks, a start or a name.
    #[must_use]
    pub fn single_person_setting(&self) -> Option<&'static str> {
        let of_one = [SETUP.key, SILHOUETTES.key, INIT.key, STATIC.key, SUBJECT.key];
        of_one.into_iter().find(|key| self.get(key).is_some())
    }

    /// Value of a setting by its name, as sources give it.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.values.by_key.get(key).map(|(value, _)| value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn sources(flags: &[(&'static str, &str)], environment: &[(&str, &str)]) -> Sources {
        Sources {
            flags: flags.iter().map(|(key, text)| (*key, (*text).to_owned())).collect(),
            environment: environment.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect(),
            file: None,
        }
    }

    #[test]
    fn the_stronger_source_wins() {
        let root = tempfile::tempdir().unwrap();
        let trial = root.path().join("study/trial");
        fs::create_dir_all(trial.join("pose")).unwrap();
        fs::write(root.path().join("sinew.toml"), "chains = 99\nroot = true\n").unwrap();
        fs::write(root.path().join("study/sinew.toml"), "root = true\nseed = 2\ndraws = 3\nfps = 50\njitter = 0.5\n")
            .unwrap();
        fs::write(trial.join("sinew.toml"), "seed = 4\ndraws = 5\nfps = 60.0\n").unwrap();
        let pose = trial.join("pose").display().to_string();
        let resolved =
            resolve(&sources(&[("keypoints", &pose), ("seed", "8")], &[("SINEW_SEED", "6"), ("SINEW_DRAWS", "7")]))
                .unwrap();
        let (config, settings) = (resolved.track(), resolved.settings().unwrap());
        assert_eq!((settings.seed, settings.draws, config.fps), (8, 7, Some(60.0)));
        let hmc = format!("{:?}", settings.method);
        assert!(hmc.contains("chains: 16") && hmc.contains("jitter: 0.5"), "{hmc}");
        assert_eq!(config.out, Path::new("sinew-out/trial"));
        assert_eq!(resolved.values.by_key["seed"].1, Origin::Flag);
        assert_eq!(resolved.values.by_key["draws"].1, Origin::Environment);
        assert_eq!(resolved.values.by_key["fps"].1, Origin::File(trial.join("sinew.toml")));
        assert_eq!(resolved.values.by_key["chains"].1, Origin::Default);
        assert!(resolved.describe().contains("# environment"));
    }

    #[test]
    fn a_written_configuration_repeats_the_run() {
        let root = tempfile::tempdir().unwrap();
        let first =
            resolve(&sources(&[("keypoints", "a/b/pose"), ("frames", "3..9"), ("threads", "2"), ("out", "x")], &[]))
                .unwrap();
        let path = root.path().join("config.toml");
        fs::write(&path, first.to_toml()).unwrap();
        let second = resolve(&Sources { file: Some(path), ..sources(&[("out", "y")], &[]) }).unwrap();
        assert_eq!(second.hash(), first.hash());
        assert_eq!(second.to_toml(), first.to_toml());
        assert_eq!(second.track().threads, None);
    }

    #[test]
    fn threads_and_paths_do_not_change_the_hash() {
        let hash = |flags: &[(&'static str, &str)]| resolve(&sources(flags, &[])).unwrap().hash();
        assert_eq!(
            hash(&[("threads", "2"), ("keypoints", "/a"), ("out", "b"), ("body", "c.toml")]),
            hash(&[("threads", "1"), ("body", "d.toml")])
        );
        assert_ne!(hash(&[("seed", "2")]), hash(&[]));
    }

    #[test]
    fn strange_variables_are_warned_of() {
        let resolved = resolve(&sources(&[], &[("SINEW_SED", "2"), ("SINEW_DATA", "/x"), ("PATH", "")])).unwrap();
        assert_eq!(
            resolved.warnings,
            ["the environment variable `SINEW_SED` is no setting; did you mean `SINEW_SEED`?"]
        );
    }
}
