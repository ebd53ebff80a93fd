//! A disk that fails at any write, sync or rename.
//!
//! The first failure is named with its path, nothing half done passes for a result, and a run is resumed when there is room again.

use crate::common::files;
use crate::common::synthetic::Whole;
use sinew::angles::{AngleMarginal, Convention, JointAngles};
use sinew::formats::calib_toml;
use sinew::track::checkpoint;
use sinew::{Error, FileError, bodies};
use sinew_results::estimate::{Draws, FrameEstimate, PointMarginal, RunInfo, StateMarginal};
use sinew_results::problem;
use sinew_results::{Disk, Ending, OWN_NAMES, ResultFolder, Storage, StoredFile, Texts, claim_in};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The disk, until a counter runs out.
#[derive(Clone, Debug)]
struct Failing(Arc<AtomicUsize>);

impl Failing {
    fn step(&self) -> io::Result<()> {
        match self.0.fetch_update(Ordering::SeqCst, Ordering::SeqCst, |left| left.checked_sub(1)) {
            Ok(_) => Ok(()),
            Err(_) => Err(io::Error::new(io::ErrorKind::StorageFull, "injected")),
        }
    }
}

struct FailingFile(Failing, Box<dyn StoredFile>);

impl Write for FailingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.step()?;
        self.1.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.1.flush()
    }
}

impl Seek for FailingFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.1.seek(to)
    }
}

impl StoredFile for FailingFile {
    fn sync(&mut self) -> io::Result<()> {
        // Hundreds of runs need no real disk.
        self.0.step()
    }
}

impl Storage for Failing {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.step()?;
        Disk.create_folder(path)
    }
    fn create(&self, path: &Path) -> io::Result<Box<dyn StoredFile>> {
        self.step()?;
        Ok(Box::new(FailingFile(self.clone(), Disk.create(path)?)))
    }
    fn resume(&self, path: &Path, length: u64) -> io::Result<Box<dyn StoredFile>> {
        self.step()?;
        Ok(Box::new(FailingFile(self.clone(), Disk.resume(path, length)?)))
    }
    fn read(&self, path: &Path) -> io::Result<Box<dyn io::Read>> {
        self.step()?;
        Disk.read(path)
    }
    fn exists(&self, path: &Path) -> bool {
        Disk.exists(path)
    }
    fn sync(&self, _: &Path) -> io::Result<()> {
        self.step()
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.step()?;
        Disk.rename(from, to)
    }
    fn remove(&self, path: &Path) -> io::Result<()> {
        self.step()?;
        Disk.remove(path)
    }
    fn files_below(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        self.step()?;
        Disk.files_below(folder)
    }
}

const FRAMES: u64 = 3;

const CALIBRATION: &str = "[cam1]\nsize = [640, 480]\nmatrix = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]\ndistortions = [0, 0, 0, 0]\nrotation = [0, 0, 0]\ntranslation = [0, 0, 3]\n";

/// Writes a small result folder; gives the steps that are left over.
fn write(folder: &Path, steps: usize) -> Result<usize, Error> {
    let left = Arc::new(AtomicUsize::new(steps));
    let body = bodies::find("cf28")?;
    let info = RunInfo {
        is_weighted: false,
        method: "hmc".into(),
        kind: Default::default(),
        zero: None,
        world: None,
        fps: 30.0,
        first_frame: 0,
        draws: 1,
        carried: Default::default(),
        acting_parts: vec!["torso".into()],
        seed: 1,
        isa: "baseline".into(),
        cameras: calib_toml::read("Calib.toml", CALIBRATION)?.cameras,
        keypoints: vec!["Nose".into()],
        has_masks: false,
        camera_offset_px: vec![[0.0; 2]],
        sigma_px: 1.0,
        sources: vec![],
        setup_toml: "schema = 2\n".into(),
        angles: JointAngles::new(&body, &[], false, Convention::OpenSim),
        body,
    };
    let (dof, angles) = (info.body.dof(), info.angles.names().len());
    let points = info.body.points().len();
    let cameras = info.cameras.len();
    let claim = claim_in(Arc::new(Failing(Arc::clone(&left))), folder, &[], false)?;
    let mut results = ResultFolder::open(claim, info, Texts::default(), None)?;
    for number in 0..FRAMES {
        results.append(&FrameEstimate {
            number,
            time_s: number as f64 / 30.0,
            observed: true,
            mean_state: vec![0.0; dof],
            points: vec![PointMarginal::default(); points],
            state: vec![StateMarginal::default(); dof],
            angles: vec![AngleMarginal::default(); angles],
            draws: Draws { states: vec![0.0; dof], ..Draws::default() },
            seen: vec![[3.0, 4.0, 0.5]; cameras],
            ess: 20.0,
            ..FrameEstimate::default()
        })?;
        results.keep()?;
    }
    results.finish(&Ending { complete: true, ..Ending::default() })?;
    Ok(left.load(Ordering::SeqCst))
}

#[test]
fn every_failure_is_reported_and_nothing_false_is_left() {
    const MANY: usize = 100_000;
    let root = tempfile::tempdir().unwrap();
    // What a run kept to resume is removed when all is done and the folder synced, and leaves the list of files, which is written in five steps: it does no harm where that fails.
    let needed = MANY - write(&root.path().join("whole"), MANY).unwrap() - OWN_NAMES.len() - 1 - 5;
    assert!(needed > 100, "{needed}");
    // Every step at the beginning and the end, where all kinds of step are, and some in between.
    let few = |steps: &usize| *steps < 60 || *steps + 60 > needed || steps.is_multiple_of(7);
    for steps in (0..needed).filter(few) {
        let folder = root.path().join(format!("{steps}"));
        match write(&folder, steps) {
            Err(error) if error.file().is_some() => {
                let FileError { path, source, .. } = error.file().unwrap();
                assert!(path.starts_with(&folder), "{steps}: {}", path.display());
                assert_eq!(source.to_string(), "injected", "{steps}");
            }
            other => panic!("{steps} of {needed}: {other:?}"),
        }
        assert!(!folder.join("summary.json").exists(), "{steps}");
        // The next run may take the folder, unless files have their names already.
        if !folder.join("config.toml").exists()
            && !folder.join("load.py").exists()
            && !folder.join("setup.toml").exists()
        {
            assert!(sinew_results::claim(&folder, &[], false).is_ok(), "{steps}");
        }
    }
}

/// Whole runs with a checkpoint after every frame, on a disk that fails from some step on: at each of the last ones, while results get their names and what is kept to resume is removed, and at some before.
/// Since nothing works after the failure, what is left is what a run leaves that is killed there.
#[test]
fn a_run_resumes_when_there_is_room_again() {
    let settings = [("method", "bootstrap"), ("particles", "8"), ("checkpoint_every", "0.02")];
    let whole = Whole::new(&settings);
    let out = whole.folder.path().join("out");
    let run = |steps: usize| {
        let left = Arc::new(AtomicUsize::new(steps));
        let claim = claim_in(Arc::new(Failing(Arc::clone(&left))), &out, &[], false)?;
        whole.run_in(claim, 1, None, None).map(|_| left.load(Ordering::SeqCst))
    };
    const MANY: usize = 1_000_000;
    let needed = MANY - run(MANY).unwrap();
    let mut resumed = 0;
    // The number of steps depends on the clock, for checkpoints do: a run that has enough of them is no failure.
    for steps in (0..needed).filter(|steps| *steps % 37 == 1 || needed - steps <= 30) {
        let _ = std::fs::remove_dir_all(&out);
        match run(steps) {
            Ok(_) => continue,
            Err(error) if error.file().is_some() => {
                let FileError { path, source, .. } = error.file().unwrap();
                assert!(path.starts_with(&out), "{steps}: {}", path.display());
                assert_eq!(source.to_string(), "injected", "{steps}");
            }
            Err(other) => panic!("{steps} of {needed}: {other:?}"),
        }
        if out.join(problem::NAME).exists() {
            let from = checkpoint::read(&out).unwrap();
            assert!(whole.run(&out, 2, None, Some(from)).unwrap().summary.complete);
            let mut found = files(&out);
            found.remove("timings.json");
            assert!(found == whole.files, "{steps} of {needed}");
            resumed += 1;
        }
    }
    println!("{needed} steps in a run, {resumed} failed runs resumed");
    assert!(resumed > 5);
}
