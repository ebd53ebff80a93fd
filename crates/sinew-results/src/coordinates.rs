//! `angles.mot`: the coordinates of the mean pose under the names of a convention, OpenSim's unless another is chosen.
//!
//! What they are: [`sinew_angles`]. Their intervals are in `angles.csv`.

use super::partial::{FilePlace, PartialFile};
use crate::Error;
use crate::estimate::{FrameEstimate, RunInfo};
use sinew_angles::CoordinateSource;
use sinew_formats::{mot, trc};
use sinew_setup::posed_body::Pose;

pub(crate) struct Coordinates {
    sources: Vec<(usize, CoordinateSource)>,
    names: Vec<String>,
    pub(crate) file: PartialFile,
}

const TITLE: &str = "Coordinates";

impl Coordinates {
    pub(crate) fn open(place: &FilePlace<'_>, info: &RunInfo) -> Result<Self, Error> {
        let columns = info.angles.columns();
        let sources = columns.iter().map(|(names, source)| (names.len(), source.clone())).collect();
        let names = columns.iter().flat_map(|(names, _)| names.clone()).collect::<Vec<_>>();
        let file = place.file("angles.mot", |out| mot::write_header(out, TITLE, &names, 0))?;
        Ok(Self { sources, names, file })
    }

    pub(crate) fn append(&mut self, estimate: &FrameEstimate, pose: &Pose) -> Result<(), Error> {
        let mut values = Vec::with_capacity(self.names.len());
        let mut angles = estimate.angles.iter().map(|angle| angle.pose.to_degrees());
        for (count, source) in &self.sources {
            match source {
                CoordinateSource::Middle([a, b]) => {
                    let middle = [0, 1, 2].map(|k| 0.5 * (pose.origins[*a][k] + pose.origins[*b][k]));
                    values.extend(trc::trc_from_world(middle));
                }
                CoordinateSource::Angles(_) => values.extend(angles.by_ref().take(*count)),
                CoordinateSource::Length { dof } => values.push(estimate.mean_state[*dof]),
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

#[cfg(test)]
mod tests {
    use sinew_angles::{Convention, JointAngles};
    use sinew_body::{Proportions, standard};
    use sinew_formats::rotation::{Matrix, product, transpose};
    use sinew_setup::posed_body::pose;

    /// Flexion, adduction and rotation of a link in another, from the links' places in a posed body.
    fn between(proximal: &Matrix, distal: &Matrix) -> [f64; 3] {
        let m = product(&transpose(proximal), distal);
        [(-m[1][2]).atan2(m[2][2]), m[0][2].asin(), (-m[0][1]).atan2(m[0][0])]
    }

    #[test]
    fn angles_of_a_state_are_angles_between_the_links_of_its_pose() {
        let body = standard::h32(&Proportions::default());
        let state: Vec<f64> = (0..body.dof()).map(|dof| 0.7 * (1.7 * dof as f64).sin()).collect();
        let posed = pose(&body, &state);
        let at = |link: &str| posed.rotations[body.link_index(link).unwrap()];
        let both = [
            (
                Convention::OpenSim,
                ["hip_flexion_r", "hip_adduction_r", "hip_rotation_r"],
                "pelvis",
                "r_thigh",
                [1.0; 3],
            ),
            (Convention::OpenSim, ["arm_flex_l", "arm_add_l", "arm_rot_l"], "girdle", "l_upper_arm", [1.0, -1.0, -1.0]),
            (Convention::Isb, ["neck_flexion", "neck_bending", "neck_rotation"], "girdle", "head", [-1.0, 1.0, 1.0]),
        ];
        for (convention, names, proximal, distal, signs) in both {
            let angles = JointAngles::new(&body, &[], false, convention);
            let mut raw = vec![0.0; angles.raw_count()];
            angles.raw(&state, None, &mut raw);
            for (k, expected) in between(&at(proximal), &at(distal)).into_iter().enumerate() {
                let index = angles.names().iter().position(|name| name == names[k]).unwrap();
                assert!((angles.signed(index, &raw) - signs[k] * expected).abs() < 1e-12, "{}", names[k]);
            }
        }
    }
}
