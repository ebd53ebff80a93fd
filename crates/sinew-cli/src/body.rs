//! `sinew body`: a body as a tree of links.
//!
//! Each with its joints, length and points; then the solids of the flesh.

use super::answer_args::Answer;
use super::ended::Ended;
use super::error::Error;
use super::report;
use serde_json::json;
use sinew::bodies;
use sinew::body::flesh::Flesh;
use sinew::body::{KinematicTree, Proportions};

/// Prints a body.
pub(crate) fn run(name: &str, answer: Answer) -> Result<Ended, Error> {
    let body = bodies::to_track(name)?;
    let tree = body.tree(&Proportions::default());
    // A body without flesh is good for keypoints.
    print(name, &tree, body.flesh(&tree).ok().as_ref(), answer)?;
    Ok(Ended::Done)
}

fn print(name: &str, body: &KinematicTree, flesh: Option<&Flesh>, answer: Answer) -> Result<(), Error> {
    let solids = flesh.map_or(&[][..], Flesh::solids);
    if answer.json {
        let link = |index: usize| {
            let link = &body.links()[index];
            let parent = link.parent.map(|parent| body.links()[parent].name.clone());
            let joints = body.dof_names()[body.first_dof(index)..][..link.joints.len()].to_vec();
            json!({ "name": link.name, "parent": parent, "offset_m": link.offset, "degrees_of_freedom": joints })
        };
        let links: Vec<_> = (0..body.links().len()).map(link).collect();
        let point = |point: &sinew::body::Point| json!({ "name": point.name, "link": body.links()[point.link].name, "offset_m": point.offset });
        let points: Vec<_> = body.points().iter().map(point).collect();
        let solid = |solid: &sinew::body::flesh::Solid| {
            json!({
                "name": solid.name,
                "link": body.links()[solid.link].name,
                "base_m": solid.base,
                "axes": solid.axes,
                "height_m": solid.frustum.height,
                "radii_m": solid.frustum.radii,
                "ratio": solid.frustum.ratio,
            })
        };
        let solids: Vec<_> = solids.iter().map(solid).collect();
        return report::answer_json(
            &json!({ "name": name, "degrees_of_freedom": body.dof(), "links": links, "points": points, "solids": solids }),
        );
    }
    let mut text = format!(
        "{name}: {} links, {} degrees of freedom, {} points\n",
        body.links().len(),
        body.dof(),
        body.points().len()
    );
    for index in (0..body.links().len()).filter(|&index| body.links()[index].parent.is_none()) {
        branch(body, index, "", "", &mut text);
    }
    if !solids.is_empty() {
        text.push_str("solids: height, half width at base and top, depth over width\n");
    }
    let width = solids.iter().map(|solid| solid.name.chars().count()).max().unwrap_or_default();
    for solid in solids {
        let (link, [base, top]) = (&body.links()[solid.link].name, solid.frustum.radii);
        let on = if *link == solid.name { String::new() } else { format!("  on {link}") };
        let (height, ratio) = (solid.frustum.height, solid.frustum.ratio);
        text += &format!("{:width$}  {height:.3} m  {base:.3} to {top:.3} m  {ratio:.2}{on}\n", solid.name);
    }
    report::answer(&text)
}

/// A link and all below it; `lead` starts its own line, `rest` those below.
fn branch(body: &KinematicTree, index: usize, lead: &str, rest: &str, text: &mut String) {
    let link = &body.links()[index];
    let [x, y, z] = link.offset;
    let length = x.hypot(y).hypot(z);
    let first = body.first_dof(index);
    let names = body.dof_names();
    let joints: Vec<&str> =
        names[first..first + link.joints.len()].iter().filter_map(|name| name.rsplit('.').next()).collect();
    let mut line = format!("{lead}{}", link.name);
    if !joints.is_empty() {
        line += &format!(
            "  [{}: {}]",
            if joints.len() == 1 { first.to_string() } else { format!("{first}-{}", first + joints.len() - 1) },
            joints.join(" ")
        );
    }
    if length > 0.0 {
        line += &format!("  {length:.3} m from its parent");
    }
    let points: Vec<&str> =
        body.points().iter().filter(|point| point.link == index).map(|point| point.name.as_str()).collect();
    if !points.is_empty() {
        line += &format!("  · {}", points.join(" "));
    }
    text.push_str(&line);
    text.push('\n');
    let children: Vec<usize> =
        (0..body.links().len()).filter(|&child| body.links()[child].parent == Some(index)).collect();
    for (i, &child) in children.iter().enumerate() {
        let (own, below) = if i + 1 == children.len() { ("└─ ", "   ") } else { ("├─ ", "│  ") };
        branch(body, child, &format!("{rest}{own}"), &format!("{rest}{below}"), text);
    }
}
