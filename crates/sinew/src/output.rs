//! The result folder: everything that a run leaves behind.
//!
//! ```text
//! summary.json   written last; "complete": true means done      timings.json   the only file that differs from run to run
//! config.toml    repeats the run with --config                  setup.toml     repeats the set-up with --setup
//! markers.trc    markers_sd.csv    angles.mot    motion.bvh     of the mean pose
//! joints.csv     angles.csv        frames.csv                   tidy tables with units in the column names
//! posterior.zarr load.py                                        draws, and how to open them
//! ```
//!
//! 1. [`claim`] a folder before any computing: refuses results that are there, inputs, and folders in use.
//! 2. [`ResultFolder::create`] opens every file under its provisional name `NAME.partial`.
//! 3. [`ResultFolder::append`] streams one frame into all of them; nothing grows with the number of frames but a few numbers a frame for the summary.
//! 4. [`ResultFolder::finish`] completes the headers, syncs, checks, renames, and writes `summary.json` last.
//!
//! A run that is stopped in between leaves readable `*.partial` files and no summary.

mod claim;
mod coordinates;
mod draws;
mod markers;
mod partial;
mod pose;
mod result_table;
mod skeleton;
mod statistics;
mod storage;
mod summary;
mod table;
mod tables;

pub use claim::{Claim, LOCK_NAME, RESULT_NAMES, claim, claim_in, is_in_use};
pub use markers::{REFERENCE_ORDER, order as marker_order};
pub use pose::{Pose, pose};
pub use result_table::{MOTION_FILES, ResultTable};
pub use skeleton::t_pose;
pub use storage::{Disk, Storage, StoredFile};
pub use summary::{Diagnostics, Ending, Limits, Summary};

use crate::Error;
use crate::estimate::{FrameEstimate, RunInfo};
use coordinates::Coordinates;
use draws::DrawStore;
use markers::Markers;
use partial::PartialFile;
use skeleton::SkeletonFile;
use statistics::Statistics;
use std::sync::Arc;
use tables::Tables;

const LOAD_PY: &str = include_str!("output/load.py");

/// A result folder being filled.
pub struct ResultFolder {
    info: RunInfo,
    markers: Markers,
    tables: Tables,
    coordinates: Coordinates,
    skeleton: SkeletonFile,
    draws: DrawStore,
    whole: Vec<PartialFile>,
    statistics: Statistics,
    claim: Claim,
}

/// Texts that stand in the folder as they are.
#[derive(Clone, Debug, Default)]
pub struct Texts {
    /// `config.toml`.
    pub config_toml: String,
    /// Settings with their origins, for the summary.
    pub settings: serde_json::Value,
    /// Hash of the settings that matter for the numbers.
    pub settings_hash: String,
}

impl ResultFolder {
    /// Opens all files.
    ///
    /// # Errors
    /// [`Error::Io`] with the path.
    pub fn create(claim: Claim, info: RunInfo, texts: Texts) -> Result<Self, Error> {
        let storage = Arc::clone(&claim.storage);
        let folder = claim.folder.clone();
        let text = |name: &str, text: &str| PartialFile::with_text(&storage, folder.join(name), text);
        Ok(Self {
            markers: Markers::create(&storage, &folder, &info)?,
            tables: Tables::create(&storage, &folder, &info)?,
            coordinates: Coordinates::create(&storage, &folder, &info)?,
            skeleton: SkeletonFile::create(&storage, &folder, &info)?,
            draws: DrawStore::create(&storage, &folder, &info)?,
            whole: vec![
                text("config.toml", &texts.config_toml)?,
                text("setup.toml", &info.setup_toml)?,
                text("load.py", LOAD_PY)?,
            ],
            statistics: Statistics::new(&info, texts),
            claim,
            info,
        })
    }

    /// Writes a frame into every file.
    ///
    /// # Errors
    /// [`Error::Io`] with the path at the first failure.
    pub fn append(&mut self, estimate: &FrameEstimate) -> Result<(), Error> {
        self.check(estimate)?;
        let pose = pose(&self.info.body, &estimate.mean_state);
        self.markers.append(self.statistics.frames(), estimate, &pose)?;
        self.tables.append(estimate)?;
        self.coordinates.append(estimate, &pose)?;
        self.skeleton.append(&pose)?;
        self.draws.append(estimate)?;
        self.statistics.add(estimate);
        Ok(())
    }

    /// Refuses an estimate of another size than the run's, and numbers that are none.
    fn check(&self, estimate: &FrameEstimate) -> Result<(), Error> {
        let (dof, points) = (self.info.body.dof(), self.info.body.points().len());
        let sizes = [
            ("mean state", estimate.mean_state.len(), dof),
            ("marginals of the state", estimate.state.len(), dof),
            ("marginals of the points", estimate.points.len(), points),
            ("draws", estimate.draws.states.len(), dof * self.info.draws),
        ];
        let failed = |what: String| Err(Error::Numerical { message: format!("frame {}: {what}", estimate.number) });
        if let Some((what, found, expected)) = sizes.into_iter().find(|(_, found, expected)| found != expected) {
            return failed(format!("{what}: {found} numbers instead of {expected}"));
        }
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let points = estimate.points.iter().all(|p| [p.mean, p.sd, p.q05, p.q95].iter().all(|values| finite(values)));
        let state = estimate.state.iter().all(|s| finite(&[s.mean, s.q05, s.q95]));
        match finite(&estimate.mean_state) && points && state && finite(&estimate.draws.states) {
            true => Ok(()),
            false => failed("the estimate has numbers that are not finite".into()),
        }
    }

    /// Completes, syncs and renames all files; `summary.json` last.
    ///
    /// # Errors
    /// [`Error::Io`] with the path at the first failure; what is not renamed by then keeps its provisional name.
    pub fn finish(self, ending: &Ending) -> Result<Summary, Error> {
        let Self { info, markers, tables, coordinates, skeleton, draws, mut whole, statistics, claim } = self;
        whole.extend(markers.finish(statistics.frames())?);
        whole.extend(tables.finish());
        whole.push(coordinates.finish(statistics.frames())?);
        whole.push(skeleton.finish(statistics.frames())?);
        let draws = draws.finish()?;
        let timings = serde_json::to_string_pretty(&ending.timings).unwrap_or_default() + "\n";
        whole.push(PartialFile::with_text(&claim.storage, claim.folder.join("timings.json"), &timings)?);
        let summary = statistics.summary(&info, ending);
        let text = serde_json::to_string_pretty(&summary).unwrap_or_default() + "\n";
        let mut last = PartialFile::with_text(&claim.storage, claim.folder.join("summary.json"), &text)?;
        whole.iter_mut().try_for_each(PartialFile::sync)?;
        last.sync()?;
        // An older summary must not speak for new files.
        let old = claim.folder.join("summary.json");
        claim.storage.remove(&old).map_err(Error::io("replace", &old))?;
        whole.into_iter().try_for_each(PartialFile::rename)?;
        draws.rename()?;
        last.rename()?;
        Ok(summary)
    }
}

/// Writes a single file beside its place, and renames it once it is whole.
///
/// # Errors
/// [`Error::Io`] with the path.
pub fn write_whole(path: &std::path::Path, bytes: &[u8]) -> Result<(), Error> {
    let storage: Arc<dyn Storage> = Arc::new(Disk);
    let mut file = PartialFile::create(&storage, path.to_owned())?;
    file.write(|out| std::io::Write::write_all(out, bytes))?;
    file.sync()?;
    file.rename()
}
