//! The plan of a study: one task a trial, with a hash of what its results depend on.
//!
//! Of text files the hash is over their content; of images, masks and films over names, sizes and times of change, since reading them all takes as long as tracking. Results and studies among the inputs do not count.

use super::submit::SUBMIT_NAMES;
use super::trials::{self, FoundTrial, TASKS, is_output};
use crate::Error;
use serde::{Deserialize, Serialize};
use sinew::config::common::{ANY_SIZE, BODY, CAMERAS, CONFIDENCE_SCALE, FPS, IMAGE_SCALE, LAYOUT, SEED, UP, UP_AXIS};
use sinew::config::{Resolved, TrackConfig};
use sinew::files::{FNV_START, fnv, open, read_bytes, read_text};
use sinew_input::folder_contents::is_video;
use sinew_results::{place, write_whole};
use std::collections::{BTreeMap, HashSet};
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::UNIX_EPOCH;

/// File of a study with what holds for all its trials.
const PLAN: &str = "plan.json";

/// Most bytes of a list of tasks.
const MAX_BYTES: u64 = 1 << 32;

/// What a study is about.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyPlan {
    /// Version of the program that made it.
    pub sinew_version: String,
    /// Folder of the trials.
    pub root: PathBuf,
    /// Whether results are packed into one archive a shard.
    pub packed: bool,
    /// What trials share.
    #[serde(default)]
    pub share: Share,
    /// How many trials there are: `tasks.jsonl` has a line for each. [`write()`] counts them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trials: Option<usize>,
}

/// What trials share.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Share {
    /// Trials of a session (one calibration) the cameras, and trials of a subject in it a set-up.
    Session,
    /// Trials of a subject in a session a set-up.
    #[default]
    Subject,
    /// Nothing: each trial has a set-up of its own.
    Nothing,
}

impl Share {
    /// The words for it.
    pub const NAMES: [&str; 3] = ["session", "subject", "nothing"];
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "session" => Ok(Self::Session),
            "subject" => Ok(Self::Subject),
            "nothing" => Ok(Self::Nothing),
            _ => Err(format!("must be one of {}", Self::NAMES.join(", "))),
        }
    }
}

/// A trial to be tracked.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// Name of the trial.
    pub trial: String,
    /// Whether it has a file of settings of its own.
    pub has_file: bool,
    /// Hash of inputs and settings.
    pub hash: String,
    /// Who is tracked, if that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subject: Option<String>,
    /// Trials with the same word share cameras, and are of one session.
    pub session: String,
    /// Trials with the same word share one set-up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pool: Option<String>,
    /// Why it cannot be run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
}

impl Task {
    /// The trial.
    #[must_use]
    pub fn as_trial(&self) -> FoundTrial {
        FoundTrial { name: self.trial.clone(), has_file: self.has_file }
    }
}

/// Makes the plan of the trials below a folder.
///
/// # Errors
/// [`Error::NoTrials`]; folders that cannot be read.
pub fn plan(root: &Path, share: Share) -> Result<Vec<Task>, Error> {
    let root = std::path::absolute(root).map_err(sinew::Error::io("read", root))?;
    let found = trials::find(&root)?;
    if found.is_empty() {
        return Err(Error::NoTrials(root));
    }
    let mut tasks: Vec<Task> = found.iter().map(|trial| task(trial, &root)).collect();
    refuse_among_people(&mut tasks);
    if share == Share::Nothing {
        tasks.iter_mut().for_each(|task| task.pool = None);
    }
    // A set-up that is shared depends on all who share it, or its cameras.
    let sharing = |task: &Task| match share {
        Share::Session => task.session.clone(),
        Share::Subject | Share::Nothing => task.pool.clone().unwrap_or_default(),
    };
    let mut hashes: BTreeMap<String, u64> = BTreeMap::new();
    for task in tasks.iter().filter(|task| task.pool.is_some()) {
        let hash = hashes.entry(sharing(task)).or_insert(FNV_START);
        *hash = fnv(*hash, task.hash.as_bytes());
    }
    for task in &mut tasks {
        let hash = hashes.get(&sharing(task));
        if let (Some(pool), Some(hash)) = (&mut task.pool, hash) {
            task.hash = format!("{:016x}", fnv(*hash, task.hash.as_bytes()));
            *pool = format!("{pool}-{hash:016x}");
        }
    }
    Ok(tasks)
}

/// A trial in a folder `people` of another one would have its results where those of people of the other are written.
fn refuse_among_people(tasks: &mut [Task]) {
    let names: HashSet<String> = tasks.iter().map(|task| task.trial.clone()).collect();
    for task in tasks {
        let mut above = task.trial.match_indices("/people/").map(|(end, _)| &task.trial[..end]);
        let Some(other) = above.find(|above| names.contains(*above)) else { continue };
        task.problem =
            Some(format!("its results would lie among those of people in `{other}`; rename the folder `people`"));
    }
}

fn task(trial: &FoundTrial, root: &Path) -> Task {
    let unknown = Task {
        trial: trial.name.clone(),
        has_file: trial.has_file,
        hash: String::new(),
        subject: None,
        session: String::new(),
        pool: None,
        problem: None,
    };
    let known = trial.settings(root, &[]).and_then(|resolved| {
        let config = resolved.track();
        let calibration = sinew::run::calibration(&config)?;
        Ok((input_hash(&resolved, &config)?, hash_of(FNV_START, &calibration)?, resolved, config))
    });
    match known {
        Ok((hash, calibration, resolved, config)) => {
            let session = format!("{calibration:016x}");
            let pool = config.subject.as_ref().and_then(|subject| pool(subject, &session, &resolved, &config));
            Task { hash: format!("{hash:016x}"), subject: config.subject, session, pool, ..unknown }
        }
        Err(error) => Task { problem: Some(sinew::with_causes(&error)), ..unknown },
    }
}

/// Who shares a set-up: trials of one subject in one session with the same body, layout and cameras, which make their own set-ups otherwise.
fn pool(subject: &str, session: &str, resolved: &Resolved, config: &TrackConfig) -> Option<String> {
    if config.setup.is_some() || config.keypoints.is_none() || config.silhouettes.is_some() {
        return None;
    }
    let of_person = [BODY.key, LAYOUT.key, CAMERAS.key, FPS.key, UP.key, UP_AXIS.key];
    let same = of_person.into_iter().chain([IMAGE_SCALE.key, CONFIDENCE_SCALE.key, SEED.key, ANY_SIZE.key]);
    let same = same.map(|key| resolved.get(key).map(sinew::config::value::to_toml).unwrap_or_default());
    let hash = same.fold(fnv(FNV_START, session.as_bytes()), |hash, value| fnv(fnv(hash, value.as_bytes()), b"\n"));
    let name: String = subject.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect();
    Some(format!("{name}-{:08x}", (hash ^ fnv(FNV_START, subject.as_bytes())) & 0xffff_ffff))
}

/// Hash of everything that results depend on.
fn input_hash(resolved: &Resolved, config: &TrackConfig) -> Result<u64, Error> {
    let mut hash = fnv(FNV_START, resolved.hash().as_bytes());
    let inputs = [&config.calibration, &config.keypoints, &config.silhouettes, &config.images];
    for path in inputs.into_iter().flatten() {
        hash = hash_of(hash, path)?;
    }
    for (key, path) in resolved.files() {
        hash = hash_of(fnv(hash, key.as_bytes()), &path)?;
    }
    Ok(hash)
}

/// Extensions of files that are not read for the hash.
const IMAGES: [&str; 5] = ["png", "jpg", "jpeg", "bmp", "tif"];

/// Larger files than this may be films.
const LARGE_BYTES: u64 = 16 << 20;

/// Folds a file, or a folder with all in it, into a hash.
fn hash_of(hash: u64, path: &Path) -> Result<u64, Error> {
    folded(hash, path, &mut HashSet::new())
}

/// As [`hash_of`], but for folders that were `seen`: links may lead to them again.
fn folded(hash: u64, path: &Path, seen: &mut HashSet<PathBuf>) -> Result<u64, Error> {
    let failed = |error| sinew::Error::io("read", path)(error);
    let found = fs::metadata(path).map_err(failed)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let hash = fnv(fnv(hash, name.as_bytes()), &[0]);
    if found.is_dir() {
        // What is given may be results: those of a standing trial.
        if (!seen.is_empty() && is_output(path)) || !seen.insert(path.canonicalize().map_err(failed)?) {
            return Ok(hash);
        }
        let mut entries: Vec<PathBuf> =
            fs::read_dir(path).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect()).map_err(failed)?;
        entries.sort();
        return entries.iter().try_fold(hash, |hash, entry| folded(hash, entry, seen));
    }
    let is_image =
        path.extension().is_some_and(|extension| IMAGES.iter().any(|image| extension.eq_ignore_ascii_case(image)));
    if is_image || (found.len() > LARGE_BYTES && is_video(path)) {
        let changed = found.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok()).unwrap_or_default();
        return Ok(fnv(fnv(hash, &found.len().to_le_bytes()), &changed.as_nanos().to_le_bytes()));
    }
    let (mut file, mut hash, mut piece) = (open(path).map_err(failed)?, hash, vec![0; 1 << 16]);
    loop {
        match file.read(&mut piece).map_err(failed)? {
            0 => return Ok(hash),
            read => hash = fnv(hash, &piece[..read]),
        }
    }
}

/// Files of a study that a plan writes.
pub const PLAN_NAMES: [&str; 5] = [PLAN, TASKS, SUBMIT_NAMES[0], SUBMIT_NAMES[1], SUBMIT_NAMES[2]];

/// Writes a plan into the folder of a study.
///
/// # Errors
/// Errors of the disk.
pub fn write(study: &Path, plan: &StudyPlan, tasks: &[Task]) -> Result<(), Error> {
    fs::create_dir_all(study).map_err(sinew::Error::io("create", study))?;
    let lines: String = tasks.iter().map(|task| serde_json::to_string(task).unwrap_or_default() + "\n").collect();
    write_whole(&place(study, TASKS)?, lines.as_bytes())?;
    let counted = StudyPlan { trials: Some(tasks.len()), ..plan.clone() };
    let text = serde_json::to_string_pretty(&counted).unwrap_or_default() + "\n";
    Ok(write_whole(&place(study, PLAN)?, text.as_bytes())?)
}

/// The plan of a study, and its tasks.
///
/// # Errors
/// [`Error::NotAStudy`], [`Error::StudyFile`].
pub fn read(study: &Path) -> Result<(StudyPlan, Vec<Task>), Error> {
    let (plan, tasks) = (study.join(PLAN), study.join(TASKS));
    if !plan.is_file() || !tasks.is_file() {
        return Err(Error::NotAStudy(study.to_owned()));
    }
    let damaged = |path: &Path, line: usize, problem: String| Error::StudyFile { path: path.to_owned(), line, problem };
    let wrong = |path: &Path, line: usize, error: serde_json::Error| damaged(path, line, error.to_string());
    let text = read_text(&plan, MAX_BYTES)?;
    let known: StudyPlan = serde_json::from_str(&text).map_err(|error| wrong(&plan, error.line(), error))?;
    // Bytes, since a file that was cut may end inside a letter.
    let bytes = read_bytes(&tasks, MAX_BYTES)?;
    let lines = (1..).zip(bytes.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()));
    let all = lines.map(|(line, text)| serde_json::from_slice(text).map_err(|error| wrong(&tasks, line, error)));
    let all: Vec<Task> = all.collect::<Result<_, _>>()?;
    match known.trials {
        Some(due) if due != all.len() => {
            let problem = format!("the file has {} trials; the plan was made of {due}", all.len());
            Err(damaged(&tasks, all.len(), problem))
        }
        _ => Ok((known, all)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write_file(root: &Path, name: &str, text: &str) {
        let path = root.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    fn study() -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        let at = root.path();
        write_file(at, "sinew.toml", "root = true\ncalibration = \"Calib.toml\"\nfps = 60\n");
        write_file(at, "Calib.toml", "cameras");
        for trial in ["S1/a", "S1/b", "S2/a"] {
            write_file(at, &format!("{trial}/pose/c1_json/c1_0.json"), trial);
        }
        write_file(at, "S1/sinew.toml", "subject = \"S1\"\n");
        root
    }

    #[test]
    fn a_hash_changes_with_settings_and_inputs_of_the_trial_and_of_who_shares_its_set_up() {
        let root = study();
        let hashes =
            || plan(root.path(), Share::Session).unwrap().into_iter().map(|task| task.hash).collect::<Vec<_>>();
        let before = hashes();
        assert_eq!(before, hashes());
        let changed = || hashes().iter().zip(&before).map(|(a, b)| a != b).collect::<Vec<_>>();
        write_file(root.path(), "S2/a/pose/c1_json/c1_0.json", "other");
        assert_eq!(changed(), [false, false, true]);
        write_file(root.path(), "S1/b/pose/c1_json/c1_0.json", "other");
        assert_eq!(changed(), [true, true, true]);
        write_file(root.path(), "S1/b/pose/c1_json/c1_0.json", "S1/b");
        write_file(root.path(), "S2/a/pose/c1_json/c1_0.json", "S2/a");
        assert_eq!(changed(), [false; 3]);
        write_file(root.path(), "sinew.toml", "root = true\ncalibration = \"Calib.toml\"\nfps = 50\n");
        assert_eq!(changed(), [true; 3]);
    }

    #[test]
    fn trials_of_a_subject_share_a_set_up() {
        let root = study();
        let tasks = plan(root.path(), Share::Session).unwrap();
        assert!(tasks[0].pool.is_some() && tasks[0].pool == tasks[1].pool && tasks[2].pool.is_none());
        assert!(tasks.iter().all(|task| task.session == tasks[0].session && task.problem.is_none()));
    }

    #[test]
    fn subjects_of_a_session_share_cameras_if_they_are_to() {
        let root = study();
        write_file(root.path(), "S2/sinew.toml", "subject = \"S2\"\n");
        let before = |share| plan(root.path(), share).unwrap();
        let [session, subject, nothing] = [Share::Session, Share::Subject, Share::Nothing].map(before);
        assert!(nothing.iter().all(|task| task.pool.is_none()));
        assert!(session.iter().chain(&subject).all(|task| task.pool.is_some()));
        write_file(root.path(), "S2/a/pose/c1_json/c1_0.json", "other");
        let changed = |before: &[Task], share| {
            let now = plan(root.path(), share).unwrap();
            now.iter().zip(before).map(|(now, before)| now.hash != before.hash).collect::<Vec<_>>()
        };
        assert_eq!(changed(&session, Share::Session), [true; 3]);
        assert_eq!(changed(&subject, Share::Subject), [false, false, true]);
        assert_eq!(changed(&nothing, Share::Nothing), [false, false, true]);
    }

    #[test]
    fn a_trial_that_cannot_be_run_has_a_task_that_says_why() {
        let root = study();
        write_file(root.path(), "S2/a/sinew.toml", "paticles = 3\nkeypoints = \"pose\"");
        let tasks = plan(root.path(), Share::Session).unwrap();
        assert!(tasks[2].problem.as_ref().unwrap().contains("paticles"), "{:?}", tasks[2]);
        write_file(root.path(), "S2/a/sinew.toml", "calibration = \"none.toml\"\nkeypoints = \"pose\"");
        let tasks = plan(root.path(), Share::Session).unwrap();
        assert!(tasks[2].problem.as_ref().unwrap().contains("none.toml"), "{:?}", tasks[2]);
        assert!(tasks[0].problem.is_none());
    }

    #[test]
    fn films_and_studies_among_the_inputs_are_not_read() {
        let root = study();
        let before = plan(root.path(), Share::Nothing).unwrap();
        let film = root.path().join("S1/a/pose/cam1.mp4");
        fs::File::create(&film).unwrap().set_len(3 << 30).unwrap();
        let with_film = plan(root.path(), Share::Nothing).unwrap();
        assert!(with_film[0].hash != before[0].hash && with_film[1..] == before[1..]);
        fs::remove_file(film).unwrap();
        write_file(root.path(), "S1/a/pose/study/tasks.jsonl", "");
        let linked = plan(root.path(), Share::Nothing).unwrap();
        write_file(root.path(), "S1/a/pose/study/ended/0-of-1.jsonl", "more");
        assert_eq!(plan(root.path(), Share::Nothing).unwrap(), linked);
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_rings_of_links_among_the_inputs_end_in_words() {
        let root = study();
        let pose = root.path().join("S1/a/pose");
        for ring in ["to_all", "to_all_again"] {
            std::os::unix::fs::symlink(root.path(), pose.join(ring)).unwrap();
        }
        assert!(plan(root.path(), Share::Nothing).unwrap()[0].problem.is_none());
        assert!(std::process::Command::new("mkfifo").arg(pose.join("pipe.json")).status().unwrap().success());
        let tasks = plan(root.path(), Share::Nothing).unwrap();
        assert!(tasks[0].problem.as_ref().unwrap().contains("pipe.json"), "{:?}", tasks[0]);
    }

    #[test]
    fn trials_among_the_people_of_another_are_refused() {
        let root = study();
        for trial in ["S1/a/people/x", "people/b"] {
            write_file(root.path(), &format!("{trial}/pose/c1_json/c1_0.json"), trial);
        }
        let tasks = plan(root.path(), Share::Nothing).unwrap();
        let refused: Vec<&str> =
            tasks.iter().filter(|task| task.problem.is_some()).map(|task| task.trial.as_str()).collect();
        assert_eq!(refused, ["S1/a/people/x"]);
        assert!(tasks[1].problem.as_ref().unwrap().contains("of people in `S1/a`"), "{:?}", tasks[1]);
    }

    #[test]
    fn plans_are_read_back() {
        let root = study();
        let tasks = plan(root.path(), Share::Session).unwrap();
        let folder = root.path().join("study");
        let (sinew_version, root_of_trials) = ("0".into(), root.path().into());
        let trials = Some(tasks.len());
        let known = StudyPlan { sinew_version, root: root_of_trials, packed: false, share: Share::Subject, trials };
        write(&folder, &StudyPlan { trials: None, ..known.clone() }, &tasks).unwrap();
        assert_eq!(read(&folder).unwrap(), (known, tasks));
        assert!(matches!(read(root.path()), Err(Error::NotAStudy(_))));
        // Cut behind each byte: every cut is noticed, by its line, also inside a letter and behind a line.
        let whole = fs::read_to_string(folder.join(TASKS)).unwrap().replace("S1/a", "S\u{e4}/a");
        let is_whole = |end: usize| whole.len() - end <= 1;
        for end in (0..whole.len()).filter(|end| !is_whole(*end)) {
            fs::write(folder.join(TASKS), &whole.as_bytes()[..end]).unwrap();
            assert!(matches!(read(&folder), Err(Error::StudyFile { .. })), "{end}");
        }
        fs::write(folder.join(TASKS), "{}\n").unwrap();
        assert!(read(&folder).unwrap_err().to_string().contains("line 1"));
    }
}
