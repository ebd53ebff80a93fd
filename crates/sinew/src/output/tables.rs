//! `joints.csv`, `angles.csv`, `frames.csv`: tidy tables with the unit in every column name.
//!
//! | file | a row is | columns |
//! |---|---|---|
//! | `joints.csv` | a point in a frame | frame, `time_s`, person, joint, `x_mean_m` … `z_q95_m` (world, Z up), observed, quality |
//! | `angles.csv` | a rotation in a frame | `time_s`, person, name, `mean_deg`, `q05_deg`, `q95_deg` |
//! | `frames.csv` | a frame | frame, `time_s`, observed, quality, ess, `log_evidence`, `r_hat`, acceptance, divergences, `residual_px` and one per camera |
//!
//! `quality` is 2 where at least two cameras saw the person, 1 for one camera, 0 where the values come from the motion model only.

use super::partial::PartialFile;
use super::storage::Storage;
use super::table::Table;
use crate::Error;
use crate::estimate::{FrameEstimate, RunInfo};
use sinew_body::Joint;
use std::path::Path;
use std::sync::Arc;

/// Number of the tracked person in the tables; there is one.
const PERSON: u64 = 0;

pub(crate) struct Tables {
    joints: Table,
    angles: Table,
    frames: Table,
    point_names: Vec<String>,
    /// Degree of freedom and name of every rotation.
    rotations: Vec<(usize, String)>,
}

fn columns<'a>(names: impl IntoIterator<Item = &'a str>) -> impl Iterator<Item = String> {
    names.into_iter().map(str::to_owned).collect::<Vec<_>>().into_iter()
}

impl Tables {
    pub(crate) fn create(storage: &Arc<dyn Storage>, folder: &Path, info: &RunInfo) -> Result<Self, Error> {
        let axes =
            ["mean", "sd", "q05", "q95"].iter().flat_map(|what| ["x", "y", "z"].map(|axis| format!("{axis}_{what}_m")));
        let joint_columns =
            columns(["frame", "time_s", "person", "joint"]).chain(axes).chain(columns(["observed", "quality"]));
        let angle_columns = columns(["time_s", "person", "name", "mean_deg", "q05_deg", "q95_deg"]);
        let diagnostics = ["ess", "log_evidence", "r_hat", "acceptance", "divergences", "residual_px"];
        let per_camera = info.cameras.iter().map(|camera| format!("residual_{}_px", camera.name));
        let frame_columns =
            columns(["frame", "time_s", "observed", "quality"]).chain(columns(diagnostics)).chain(per_camera);
        let named = info.body.dof_names().into_iter().zip(info.body.joints()).enumerate();
        let rotations =
            named.filter(|(_, (_, (_, joint)))| matches!(joint, Joint::Rotate(_))).map(|(dof, (name, _))| (dof, name));
        Ok(Self {
            joints: Table::create(storage, folder.join("joints.csv"), joint_columns)?,
            angles: Table::create(storage, folder.join("angles.csv"), angle_columns)?,
            frames: Table::create(storage, folder.join("frames.csv"), frame_columns)?,
            point_names: info.body.points().iter().map(|point| point.name.clone()).collect(),
            rotations: rotations.collect(),
        })
    }

    pub(crate) fn append(&mut self, estimate: &FrameEstimate) -> Result<(), Error> {
        let (observed, quality) = (u64::from(estimate.observed), estimate.quality as u64);
        for (name, point) in self.point_names.iter().zip(&estimate.points) {
            let mut row = self.joints.row();
            row.integer(estimate.number).number(estimate.time_s).integer(PERSON).text(name);
            for value in [point.mean, point.sd, point.q05, point.q95].as_flattened() {
                row.number(*value);
            }
            row.integer(observed).integer(quality);
            row.end()?;
        }
        for (dof, name) in &self.rotations {
            let angle = &estimate.state[*dof];
            let mut row = self.angles.row();
            row.number(estimate.time_s).integer(PERSON).text(name);
            [angle.mean, angle.q05, angle.q95].iter().for_each(|value| {
                row.number(value.to_degrees());
            });
            row.end()?;
        }
        let mut row = self.frames.row();
        row.integer(estimate.number).number(estimate.time_s).integer(observed).integer(quality);
        row.number(estimate.ess).optional(estimate.log_evidence).optional(estimate.r_hat).optional(estimate.acceptance);
        row.integer(estimate.divergences).optional(mean(&estimate.residual_px));
        estimate.residual_px.iter().for_each(|residual| {
            row.optional(*residual);
        });
        row.end()
    }

    pub(crate) fn finish(self) -> [PartialFile; 3] {
        [self.joints.file, self.angles.file, self.frames.file]
    }
}

/// Root mean square over the cameras that saw the person.
fn mean(residuals: &[Option<f64>]) -> Option<f64> {
    let seen: Vec<f64> = residuals.iter().flatten().copied().collect();
    (!seen.is_empty()).then(|| (seen.iter().map(|r| r * r).sum::<f64>() / seen.len() as f64).sqrt())
}
