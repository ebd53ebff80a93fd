//! Kinematic tree: links in topological order, each with an offset from its parent and an ordered list of joints.
//!
//! With the root at the world origin, link `i` has rotation `R_i` (world from link) and origin `p_i`:
//!
//! ```text
//! R = R_parent · rest,  p = p_parent + R_parent · offset
//! for each joint, left to right:   translate along axis a:  p += R e_a q      rotate about axis a:  R = R · R_a(q)
//! ```
//!
//! An ordered list `z, y, x` of rotations gives `R = R_Z R_Y R_X` (Choo & Fleet 2001, eq. 19). Every joint is one degree of freedom; the degrees of freedom are
//! numbered link by link, left to right. A point fixed to link `b` at `m` lies at `p_b + R_b m`.

use crate::Error;
use crate::rotation::{IDENTITY, Matrix, about, apply, is_rotation, product};

/// Axis of a joint in the link's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Axis {
    /// Subject's right in the standard bodies.
    X,
    /// Forward in the standard bodies.
    Y,
    /// Up in the standard bodies.
    Z,
    /// Any other: a unit vector. [`Axis::along`] makes one of any vector.
    Free([f64; 3]),
}

/// How far from a coordinate axis a direction may be that is taken for it: rounding, no more.
const SNAP: f64 = 1e-15;

impl Axis {
    /// The axis in the direction of a vector; x, y or z where it is one of them.
    ///
    /// # Errors
    /// [`Error::NoAxis`] for a vector that is zero or not finite.
    pub fn along(vector: [f64; 3]) -> Result<Self, Error> {
        let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(length.is_finite() && length > 0.0) {
            return Err(Error::NoAxis { vector });
        }
        // A unit vector keeps its bits, so that what is written reads back equal.
        let unit = if (length - 1.0).abs() < SNAP { vector } else { vector.map(|x| x / length) };
        Ok(Self::Free(unit).snapped())
    }

    /// The coordinate axis that this one is but for rounding; else itself.
    fn snapped(self) -> Self {
        let near = |axis: &Self| (0..3).all(|k| (axis.direction()[k] - self.direction()[k]).abs() < SNAP);
        [Self::X, Self::Y, Self::Z].into_iter().find(near).unwrap_or(self)
    }

    /// 0, 1, 2 for x, y, z; `None` for a free axis.
    #[inline(always)]
    #[must_use]
    pub const fn index(self) -> Option<usize> {
        match self {
            Self::X => Some(0),
            Self::Y => Some(1),
            Self::Z => Some(2),
            Self::Free(_) => None,
        }
    }

    /// Its unit vector.
    #[must_use]
    pub const fn direction(self) -> [f64; 3] {
        match self {
            Self::X => IDENTITY[0],
            Self::Y => IDENTITY[1],
            Self::Z => IDENTITY[2],
            Self::Free(direction) => direction,
        }
    }

    /// Right-handed rotation about it, radians.
    #[must_use]
    pub fn rotation(self, angle: f64) -> Matrix {
        let (s, c) = angle.sin_cos();
        match self {
            Self::X => [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
            Self::Y => [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
            Self::Z => [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
            Self::Free(direction) => about(direction, angle),
        }
    }

    /// The axis in a frame in which that of the link has this rotation.
    pub(crate) fn turned(self, rotation: &Matrix) -> Self {
        Self::Free(apply(rotation, self.direction())).snapped()
    }
}

/// One degree of freedom: a motion along or about one axis of the link's frame so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// Translation in metres.
    Translate(Axis),
    /// Active right-handed rotation in radians.
    Rotate(Axis),
}

/// Names of the joints along and about coordinate axes.
const JOINTS: [(&str, Joint); 6] = [
    ("tx", Joint::Translate(Axis::X)),
    ("ty", Joint::Translate(Axis::Y)),
    ("tz", Joint::Translate(Axis::Z)),
    ("rx", Joint::Rotate(Axis::X)),
    ("ry", Joint::Rotate(Axis::Y)),
    ("rz", Joint::Rotate(Axis::Z)),
];

impl Joint {
    /// The joint of a name: `tx`, `ty`, `tz`, `rx`, `ry` or `rz`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        JOINTS.iter().find(|(known, _)| *known == name).map(|(_, joint)| *joint)
    }

    /// Its name; none about a free axis.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        JOINTS.iter().find(|(_, known)| *known == self).map(|(name, _)| *name)
    }

    /// Its axis.
    #[must_use]
    pub const fn axis(self) -> Axis {
        match self {
            Self::Translate(axis) | Self::Rotate(axis) => axis,
        }
    }
}

/// A rigid part of the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Unique name, for reports and files.
    pub name: String,
    /// Index of the parent link, smaller than this link's own; `None` for a root.
    pub parent: Option<usize>,
    /// Origin in the parent's frame, metres.
    pub offset: [f64; 3],
    /// Rotation in the parent's frame where all joints are at zero; `None` for that of the parent.
    pub rest: Option<Matrix>,
    /// Joints in the order in which they act, left to right.
    pub joints: Vec<Joint>,
}

/// A point fixed to a link: a marker, a joint centre or a face point.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Unique name; keypoint layouts and markers are matched by it.
    pub name: String,
    /// Index of the link that carries it.
    pub link: usize,
    /// Position in that link's frame, metres.
    pub offset: [f64; 3],
}

impl Link {
    /// A link without a rest rotation.
    #[must_use]
    pub fn new(name: impl Into<String>, parent: Option<usize>, offset: [f64; 3], joints: Vec<Joint>) -> Self {
        Self { name: name.into(), parent, offset, rest: None, joints }
    }

    /// The joints, where the link has no rest rotation: what a rule about coordinate axes may look at.
    pub(crate) fn plain_joints(&self) -> Option<&[Joint]> {
        self.rest.is_none().then_some(&self.joints)
    }
}

/// A validated kinematic tree with named points. Immutable; shared freely between threads.
#[derive(Clone, Debug, PartialEq)]
pub struct KinematicTree {
    links: Vec<Link>,
    points: Vec<Point>,
    first_dof: Vec<usize>,
    dof: usize,
}

impl KinematicTree {
    /// Validates links (parents first, unique names, finite offsets, rest rotations that are rotations, axes of length 1) and points.
    ///
    /// # Errors
    /// [`Error`] names the first link or point at fault.
    pub fn new(links: Vec<Link>, points: Vec<Point>) -> Result<Self, Error> {
        if links.is_empty() {
            return Err(Error::EmptyTree);
        }
        let mut first_dof = Vec::with_capacity(links.len());
        let mut dof = 0;
        for (i, link) in links.iter().enumerate() {
            if let Some(parent) = link.parent
                && parent >= i
            {
                return Err(Error::ParentNotBefore { link: link.name.clone(), parent });
            }
            if !link.offset.iter().all(|x| x.is_finite()) {
                return Err(Error::NotFinite { what: format!("offset of link `{}`", link.name) });
            }
            if link.rest.as_ref().is_some_and(|rest| !is_rotation(rest)) {
                return Err(Error::NoRotation { link: link.name.clone() });
            }
            for joint in &link.joints {
                let vector = joint.axis().direction();
                let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
                // Negated, so that NaN is refused.
                let is_unit = (length - 1.0).abs() < 1e-9;
                if !is_unit {
                    return Err(Error::NoAxis { vector });
                }
            }
            if links[..i].iter().any(|other| other.name == link.name) {
                return Err(Error::DuplicateName { name: link.name.clone() });
            }
            first_dof.push(dof);
            dof += link.joints.len();
        }
        for (i, point) in points.iter().enumerate() {
            if point.link >= links.len() {
                return Err(Error::NoSuchLink { point: point.name.clone(), link: point.link });
            }
            if !point.offset.iter().all(|x| x.is_finite()) {
                return Err(Error::NotFinite { what: format!("offset of point `{}`", point.name) });
            }
            if points[..i].iter().any(|other| other.name == point.name) {
                return Err(Error::DuplicateName { name: point.name.clone() });
            }
        }
        Ok(Self { links, points, first_dof, dof })
    }

    /// The same body with its points elsewhere on their links, by these vectors in the frames of the links, metres, in the order of the points.
    #[must_use]
    pub fn with_points_moved(&self, by: &[[f64; 3]]) -> Self {
        let mut moved = self.clone();
        for (point, by) in moved.points.iter_mut().zip(by) {
            point.offset.iter_mut().zip(by).for_each(|(x, by)| *x += by);
        }
        moved
    }

    /// The same body with the origins of its links elsewhere in their parents, by these vectors in the frames of the parents, metres, in the order of the links.
    #[must_use]
    pub fn with_links_moved(&self, by: &[[f64; 3]]) -> Self {
        let mut moved = self.clone();
        for (link, by) in moved.links.iter_mut().zip(by) {
            link.offset.iter_mut().zip(by).for_each(|(x, by)| *x += by);
        }
        moved
    }

    /// The same body with four more points on each of some links: its origin and the tips of its x, y and z axis.
    pub(crate) fn with_frames_shown(&self, links: impl Iterator<Item = usize>) -> Self {
        let mut shown = self.clone();
        for link in links {
            let tips = [[0.0; 3]].into_iter().chain(IDENTITY);
            shown.points.extend(tips.map(|offset| Point { name: String::new(), link, offset }));
        }
        shown
    }

    /// Links, parents before children.
    #[must_use]
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Points, in the order given.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Number of degrees of freedom.
    #[must_use]
    pub const fn dof(&self) -> usize {
        self.dof
    }

    /// Index of a link's first degree of freedom; its others follow.
    #[must_use]
    pub fn first_dof(&self, link: usize) -> usize {
        self.first_dof[link]
    }

    /// Joint of every degree of freedom with the index of its link, in state order.
    pub fn joints(&self) -> impl Iterator<Item = (usize, Joint)> + '_ {
        self.links.iter().enumerate().flat_map(|(i, link)| link.joints.iter().map(move |&joint| (i, joint)))
    }

    /// Name of every degree of freedom, `link.tx` or `link.rx`, in state order; free axes of a link are u, v, w in turn.
    #[must_use]
    pub fn dof_names(&self) -> Vec<String> {
        let names = |link: &Link| {
            let mut free = 0;
            let name = |joint: &Joint| {
                let kind = if matches!(joint, Joint::Translate(_)) { 't' } else { 'r' };
                let axis = joint.axis().index().unwrap_or_else(|| {
                    free += 1;
                    3 + (free - 1) % 3
                });
                format!("{}.{kind}{}", link.name, ['x', 'y', 'z', 'u', 'v', 'w'][axis])
            };
            link.joints.iter().map(name).collect::<Vec<_>>()
        };
        self.links.iter().flat_map(names).collect()
    }

    /// Frame of every link in a state: its rotation (world from link) and its origin, metres. For set-up and output; [`Plan`](crate::Plan) is for many states.
    ///
    /// # Panics
    /// If the state is shorter than the number of degrees of freedom.
    #[must_use]
    pub fn link_frames(&self, state: &[f64]) -> Vec<(Matrix, [f64; 3])> {
        let moved = |rotation: &Matrix, from: [f64; 3], by: [f64; 3]| {
            let by = apply(rotation, by);
            [0, 1, 2].map(|k| from[k] + by[k])
        };
        let mut frames: Vec<(Matrix, [f64; 3])> = Vec::with_capacity(self.links.len());
        for (link, &first) in self.links.iter().zip(&self.first_dof) {
            let (mut rotation, mut origin) = match link.parent {
                Some(parent) => (frames[parent].0, moved(&frames[parent].0, frames[parent].1, link.offset)),
                None => (IDENTITY, link.offset),
            };
            if let Some(rest) = &link.rest {
                rotation = product(&rotation, rest);
            }
            for (joint, &q) in link.joints.iter().zip(&state[first..][..link.joints.len()]) {
                match joint {
                    Joint::Translate(axis) => origin = moved(&rotation, origin, axis.direction().map(|x| q * x)),
                    Joint::Rotate(axis) => rotation = product(&rotation, &axis.rotation(q)),
                }
            }
            frames.push((rotation, origin));
        }
        frames
    }

    /// Index of the point of that name.
    #[must_use]
    pub fn point_index(&self, name: &str) -> Option<usize> {
        self.points.iter().position(|point| point.name == name)
    }

    /// Index of the link of that name.
    #[must_use]
    pub fn link_index(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
    }
}
