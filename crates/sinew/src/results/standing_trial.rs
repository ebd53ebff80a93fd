//! A run of a standing trial, read back as the zero of angles: what `--static` takes ([`sinew_angles::zero`]).
//!
//! TRIAL is the result folder of a run of that trial, of the same person. With the set-up of the standing trial (`--setup TRIAL/setup.toml`) draw i of both runs is of the same constants: what lasts, such as the place of a keypoint on its link, is
//! in both and goes with the difference. With a set-up of its own, draws are paired as they come, and what lasts counts twice. Draws of a smoothed run are trajectories; of a filtered one, draws
//! of different frames share what lasts and nothing else, so that what is left of their own errors in the mean over the trial counts too little.

use super::error::ResultsError;
use super::people::refuse_several;
use super::stored_array::stored_array;
use crate::setup::{MeasuredErrors, Setup};
use crate::{Error, files};
use sinew_angles::zero::mean_directions;
use sinew_angles::{AngleZero, Convention, JointAngles};
use sinew_body::Joint;
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use std::path::Path;

/// Angles of a standing trial.
#[derive(Clone, Debug, PartialEq)]
pub struct StandingTrial {
    names: Vec<String>,
    /// Mean directions over the frames, radians: a row for each draw, a number for each name.
    drawn: Vec<f64>,
    lasting: Option<MeasuredErrors>,
}

impl StandingTrial {
    /// Reads the run of a standing trial.
    ///
    /// # Errors
    /// A folder without a summary or without draws; files that cannot be read.
    pub fn read(folder: &Path, convention: Convention) -> Result<Self, Error> {
        refuse_several(folder)?;
        if !folder.join("summary.json").exists() {
            std::fs::read_dir(folder).map_err(Error::io("read", folder))?;
            return Err(ResultsError::NoSummary(folder.to_owned()).into());
        }
        let path = folder.join("setup.toml");
        let setup = Setup::from_toml(&path.display().to_string(), &files::read_text(&path, MAX_CONFIG_BYTES)?)?;
        let tree = setup.tree();
        let is_rotation = |(_, (_, joint)): &(usize, (usize, Joint))| matches!(joint, Joint::Rotate(_));
        let rotations: Vec<usize> = tree.joints().enumerate().filter(is_rotation).map(|(dof, _)| dof).collect();
        let array = stored_array(folder, "posterior/angle")?.filter(|array| {
            array.shape.len() == 4 && array.shape[3] == rotations.len() && array.values.iter().all(|x| x.is_finite())
        });
        let array = array.filter(|array| !array.values.is_empty());
        let array = array.ok_or_else(|| ResultsError::NoDraws(folder.to_owned()))?;
        let angles = JointAngles::new(&tree, &[], true, convention);
        let state = |values: &[f64]| {
            let mut state = vec![0.0; tree.dof()];
            rotations.iter().zip(values).for_each(|(dof, angle)| state[*dof] = *angle);
            state
        };
        let drawn = array.values.chunks_exact(array.shape[2] * rotations.len()).flat_map(|draw| {
            let states: Vec<Vec<f64>> = draw.chunks_exact(rotations.len()).map(state).collect();
            mean_directions(&angles, states.iter().map(Vec::as_slice))
        });
        Ok(Self { drawn: drawn.collect(), names: angles.names().to_vec(), lasting: setup.lasting })
    }

    /// The zero of some angles, for a run with a set-up that knows this of what is constant.
    #[must_use]
    pub fn zero(&self, angles: &JointAngles, lasting: Option<&MeasuredErrors>) -> AngleZero {
        let shared = lasting.filter(|own| Some(*own) == self.lasting.as_ref()).map(MeasuredErrors::draws);
        AngleZero::new(angles, &self.names, &self.drawn, shared)
    }
}
