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
