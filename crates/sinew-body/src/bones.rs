//! A body from a table of offsets: a line a bone, as data sheets of skeletons have it.

use crate::Error;
use crate::tree::{Joint, KinematicTree, Link, Point};

/// A line of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bone<'a> {
    /// Its name.
    pub name: &'a str,
    /// Name of the bone that carries it, which stands before it; empty for a root.
    pub parent: &'a str,
    /// Where it begins, in the frame of its parent, metres.
    pub offset: [f64; 3],
    /// Its joints, left to right, with spaces between them: `tx`, `ty`, `tz`, `rx`, `ry`, `rz`. Without any it is rigid, a tip for example.
    pub joints: &'a str,
}

/// The body: a link for each bone, and a point of its name where it begins.
///
/// # Errors
/// [`Error::NoSuchParent`] and [`Error::NoSuchJoint`] for names that are none, and what [`KinematicTree::new`] refuses.
///
/// ```
/// use sinew_body::bones::{Bone, skeleton};
///
/// let bone = |name, parent, offset, joints| Bone { name, parent, offset, joints };
/// let arm = skeleton(&[
///     bone("shoulder", "", [0.0, 0.0, 1.4], "rz ry rx"),
///     bone("elbow", "shoulder", [0.0, 0.0, -0.30], "rx"),
///     bone("wrist", "elbow", [0.0, 0.0, -0.26], ""),
/// ])?;
/// assert_eq!(arm.dof_names(), ["shoulder.rz", "shoulder.ry", "shoulder.rx", "elbow.rx"]);
/// # Ok::<(), sinew_body::Error>(())
/// ```
pub fn skeleton(bones: &[Bone<'_>]) -> Result<KinematicTree, Error> {
    let link = |(index, bone): (usize, &Bone<'_>)| {
        let named = || bones[..index].iter().position(|above| above.name == bone.parent);
        let parent = if bone.parent.is_empty() {
            None
        } else {
            let missing = || Error::NoSuchParent { link: bone.name.into(), parent: bone.parent.into() };
            Some(named().ok_or_else(missing)?)
        };
        let joint = |name: &str| {
            let unknown = || Error::NoSuchJoint { link: bone.name.into(), joint: name.into() };
            Joint::named(name).ok_or_else(unknown)
        };
        let joints = bone.joints.split_whitespace().map(joint).collect::<Result<_, _>>()?;
        Ok(Link::new(bone.name, parent, bone.offset, joints))
    };
    let links = bones.iter().enumerate().map(link).collect::<Result<_, Error>>()?;
    let point = |(link, bone): (usize, &Bone<'_>)| Point { name: bone.name.into(), link, offset: [0.0; 3] };
    KinematicTree::new(links, bones.iter().enumerate().map(point).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_are_none_are_refused_with_what_to_write() {
        let bone = |name, parent, joints| Bone { name, parent, offset: [0.0; 3], joints };
        let fault = |bones: &[Bone<'_>]| skeleton(bones).unwrap_err().to_string();
        assert_eq!(
            fault(&[bone("hip", "", "tx rq")]),
            "link `hip`: unknown joint `rq`; a joint is tx, ty, tz, rx, ry or rz"
        );
        assert_eq!(
            fault(&[bone("knee", "hip", "rx"), bone("hip", "", "")]),
            "link `knee`: no link before it is named `hip`; parents must come before their children"
        );
        assert_eq!(fault(&[]), Error::EmptyTree.to_string());
        assert_eq!(fault(&[bone("hip", "", ""), bone("hip", "", "")]), Error::DuplicateName { name: "hip".into() }.to_string());
    }
}
