//! What is refused of a live run.

use std::net::SocketAddr;

/// Why frames cannot be tracked as they come.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LiveError {
    /// A place from which no frames come.
    #[error("`{0}` is no place for frames to come from; expected `-` or `tcp:127.0.0.1:PORT`")]
    Place(String),
    /// A socket that others than this machine reach.
    #[error("{0} can be reached from elsewhere; frames are taken from this machine only")]
    NotLoopback(SocketAddr),
    /// A socket that cannot be had.
    #[error("tcp:{address} cannot be listened on: {source}")]
    Listen {
        /// The address.
        address: SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// A setting that belongs to a recording on disk.
    #[error("`{0}` has no use where frames come live")]
    OfFiles(&'static str),
    /// No frame to be tracked.
    #[error("no frame came that could be tracked")]
    NoFrame,
    /// Fewer frames than the set-up needs.
    #[error("the frames ended after {found} of {expected} for the set-up")]
    SetupCutShort {
        /// Frames that came.
        found: u64,
        /// Frames wanted.
        expected: u64,
    },
}
