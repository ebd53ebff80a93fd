//! A kinematic tree flattened for evaluation.
//!
//! Links stand parents first, points sorted by link, every link's translations before its rotations (a link written otherwise becomes two). All vectors that an evaluation keeps lie in one
//! array, and the plan knows the place of each: the frame of a link with children takes four places (the columns of `R`, the origin), that of a link without one (the
//! origin), the world's the first four. Every frame is taken parallel to the world's where all joints are at zero, so that rest rotations turn offsets and axes once, here, and no state later. The axis of a rotation is a column of the frame before it or after it wherever such a frame is kept; only the others take a place of their own.

use super::straight_line::Body;
use super::structure::structure;
use crate::rotation::{Matrix, apply, product};
use crate::tree::{Axis, Joint, KinematicTree};
use std::ops::Range;

/// Places of a kept frame.
const FRAME: usize = 4;
/// Place of the origin in a frame.
pub(super) const ORIGIN: usize = 3;

#[derive(Clone, Debug)]
pub(super) struct PlanLink {
    pub parent: Option<usize>,
    pub offset: [f64; 3],
    /// First degree of freedom.
    pub first: usize,
    pub translations: usize,
    pub rotations: usize,
    pub points: usize,
    pub has_children: bool,
    /// Whether its force and moment go through memory: it has points, or a child that is not the next link.
    pub gathers: bool,
    /// Whether its parent is the link before it, to which the backward sweep hands force and moment in registers.
    pub follows: bool,
    /// Place of the parent's frame.
    pub from: usize,
    /// Place of the own frame, or of the origin alone.
    pub frame: usize,
}

impl PlanLink {
    /// Its degrees of freedom.
    #[inline(always)]
    pub const fn dofs(&self) -> Range<usize> {
        self.first..self.first + self.translations + self.rotations
    }

    /// Place of the origin.
    #[inline(always)]
    pub const fn origin(&self) -> usize {
        if self.has_children { self.frame + ORIGIN } else { self.frame }
    }
}

#[derive(Clone, Debug)]
pub(super) struct PlanJoint {
    pub axis: Axis,
    /// Place of the world axis.
    pub place: usize,
    /// Whether the axis must be stored there: no frame has it.
    pub stored: bool,
}

/// A kinematic tree flattened for lane kernels.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(super) links: Vec<PlanLink>,
    /// Degrees of freedom in state order: link by link, translations before rotations.
    pub(super) joints: Vec<PlanJoint>,
    /// Offset of each point, link by link.
    pub(super) offsets: Vec<[f64; 3]>,
    /// Link of each point.
    pub(super) link_of: Vec<usize>,
    /// The caller's index of each point.
    order: Vec<usize>,
    /// Places of vectors in all.
    pub(super) vectors: usize,
    /// Whose straight-line code walks it, with the offset of each link.
    pub(super) straight_line: Option<(Body, Vec<[f64; 3]>)>,
}

impl Plan {
    /// Flattens a tree with the points of the given indices.
    ///
    /// # Panics
    /// If an index is not that of a point of the tree.
    #[must_use]
    pub fn new(tree: &KinematicTree, points: &[usize]) -> Self {
        let link_offsets = tree.links().iter().map(|link| link.offset).collect();
        let mut plan = Self {
            links: vec![],
            joints: vec![],
            offsets: vec![],
            link_of: vec![],
            order: vec![],
            vectors: 0,
            straight_line: Body::of(&structure(tree, points)).map(|body| (body, link_offsets)),
        };
        let mut last_segment: Vec<usize> = Vec::with_capacity(tree.links().len());
        let mut rests: Vec<Option<Matrix>> = Vec::with_capacity(tree.links().len());
        for (index, link) in tree.links().iter().enumerate() {
            let mut parent = link.parent.map(|p| last_segment[p]);
            let above = link.parent.and_then(|p| rests[p]);
            let mut offset = turned(above.as_ref(), link.offset);
            let rest = match (above, link.rest) {
                (Some(above), Some(rest)) => Some(product(&above, &rest)),
                (above, rest) => above.or(rest),
            };
            rests.push(rest);
            let mut joints = link.joints.iter().map(|joint| turned_joint(rest.as_ref(), *joint)).peekable();
            loop {
                plan.push_segment(&mut joints, parent, offset);
                parent = Some(plan.links.len() - 1);
                offset = [0.0; 3];
                if joints.peek().is_none() {
                    break;
                }
            }
            let segment = plan.links.len() - 1;
            last_segment.push(segment);
            for (k, &p) in points.iter().enumerate() {
                let point = &tree.points()[p];
                if point.link == index {
                    plan.offsets.push(turned(rest.as_ref(), point.offset));
                    plan.link_of.push(segment);
                    plan.order.push(k);
                    plan.links[segment].points += 1;
                }
            }
        }
        plan.place_vectors();
        plan
    }

    /// Takes the next translations and the rotations after them for a link of the plan.
    fn push_segment(
        &mut self,
        joints: &mut std::iter::Peekable<impl Iterator<Item = Joint>>,
        parent: Option<usize>,
        offset: [f64; 3],
    ) {
        let first = self.joints.len();
        let placeless = |axis: &Axis| PlanJoint { axis: *axis, place: 0, stored: false };
        while let Some(Joint::Translate(axis)) = joints.peek() {
            self.joints.push(placeless(axis));
            joints.next();
        }
        let translations = self.joints.len() - first;
        while let Some(Joint::Rotate(axis)) = joints.peek() {
            self.joints.push(placeless(axis));
            joints.next();
        }
        let rotations = self.joints.len() - first - translations;
        if let Some(p) = parent {
            self.links[p].has_children = true;
        }
        self.links.push(PlanLink {
            parent,
            offset,
            first,
            translations,
            rotations,
            points: 0,
            has_children: false,
            gathers: false,
            follows: false,
            from: 0,
            frame: 0,
        });
    }

    /// Gives every vector its place.
    fn place_vectors(&mut self) {
        let mut next = FRAME;
        for index in 0..self.links.len() {
            let parent = self.links[index].parent;
            let from = parent.map_or(0, |parent| self.links[parent].frame);
            let follows = parent.is_some_and(|parent| parent + 1 == index);
            if let Some(parent) = parent.filter(|_| !follows) {
                self.links[parent].gathers = true;
            }
            let link = &mut self.links[index];
            link.from = from;
            link.follows = follows;
            link.gathers |= link.points > 0;
            link.frame = next;
            next += if link.has_children { FRAME } else { 1 };
            let (translations, rotations) = self.joints[link.dofs()].split_at_mut(link.translations);
            let mut own_place = |joint: &mut PlanJoint| {
                joint.place = next;
                joint.stored = true;
                next += 1;
            };
            for joint in translations {
                match joint.axis.index() {
                    Some(axis) => joint.place = from + axis,
                    None => own_place(joint),
                }
            }
            let axes: Vec<Axis> = rotations.iter().map(|joint| joint.axis).collect();
            for (j, joint) in rotations.iter_mut().enumerate() {
                let same = |axes: &[Axis]| axes.iter().all(|a| *a == joint.axis);
                match joint.axis.index() {
                    Some(axis) if same(&axes[..j]) => joint.place = from + axis,
                    Some(axis) if link.has_children && same(&axes[j..]) => joint.place = link.frame + axis,
                    _ => own_place(joint),
                }
            }
        }
        self.vectors = next;
    }

    /// Whether [`Plan::sweep`] runs straight-line code: tree and points belong to a built-in body, in any size.
    #[must_use]
    pub const fn has_straight_line(&self) -> bool {
        self.straight_line.is_some()
    }

    /// The same plan walked by loops even where it has [straight-line code](Plan::sweep): what that code is compared with.
    #[must_use]
    pub fn without_straight_line(self) -> Self {
        Self { straight_line: None, ..self }
    }

    /// Flattens a tree with all its points.
    #[must_use]
    pub fn with_all_points(tree: &KinematicTree) -> Self {
        Self::new(tree, &(0..tree.points().len()).collect::<Vec<_>>())
    }

    /// Number of degrees of freedom.
    #[must_use]
    pub const fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Number of points.
    #[must_use]
    pub const fn points(&self) -> usize {
        self.order.len()
    }

    /// For each point in the plan's order its index among the points that the plan was made with.
    #[must_use]
    pub fn order(&self) -> &[usize] {
        &self.order
    }
}

/// A vector of a link's frame in the plan's, which has no rest rotation.
fn turned(rest: Option<&Matrix>, vector: [f64; 3]) -> [f64; 3] {
    rest.map_or(vector, |rest| apply(rest, vector))
}

/// A joint with its axis in the plan's frame.
fn turned_joint(rest: Option<&Matrix>, joint: Joint) -> Joint {
    let Some(rest) = rest else { return joint };
    match joint {
        Joint::Translate(axis) => Joint::Translate(axis.turned(rest)),
        Joint::Rotate(axis) => Joint::Rotate(axis.turned(rest)),
    }
}
