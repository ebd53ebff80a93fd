//! A body with its flesh, flattened for projection.

use crate::silhouettes::outline::FRAME;
use sinew_body::flesh::Flesh;
use sinew_body::frustum::Frustum;
use sinew_body::{Error, KinematicTree, Plan};
use sinew_core::part::{Part, PartTree, Partition};

/// Most solids of a body: sets of them are bits of a word.
pub const MOST_SOLIDS: usize = 32;

/// The parts of a body that trackers choose one by one, and that image likelihoods judge: its solids, each with its coordinates.
///
/// # Errors
/// Solids of which one has no coordinate of its own.
pub fn part_tree(tree: &KinematicTree, flesh: &Flesh) -> Result<PartTree, sinew_core::Error> {
    let parts = flesh.coordinates(tree).into_iter().map(|part| Part::new(part, tree.dof()));
    let partition = Partition::new(parts.collect::<Result<_, _>>()?, tree.dof())?;
    PartTree::new(partition, flesh.parents().to_vec())
}

/// Kinematics and solids of a body.
#[derive(Clone, Debug)]
pub struct SolidBody {
    pub(crate) plan: Plan,
    pub(crate) solids: Vec<Frustum>,
    /// For each solid the set of those that it hangs on or that hang on it.
    pub(crate) adjacent: Vec<u32>,
}

impl SolidBody {
    /// The solids of a tree.
    ///
    /// # Errors
    /// More than [`MOST_SOLIDS`]; names that points of the tree have.
    pub fn new(tree: &KinematicTree, flesh: &Flesh) -> Result<Self, Error> {
        let solids = flesh.solids();
        if let Some(solid) = solids.get(MOST_SOLIDS) {
            return Err(Error::BadSolid { solid: solid.name.clone(), what: "a body may have 32 solids at most" });
        }
        let (with_frames, first) = flesh.with_frames(tree)?;
        let points: Vec<usize> = (first..first + 4 * solids.len()).collect();
        let mut adjacent = vec![0; solids.len()];
        for (solid, parent) in flesh.parents().iter().enumerate() {
            if let Some(parent) = *parent {
                adjacent[solid] |= 1 << parent;
                adjacent[parent] |= 1 << solid;
            }
        }
        Ok(Self {
            plan: Plan::new(&with_frames, &points),
            solids: solids.iter().map(|s| s.frustum).collect(),
            adjacent,
        })
    }

    /// Degrees of freedom.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.plan.dof()
    }

    /// Number of solids.
    #[must_use]
    pub fn count(&self) -> usize {
        self.solids.len()
    }

    /// Blocks that frames of all solids take.
    pub(crate) fn frame_blocks(&self) -> usize {
        FRAME * self.solids.len()
    }
}
