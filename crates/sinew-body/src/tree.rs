//! Kinematic tree: links in topological order, each with an offset from its parent and an ordered list of joints.
//!
//! With the root at the world origin, link `i` has rotation `R_i` (world from link) and origin `p_i`:
//!
//! ```text
//! R = R_parent,  p = p_parent + R_parent · offset
//! for each joint, left to right:   translate along axis a:  p += R e_a q      rotate about axis a:  R = R · R_a(q)
//! ```
//!
//! An ordered list `z, y, x` of rotations gives `R = R_Z R_Y R_X` (Choo & Fleet 2001, eq. 19). Every joint is one degree of freedom; the degrees of freedom are
//! numbered link by link, left to right. A point fixed to link `b` at `m` lies at `p_b + R_b m`.

use crate::Error;

/// Coordinate axis of a link's own frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Subject's right in the standard bodies.
    X,
    /// Forward in the standard bodies.
    Y,
    /// Up in the standard bodies.
    Z,
}

impl Axis {
    /// 0, 1, 2 for x, y, z.
    #[inline(always)]
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

/// One degree of freedom: a motion along or about one axis of the link's frame so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// Translation in metres.
    Translate(Axis),
    /// Active right-handed rotation in radians.
    Rotate(Axis),
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

/// A validated kinematic tree with named points. Immutable; shared freely between threads.
#[derive(Clone, Debug, PartialEq)]
pub struct KinematicTree {
    links: Vec<Link>,
    points: Vec<Point>,
    first_dof: Vec<usize>,
    dof: usize,
}

impl KinematicTree {
    /// Validates links (parents first, unique names, finite offsets) and points.
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

    /// Name of every degree of freedom, `link.tx` or `link.rx`, in state order.
    #[must_use]
    pub fn dof_names(&self) -> Vec<String> {
        self.joints()
            .map(|(link, joint)| {
                let (kind, axis) = match joint {
                    Joint::Translate(axis) => ('t', axis),
                    Joint::Rotate(axis) => ('r', axis),
                };
                format!("{}.{kind}{}", self.links[link].name, ['x', 'y', 'z'][axis.index()])
            })
            .collect()
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
