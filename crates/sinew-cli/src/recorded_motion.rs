//! The motion of a file as points at a rate, for `sinew simulate`.

use super::error::Error;
use sinew::files;
use sinew::formats::source_text::MAX_TEXT_BYTES;
use sinew::formats::{amc, asf};
use sinew_motion::cmu::joints;
use sinew_motion::points::Trajectories;
use sinew_motion::recorded;
use sinew_tools::motion::{self, Content, Format};
use std::path::Path;

/// Reads a motion at a rate; `skeleton` is the ASF file of an AMC file. The second value is what was odd, and what was assumed.
///
/// # Errors
/// What [`motion::read`] refuses; [`Error::NoPoints`]; [`Error::Motion`] for files without one of the joints, or with a joint that is missing in a frame.
pub(crate) fn recorded_motion(
    path: &Path,
    skeleton: Option<&Path>,
    rate_hz: f64,
) -> Result<(Trajectories, Vec<String>), Error> {
    if let (Format::Amc, Some(skeleton)) = (Format::of(path).map_err(sinew_tools::Error::from)?, skeleton) {
        let (skeleton, motion) = acclaim(path, skeleton)?;
        let warnings = motion.warnings.iter().map(ToString::to_string).collect();
        return Ok((joints(&skeleton, &motion, rate_hz), warnings));
    }
    let motion = motion::read(path, skeleton, None)?;
    let name = path.display();
    let table = motion.points().ok_or_else(|| Error::NoPoints(path.to_owned()))?;
    let is_skeleton = matches!(motion.content, Content::Skeleton(_));
    let (found, assumed) = recorded::from_points(&table, motion.rate_hz, !is_skeleton, rate_hz)
        .map_err(|problem| Error::Motion { path: path.to_owned(), problem })?;
    let assumed = assumed.map(|unit| format!("{name} is taken to be in {unit}, by the length of its legs"));
    let odd = if is_skeleton { vec![] } else { motion.warnings };
    Ok((found, odd.into_iter().chain(assumed).collect()))
}

/// An AMC file and its skeleton.
fn acclaim(path: &Path, skeleton: &Path) -> Result<(asf::Asf, amc::Amc), sinew::Error> {
    let skeleton = asf::read(&skeleton.display().to_string(), &files::read_text(skeleton, MAX_TEXT_BYTES)?)?;
    let motion = amc::read(&path.display().to_string(), &files::read_text(path, MAX_TEXT_BYTES)?, &skeleton)?;
    Ok((skeleton, motion))
}
