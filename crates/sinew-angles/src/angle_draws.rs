//! Draws of the rotations of a body over the frames of a run.

use sinew_body::{Joint, KinematicTree};

/// Draws of states, of which translations are 0.
#[derive(Clone, Debug, PartialEq)]
pub struct AngleDraws {
    tree: KinematicTree,
    rotations: Vec<usize>,
    frames: usize,
    values: Vec<f64>,
}

impl AngleDraws {
    /// From an array of chain, draw, frame and rotation of a body, radians; `None` for other shapes, none at all, and numbers that are not finite.
    #[must_use]
    pub fn new(tree: KinematicTree, shape: &[usize], values: Vec<f64>) -> Option<Self> {
        let is_rotation = |(_, (_, joint)): &(usize, (usize, Joint))| matches!(joint, Joint::Rotate(_));
        let rotations: Vec<usize> = tree.joints().enumerate().filter(is_rotation).map(|(dof, _)| dof).collect();
        let [_, _, frames, width] = *shape else { return None };
        let is_whole = width == rotations.len()
            && !values.is_empty()
            && shape.iter().product::<usize>() == values.len()
            && values.iter().all(|x| x.is_finite());
        is_whole.then_some(Self { tree, rotations, frames, values })
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

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::{Proportions, standard};

    #[test]
    fn states_have_the_rotations_of_their_draw_and_frame() {
        let tree = standard::h32(&Proportions::default());
        let width = tree.joints().filter(|(_, joint)| matches!(joint, Joint::Rotate(_))).count();
        let shape = [1, 2, 3, width];
        let values: Vec<f64> = (0..6 * width).map(|k| k as f64).collect();
        let draws = AngleDraws::new(tree.clone(), &shape, values.clone()).unwrap();
        assert_eq!((draws.draws(), draws.frames()), (2, 3));
        let first = draws.state(1, 2).into_iter().find(|x| *x != 0.0);
        assert_eq!(first, Some((5 * width) as f64));
        for shape in [&shape[..3], &[1, 2, 3, width - 1], &[1, 2, 4, width]] {
            assert!(AngleDraws::new(tree.clone(), shape, values.clone()).is_none());
        }
        assert!(AngleDraws::new(tree, &shape, vec![f64::NAN; 6 * width]).is_none());
    }
}
