//! How well a tracked body covers the silhouettes of a camera.

use serde::{Deserialize, Serialize};

/// How well the tracked body covers one camera's silhouettes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SilhouetteOverlap {
    /// Frames with a silhouette.
    pub frames: u64,
    /// Mean over them of the share of the body's pixels that are the silhouette's.
    pub precision: f64,
    /// Mean over them of the share of the silhouette's pixels that are the body's.
    pub recall: f64,
}
