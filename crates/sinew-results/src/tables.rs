//! `joints.csv`, `keypoints.csv`, `angles.csv`, `state.csv`, `frames.csv`: tidy tables with the unit in every column name.
//!
//! | file | a row is | columns |
//! |---|---|---|
//! | `joints.csv` | a point in a frame | frame, `time_s`, person, joint, `x_mean_m` … `z_q95_m`, `x_sd_within_m` … (world, Z up), observed, quality |
//! | `keypoints.csv` | a keypoint in a frame, where the detectors see it in space | the same with keypoint for joint; no rows where that is not known |
//! | `angles.csv` | an angle of a joint in a frame | frame, `time_s`, person, name, `mean_deg`, `q05_deg`, `q95_deg`, `rate_mean_deg_s`, `rate_q05_deg_s`, `rate_q95_deg_s`, seen |
//! | `state.csv` | a degree of freedom in a frame | frame, `time_s`, person, name, unit, mean, q05, q95 |
//! | `frames.csv` | a frame | frame, `time_s`, observed, quality, restarted, ess, `log_evidence`, `r_hat`, `e_bfmi`, acceptance, `off_manifold`, divergences, `residual_px` and one per camera |
//!
//! `quality` is 2 where at least two cameras saw the person, 1 for one camera, 0 where the values come from the motion model only.

use super::partial::{FilePlace, PartialFile};
use crate::Error;
use crate::estimate::{FrameEstimate, PointMarginal, RunInfo, StateMarginal};
use sinew_body::Joint;
use sinew_formats::tidy_csv::Cell;

/// Number of the tracked person in the tables; there is one.
pub(crate) const PERSON: Cell<'_> = Cell::Integer(0);

pub(crate) struct Tables {
    pub(crate) joints: PartialFile,
    pub(crate) keypoints: PartialFile,
    pub(crate) angles: PartialFile,
    pub(crate) state: PartialFile,
    pub(crate) frames: PartialFile,
    point_names: Vec<String>,
    keypoint_names: Vec<String>,
    angle_names: Vec<String>,
    /// Name and unit of every degree of freedom.
    state_names: Vec<(String, &'static str)>,
}

const ANGLES: &str =
    "frame time_s person name mean_deg q05_deg q95_deg rate_mean_deg_s rate_q05_deg_s rate_q95_deg_s seen";
const STATE: &str = "frame time_s person name unit mean q05 q95";

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
    pub(crate) fn open(place: &FilePlace<'_>, info: &RunInfo) -> Result<Self, Error> {
        let point_columns =
            |what| [&["frame", "time_s", "person", what][..], &MARGINALS, &["observed", "quality"]].concat();
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
        let unit = |joint: Joint| if matches!(joint, Joint::Rotate(_)) { "deg" } else { "m" };
        let state_names = info.body.dof_names().into_iter().zip(info.body.joints().map(|(_, joint)| unit(joint)));
        Ok(Self {
            joints: place.table("joints.csv", &point_columns("joint"))?,
            keypoints: place.table("keypoints.csv", &point_columns("keypoint"))?,
            angles: place.table("angles.csv", &ANGLES.split(' ').collect::<Vec<_>>())?,
            state: place.table("state.csv", &STATE.split(' ').collect::<Vec<_>>())?,
            frames: place.table("frames.csv", &frame_columns)?,
            point_names: info.body.points().iter().map(|point| point.name.clone()).collect(),
            keypoint_names: info.keypoints.clone(),
            angle_names: info.angles.names().to_vec(),
            state_names: state_names.collect(),
        })
    }

    /// Writes a frame; `seen` says of each angle whether the frame shows it, where that is known.
    pub(crate) fn append(&mut self, estimate: &FrameEstimate, seen: &[Option<bool>]) -> Result<(), Error> {
        let time = Cell::Number(estimate.time_s);
        let flags = [integer(estimate.observed.into()), integer(estimate.quality as u64)];
        let rows = |table: &mut PartialFile, names: &[String], points: &[PointMarginal]| {
            names.iter().zip(points).try_for_each(|(name, point)| {
                let mut cells = vec![integer(estimate.number), time, PERSON, Cell::Text(name)];
                let numbers = [point.mean, point.sd, point.q05, point.q95, point.sd_within];
                cells.extend(numbers.as_flattened().iter().copied().map(Cell::Number));
                cells.extend(flags);
                table.row(&cells)
            })
        };
        rows(&mut self.joints, &self.point_names, &estimate.points)?;
        rows(&mut self.keypoints, &self.keypoint_names, &estimate.keypoints)?;
        for ((name, angle), seen) in self.angle_names.iter().zip(&estimate.angles).zip(seen) {
            let mut cells = vec![integer(estimate.number), time, PERSON, Cell::Text(name)];
            cells.extend([angle.mean, angle.q05, angle.q95].map(|value| Cell::Number(value.to_degrees())));
            let rate = angle.rate.map(|rate| rate.map(f64::to_degrees));
            cells.extend([0, 1, 2].map(|k: usize| optional(rate.map(|rate| rate[k]))));
            cells.push(seen.map_or(Cell::Empty, |seen| integer(seen.into())));
            self.angles.row(&cells)?;
        }
        for (dof, (name, unit)) in self.state_names.iter().enumerate() {
            let StateMarginal { q05, q95, .. } = estimate.state[dof];
            let shown = |value: f64| Cell::Number(if *unit == "deg" { value.to_degrees() } else { value });
            let [mean, q05, q95] = [estimate.mean_state[dof], q05, q95].map(shown);
            let (number, name, unit) = (integer(estimate.number), Cell::Text(name), Cell::Text(unit));
            self.state.row(&[number, time, PERSON, name, unit, mean, q05, q95])?;
        }
        let mut cells = vec![integer(estimate.number), time, flags[0], flags[1], integer(estimate.restarted.into())];
        cells.push(optional(Some(estimate.ess)));
        let FrameEstimate { log_evidence, r_hat, energy_fraction, acceptance, off_manifold, .. } = *estimate;
        cells.extend([log_evidence, r_hat, energy_fraction, acceptance, off_manifold].map(optional));
        cells.extend([integer(estimate.divergences), optional(rms(&estimate.residual_px))]);
        cells.extend(estimate.residual_px.iter().copied().map(optional));
        self.frames.row(&cells)
    }

    pub(crate) fn finish(self) -> [PartialFile; 5] {
        [self.joints, self.keypoints, self.angles, self.state, self.frames]
    }
}

/// A count.
pub(crate) fn integer(value: u64) -> Cell<'static> {
    Cell::Integer(i64::try_from(value).unwrap_or(i64::MAX))
}

/// A diagnostic, or nothing where a method does not have it; an infinite one (R-hat of chains that never moved) becomes NaN.
fn optional(value: Option<f64>) -> Cell<'static> {
    value.map_or(Cell::Empty, |value| Cell::Number(if value.is_finite() { value } else { f64::NAN }))
}

/// Root mean square over the cameras that saw the person.
fn rms(residuals: &[Option<f64>]) -> Option<f64> {
    let seen: Vec<f64> = residuals.iter().flatten().copied().collect();
    (!seen.is_empty()).then(|| (seen.iter().map(|r| r * r).sum::<f64>() / seen.len() as f64).sqrt())
}
