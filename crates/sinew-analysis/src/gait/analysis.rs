//! What is read from the gait of a person.

use super::cycles::AngleCycle;
use super::events::GaitEvent;
use super::strides::Stride;

/// The gait of a person.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GaitAnalysis {
    /// Events of both feet, in the order of time.
    pub events: Vec<GaitEvent>,
    /// Number of the frame of each, with its fraction.
    pub event_frames: Vec<f64>,
    /// Strides of both sides, in the order of time.
    pub strides: Vec<Stride>,
    /// Angles over the cycle.
    pub cycles: Vec<AngleCycle>,
    /// What a reader should know of it.
    pub warnings: Vec<String>,
}
