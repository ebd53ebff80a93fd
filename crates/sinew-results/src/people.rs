//! `people.csv` and `summary.json` of a run that tracked several people: who was seen where, when, for how long.
//!
//! Results of a person lie in a folder of their own, `people/01`, `people/02`, …, in the order of coming.

use super::claim::Claim;
use super::own_files::{add_own, listed, refuse_others, remove_results};
use super::partial::write_whole;
use super::place::place;
use super::results_error::ResultsError;
use crate::Error;
use serde::Serialize;
use sinew_formats::tidy_csv::quoted;
use sinew_input::roll::PersonSeen;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Version of the layout of `summary.json`.
const SCHEMA_VERSION: u32 = 1;

/// Files of a run of several people, beside the folders of each.
pub const FILES: [&str; 2] = ["people.csv", "summary.json"];

/// One of several people, and what became of their run.
#[derive(Clone, Debug, Serialize)]
pub struct PersonTracked {
    /// Number, from 1 on in the order of coming.
    pub person: usize,
    /// Folder of their results, from the folder of the run.
    pub folder: String,
    /// First frame and the one after the last.
    pub frames: [u64; 2],
    /// Frames in which at least two cameras saw them.
    pub seen_frames: u64,
    /// Frames in which each camera saw them, in the order of the cameras.
    pub camera_frames: Vec<u64>,
    /// Whether all of them are tracked.
    pub complete: bool,
    /// Whether they are, and no diagnostic failed.
    pub trusted: bool,
    /// Why they are not, where it was not an interrupt.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
    /// Diagnostics that failed, in words.
    pub failed_diagnostics: Vec<String>,
}

/// What a run of several people came to.
#[derive(Clone, Debug, Serialize)]
pub struct PeopleSummary {
    /// Version of this layout.
    pub schema_version: u32,
    /// Whether everybody is tracked who could be.
    pub complete: bool,
    /// Version of the program.
    pub sinew_version: &'static str,
    /// Cameras.
    pub cameras: Vec<String>,
    /// Frames a second.
    pub fps: f64,
    /// Everybody.
    pub people: Vec<PersonTracked>,
}

/// Folder of a person's results, from the folder of the run.
#[must_use]
pub fn person_folder(index: usize) -> PathBuf {
    Path::new("people").join(format!("{:02}", index + 1))
}

/// Folders of the people of a run, in the order of coming.
pub fn person_folders(of_run: &Path) -> impl Iterator<Item = PathBuf> + '_ {
    (0..).map(|index| of_run.join(person_folder(index))).take_while(|folder| folder.is_dir())
}

impl PersonTracked {
    /// The cameras that saw them, in words.
    #[must_use]
    pub fn seen_by(&self, cameras: &[String]) -> String {
        let seen: Vec<&str> = cameras
            .iter()
            .zip(&self.camera_frames)
            .filter(|(_, frames)| **frames > 0)
            .map(|(name, _)| name.as_str())
            .collect();
        if seen.len() == cameras.len() { format!("all {}", seen.len()) } else { seen.join(" ") }
    }

    /// Why they are not tracked, or which diagnostics failed; empty where all is well.
    fn problem(&self) -> String {
        self.failed.clone().unwrap_or_else(|| self.failed_diagnostics.join("; "))
    }
}

/// Removes what runs of ours left of people from a number on, counted from 0, and folders in which nothing else is.
///
/// # Errors
/// A file that cannot be removed.
pub fn forget_people(of_run: &Path, from: usize) -> Result<(), Error> {
    let folders: Vec<PathBuf> = person_folders(of_run).skip(from).collect();
    for folder in folders {
        place(of_run, folder.strip_prefix(of_run).unwrap_or(&folder))?;
        remove_results(&folder)?;
    }
    // Somebody else may have something in it; then it stays.
    let _ = std::fs::remove_dir(of_run.join("people"));
    Ok(())
}

/// Whether a folder holds results of several people, whole or not.
#[must_use]
pub fn is_of_several(folder: &Path) -> bool {
    folder.join("people.csv").exists() && !folder.join("joints.csv").exists()
}

/// Refuses the results of several people where one person is needed.
///
/// # Errors
/// [`ResultsError::SeveralPeople`].
pub fn refuse_several(folder: &Path) -> Result<(), ResultsError> {
    if is_of_several(folder) { Err(ResultsError::SeveralPeople(folder.to_owned())) } else { Ok(()) }
}

impl PeopleSummary {
    /// Of people nobody of whom is tracked yet.
    #[must_use]
    pub fn begun(cameras: Vec<String>, fps: f64, people: &[PersonSeen]) -> Self {
        let person = |(index, seen): (usize, &PersonSeen)| PersonTracked {
            person: index + 1,
            folder: person_folder(index).display().to_string(),
            frames: [seen.frames.start, seen.frames.end],
            seen_frames: seen.seen,
            camera_frames: seen.by_camera.clone(),
            complete: false,
            trusted: false,
            failed: None,
            failed_diagnostics: vec![],
        };
        let people = people.iter().enumerate().map(person).collect();
        let sinew_version = env!("CARGO_PKG_VERSION");
        Self { schema_version: SCHEMA_VERSION, complete: false, sinew_version, cameras, fps, people }
    }

    /// Refuses files of others where both files are to be.
    ///
    /// # Errors
    /// [`Error::OutputExists`] that names the file.
    pub fn refuse_others(claim: &Claim) -> Result<(), Error> {
        let own = listed(&**claim.storage(), claim.folder())?;
        FILES.iter().try_for_each(|name| refuse_others(claim.folder(), &own, name))
    }

    /// Writes both files.
    ///
    /// # Errors
    /// As [`PeopleSummary::refuse_others`]; a file that cannot be written, with the path.
    pub fn write(&self, claim: &Claim) -> Result<(), Error> {
        Self::refuse_others(claim)?;
        add_own(claim.storage(), claim.folder(), &FILES)?;
        let folder = claim.folder();
        write_whole(&folder.join("people.csv"), self.to_csv().as_bytes())?;
        let json = serde_json::to_string_pretty(self).unwrap_or_default() + "\n";
        write_whole(&folder.join("summary.json"), json.as_bytes())
    }

    /// One row a person: number, folder, frames, frames in which at least two cameras saw them, whether they are tracked and to be trusted, what is wrong, and frames in which each camera saw them.
    fn to_csv(&self) -> String {
        // Writing to a String cannot fail.
        let mut text = String::from("person,folder,first_frame,last_frame,seen_frames,complete,trusted,problem");
        for camera in &self.cameras {
            let _ = write!(text, ",{}", quoted(&format!("seen_frames_{camera}")));
        }
        text.push('\n');
        for tracked in &self.people {
            let PersonTracked { person, folder, frames: [first, end], seen_frames, camera_frames, .. } = tracked;
            let (complete, trusted, problem) = (tracked.complete, tracked.trusted, quoted(&tracked.problem()));
            let last = end.saturating_sub(1);
            let _ = write!(text, "{person},{folder},{first},{last},{seen_frames},{complete},{trusted},{problem}");
            for frames in camera_frames {
                let _ = write!(text, ",{frames}");
            }
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_says_who_was_seen_where_and_when() {
        let seen = PersonSeen { frames: 3..13, seen: 8, by_camera: vec![9, 8] };
        let all = [seen.clone(), seen.clone(), seen];
        let mut summary = PeopleSummary::begun(vec!["a".into(), "b,c".into()], 30.0, &all);
        summary.people[0].complete = true;
        summary.people[0].trusted = true;
        summary.people[1].complete = true;
        summary.people[1].failed_diagnostics = vec!["R-hat 1.3, too large".into()];
        summary.people[2].failed = Some("no pose".into());
        let expected = "person,folder,first_frame,last_frame,seen_frames,complete,trusted,problem,\
                        seen_frames_a,\"seen_frames_b,c\"\n\
                        1,people/01,3,12,8,true,true,,9,8\n\
                        2,people/02,3,12,8,true,false,\"R-hat 1.3, too large\",9,8\n\
                        3,people/03,3,12,8,false,false,no pose,9,8\n";
        assert_eq!(summary.to_csv(), expected);
    }
}
