//! `angles.mot`: the coordinates of the mean pose under the names of a convention, OpenSim's unless another is chosen.
//!
//! What they are: [`crate::results::joint_angles`]. Their intervals are in `angles.csv`.

use super::partial::{PartialFile, Place};
use super::pose::Pose;
use crate::Error;
use crate::results::estimate::{FrameEstimate, RunInfo};
use crate::results::joint_angles::Source;
use sinew_formats::{mot, trc};

pub(crate) struct Coordinates {
    sources: Vec<(usize, Source)>,
    names: Vec<String>,
    pub(crate) file: PartialFile,
}

const TITLE: &str = "Coordinates";

impl Coordinates {
    pub(crate) fn open(place: &Place<'_>, info: &RunInfo) -> Result<Self, Error> {
        let columns = info.angles.columns.clone();
        let sources = columns.iter().map(|(names, source)| (names.len(), source.clone())).collect();
        let names = columns.into_iter().flat_map(|(names, _)| names).collect::<Vec<_>>();
        let file = place.file("angles.mot", |out| mot::write_header(out, TITLE, &names, 0))?;
        Ok(Self { sources, names, file })
    }

    pub(crate) fn append(&mut self, estimate: &FrameEstimate, pose: &Pose) -> Result<(), Error> {
        let mut values = Vec::with_capacity(self.names.len());
        let mut angles = estimate.angles.iter().map(|angle| angle.of_mean_pose.to_degrees());
        for (count, source) in &self.sources {
            match source {
                Source::Middle([a, b]) => {
                    let middle = [0, 1, 2].map(|k| 0.5 * (pose.origins[*a][k] + pose.origins[*b][k]));
                    values.extend(trc::trc_from_world(middle));
                }
                Source::Angles(_) => values.extend(angles.by_ref().take(*count)),
                Source::Length { dof } => values.push(estimate.mean_state[*dof]),
            }
        }
        self.file.write(|out| mot::write_row(out, estimate.time_s, &values))
    }

    pub(crate) fn finish(mut self, frames: u64) -> Result<PartialFile, Error> {
        let frames = u32::try_from(frames).unwrap_or(u32::MAX);
        self.file.rewrite_start(|out| mot::write_header(out, TITLE, &self.names, frames))?;
        Ok(self.file)
    }
}
