//! Settings of a run, from the strongest source that names them.
//!
//! flag > environment (`SINEW_SEED`) > `sinew.toml` of the trial > those of the folders above, up to one with `root = true` > default.
//!
//! The *trial* is the folder that holds the keypoint folder; without keypoints it is the current folder. `--config FILE` takes the place of the trial's file. Every value
//! knows its [`Origin`]. [`Resolved::to_toml`] repeats a run wherever it is started: paths in it are absolute, and it is its own root.

pub mod file;
pub mod setting;
mod track;
pub mod value;

pub use crate::track::Method;
pub use track::{Init, TrackConfig};

use crate::Error;
use setting::{SETTINGS, is_local};
use sinew_formats::nearest::nearest;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use value::{Value, from_text, to_json, to_toml};

/// Where a value comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Command line.
    Flag,
    /// Environment variable.
    Environment,
    /// A file.
    File(PathBuf),
    /// Nobody gave one.
    Default,
}

impl Origin {
    /// In words.
    #[must_use]
    pub fn describe(&self) -> String {
        match self {
            Self::Flag => "flag".into(),
            Self::Environment => "environment".into(),
            Self::File(path) => path.display().to_string(),
            Self::Default => "default".into(),
        }
    }
}

/// What the program was started with.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// Settings on the command line, as typed.
    pub flags: Vec<(&'static str, String)>,
    /// Environment variables.
    pub environment: Vec<(String, String)>,
    /// `--config`.
    pub file: Option<PathBuf>,
}

/// Every setting that has a value.
#[derive(Clone, Debug, Default)]
pub struct Resolved {
    values: BTreeMap<&'static str, (Value, Origin)>,
    /// Variables that look like settings and are none.
    pub warnings: Vec<String>,
}

/// Variables of ours that are no settings.
const OTHER_VARIABLES: [&str; 1] = ["SINEW_DATA"];

/// Finds every setting.
///
/// # Errors
/// [`Error::Config`] with all problems of a source, [`Error::Io`] for a file that cannot be read.
pub fn resolve(sources: &Sources) -> Result<Resolved, Error> {
    let here = Path::new("");
    let mut resolved = Resolved::default();
    let mut problems = Vec::new();
    for (key, text) in &sources.flags {
        resolved.take(key, text, Origin::Flag, &mut problems);
    }
    refuse("the command line", problems)?;
    let mut problems = Vec::new();
    for (name, text) in &sources.environment {
        let Some(key) = name.strip_prefix("SINEW_").map(str::to_lowercase) else { continue };
        match setting::find(&key) {
            Some(setting) => {
                let mut of_variable = Vec::new();
                resolved.take(setting.key, text, Origin::Environment, &mut of_variable);
                problems.extend(of_variable.into_iter().map(|problem| format!("{name}: {problem}")));
            }
            None if OTHER_VARIABLES.contains(&name.as_str()) => {}
            None => {
                let meant = nearest(&key, SETTINGS.iter().map(|setting| setting.key));
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
    for setting in SETTINGS.iter().filter(|setting| !setting.default.is_empty()) {
        let value = from_text(setting, setting.default, here);
        let value = value.map_err(|problem| Error::Config { file: "the defaults".into(), problems: vec![problem] })?;
        resolved.values.entry(setting.key).or_insert((value, Origin::Default));
    }
    resolved.check()?;
    Ok(resolved)
}

fn refuse(source: &str, problems: Vec<String>) -> Result<(), Error> {
    if problems.is_empty() { Ok(()) } else { Err(Error::Config { file: source.into(), problems }) }
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
    fn take(&mut self, key: &'static str, text: &str, origin: Origin, problems: &mut Vec<String>) {
        let Some(setting) = setting::find(key) else { return };
        match from_text(setting, text, Path::new("")) {
            Ok(value) => {
                self.values.entry(key).or_insert((value, origin));
            }
            Err(problem) => problems.push(problem),
        }
    }

    /// What no setting alone can tell.
    fn check(&self) -> Result<(), Error> {
        if self.text("method").as_deref() != Some("hmc") {
            return Ok(());
        }
        let (burn_in, updates) = (self.count("burn_in").unwrap_or_default(), self.count("updates").unwrap_or(1));
        if burn_in < updates {
            return Ok(());
        }
        let problem = format!("`burn_in` is {burn_in}; it must be less than `updates`, which is {updates}");
        Err(Error::Config { file: "the configuration".into(), problems: vec![problem] })
    }

    /// Warnings about flags that change nothing beside the other settings.
    #[must_use]
    pub fn idle_flags(&self) -> Vec<String> {
        let is = |key: &str, value: &str| self.text(key).as_deref() == Some(value);
        let idle = |key: &str| match key {
            "particles" | "min_ess" if is("method", "hmc") => Some("`--method hmc`".to_owned()),
            "chains" | "updates" | "burn_in" | "jitter" | "max_r_hat" | "max_r_hat_share" | "max_divergent_share"
                if !is("method", "hmc") =>
            {
                Some(format!("`--method {}`", self.text("method").unwrap_or_default()))
            }
            "layers" | "survival" | "adaptive" | "crossover" if !is("method", "annealed") => {
                Some("a method other than `annealed`".to_owned())
            }
            "fine" if !is("method", "coarse-to-fine") => Some("a method other than `coarse-to-fine`".to_owned()),
            "images" | "mask_scale" | "score" | "kappa" | "raster" if !self.values.contains_key("silhouettes") => {
                Some("no `--silhouettes`".to_owned())
            }
            "degrees" if is("noise", "floor") => Some("`--noise floor`".to_owned()),
            "outlier" if is("noise", "student-t") => Some("`--noise student-t`".to_owned()),
            "setup_frames" | "person" if self.values.contains_key("setup") => Some("`--setup`".to_owned()),
            _ => None,
        };
        let given = self.values.iter().filter(|(_, (_, origin))| *origin == Origin::Flag);
        given
            .filter_map(|(key, _)| Some(format!("`--{}` changes nothing with {}", key.replace('_', "-"), idle(key)?)))
            .collect()
    }

    fn add(&mut self, file: file::ConfigFile) {
        for (key, value) in file.values {
            self.values.entry(key).or_insert_with(|| (value, Origin::File(file.path.clone())));
        }
    }

    /// Value of a setting.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.values.get(key).map(|(value, _)| value)
    }

    fn path(&self, key: &str) -> Option<PathBuf> {
        match self.get(key) {
            Some(Value::Path(path)) => Some(path.clone()),
            _ => None,
        }
    }

    fn text(&self, key: &str) -> Option<String> {
        match self.get(key) {
            Some(Value::Text(text)) => Some(text.clone()),
            Some(Value::Path(path)) => Some(path.to_string_lossy().into_owned()),
            _ => None,
        }
    }

    fn count(&self, key: &str) -> Option<u64> {
        match self.get(key) {
            Some(Value::Count(count)) => Some(*count),
            _ => None,
        }
    }

    fn size(&self, key: &str) -> usize {
        usize::try_from(self.count(key).unwrap_or_default()).unwrap_or(usize::MAX)
    }

    fn number(&self, key: &str) -> Option<f64> {
        match self.get(key) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        }
    }

    fn flag(&self, key: &str) -> bool {
        self.get(key) == Some(&Value::Flag(true))
    }

    fn frames(&self, key: &str) -> Option<Range<u64>> {
        match self.get(key) {
            Some(Value::Frames(frames)) => Some(frames.clone()),
            _ => None,
        }
    }

    /// The folder that holds the keypoint folder, or that of the masks.
    fn trial_folder(&self) -> Option<PathBuf> {
        let input = self.path("keypoints").or_else(|| self.path("silhouettes"))?;
        normal(&std::path::absolute(input).ok()?).parent().map(Path::to_owned)
    }

    /// Settings with their origins, one line each, as TOML with comments.
    #[must_use]
    pub fn describe(&self) -> String {
        let mut lines: Vec<(String, String)> = Vec::new();
        for setting in &SETTINGS {
            lines.push(match self.values.get(setting.key) {
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
        let mut out =
            String::from("# Settings in force. Repeat the run with: sinew track --config config.toml\nroot = true\n");
        for (key, value) in self.repeated() {
            let _ = writeln!(out, "{key} = {}", to_toml(&value));
        }
        out
    }

    fn repeated(&self) -> impl Iterator<Item = (&'static str, Value)> + '_ {
        let kept = SETTINGS.iter().filter(|setting| !is_local(setting.key));
        kept.filter_map(|setting| {
            let value = match self.get(setting.key)? {
                Value::Path(path) => Value::Path(normal(&std::path::absolute(path).unwrap_or_else(|_| path.clone()))),
                other => other.clone(),
            };
            Some((setting.key, value))
        })
    }

    /// Settings with origins, as JSON; threads and paths are left out, and a file is named without its folder: the same run is told in the same words wherever
    /// it happens.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        let of = |setting: &setting::Setting| {
            let (value, origin) = self.values.get(setting.key)?;
            let origin = match origin {
                Origin::File(path) => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
                other => other.describe(),
            };
            let told = !is_local(setting.key) && !matches!(value, Value::Path(_));
            told.then(|| (setting.key.to_owned(), serde_json::json!({ "value": to_json(value), "origin": origin })))
        };
        SETTINGS.iter().filter_map(of).collect::<serde_json::Map<_, _>>().into()
    }

    /// Files that settings name, by setting.
    #[must_use]
    pub fn files(&self) -> BTreeMap<&'static str, PathBuf> {
        let file = |(key, (value, _)): (&&'static str, &(Value, Origin))| match value {
            Value::Path(path) if path.is_file() => Some((*key, path.clone())),
            _ => None,
        };
        self.values.iter().filter_map(file).collect()
    }

    /// Settings that change numbers, as they stand in a file; files that settings name are told apart by their content ([`Resolved::files`]).
    #[must_use]
    pub fn of_numbers(&self) -> BTreeMap<String, String> {
        let of = |setting: &setting::Setting| match self.get(setting.key)? {
            Value::Path(_) => None,
            value => Some((setting.key.to_owned(), to_toml(value))),
        };
        SETTINGS.iter().filter(|setting| setting.hashed).filter_map(of).collect()
    }

    /// Those of [`Resolved::to_json`] that change numbers, here or in another run's summary, in the words of JSON.
    #[must_use]
    pub fn of_numbers_told(settings: &serde_json::Value) -> BTreeMap<String, String> {
        let told = |setting: &&setting::Setting| settings[setting.key].get("value").map(ToString::to_string);
        let of = |setting: &setting::Setting| Some((setting.key.to_owned(), told(&setting)?));
        SETTINGS.iter().filter(|setting| setting.hashed).filter_map(of).collect()
    }

    /// Hash of the settings that change numbers: FNV-1a, 64 bits, over `key = value` lines in the order of [`SETTINGS`].
    #[must_use]
    pub fn hash(&self) -> String {
        let values = self.of_numbers();
        let lines = SETTINGS.iter().filter_map(|setting| {
            let value = values.get(setting.key)?;
            Some(format!("{} = {value}\n", setting.key))
        });
        let hash = lines.fold(crate::files::FNV_START, |hash, line| crate::files::fnv(hash, line.as_bytes()));
        format!("{hash:016x}")
    }

    /// Whether a setting has a value that somebody gave.
    #[must_use]
    pub fn is_given(&self, key: &str) -> bool {
        self.values.get(key).is_some_and(|(_, origin)| *origin != Origin::Default)
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
        let config = resolved.track();
        assert_eq!((config.seed, config.draws, config.fps, config.jitter, config.chains), (8, 7, Some(60.0), 0.5, 16));
        assert_eq!(config.out, Path::new("sinew-out/trial"));
        assert_eq!(resolved.values["seed"].1, Origin::Flag);
        assert_eq!(resolved.values["draws"].1, Origin::Environment);
        assert_eq!(resolved.values["fps"].1, Origin::File(trial.join("sinew.toml")));
        assert_eq!(resolved.values["chains"].1, Origin::Default);
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
