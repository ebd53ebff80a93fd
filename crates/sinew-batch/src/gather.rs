//! One table and one page over all trials of a study, and statistics by group.

use super::angle_draws::{ANGLE_DRAWS, read_angle_draws};
use super::group_statistics::{Groups, to_csv};
use super::ledger::{EndedTask, TaskEnd, ended, results_folder};
use super::packed::{inside, unpacked};
use super::page::page;
use super::plan::{Task, read};
use super::trial_table::{Gathered, TrialState, row, table};
use crate::Error;
use serde_json::Value;
use sinew::files::read_text;
use sinew::formats::json_text;
use sinew::formats::source_text::{MAX_TEXT_BYTES, decode};
use sinew_results::{Disk, Occupied, Storage, add_own, is_own, place, write_whole};
use std::fs;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

/// By what trials are put into groups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GroupBy {
    /// The folder that holds the trial.
    #[default]
    Folder,
    /// The name of the trial's own folder: the same exercise of many people.
    Name,
    /// The person.
    Subject,
    /// All together.
    All,
}

impl GroupBy {
    /// The words for it.
    pub const NAMES: [&str; 4] = ["folder", "name", "subject", "all"];

    /// The group of a task.
    fn of(self, task: &Task) -> String {
        let (above, own) = task.trial.rsplit_once('/').unwrap_or(("", &task.trial));
        match self {
            Self::Folder => above.to_owned(),
            Self::Name => own.to_owned(),
            Self::Subject => task.subject.clone().unwrap_or_default(),
            Self::All => "all".to_owned(),
        }
    }
}

impl FromStr for GroupBy {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let all = [Self::Folder, Self::Name, Self::Subject, Self::All];
        let found = Self::NAMES.iter().zip(all).find(|(name, _)| **name == text);
        found.map(|(_, by)| by).ok_or_else(|| format!("expected one of {}", Self::NAMES.join(", ")))
    }
}

/// Files that it writes.
const NAMES: [&str; 3] = ["summary.csv", "groups.csv", "report.html"];

/// Gathers a study; files of others are replaced only if `force` says so.
///
/// # Errors
/// A study or results of it that cannot be read; files of others in the way; errors of the disk.
pub fn gather(study: &Path, by: GroupBy, force: bool) -> Result<Gathered, Error> {
    let is_in_the_way = |name: &&str| !force && study.join(name).exists() && !is_own(study, name);
    if let Some(name) = NAMES.into_iter().find(is_in_the_way) {
        let (path, found) = (study.join(name), Occupied::File);
        return Err(sinew_results::Error::OutputExists { path, found }.into());
    }
    let (plan, tasks) = read(study)?;
    let known = ended(study)?;
    let (mut rows, mut groups, mut gathered) = (vec![], Groups::default(), Gathered::default());
    for task in &tasks {
        let line = known.get(&task.trial).filter(|line| line.hash == task.hash);
        let found = line.filter(|line| line.is_there() && line.is_kept(study)).map(|line| results(study, line));
        let found = found.unwrap_or(Ok(vec![]));
        let damage = found.as_ref().err().map(|error| sinew::with_causes(error));
        let found = found.unwrap_or_default();
        let (state, why) = state_of(line, !found.is_empty(), damage);
        gathered.counts[state as usize] += 1;
        if found.is_empty() {
            gathered.lacking.push((task.trial.clone(), why.clone()));
            rows.push(row(task, "", state, &why, &Value::Null));
        }
        for (person, summary, angles) in found {
            rows.push(row(task, &person, state, &why, &summary));
            groups.add(&by.of(task), read_angle_draws(&angles));
        }
    }
    let statistics = groups.statistics();
    let texts = [table(&rows), to_csv(&statistics), page(&plan, &gathered, &rows, &statistics)];
    add_own(&(Arc::new(Disk) as Arc<dyn Storage>), study, &NAMES)?;
    for (name, text) in NAMES.iter().zip(texts) {
        write_whole(&place(study, name)?, text.as_bytes())?;
    }
    Ok(gathered)
}

fn state_of(line: Option<&EndedTask>, has_results: bool, damage: Option<String>) -> (TrialState, String) {
    match line {
        Some(line) if line.is_there() && !has_results => {
            // A run sees summaries and archives that are gone or cut, and not what else is wrong.
            let why = match (damage, &line.packed) {
                (None, _) => "its results are gone or damaged: run the study again".into(),
                (Some(why), Some(packed)) => {
                    format!("its results are damaged ({why}): remove {}, and run the study again", packed.archive)
                }
                (Some(why), None) => {
                    let folder = results_folder(Path::new(""), &line.trial);
                    format!("its results are damaged ({why}): remove {}, and run the study again", folder.display())
                }
            };
            (TrialState::Missing, why)
        }
        None => (TrialState::Missing, "not run yet, or not since inputs or settings changed".into()),
        Some(line) => {
            let state = match line.ended {
                TaskEnd::Done => TrialState::Done,
                TaskEnd::Doubtful => TrialState::Doubtful,
                TaskEnd::Failed => TrialState::Failed,
            };
            (state, line.why.clone())
        }
    }
}

/// Person, summary and angles of each result folder of a trial.
fn results(study: &Path, line: &EndedTask) -> Result<Vec<(String, Value, String)>, Error> {
    let mut files: Vec<(String, String)> = match &line.packed {
        Some(packed) => unpacked(study, packed, |name| name.ends_with("summary.json") || name.ends_with(ANGLE_DRAWS))?
            .into_iter()
            .map(|(name, bytes)| Ok((inside(&line.trial, &name).to_owned(), text_of(&name, &bytes)?)))
            .collect::<Result<_, Error>>()?,
        None => small_files(&results_folder(study, &line.trial))?,
    };
    files.sort();
    let text = |wanted: &str| files.iter().find(|(name, _)| name == wanted).map(|(_, text)| text.clone());
    let summaries: Vec<&(String, String)> = files.iter().filter(|(name, _)| name.ends_with("summary.json")).collect();
    let has_people = summaries.len() > 1;
    let found = summaries.into_iter().filter(|(name, _)| !has_people || name.contains('/')).map(|(name, summary)| {
        let folder = name.strip_suffix("summary.json").unwrap_or_default();
        let person = folder.trim_end_matches('/').rsplit('/').next().unwrap_or_default().to_owned();
        let summary: Value = json_text::parse(name, summary).map_err(sinew::Error::from)?;
        Ok((person, summary, text(&format!("{folder}{ANGLE_DRAWS}")).unwrap_or_default()))
    });
    found.collect()
}

/// Text of a file in an archive.
fn text_of(name: &str, bytes: &[u8]) -> Result<String, Error> {
    Ok(decode(name, bytes, MAX_TEXT_BYTES).map_err(sinew::Error::from)?.to_owned())
}

/// The summaries and angles in a result folder and in the folders of its people, by their path in it.
fn small_files(folder: &Path) -> Result<Vec<(String, String)>, Error> {
    let people = fs::read_dir(folder.join("people")).into_iter().flatten().flatten();
    let people = people.map(|entry| format!("people/{}/", entry.file_name().to_string_lossy()));
    let mut found = vec![];
    for below in std::iter::once(String::new()).chain(people) {
        for name in ["summary.json", ANGLE_DRAWS] {
            let path = folder.join(&below).join(name);
            if path.is_file() {
                let text = read_text(&path, MAX_TEXT_BYTES).map_err(sinew::Error::from)?;
                found.push((format!("{below}{name}"), text));
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(trial: &str, subject: Option<&str>) -> Task {
        let (session, hash) = (String::new(), String::new());
        Task {
            trial: trial.into(),
            has_file: true,
            hash,
            subject: subject.map(str::to_owned),
            session,
            pool: None,
            problem: None,
        }
    }

    #[test]
    fn trials_are_grouped() {
        let walk = task("S1/day2/walk", Some("anna"));
        let groups = GroupBy::NAMES.map(|name| name.parse::<GroupBy>().unwrap().of(&walk));
        assert_eq!(groups, ["S1/day2", "walk", "anna", "all"]);
        assert!("people".parse::<GroupBy>().is_err());
    }

    /// A trial whose angles are no text beside one whose summary was cut and one that is whole.
    #[test]
    fn damaged_results_are_missing_and_what_to_do_is_said() {
        use super::super::ledger::Ledger;
        use super::super::plan::{Share, StudyPlan, write};
        use super::super::shard::Shard;
        let study = tempfile::tempdir().unwrap();
        let at = study.path();
        let tasks = ["a", "b", "c"].map(|trial| Task { hash: "x".into(), ..task(trial, None) });
        let plan = StudyPlan {
            sinew_version: "0".into(),
            root: at.into(),
            packed: false,
            share: Share::Nothing,
            trials: None,
        };
        write(at, &plan, &tasks).unwrap();
        let line = |trial: &str| serde_json::json!({"trial": trial, "hash": "x", "ended": "done", "code": 0, "seconds": 1, "computing_s": 1, "run": 1, "at_unix_s": 0});
        let lines = ["a", "b", "c"].map(|trial| serde_json::from_value::<EndedTask>(line(trial)).unwrap());
        Ledger::open(at, Shard::WHOLE).unwrap().add(lines.iter()).unwrap();
        let write_file = |name: &str, bytes: &[u8]| {
            let path = at.join("results").join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        };
        for trial in ["a", "b", "c"] {
            write_file(&format!("{trial}/summary.json"), b"{\"frame_count\": 3}");
        }
        write_file("b/summary.json", b"{\"frame_count\": ");
        write_file("c/angle_draws.csv", b"name,draw\n\xc3");
        let gathered = gather(at, GroupBy::All, false).unwrap();
        assert_eq!(gathered.counts, [1, 0, 0, 2]);
        let [b, c] = gathered.lacking.as_slice() else { panic!("{gathered:?}") };
        assert_eq!(b.1, "its results are gone or damaged: run the study again");
        assert!(c.1.contains("is not UTF-8") && c.1.ends_with("remove results/c, and run the study again"), "{}", c.1);
    }

    /// A trial of two people: what its summary says of both is no third one.
    #[test]
    fn a_trial_of_several_people_has_a_row_for_each() {
        let study = tempfile::tempdir().unwrap();
        let line = serde_json::json!({"trial": "a", "hash": "x", "ended": "done", "code": 0, "seconds": 1, "computing_s": 1, "run": 1, "at_unix_s": 0});
        let line = serde_json::from_value::<EndedTask>(line).unwrap();
        let folder = results_folder(study.path(), "a");
        for below in ["", "people/01", "people/02"] {
            fs::create_dir_all(folder.join(below)).unwrap();
            fs::write(folder.join(below).join("summary.json"), "{}").unwrap();
        }
        let people = |found: Vec<(String, Value, String)>| found.into_iter().map(|(person, ..)| person);
        assert_eq!(people(results(study.path(), &line).unwrap()).collect::<Vec<_>>(), ["01", "02"]);
    }
}
