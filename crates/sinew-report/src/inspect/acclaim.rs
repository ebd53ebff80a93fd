//! What the skeleton and the motion file of an Acclaim recording hold when they come alone.

use super::facts::{Facts, shortened};
use crate::Error;
use sinew::files::read_text;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::{amc, asf};
use std::path::Path;

pub(super) fn skeleton(path: &Path) -> Result<Facts, Error> {
    let asf = asf::read(&path.display().to_string(), &read_text(path, MAX_TEXT_BYTES)?)?;
    let mut facts = Facts::new(format!("{}: Acclaim skeleton of {} bones", path.display(), asf.bones.len()));
    let root_channels = asf.root_channels.len();
    facts.row("degrees of freedom", format!("{}, {root_channels} of them the root's", asf.channels()));
    let angles = if asf.degrees { "degrees" } else { "radians" };
    facts.row("units", format!("1 unit of length is {:.4} m, angles in {angles}", asf.metres_per_unit()));
    let names: Vec<String> = asf.bones.iter().map(|bone| bone.name.clone()).collect();
    facts.row("bones", shortened(&names));
    Ok(facts)
}

pub(super) fn motion(path: &Path) -> Result<Facts, Error> {
    let numbers = amc::frame_numbers(&read_text(path, MAX_TEXT_BYTES)?);
    let mut facts = Facts::new(format!("{}: AMC, angles without a skeleton", path.display()));
    match (numbers.first(), numbers.last()) {
        (Some(first), Some(last)) => {
            facts.row("frames", format!("{} ({first}..{})", numbers.len(), last.saturating_add(1)));
        }
        _ => facts.odd.push("no frames; expected a line with the number of each".into()),
    }
    facts.row("skeleton", "in an .asf file: `sinew inspect FILE.asf FILE.amc` looks at both");
    Ok(facts)
}
