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

impl LiveError {
    /// Code with which a program ends; the table is that of [`crate::Error`].
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Place(_) | Self::NotLoopback(_) | Self::OfFiles(_) => 2,
            Self::NoFrame | Self::SetupCutShort { .. } => 3,
            Self::Listen { .. } => 5,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        match self {
            Self::Place(_) => "`--live -` reads standard input, `--live tcp:127.0.0.1:7777` a socket",
            Self::NotLoopback(_) => {
                "listen on 127.0.0.1 or [::1], and bring frames of other machines there by a tunnel"
            }
            Self::Listen { .. } => "choose another port; 0 takes one that is free",
            Self::OfFiles(_) => "leave it out, or track a recording without `--live`",
            Self::NoFrame => "send one line a frame: {\"frame\": 0, \"cameras\": {\"cam1\": {\"people\": [...]}}}",
            Self::SetupCutShort { .. } => {
                "give a set-up of an earlier run (`--setup`), or fewer seconds (`--setup-seconds`)"
            }
        }
    }
}
