//! The joints of a motion file as points at a rate.

use super::content::Content;
use super::error::MotionError;
use super::format::Format;
use super::read::{AMC_RATE_HZ, read};
use crate::Error;
use crate::{cmu, recorded};
use sinew_body::points::Trajectories;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::{amc, asf};
use sinew_input::files;
use std::path::Path;

/// Joints over time.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedJoints {
    /// The evaluation joints and what else is known, at the rate that was wanted.
    pub motion: Trajectories,
    /// Frames per second of the file.
    pub recorded_hz: f64,
    /// What was odd, and what was assumed.
    pub warnings: Vec<String>,
}

/// Reads a motion; `skeleton` is the ASF file of an AMC file, `fps` the rate of files that have none. `rate_of` gives the rate that is wanted, from that of the file.
///
/// # Errors
/// What [`read`] refuses; [`MotionError::NoPoints`]; [`MotionError::Joints`] for files without one of the joints, or with a joint that is missing in a frame.
pub fn recorded_joints(
    path: &Path,
    skeleton: Option<&Path>,
    fps: Option<f64>,
    rate_of: impl Fn(f64) -> f64,
) -> Result<RecordedJoints, Error> {
    if let (Format::Amc, Some(skeleton)) = (Format::of(path)?, skeleton) {
        let (skeleton, motion) = acclaim(path, skeleton)?;
        let warnings = motion.warnings.iter().map(ToString::to_string).collect();
        let recorded_hz = fps.unwrap_or(AMC_RATE_HZ);
        let motion = cmu::joints(&skeleton, &motion, recorded_hz / rate_of(recorded_hz));
        return Ok(RecordedJoints { motion, recorded_hz, warnings });
    }
    let motion = read(path, skeleton, fps)?;
    let table = motion.points().ok_or_else(|| MotionError::NoPoints { path: path.to_owned() })?;
    let is_skeleton = matches!(motion.content, Content::Skeleton(_));
    let recorded_hz = motion.rate_hz;
    let (found, assumed) = recorded::from_points(&table, recorded_hz, !is_skeleton, rate_of(recorded_hz))
        .map_err(|problem| MotionError::Joints { path: path.to_owned(), problem })?;
    let assumed = assumed.map(|unit| format!("{} is taken to be in {unit}, by the length of its legs", path.display()));
    let odd = if is_skeleton { vec![] } else { motion.warnings };
    Ok(RecordedJoints { motion: found, recorded_hz, warnings: odd.into_iter().chain(assumed).collect() })
}

/// An AMC file and its skeleton.
fn acclaim(path: &Path, skeleton: &Path) -> Result<(asf::Asf, amc::Amc), sinew_results::Error> {
    let skeleton = asf::read(&skeleton.display().to_string(), &files::read_text(skeleton, MAX_TEXT_BYTES)?)?;
    let motion = amc::read(&path.display().to_string(), &files::read_text(path, MAX_TEXT_BYTES)?, &skeleton)?;
    Ok((skeleton, motion))
}
