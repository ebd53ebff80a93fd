//! The result folder: everything that a run leaves behind.
//!
//! ```text
//! summary.json   written last; "complete": true means done      timings.json   the only file that differs from run to run
//! config.toml    repeats the run with --config                  setup.toml     repeats the set-up with --setup
//! markers.trc    markers_sd.csv    angles.mot    motion.bvh     of the mean pose
//! joints.csv     keypoints.csv     angles.csv     state.csv
//! frames.csv                                                    tidy tables with units in the column names
//! actions.csv                                                   of methods with action primitives alone
//! posterior.zarr load.py                                        draws, and how to open them
//! ```
//!
//! 1. [`super::claim()`] a folder before any computing: refuses results that are there, inputs, and folders in use.
//! 2. [`ResultFolder::open`] opens every file under its provisional name `NAME.partial`, or as a run left it that was stopped.
//! 3. [`ResultFolder::append`] streams one frame into all of them; memory does not grow with the number of frames: what the summary needs of each is kept in a file.
//! 4. [`ResultFolder::finish`] completes the headers, syncs, checks, renames, and writes `summary.json` last.
//!
//! [`ResultFolder::keep`] says how far the files go, for a checkpoint. A run that is stopped in between leaves readable `*.partial` files and no summary.

use super::actions::{self, Actions};
use super::coordinates::Coordinates;
use super::derived::is_derived;
use super::draws::{self, DrawStore, OpenChunks};
use super::estimate::{FrameEstimate, RunInfo};
use super::journal::Journal;
use super::markers::Markers;
use super::problem::check_length;
use super::results_error::ResultsError;
use super::skeleton::SkeletonFile;
use super::statistics::Statistics;
use super::tables::Tables;
use super::texts::Texts;
use crate::Error;
use serde::{Deserialize, Serialize};
use sinew_angles::visibility::Visibility;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::claim::{Claim, OWN_NAMES, RESULT_NAMES, is_incomplete};
use super::own_files::{listed, refuse_others, remove_own, write_list};
use super::partial::{FilePlace, PartialFile, Position};
use super::summary::{Ending, Summary};
use sinew_setup::posed_body::pose;

const LOAD_PY: &str = include_str!("load.py");

/// A result folder being filled.
pub struct ResultFolder {
    info: RunInfo,
    texts: Texts,
    markers: Markers,
    tables: Tables,
    visibility: Option<Visibility>,
    /// Frames in which each angle is not seen.
    unseen: Vec<u64>,
    actions: Actions,
    coordinates: Coordinates,
    skeleton: SkeletonFile,
    draws: DrawStore,
    journal: Journal,
    whole: Vec<PartialFile>,
    frames: u64,
    claim: Claim,
}

/// How far the files of a folder were written, and what their writers remember.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Written {
    frames: u64,
    positions: BTreeMap<String, Position>,
    unseen: Vec<u64>,
    channels_before: Option<Vec<f64>>,
    draws: OpenChunks,
}

impl ResultFolder {
    /// Refuses files of others where a run will write.
    ///
    /// # Errors
    /// [`Error::OutputExists`] that names the file.
    pub fn refuse_others(claim: &Claim) -> Result<(), Error> {
        let own = listed(&*claim.storage, &claim.folder)?;
        let names = files_of_run().chain(provisional()).chain([format!("{}/", draws::NAME)]);
        names.into_iter().try_for_each(|name| refuse_others(&claim.folder, &own, &name))
    }

    /// Removes what a run left that was stopped, and lists what a new one writes before it is whole.
    ///
    /// # Errors
    /// As [`ResultFolder::refuse_others`], and a file that cannot be read or written with the path.
    pub fn begin(claim: &Claim) -> Result<(), Error> {
        Self::refuse_others(claim)?;
        remove_checkpoint(claim)?;
        let mut own = listed(&*claim.storage, &claim.folder)?;
        own.extend(provisional());
        write_list(&claim.storage, &claim.folder, own)
    }

    /// Removes what a run left that was stopped: it is not to be resumed.
    ///
    /// # Errors
    /// A file that cannot be read or written with the path.
    pub fn forget(claim: &Claim) -> Result<(), Error> {
        remove_checkpoint(claim)?;
        let before = listed(&*claim.storage, &claim.folder)?;
        let left = &before - &provisional().collect::<BTreeSet<_>>();
        if left == before { Ok(()) } else { write_list(&claim.storage, &claim.folder, left) }
    }

    /// Opens all files: new ones, or the files of a run that was stopped, cut to what was `written` then. Older results lose their summary and their checkpoint.
    ///
    /// # Errors
    /// A file that cannot be read or written with the path; [`Error::Checkpoint`] for files that are not as they were left.
    pub fn open(claim: Claim, info: RunInfo, texts: Texts, written: Option<&Written>) -> Result<Self, Error> {
        let storage = Arc::clone(&claim.storage);
        let folder = claim.folder.clone();
        let place =
            FilePlace { storage: &storage, folder: &folder, written: written.map(|written| &written.positions) };
        // What the run itself said when it was stopped; whole results of a run before stay until these are.
        if written.is_some() && is_incomplete(&folder) {
            claim.remove("summary.json")?;
        }
        let text = |name: &str, text: &str| PartialFile::with_text(&storage, folder.join(name), text);
        let mut skeleton = SkeletonFile::open(&place, &info)?;
        if let Some(written) = written {
            let remembered = skeleton.remember(written.channels_before.clone());
            remembered.map_err(|problem| Error::checkpoint(&folder, problem))?;
        }
        let angles = info.angles.names().len();
        let unseen = written.map_or_else(|| vec![0; angles], |written| written.unseen.clone());
        check_length(unseen.len(), angles).map_err(|problem| Error::checkpoint(&folder, problem))?;
        Ok(Self {
            markers: Markers::open(&place, &info)?,
            tables: Tables::open(&place, &info)?,
            visibility: visibility(&info),
            unseen,
            actions: Actions::open(&place, &info)?,
            coordinates: Coordinates::open(&place, &info)?,
            skeleton,
            draws: DrawStore::open(&place, &info, written.map(|written| &written.draws))?,
            journal: Journal::open(&place, info.cameras.len(), info.body.points().len())?,
            whole: vec![
                text("config.toml", &texts.config_toml)?,
                text("setup.toml", &info.setup_toml)?,
                text("load.py", LOAD_PY)?,
            ],
            frames: written.map_or(0, |written| written.frames),
            texts,
            claim,
            info,
        })
    }

    /// The right to the folder.
    pub const fn claim(&self) -> &Claim {
        &self.claim
    }

    /// Hands everything to the disk, and says how far it goes.
    ///
    /// # Errors
    /// A file that cannot be read or written with the path.
    pub fn keep(&mut self) -> Result<Written, Error> {
        let files = [
            &mut self.markers.trc,
            &mut self.markers.sd,
            &mut self.tables.joints,
            &mut self.tables.keypoints,
            &mut self.tables.angles,
            &mut self.tables.state,
            &mut self.tables.frames,
            &mut self.coordinates.file,
            &mut self.skeleton.file,
            &mut self.journal.file,
            &mut self.draws.whole.file,
        ];
        let files = files.into_iter().chain(self.actions.file());
        Ok(Written {
            frames: self.frames,
            positions: files.map(PartialFile::keep).collect::<Result<_, _>>()?,
            unseen: self.unseen.clone(),
            channels_before: self.skeleton.before.clone(),
            draws: self.draws.keep()?,
        })
    }

    /// Writes a frame into every file.
    ///
    /// # Errors
    /// A file that cannot be read or written with the path at the first failure.
    pub fn append(&mut self, estimate: &FrameEstimate) -> Result<(), Error> {
        self.check(estimate)?;
        let pose = pose(&self.info.body, &estimate.mean_state);
        self.markers.append(self.frames, estimate, &pose)?;
        let seen = self.seen(estimate);
        self.unseen.iter_mut().zip(&seen).for_each(|(count, seen)| *count += u64::from(*seen == Some(false)));
        self.tables.append(estimate, &seen)?;
        self.actions.append(estimate)?;
        self.coordinates.append(estimate, &pose)?;
        self.skeleton.append(&pose)?;
        self.draws.append(estimate)?;
        self.journal.append(estimate)?;
        self.frames += 1;
        Ok(())
    }

    /// Whether each angle is seen in a frame, where that is known.
    fn seen(&self, estimate: &FrameEstimate) -> Vec<Option<bool>> {
        let seen = self.visibility.as_ref().and_then(|known| known.seen_by(&estimate.mean_state, &estimate.seen));
        seen.map_or_else(|| vec![None; self.unseen.len()], |seen| seen.into_iter().map(Some).collect())
    }

    /// Refuses an estimate of another size than the run's, and numbers that are none.
    fn check(&self, estimate: &FrameEstimate) -> Result<(), Error> {
        let (dof, points) = (self.info.body.dof(), self.info.body.points().len());
        let sizes = [
            ("mean state", estimate.mean_state.len(), dof),
            ("marginals of the state", estimate.state.len(), dof),
            ("marginals of the angles", estimate.angles.len(), self.unseen.len()),
            ("marginals of the points", estimate.points.len(), points),
            ("draws", estimate.draws.states.len(), dof * self.info.draws),
        ];
        let frame = estimate.number;
        if let Some((what, found, expected)) = sizes.into_iter().find(|(_, found, expected)| found != expected) {
            return Err(ResultsError::EstimateSize { frame, what, found, expected }.into());
        }
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let points = estimate.points.iter().all(|p| [p.mean, p.sd, p.q05, p.q95].iter().all(|values| finite(values)));
        let state = estimate.state.iter().all(|s| finite(&[s.mean, s.q05, s.q95]));
        let angles = estimate
            .angles
            .iter()
            .all(|a| finite(&[a.pose, a.mean, a.q05, a.q95]) && a.rate.is_none_or(|rate| finite(&rate)));
        match finite(&estimate.mean_state) && points && state && angles && finite(&estimate.draws.states) {
            true => Ok(()),
            false => Err(ResultsError::NotFinite { frame }.into()),
        }
    }

    /// Completes, syncs and renames all files; `summary.json` last. What a run is resumed from, and what an earlier run wrote, is removed where all frames are there. Where they are not, whole results of an earlier run
    /// stay as they are, and these keep their provisional names.
    ///
    /// # Errors
    /// A file that cannot be read or written with the path at the first failure; what is not renamed by then keeps its provisional name.
    pub fn finish(self, ending: &Ending) -> Result<Summary, Error> {
        let Self { info, texts, markers, tables, actions, coordinates, skeleton, draws, .. } = self;
        let Self { mut journal, mut whole, frames, claim, unseen, .. } = self;
        whole.extend(markers.finish(frames)?);
        whole.extend(tables.finish());
        whole.extend(actions.finish());
        whole.push(coordinates.finish(frames)?);
        whole.push(skeleton.finish(frames)?);
        let draws = draws.finish()?;
        let mut statistics = Statistics::new(&info, texts);
        journal.read_back(info.fps, |frame| statistics.add(frame))?;
        let summary = statistics.summary(&info, ending, &unseen);
        if !ending.complete && claim.folder.join("summary.json").exists() && !is_incomplete(&claim.folder) {
            return Ok(summary);
        }
        let timings = serde_json::to_string_pretty(&ending.timings).unwrap_or_default() + "\n";
        whole.push(PartialFile::with_text(&claim.storage, claim.folder.join("timings.json"), &timings)?);
        let text = serde_json::to_string_pretty(&summary).unwrap_or_default() + "\n";
        let mut last = PartialFile::with_text(&claim.storage, claim.folder.join("summary.json"), &text)?;
        whole.iter_mut().try_for_each(PartialFile::sync)?;
        last.sync()?;
        let before = listed(&*claim.storage, &claim.folder)?;
        let mut new: BTreeSet<String> = whole.iter().chain([&last]).map(PartialFile::name).collect();
        new.extend(draws.names()?);
        write_list(&claim.storage, &claim.folder, &before | &new)?;
        refuse_others(&claim.folder, &before, &format!("{}/", draws::NAME))?;
        // An older summary must not speak for new files.
        claim.remove("summary.json")?;
        whole.into_iter().try_for_each(PartialFile::rename)?;
        remove_own(&*claim.storage, &claim.folder, before.iter().filter(|name| is_draws(name)))?;
        draws.rename()?;
        claim.storage.sync(&claim.folder).map_err(Error::io("write", &claim.folder))?;
        last.rename()?;
        // A run that cannot be sure of its summary keeps what it could be resumed from.
        if claim.storage.sync(&claim.folder).is_ok() && ending.complete {
            drop(journal);
            // The results are whole: what stays does no harm and is listed, and `--resume` says that there is nothing to do.
            let removed = OWN_NAMES.iter().try_for_each(|name| claim.remove(name));
            let _ = removed.and_then(|()| replace_former(&claim, &before, &new));
        }
        Ok(summary)
    }
}

/// Removes what a run is resumed from.
fn remove_checkpoint(claim: &Claim) -> Result<(), Error> {
    // The checkpoint first: without it the others mean nothing.
    OWN_NAMES.iter().rev().try_for_each(|name| claim.remove(name))
}

/// Files that a run leaves, without the draws.
fn files_of_run() -> impl Iterator<Item = String> {
    let files = RESULT_NAMES.into_iter().filter(|name| *name != draws::NAME);
    files.chain([actions::NAME]).map(str::to_owned)
}

/// What a run writes before it is whole, as the list has it.
fn provisional() -> impl Iterator<Item = String> {
    let files = files_of_run().map(|name| format!("{name}.partial"));
    files.chain(OWN_NAMES.map(str::to_owned)).chain([format!("{}.partial/", draws::NAME)])
}

/// Whether a listed file belongs to the draws.
fn is_draws(name: &str) -> bool {
    name.strip_prefix(draws::NAME).is_some_and(|rest| rest.starts_with('/'))
}

/// Removes what runs of one person left in a folder and no new file replaces, and drops it from the list.
fn replace_former(claim: &Claim, before: &BTreeSet<String>, new: &BTreeSet<String>) -> Result<(), Error> {
    let of_runs: BTreeSet<String> = files_of_run().chain(provisional()).chain(["people.csv".to_owned()]).collect();
    let is_old =
        |name: &&String| (of_runs.contains(*name) || is_derived(name) || is_draws(name)) && !new.contains(*name);
    let old: BTreeSet<String> = before.iter().filter(is_old).cloned().collect();
    remove_own(&*claim.storage, &claim.folder, old.iter())?;
    write_list(&claim.storage, &claim.folder, &(before | new) - &old)
}

impl Claim {
    /// Removes what earlier runs of one person left, but for the `new` files.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn replace_results(&self, new: &[&str]) -> Result<(), Error> {
        let new = new.iter().map(|name| (*name).to_owned()).collect();
        replace_former(self, &listed(&*self.storage, &self.folder)?, &new)
    }
}

/// What says which angles keypoints show; none where masks show the body, too.
fn visibility(info: &RunInfo) -> Option<Visibility> {
    Visibility::new(info.angles.clone(), &info.body, &info.keypoints).filter(|_| !info.has_masks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{Draws, PointMarginal, StateMarginal};
    use crate::{claim, claim_to_resume};
    use sinew_angles::{AngleMarginal, Convention, JointAngles};
    use sinew_observe::Camera;
    use std::fs;
    use std::path::Path;

    const FRAMES: u64 = 20;

    fn info() -> RunInfo {
        RunInfo {
            method: "hmc".into(),
            is_weighted: false,
            kind: Default::default(),
            zero: None,
            world: None,
            fps: 30.0,
            first_frame: 0,
            draws: 1,
            carried: Default::default(),
            acting_parts: vec![],
            seed: 1,
            isa: "baseline".into(),
            cameras: vec![Camera::look_at("C1", [640.0, 480.0], 500.0, [3.0, 0.0, 1.0], [0.0, 0.0, 1.0]).unwrap()],
            keypoints: vec!["Nose".into()],
            camera_offset_px: vec![[0.0; 2]],
            sigma_px: 4.0,
            has_masks: false,
            sources: vec![],
            setup_toml: String::new(),
            angles: JointAngles::new(&sinew_setup::bodies::find("cf28").unwrap(), &[], false, Convention::OpenSim),
            body: sinew_setup::bodies::find("cf28").unwrap(),
        }
    }

    /// Someone who turns to the left, by half a radian a frame.
    fn turning(number: u64, info: &RunInfo) -> FrameEstimate {
        let turn = info.body.dof_names().iter().position(|name| name.ends_with("rz")).unwrap();
        let mut state = vec![0.0; info.body.dof()];
        state[turn] = 0.5 * number as f64;
        FrameEstimate {
            number,
            points: vec![PointMarginal::default(); info.body.points().len()],
            state: vec![StateMarginal::default(); state.len()],
            angles: vec![AngleMarginal::default(); info.angles.names().len()],
            draws: Draws { states: state.clone(), ..Draws::default() },
            seen: vec![[3.0, 4.0, 0.5]],
            mean_state: state,
            ..FrameEstimate::default()
        }
    }

    /// `motion.bvh` of a run that was stopped after `stop` frames.
    fn written(folder: &Path, stop: u64) -> Vec<u8> {
        let open =
            |claim, written: Option<&Written>| ResultFolder::open(claim, info(), Texts::default(), written).unwrap();
        let mut results = open(claim(folder, &[], false).unwrap(), None);
        (0..stop).for_each(|number| results.append(&turning(number, &info())).unwrap());
        let written = results.keep().unwrap();
        drop(results);
        let mut results = open(claim_to_resume(folder, &[]).unwrap(), Some(&written));
        (stop..FRAMES).for_each(|number| results.append(&turning(number, &info())).unwrap());
        results.finish(&Ending { complete: true, ..Ending::default() }).unwrap();
        fs::read(folder.join("motion.bvh")).unwrap()
    }

    #[test]
    fn channels_beyond_half_a_turn_do_not_jump_where_a_run_is_resumed() {
        let root = tempfile::tempdir().unwrap();
        let unbroken = written(&root.path().join("0"), 0);
        let last = String::from_utf8_lossy(&unbroken).lines().last().unwrap().to_owned();
        // 9.5 rad, three half turns: 544 degrees.
        assert!(last.split(' ').any(|angle| angle.parse::<f64>().unwrap().abs() > 540.0), "{last}");
        for stop in [5, 8, 19] {
            assert!(written(&root.path().join(stop.to_string()), stop) == unbroken, "stopped after {stop}");
        }
    }

    fn frames_in(folder: &Path) -> usize {
        fs::read_to_string(folder.join("frames.csv")).unwrap().lines().count() - 1
    }

    #[test]
    fn whole_results_stay_until_new_ones_are_whole() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("out");
        let run = |frames: u64, complete: bool| {
            let claim = claim(&folder, &[], true).unwrap();
            ResultFolder::begin(&claim).unwrap();
            let mut results = ResultFolder::open(claim, info(), Texts::default(), None).unwrap();
            (0..frames).for_each(|number| results.append(&turning(number, &info())).unwrap());
            let written = results.keep().unwrap();
            results.finish(&Ending { complete, ..Ending::default() }).unwrap();
            written
        };
        let says_complete = || fs::read_to_string(folder.join("summary.json")).unwrap().contains("\"complete\": true");
        run(6, true);
        assert!(frames_in(&folder) == 6 && says_complete());
        // Interrupted: what was there stays, what was done lies beside it and is continued.
        let written = run(4, false);
        assert!(frames_in(&folder) == 6 && says_complete() && folder.join("frames.csv.partial").exists());
        let claim = claim_to_resume(&folder, &[]).unwrap();
        let mut results = ResultFolder::open(claim, info(), Texts::default(), Some(&written)).unwrap();
        assert!(frames_in(&folder) == 6 && says_complete());
        results.append(&turning(4, &info())).unwrap();
        results.finish(&Ending { complete: true, ..Ending::default() }).unwrap();
        assert!(frames_in(&folder) == 5 && says_complete());
        // Where there was nothing, a part is written, and says so.
        fs::remove_dir_all(&folder).unwrap();
        run(3, false);
        assert!(frames_in(&folder) == 3 && !says_complete());
    }

    /// A run of one frame, and a table of it.
    fn table_of(info: RunInfo, name: &str) -> (tempfile::TempDir, String) {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("out");
        let frame = turning(0, &info);
        let mut results =
            ResultFolder::open(claim(&folder, &[], false).unwrap(), info, Texts::default(), None).unwrap();
        results.append(&frame).unwrap();
        results.finish(&Ending { complete: true, ..Ending::default() }).unwrap();
        let text = fs::read_to_string(folder.join(name)).unwrap();
        (root, text)
    }

    #[test]
    fn an_angle_of_which_nobody_knows_whether_it_is_seen_has_an_empty_cell() {
        let blind = RunInfo { keypoints: vec!["Antenna".into()], ..info() };
        let frame =
            |text: &str| text.lines().skip(1).map(|line| line.rsplit(',').next() == Some("")).collect::<Vec<_>>();
        let (_, text) = table_of(blind, "angles.csv");
        assert!(frame(&text).len() > 10 && frame(&text).iter().all(|is_empty| *is_empty), "{text}");
        let (_, text) = table_of(info(), "angles.csv");
        assert!(frame(&text).iter().all(|is_empty| !is_empty), "{text}");
    }

    /// The camera was put at this place.
    #[test]
    fn the_centre_of_a_camera_is_where_it_stands() {
        let (root, _) = table_of(info(), "angles.csv");
        let centres = crate::stored_array::stored_array(&root.path().join("out"), "constant_data/camera_centre");
        let found = centres.unwrap().unwrap().values;
        assert!(found.len() == 3 && found.iter().zip([3.0, 0.0, 1.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
    }

    #[test]
    fn a_frame_of_a_skeleton_lasts_as_long_as_one_of_the_run() {
        let (_, text) = table_of(RunInfo { fps: 50.0, ..info() }, "motion.bvh");
        let time = text.lines().find_map(|line| line.strip_prefix("Frame Time:")).unwrap();
        assert!((time.trim().parse::<f64>().unwrap() - 0.02).abs() < 1e-12, "{time}");
    }
}
