//! Draws of the rotations of a run's body, read back from `posterior/angle` of its `posterior.zarr`.

use super::stored_array::stored_array;
use crate::Error;
use crate::setup::Setup;
use sinew_body::{Joint, KinematicTree};
use std::path::Path;

/// Draws of states, of which translations are 0.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleDraws {
    tree: KinematicTree,
    rotations: Vec<usize>,
    frames: usize,
    values: Vec<f64>,
}

impl AngleDraws {
    /// Those in a result folder with this set-up; `None` where there are none, or others than its body has.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn read(folder: &Path, setup: &Setup) -> Result<Option<Self>, Error> {
        let tree = setup.tree();
        let is_rotation = |(_, (_, joint)): &(usize, (usize, Joint))| matches!(joint, Joint::Rotate(_));
        let rotations: Vec<usize> = tree.joints().enumerate().filter(is_rotation).map(|(dof, _)| dof).collect();
        let array = stored_array(folder, "posterior/angle")?.filter(|array| {
            array.shape.len() == 4
                && array.shape[3] == rotations.len()
                && !array.values.is_empty()
                && array.values.iter().all(|x| x.is_finite())
        });
        Ok(array.map(|array| Self { frames: array.shape[2], values: array.values, tree, rotations }))
    }

    /// The body.
    #[must_use]
    pub const fn tree(&self) -> &KinematicTree {
        &self.tree
    }

    /// Frames of each draw.
    #[must_use]
    pub const fn frames(&self) -> usize {
        self.frames
    }

    /// Draws of each frame.
    #[must_use]
    pub const fn draws(&self) -> usize {
        self.values.len() / (self.frames * self.rotations.len())
    }

    /// The state of a draw in a frame.
    #[must_use]
    pub fn state(&self, draw: usize, frame: usize) -> Vec<f64> {
        let width = self.rotations.len();
        let values = &self.values[(draw * self.frames + frame) * width..][..width];
        let mut state = vec![0.0; self.tree.dof()];
        self.rotations.iter().zip(values).for_each(|(dof, angle)| state[*dof] = *angle);
        state
    }
}
