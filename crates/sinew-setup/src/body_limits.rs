//! Soft limits of the joints of a body: [`JointLimits`] on the ranges of motion of adults ([`sinew_body::motion_ranges`]).

use sinew_core::density::Lanes;
use sinew_core::lanes::Isa;
use sinew_dynamics::Error;
use sinew_dynamics::joint_limits::{JointLimits, SIGMA_RAD};
use sinew_dynamics::joint_ranges::JointRanges;

/// The limits of these ranges as a density on its states.
///
/// # Errors
/// Ranges whose ends are in the wrong order.
pub fn body_limits(ranges: Vec<Option<[f64; 2]>>, isa: Isa) -> Result<Lanes<JointLimits>, Error> {
    let ranges = JointRanges::new(ranges)?;
    Ok(Lanes { leaf: JointLimits::new(&ranges, SIGMA_RAD), isa })
}
