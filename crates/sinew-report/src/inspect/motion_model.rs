//! What a motion model holds.

use super::facts::Facts;
use crate::Error;
use sinew::files::read_text;
use sinew_dynamics::primitives::file;
use sinew_dynamics::primitives::model::PrimitiveModel;
use sinew_dynamics::primitives::summary::summary;
use sinew_motion::learn::LearnError;
use std::path::Path;

/// Reads a motion model.
///
/// # Errors
/// A file that cannot be read or is none.
pub(super) fn read(path: &Path) -> Result<PrimitiveModel, Error> {
    let text = read_text(path, file::MAX_BYTES)?;
    Ok(file::read(&path.display().to_string(), &text).map_err(LearnError::Model)?)
}

pub(super) fn facts(path: &Path) -> Result<Facts, Error> {
    let model = read(path)?;
    let mut facts = Facts::new(format!("{}: motion model of action primitives", path.display()));
    facts.row("body", format!("{}, {} degrees of freedom", model.state, model.dim));
    facts.row("rate", format!("{} frames per second", model.frame_rate));
    facts.row("primitive", format!("{} frames", model.length));
    for primitives in &model.primitives {
        let found = summary(primitives, &[], model.dim).map_err(LearnError::Learning)?;
        facts.row(
            format!("vector {}", found.feature),
            format!(
                "{} angles, {} windows, {} of {} clusters ({} with ten windows or more), {:.1} % of the variance",
                found.coordinates,
                found.windows,
                found.clusters,
                found.requested,
                found.well_filled,
                100.0 * found.share
            ),
        );
        if !primitives.clustering.converged {
            let iterations = primitives.clustering.iterations;
            facts
                .odd
                .push(format!("{}: clustering had not converged after {iterations} iterations", found.feature).into());
        }
    }
    Ok(facts)
}
