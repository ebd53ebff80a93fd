//! `joints.csv`, `keypoints.csv`, `angles.csv`, `frames.csv`: tidy tables with the unit in every column name.
//!
//! | file | a row is | columns |
//! |---|---|---|
//! | `joints.csv` | a point in a frame | frame, `time_s`, person, joint, `x_mean_m` … `z_q95_m`, `x_sd_within_m` … (world, Z up), observed, quality |
//! | `keypoints.csv` | a keypoint in a frame, where the detectors see it in space | the same with keypoint for joint; no rows where that is not known |
//! | `angles.csv` | a rotation in a frame | `time_s`, person, name, `mean_deg`, `q05_deg`, `q95_deg` |
//! | `frames.csv` | a frame | frame, `time_s`, observed, quality, restarted, ess, `log_evidence`, `r_hat`, `e_bfmi`, acceptance, `off_manifold`, divergences, `residual_px` and one per camera |
//!
//! `quality` is 2 where at least two cameras saw the person, 1 for one camera, 0 where the values come from the motion model only.

use super::partial::{PartialFile, Place};
use super::table::{Table, integer, optional};
use crate::Error;
use crate::results::estimate::{FrameEstimate, PointMarginal, RunInfo};
use sinew_body::Joint;
use sinew_formats::tidy_csv::Cell;

/// Number of the tracked person in the tables; there is one.
pub(crate) const PERSON: Cell<'_> = Cell::Integer(0);

pub(crate) struct Tables {
    pub(crate) joints: Table,
    pub(crate) keypoints: Table,
    pub(crate) angles: Table,
    pub(crate) frames: Table,
    point_names: Vec<String>,
    keypoint_names: Vec<String>,
    /// Degree of freedom and name of every rotation.
    rotations: Vec<(usize, String)>,
}

const MARGINALS: [&str; 15] = [
    "x_mean_m",
    "y_mean_m",
    "z_mean_m",
    "x_sd_m",
    "y_sd_m",
    "z_sd_m",
    "x_q05_m",
    "y_q05_m",
    "z_q05_m",
    "x_q95_m",
    "y_q95_m",
    "z_q95_m",
    "x_sd_within_m",
    "y_sd_within_m",
    "z_sd_within_m",
];

impl Tables {
    pub(crate) fn open(place: &Place<'_>, info: &RunInfo) -> Result<Self, Error> {
        let point_columns =
            |what| [&["frame", "time_s", "person", what][..], &MARGINALS, &["observed", "quality"]].concat();
        let angle_columns = ["time_s", "person", "name", "mean_deg", "q05_deg", "q95_deg"];
        let mut frame_columns: Vec<String> = [
            "frame",
            "time_s",
            "observed",
            "quality",
            "restarted",
            "ess",
            "log_evidence",
            "r_hat",
            "e_bfmi",
            "acceptance",
            "off_manifold",
            "divergences",
            "residual_px",
        ]
        .map(Into::into)
        .into();
        frame_columns.extend(info.cameras.iter().map(|camera| format!("residual_{}_px", camera.name)));
        let named = info.body.dof_names().into_iter().zip(info.body.joints()).enumerate();
        let rotations =
            named.filter(|(_, (_, (_, joint)))| matches!(joint, Joint::Rotate(_))).map(|(dof, (name, _))| (dof, name));
        Ok(Self {
            joints: Table::open(place, "joints.csv", &point_columns("joint"))?,
            keypoints: Table::open(place, "keypoints.csv", &point_columns("keypoint"))?,
            angles: Table::open(place, "angles.csv", &angle_columns)?,
            frames: Table::open(place, "frames.csv", &frame_columns)?,
            point_names: info.body.points().iter().map(|point| point.name.clone()).collect(),
            keypoint_names: info.keypoints.clone(),
            rotations: rotations.collect(),
        })
    }

    pub(crate) fn append(&mut self, estimate: &FrameEstimate) -> Result<(), Error> {
        let time = Cell::Number(estimate.time_s);
        let flags = [integer(estimate.observed.into()), integer(estimate.quality as u64)];
        let rows = |table: &mut Table, names: &[String], points: &[PointMarginal]| {
            names.iter().zip(points).try_for_each(|(name, point)| {
                let mut cells = vec![integer(estimate.number), time, PERSON, Cell::Text(name)];
                let numbers = [point.mean, point.sd, point.q05, point.q95, point.sd_within];
                cells.extend(numbers.as_flattened().iter().copied().map(Cell::Number));
                cells.extend(flags);
                table.append(&cells)
            })
        };
        rows(&mut self.joints, &self.point_names, &estimate.points)?;
        rows(&mut self.keypoints, &self.keypoint_names, &estimate.keypoints)?;
        for (dof, name) in &self.rotations {
            let angle = &estimate.state[*dof];
            let [mean, q05, q95] = [angle.mean, angle.q05, angle.q95].map(|value| Cell::Number(value.to_degrees()));
            self.angles.append(&[time, PERSON, Cell::Text(name), mean, q05, q95])?;
        }
        let mut cells = vec![integer(estimate.number), time, flags[0], flags[1], integer(estimate.restarted.into())];
        cells.push(optional(Some(estimate.ess)));
        let FrameEstimate { log_evidence, r_hat, energy_fraction, acceptance, off_manifold, .. } = *estimate;
        cells.extend([log_evidence, r_hat, energy_fraction, acceptance, off_manifold].map(optional));
        cells.extend([integer(estimate.divergences), optional(rms(&estimate.residual_px))]);
        cells.extend(estimate.residual_px.iter().copied().map(optional));
        self.frames.append(&cells)
    }

    pub(crate) fn finish(self) -> [PartialFile; 4] {
        [self.joints.file, self.keypoints.file, self.angles.file, self.frames.file]
    }
}

/// Root mean square over the cameras that saw the person.
fn rms(residuals: &[Option<f64>]) -> Option<f64> {
    let seen: Vec<f64> = residuals.iter().flatten().copied().collect();
    (!seen.is_empty()).then(|| (seen.iter().map(|r| r * r).sum::<f64>() / seen.len() as f64).sqrt())
}
