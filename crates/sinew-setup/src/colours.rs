//! Colours of the subject's parts, as the set-up stores them.

use serde::{Deserialize, Serialize};
use sinew_body::flesh::Flesh;
use sinew_observe::Camera;
use sinew_observe::silhouettes::colour_histogram::{Counts, LEVELS, Reference};

/// Version of the table.
pub const VERSION: u32 = 1;
/// Largest count of a colour.
const MOST_PIXELS: u32 = 1_000_000;

/// What was counted in the pictures of some frames.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredColours {
    /// Version of this table.
    pub version: u32,
    /// Frames whose pictures were counted.
    pub frames: Vec<u64>,
    /// Parts that a camera saw, camera by camera.
    pub part: Vec<PartColours>,
}

/// Colours of a part of the body in a camera.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartColours {
    /// Name of the camera in the calibration.
    pub camera: String,
    /// Name of the solid.
    pub name: String,
    /// Levels of red, green and blue, each from 0 to 7, and how many pixels had them; rising by colour.
    pub pixels: Vec<[u32; 4]>,
}

impl PartColours {
    /// The colours that were counted of a part.
    #[must_use]
    pub fn of(camera: &str, name: &str, counts: &Counts) -> Self {
        let pixels = counts.levels().map(|([r, g, b], count)| [r.into(), g.into(), b.into(), count]);
        Self { camera: camera.into(), name: name.into(), pixels: pixels.collect() }
    }

    fn reference(&self) -> Option<Reference> {
        let level = |&[r, g, b, count]: &[u32; 4]| ([r, g, b].map(|level| level.min(255) as u8), count);
        Counts::from_levels(self.pixels.iter().map(level))?.reference()
    }

    /// The first entry that cannot be, if any.
    fn wrong_entry(&self) -> Option<[u32; 4]> {
        let is_right = |[r, g, b, count]: [u32; 4]| {
            [r, g, b].iter().all(|&level| (level as usize) < LEVELS) && (1..=MOST_PIXELS).contains(&count)
        };
        let falls = self.pixels.windows(2).find(|pair| pair[0][..3] >= pair[1][..3]).map(|pair| pair[1]);
        self.pixels.iter().copied().find(|entry| !is_right(*entry)).or(falls)
    }
}

impl MeasuredColours {
    /// For each camera and solid the colours to be found again.
    #[must_use]
    pub fn references(&self, cameras: &[Camera], flesh: &Flesh) -> Vec<Vec<Option<Reference>>> {
        let reference = |camera: &Camera, solid: &str| {
            let known = self.part.iter().find(|part| part.camera == camera.name && part.name == solid);
            known.and_then(PartColours::reference)
        };
        let solids = flesh.solids();
        cameras.iter().map(|camera| solids.iter().map(|solid| reference(camera, &solid.name)).collect()).collect()
    }

    /// Whether no colour was counted, but greys alone.
    #[must_use]
    pub fn are_grey(&self) -> bool {
        self.part.iter().flat_map(|part| &part.pixels).all(|[r, g, b, _]| r == g && g == b)
    }

    /// What cannot be about them, if anything, for the names of a set-up's cameras and the solids of its body.
    #[must_use]
    pub fn problem(&self, cameras: &[&str], flesh: &Flesh) -> Option<String> {
        if self.version != VERSION {
            return Some(format!(
                "colours: version = {}; this version reads {VERSION}: make the set-up again",
                self.version
            ));
        }
        let parts: Vec<&str> = flesh.solids().iter().map(|solid| solid.name.as_str()).collect();
        self.part.iter().enumerate().find_map(|(place, part)| {
            let PartColours { camera, name, .. } = part;
            if !cameras.contains(&camera.as_str()) {
                return Some(format!("colours: no camera `{camera}`; the set-up has: {}", cameras.join(", ")));
            }
            if !parts.contains(&name.as_str()) {
                return Some(format!("colours: the body has no part `{name}`; it has: {}", parts.join(", ")));
            }
            if self.part[..place].iter().any(|former| former.camera == *camera && former.name == *name) {
                return Some(format!("colours: part `{name}` of camera `{camera}` is there twice"));
            }
            let entry = part.wrong_entry()?;
            Some(format!(
                "colours: part `{name}` of camera `{camera}`: pixels {entry:?}; must be levels from 0 to {} and a count \
                 from 1 to {MOST_PIXELS}, rising by colour",
                LEVELS - 1
            ))
        })
    }
}
