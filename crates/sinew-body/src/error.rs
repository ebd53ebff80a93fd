//! What can be wrong with a body or a request for a pose.

/// Everything that this crate refuses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A tree needs at least one link.
    #[error("the body has no links; give at least one")]
    EmptyTree,
    /// Links must come after their parents.
    #[error("link `{link}`: its parent has index {parent}; parents must come before their children")]
    ParentNotBefore {
        /// Link at fault.
        link: String,
        /// Parent index found.
        parent: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what} is not a finite number")]
    NotFinite {
        /// The value at fault.
        what: String,
    },
    /// A vector that is no direction.
    #[error("the axis {vector:?} of a joint is no unit vector; `Axis::along` makes one of any vector but zero")]
    NoAxis {
        /// The vector found.
        vector: [f64; 3],
    },
    /// A rest rotation that is none.
    #[error("link `{link}`: the rest rotation is no rotation; its rows must be a right-handed frame of unit vectors")]
    NoRotation {
        /// Link at fault.
        link: String,
    },
    /// A parent that no link before has as its name.
    #[error("link `{link}`: no link before it is named `{parent}`; parents must come before their children")]
    NoSuchParent {
        /// Link at fault.
        link: String,
        /// Name found.
        parent: String,
    },
    /// A name of no joint.
    #[error("link `{link}`: unknown joint `{joint}`; a joint is tx, ty, tz, rx, ry or rz")]
    NoSuchJoint {
        /// Link at fault.
        link: String,
        /// Name found.
        joint: String,
    },
    /// Two links or two points share a name.
    #[error("the name `{name}` is used twice; names of links and of points must be unique")]
    DuplicateName {
        /// The shared name.
        name: String,
    },
    /// A point is fixed to a link that does not exist.
    #[error("point `{point}` is fixed to link {link}, which does not exist")]
    NoSuchLink {
        /// Point at fault.
        point: String,
        /// Link index found.
        link: usize,
    },
    /// Trajectories without a point of a name.
    #[error("the motion has no {0}")]
    NoPoint(String),
    /// Flesh needs at least one solid.
    #[error("the body has no solids; give at least one")]
    NoSolid,
    /// A solid that cannot be part of a body.
    #[error("solid `{solid}`: {what}")]
    BadSolid {
        /// Solid at fault.
        solid: String,
        /// What is wrong.
        what: &'static str,
    },
}
