//! How a link is turned relative to another, and what is read of it.

use crate::decomposition::{AngleSequence, Matrix, near, turned};
use sinew_body::Axis;
use sinew_body::rotation::product;

/// One or three columns of `angles.mot`.
#[derive(Clone, Debug, PartialEq)]
pub enum CoordinateSource {
    /// Middle of the origins of two links, axes of the marker files.
    Middle([usize; 2]),
    /// Angles of a link.
    Angles(LinkAngles),
    /// A translation of the state.
    Length {
        /// Degree of freedom.
        dof: usize,
    },
}

/// A rotation about an axis of a link by a degree of freedom, or back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTurn {
    /// The axis.
    pub axis: Axis,
    /// Degree of freedom.
    pub dof: usize,
    /// 1, or −1 for the way back.
    pub sign: f64,
}

/// How a link is turned relative to another, and what is read of it.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkAngles {
    /// The link that turns.
    pub link: usize,
    /// From the one to the other, in the order in which they act.
    pub turns: Vec<JointTurn>,
    /// How the rotation is read.
    pub sequence: AngleSequence,
    /// Signs of the three angles.
    pub signs: [f64; 3],
    /// Which of them are columns.
    pub kept: [bool; 3],
}

const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl LinkAngles {
    /// The rotation in a state.
    fn rotation(&self, state: &[f64]) -> Matrix {
        self.turns.iter().fold(IDENTITY, |m, turn| {
            let angle = turn.sign * state[turn.dof];
            match turn.axis.index() {
                Some(axis) => turned(m, axis, angle),
                None => product(&m, &turn.axis.rotation(angle)),
            }
        })
    }

    /// The three angles without their signs, those nearest to the ones before where there are such.
    #[must_use]
    pub fn raw(&self, state: &[f64], before: Option<[f64; 3]>) -> [f64; 3] {
        match (self.sequence, &self.turns[..]) {
            // A hinge counts whole turns itself.
            (AngleSequence::Hinge, [turn]) => [turn.sign * state[turn.dof], 0.0, 0.0],
            (sequence, _) => {
                let angles = sequence.angles(&self.rotation(state));
                before.map_or(angles, |before| near(sequence, angles, before))
            }
        }
    }
}
