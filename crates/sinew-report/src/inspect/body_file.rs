//! What a body file and a mapping of keypoints hold.

use super::facts::{Facts, Odd, shortened};
use crate::Error;
use sinew::files::read_text;
use sinew::input::recording::check_layout;
use sinew_body::standard::h32;
use sinew_body::{KinematicTree, Proportions};
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_formats::{body_toml, layout};
use std::path::Path;

pub(super) fn body(path: &Path) -> Result<Facts, Error> {
    let body_toml::BodyDefinition { tree: body, flesh } =
        body_toml::read(&path.display().to_string(), &read_text(path, MAX_CONFIG_BYTES)?)?;
    let mut facts = Facts::new(format!("{}: body of {} links", path.display(), body.links().len()));
    let moving = body.links().iter().filter(|link| !link.joints.is_empty()).count();
    facts.row("joints", moving.to_string());
    facts.row("degrees of freedom", body.dof().to_string());
    facts.row("points", format!("{}: {}", body.points().len(), shortened(&point_names(&body))));
    if let Some(flesh) = flesh {
        let names: Vec<String> = flesh.solids().iter().map(|solid| solid.name.clone()).collect();
        facts.row("solids", format!("{}: {}", names.len(), shortened(&names)));
    }
    Ok(facts)
}

pub(super) fn mapping(path: &Path) -> Result<Facts, Error> {
    let layout = layout::read(&path.display().to_string(), &read_text(path, MAX_CONFIG_BYTES)?)?;
    let known = point_names(&h32(&Proportions::default()));
    let (used, unused): (Vec<String>, Vec<String>) =
        layout.points.iter().flatten().cloned().partition(|name| known.contains(name));
    let mut facts = Facts::new(format!("{}: mapping of {} keypoints", path.display(), layout.points.len()));
    facts.row("known", format!("{}: {}", used.len(), shortened(&used)));
    if !unused.is_empty() {
        facts.odd.push(format!("points that the body h32 lacks, ignored: {}", shortened(&unused)).into());
    }
    facts.odd.extend(check_layout(&layout).err().map(|error| Odd::Words(error.to_string())));
    Ok(facts)
}

fn point_names(body: &KinematicTree) -> Vec<String> {
    body.points().iter().map(|point| point.name.clone()).collect()
}
