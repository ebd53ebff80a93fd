//! The motion of a file as points at a rate, for `sinew simulate`.

use sinew::formats::source_text::MAX_TEXT_BYTES;
use sinew::formats::{amc, asf};
use sinew::motion::{self, Content, Format};
use sinew::{Error, files};
use sinew_simulate::cmu::joints;
use sinew_simulate::points::Trajectories;
use sinew_simulate::{NEEDED, recorded};
use std::path::Path;

/// Reads a motion at a rate; `skeleton` is the ASF file of an AMC file. The second value is what was odd, and what was assumed.
///
/// # Errors
/// What [`motion::read`] refuses; [`Error::Input`] for files without points, without one of the joints, or with a joint that is missing in a frame.
pub(crate) fn recorded_motion(
    path: &Path,
    skeleton: Option<&Path>,
    rate_hz: f64,
) -> Result<(Trajectories, Vec<String>), Error> {
    if let (Format::Amc, Some(skeleton)) = (Format::of(path)?, skeleton) {
        let skeleton = asf::read(&skeleton.display().to_string(), &files::read_text(skeleton, MAX_TEXT_BYTES)?)?;
        let motion = amc::read(&path.display().to_string(), &files::read_text(path, MAX_TEXT_BYTES)?, &skeleton)?;
        let warnings = motion.warnings.iter().map(ToString::to_string).collect();
        return Ok((joints(&skeleton, &motion, rate_hz), warnings));
    }
    let motion = motion::read(path, skeleton, None)?;
    let name = path.display();
    let refuse = |what: String, help| Error::Input { message: format!("{name}: {what}"), help };
    let table = motion
        .points()
        .ok_or_else(|| refuse("coordinates without a body tell no points".into(), Some(NEEDED.into())))?;
    let is_skeleton = matches!(motion.content, Content::Skeleton(_));
    let (found, assumed) = recorded::from_points(&table, motion.rate_hz, !is_skeleton, rate_hz)
        .map_err(|error| refuse(error.to_string(), error.help()))?;
    let assumed = assumed.map(|unit| format!("{name} is taken to be in {unit}, by the length of its legs"));
    let odd = if is_skeleton { vec![] } else { motion.warnings };
    Ok((found, odd.into_iter().chain(assumed).collect()))
}
