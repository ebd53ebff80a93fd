//! `posterior.zarr`: equal-weight draws and their statistics, streamed chunk by chunk for ArviZ and xarray.
//!
//! Length and checksum of every chunk that is whole are listed in a file of the program's own ([`super::chunks`]), so that a run that is resumed sees whether they are as they were left.
//!
//! `posterior` holds the rotations of the state, the root's place, the position of every point, the size of the body where it was not measured, and where the detectors see the keypoints in space; `sample_stats` the statistics that the method has; `observed_data` the keypoints that were used.

use super::chunks::ChunkList;
use super::own_files::slashed;
use super::partial::{FilePlace, partial_path, take_back};
use super::results_error::ResultsError;
use crate::Error;
use crate::estimate::{Carried, EstimateKind, FrameEstimate, RunInfo};
use crate::storage::Storage;
use serde::{Deserialize, Serialize};
use sinew_body::{Joint, Plan, point_positions};
use sinew_core::lanes::Isa;
use sinew_formats::zarr::inference_data::{self, RunAttributes};
use sinew_formats::zarr::{Constant, DataType, FrameValues, Group, Labels, Store, Variable, Writer};
use std::collections::BTreeSet;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the store.
pub(crate) const NAME: &str = "posterior.zarr";

/// The end of the keys that hold no numbers: a resumed run writes them again.
const METADATA: &str = "zarr.json";

/// A folder of the storage as a place for Zarr keys.
struct FolderStore {
    storage: Arc<dyn Storage>,
    folder: PathBuf,
    /// Written and not yet synced, with the folders that got a name.
    unsynced: BTreeSet<PathBuf>,
    /// Rows of the list for what was written last.
    rows: Vec<u8>,
}

impl FolderStore {
    fn sync(&mut self) -> Result<(), Error> {
        for path in std::mem::take(&mut self.unsynced) {
            self.storage.sync(&path).map_err(Error::io("write", path))?;
        }
        Ok(())
    }

    /// Removes a value; false where there is none.
    fn remove(&mut self, key: &str) -> io::Result<bool> {
        let path = self.folder.join(key);
        let is_there = self.storage.exists(&path);
        if is_there {
            self.storage.remove(&path)?;
        }
        Ok(is_there)
    }
}

impl Store for FolderStore {
    fn put(&mut self, key: &str, bytes: &[u8]) -> io::Result<()> {
        let path = self.folder.join(key);
        let is_new = !self.storage.exists(&path);
        let created = match (self.storage.create(&path), path.parent()) {
            (Err(error), Some(parent)) if error.kind() == io::ErrorKind::NotFound => {
                self.storage.create_folder(parent)?;
                let above = parent.ancestors().skip(1).take_while(|folder| folder.starts_with(&self.folder));
                self.unsynced.extend(above.map(Path::to_owned));
                self.storage.create(&path)
            }
            (created, _) => created,
        };
        created?.write_all(bytes)?;
        self.unsynced.extend(path.parent().filter(|_| is_new).map(Path::to_owned));
        self.unsynced.insert(path);
        if !key.ends_with(METADATA) {
            self.rows.extend(ChunkList::row(key, bytes));
        }
        Ok(())
    }
}

pub(crate) struct DrawStore {
    writer: Writer<FolderStore>,
    pub(crate) whole: ChunkList,
    partial: PathBuf,
    path: PathBuf,
    plan: Plan,
    isa: Isa,
    dof: usize,
    rotations: Vec<usize>,
    root: [Option<usize>; 3],
    carried: Carried,
}

/// How far a store was written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct OpenChunks {
    frames: usize,
    chunks: Vec<Vec<u8>>,
}

/// A complete store under its provisional name.
pub(crate) struct FinishedDraws {
    storage: Arc<dyn Storage>,
    partial: PathBuf,
    path: PathBuf,
}

impl FinishedDraws {
    /// Names that its files will have, from the result folder.
    pub(crate) fn names(&self) -> Result<Vec<String>, Error> {
        let files = self.storage.files_below(&self.partial).map_err(Error::io("read", &self.partial))?;
        Ok(files.iter().map(|file| format!("{NAME}/{}", slashed(&self.partial, file))).collect())
    }

    /// Gives the store its name, which nothing has.
    pub(crate) fn rename(self) -> Result<(), Error> {
        self.storage.rename(&self.partial, &self.path).map_err(Error::io("write", &self.path))
    }
}

impl DrawStore {
    pub(crate) fn open(place: &FilePlace<'_>, info: &RunInfo, from: Option<&OpenChunks>) -> Result<Self, Error> {
        let storage = place.storage;
        let path = place.folder.join(NAME);
        let partial = partial_path(&path);
        match from {
            None => storage.remove(&partial).map_err(Error::io("replace", &partial))?,
            Some(_) => drop(take_back(storage, &path)?),
        }
        let mut whole = ChunkList::open(place)?;
        if from.is_some() {
            whole.check(storage, place.folder, &partial)?;
        }
        let joints: Vec<(usize, Joint)> = info.body.joints().collect();
        let is_rotation = |dof: &usize| matches!(joints[*dof].1, Joint::Rotate(_));
        let rotations: Vec<usize> = (0..joints.len()).filter(is_rotation).collect();
        let translation = |axis: usize| {
            joints.iter().position(|(link, joint)| {
                info.body.links()[*link].parent.is_none()
                    && matches!(joint, Joint::Translate(a) if a.index() == Some(axis))
            })
        };
        let store = FolderStore {
            storage: Arc::clone(storage),
            folder: partial.clone(),
            unsynced: BTreeSet::new(),
            rows: vec![],
        };
        let mut writer = Writer::create(store, schema(info, &rotations)).map_err(Error::io("write", &partial))?;
        if let Some(OpenChunks { frames, chunks }) = from {
            let resumed = writer.resume(*frames, chunks, FolderStore::remove);
            writer = resumed.map_err(Error::io("write", &partial))?;
        }
        // Labels and constants are written again by a resumed run.
        writer.store_mut().rows.clear();
        Ok(Self {
            writer,
            whole,
            partial,
            path,
            plan: Plan::with_all_points(&info.body),
            // The draws are stored as float32: the same on every instruction set but for rounding ties.
            isa: Isa::baseline(),
            dof: info.body.dof(),
            rotations,
            root: [0, 1, 2].map(translation),
            carried: info.carried,
        })
    }

    pub(crate) fn append(&mut self, estimate: &FrameEstimate) -> Result<(), Error> {
        let draws = &estimate.draws;
        let states = || draws.states.chunks_exact(self.dof);
        let angle: Vec<f64> = states().flat_map(|state| self.rotations.iter().map(|&dof| state[dof])).collect();
        let root: Vec<f64> =
            states().flat_map(|state| self.root.map(|dof| dof.map_or(0.0, |dof| state[dof]))).collect();
        let mut markers = vec![0.0; 3 * self.plan.points() * (draws.states.len() / self.dof.max(1))];
        for (state, out) in states().zip(markers.chunks_exact_mut((3 * self.plan.points()).max(1))) {
            point_positions(&self.plan, self.isa, state, out);
        }
        markers.iter_mut().zip(&draws.shape).for_each(|(x, by)| *x += by);
        if self.carried.size {
            let roots = root.chunks_exact(3).zip(&draws.size);
            for ((root, size), points) in roots.zip(markers.chunks_exact_mut((3 * self.plan.points()).max(1))) {
                let about = points.iter_mut().zip(root.iter().cycle());
                about.for_each(|(x, root)| *x = root + size * (*x - root));
            }
        }
        let steps: Vec<i64> = draws.hmc.iter().flat_map(|hmc| &hmc.n_steps).map(|&n| i64::from(n)).collect();
        let evidence = [estimate.log_evidence.unwrap_or(f64::NAN)];
        let ess = [estimate.ess];
        let mut values = vec![FrameValues::Numbers(&root), FrameValues::Numbers(&markers)];
        if !self.rotations.is_empty() {
            values.insert(0, FrameValues::Numbers(&angle));
        }
        if self.carried.size {
            values.push(FrameValues::Numbers(&draws.size));
        }
        if self.carried.detected {
            values.push(FrameValues::Numbers(&draws.detected));
        }
        if self.carried.lp {
            values.push(FrameValues::Numbers(&draws.lp));
        }
        if self.carried.hmc {
            let hmc = draws.hmc.as_ref().ok_or_else(|| lacking("hmc"))?;
            values.extend([
                FrameValues::Numbers(&hmc.acceptance_rate),
                FrameValues::Numbers(&hmc.step_size),
                FrameValues::Integers(&steps),
                FrameValues::Flags(&hmc.diverging),
                FrameValues::Numbers(&hmc.energy),
            ]);
        }
        values.push(FrameValues::Numbers(&ess));
        if self.carried.log_evidence {
            values.push(FrameValues::Numbers(&evidence));
        }
        let resampled = [estimate.particles.as_ref().is_some_and(|particles| particles.resampled)];
        if self.carried.particles.is_some() {
            let particles = estimate.particles.as_ref().ok_or_else(|| lacking("particle"))?;
            values.extend([FrameValues::Flags(&resampled), FrameValues::Numbers(&particles.log_weight)]);
        }
        let pixels: Vec<f64> = estimate.seen.iter().flat_map(|[u, v, _]| [*u, *v]).collect();
        let confidence: Vec<f64> = estimate.seen.iter().map(|[_, _, confidence]| *confidence).collect();
        values.extend([FrameValues::Numbers(&pixels), FrameValues::Numbers(&confidence)]);
        let number = i64::try_from(estimate.number).unwrap_or(i64::MAX);
        self.writer.push(number, estimate.time_s, &values).map_err(Error::io("write", &self.partial))?;
        self.whole.append(&std::mem::take(&mut self.writer.store_mut().rows))
    }

    /// Hands what was written to the disk, and gives what was not.
    pub(crate) fn keep(&mut self) -> Result<OpenChunks, Error> {
        self.writer.store_mut().sync()?;
        let chunks = self.writer.open_chunks().map(<[u8]>::to_vec).collect();
        Ok(OpenChunks { frames: self.writer.frames(), chunks })
    }

    pub(crate) fn finish(self) -> Result<FinishedDraws, Error> {
        let mut store = self.writer.finish().map_err(Error::io("write", &self.partial))?;
        store.sync()?;
        Ok(FinishedDraws { storage: store.storage, partial: self.partial, path: self.path })
    }
}

fn lacking(what: &'static str) -> Error {
    ResultsError::LackingStatistics(what).into()
}

const PER_DRAW: &[&str] = &["chain", "draw", "frame"];
const PER_FRAME: &[&str] = &["chain", "frame"];

/// `sample_stats`: what the method brings.
fn statistics(carried: Carried, run: &RunAttributes<'_>) -> Group {
    let mut statistics = inference_data::group("sample_stats", run);
    let mut add = |wanted: bool, name: &str, dimensions: &[&str], data_type| {
        if wanted {
            statistics.variables.push(Variable::new(name, dimensions, data_type));
        }
    };
    let Carried { lp, hmc, log_evidence, particles, .. } = carried;
    add(lp, "lp", PER_DRAW, DataType::Float64);
    add(hmc, "acceptance_rate", PER_DRAW, DataType::Float64);
    add(hmc, "step_size", PER_DRAW, DataType::Float64);
    add(hmc, "n_steps", PER_DRAW, DataType::Int64);
    add(hmc, "diverging", PER_DRAW, DataType::Bool);
    add(hmc, "energy", PER_DRAW, DataType::Float64);
    add(true, "ess", PER_FRAME, DataType::Float64);
    add(log_evidence, "log_evidence", PER_FRAME, DataType::Float64);
    add(particles.is_some(), "resampled", PER_FRAME, DataType::Bool);
    add(particles.is_some(), "log_weight", &["chain", "particle", "frame"], DataType::Float64);
    statistics
}

fn schema(info: &RunInfo, rotations: &[usize]) -> sinew_formats::zarr::Schema {
    let run = RunAttributes {
        library_version: env!("CARGO_PKG_VERSION"),
        method: &info.method,
        kind: match info.kind {
            EstimateKind::Filtered => inference_data::DrawsKind::Filtered,
            EstimateKind::FixedLag => inference_data::DrawsKind::FixedLag,
            EstimateKind::Smoothed => inference_data::DrawsKind::Smoothed,
        },
        seed: info.seed,
        created_at: None,
    };
    let names = info.body.dof_names();
    let dof = rotations.iter().map(|&dof| names[dof].clone()).collect();
    let points = info.body.points().iter().map(|point| point.name.clone()).collect();
    let mut schema = inference_data::schema(1, info.draws, dof, points);
    let statistics = statistics(info.carried, &run);
    if let Some(count) = info.carried.particles {
        schema.dimensions.insert("particle".into(), Labels::Count(count));
    }
    let mut observed = inference_data::group("observed_data", &run);
    let sighting = &["frame", "camera", "keypoint"][..];
    let pixel = [sighting, &["image_axis"]].concat();
    observed.variables.push(Variable::new("pixel", &pixel, DataType::Float32).with_attribute("units", "px"));
    observed.variables.push(Variable::new("confidence", sighting, DataType::Float32));
    schema.dimensions.insert("keypoint".into(), Labels::Names(info.keypoints.clone()));
    schema.dimensions.insert("image_axis".into(), Labels::Names(vec!["u".into(), "v".into()]));
    let mut constants = inference_data::group("constant_data", &run);
    let cameras = info.cameras.iter().map(|camera| camera.name.clone()).collect();
    schema.dimensions.insert("camera".into(), Labels::Names(cameras));
    let centres = info.cameras.iter().flat_map(|camera| {
        let (r, t) = (&camera.rotation, &camera.translation);
        [0, 1, 2].map(|k| -(0..3).map(|j| r[j][k] * t[j]).sum::<f64>())
    });
    constants.constants.push(Constant {
        variable: Variable::new("camera_centre", &["camera", "axis"], DataType::Float64).with_attribute("units", "m"),
        values: centres.collect(),
    });
    let mut posterior = inference_data::posterior(&run);
    // A body that only translates has no angles.
    posterior.variables.retain(|variable| variable.name != "angle" || !rotations.is_empty());
    if info.carried.size {
        posterior.variables.push(Variable::new("size", PER_DRAW, DataType::Float32));
    }
    if info.carried.detected {
        let dimensions = [PER_DRAW, &["keypoint", "axis"]].concat();
        let detected = Variable::new("keypoint_position", &dimensions, DataType::Float32);
        posterior.variables.push(detected.with_attribute("units", "m"));
    }
    schema.groups.extend([posterior, statistics, observed, constants]);
    schema.attributes = inference_data::root(&run, &schema.groups);
    schema
}
