//! What two bodies must share to share their code: everything but the sizes.

use crate::tree::{Axis, Joint, KinematicTree};
use std::fmt::Write;

/// Links, joints and points as text: a link is its parent, its joints, which components of its offset are not zero, then the same of each of its points; `points` as in [`super::Plan::new`]. Links with rest rotations and free axes are those of no built-in body.
pub fn structure(tree: &KinematicTree, points: &[usize]) -> String {
    let mut text = String::new();
    for (index, link) in tree.links().iter().enumerate() {
        let parent = link.parent.map_or(String::from("-"), |parent| parent.to_string());
        let rest = if link.rest.is_some() { "rest " } else { "" };
        let joints: String = link.joints.iter().map(|joint| letter(*joint)).collect();
        let own = points.iter().map(|&p| &tree.points()[p]).filter(|point| point.link == index);
        let masks: String = own.map(|point| format!(" {}", mask(&point.offset))).collect();
        let _ = writeln!(text, "{parent} {rest}{joints} {}{masks}", mask(&link.offset));
    }
    text
}

/// Translations in small letters, rotations in capitals.
const fn letter(joint: Joint) -> char {
    match joint {
        Joint::Translate(Axis::X) => 'x',
        Joint::Translate(Axis::Y) => 'y',
        Joint::Translate(Axis::Z) => 'z',
        Joint::Translate(Axis::Free(_)) => 'f',
        Joint::Rotate(Axis::X) => 'X',
        Joint::Rotate(Axis::Y) => 'Y',
        Joint::Rotate(Axis::Z) => 'Z',
        Joint::Rotate(Axis::Free(_)) => 'F',
    }
}

fn mask(offset: &[f64; 3]) -> String {
    offset.iter().map(|&x| if x == 0.0 { '0' } else { '1' }).collect()
}
