//! The flesh of a body: solids fixed to the links of a tree. Silhouettes need it, and whatever else asks what is inside a body.
//!
//! The links say how a body moves, the solids how thick it is: sizes are data of a subject like its segment lengths.

use crate::Error;
use crate::frustum::Frustum;
use crate::tree::{KinematicTree, Point};

/// A truncated elliptical cone fixed to a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Unique name.
    pub name: String,
    /// Index of the link that carries it.
    pub link: usize,
    /// Centre of its base in that link's frame, metres.
    pub base: [f64; 3],
    /// Its axes x, y, z in that link's frame, unit vectors; z goes from base to top.
    pub axes: [[f64; 3]; 3],
    /// Its shape.
    pub frustum: Frustum,
}

/// Axes of a solid that stands upright in its link's frame.
pub const UPWARDS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Axes of a solid that hangs down, its x to the left.
pub const DOWNWARDS: [[f64; 3]; 3] = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
/// Axes of a solid that points forward, its y down.
pub const FORWARDS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];

/// Solids of a body, parents before children.
#[derive(Clone, Debug, PartialEq)]
pub struct Flesh {
    solids: Vec<Solid>,
    /// For each link the solid that its degrees of freedom belong to.
    owner: Vec<usize>,
    parents: Vec<Option<usize>>,
}

/// How far from unit length and right angles axes may be.
const ORTHONORMAL: f64 = 1e-9;

impl Flesh {
    /// Validates the solids of a tree.
    ///
    /// A link belongs to the first solid that it carries, else to that of its parent, a root to the first of all. A solid hangs on the one that its link's parent belongs to, a second one of a link on the first.
    ///
    /// # Errors
    /// [`Error`] names the first solid at fault: a link that is not there, numbers that are not finite or not positive, axes that are no right-handed frame, names that are taken, a parent that comes later; or that there are none.
    pub fn new(tree: &KinematicTree, solids: Vec<Solid>) -> Result<Self, Error> {
        if solids.is_empty() {
            return Err(Error::NoSolid);
        }
        for (index, solid) in solids.iter().enumerate() {
            check(solid, tree).map_err(|what| Error::BadSolid { solid: solid.name.clone(), what })?;
            if solids[..index].iter().any(|other| other.name == solid.name) {
                return Err(Error::DuplicateName { name: solid.name.clone() });
            }
        }
        let mut owner: Vec<usize> = Vec::with_capacity(tree.links().len());
        for (link, tree_link) in tree.links().iter().enumerate() {
            let own = solids.iter().position(|solid| solid.link == link);
            owner.push(own.unwrap_or_else(|| tree_link.parent.map_or(0, |parent| owner[parent])));
        }
        let mut parents = Vec::with_capacity(solids.len());
        for (index, solid) in solids.iter().enumerate() {
            let first = owner[solid.link];
            let above = || tree.links()[solid.link].parent.map(|parent| owner[parent]);
            let parent = if first == index { above() } else { Some(first) }.filter(|parent| *parent != index);
            if parent.is_some_and(|parent| parent > index) {
                return Err(Error::BadSolid {
                    solid: solid.name.clone(),
                    what: "the solid that it hangs on comes after it",
                });
            }
            parents.push(parent);
        }
        Ok(Self { solids, owner, parents })
    }

    /// The same solids with their radii at base and top times a factor each, which must be positive and finite.
    #[must_use]
    pub fn with_radii(&self, factors: impl Fn(&Solid) -> [f64; 2]) -> Self {
        let mut scaled = self.clone();
        for solid in &mut scaled.solids {
            let factors = factors(solid);
            solid.frustum.radii = [0, 1].map(|end| solid.frustum.radii[end] * factors[end]);
        }
        scaled
    }

    /// The solids.
    #[must_use]
    pub fn solids(&self) -> &[Solid] {
        &self.solids
    }

    /// The solid that each one hangs on.
    #[must_use]
    pub fn parents(&self) -> &[Option<usize>] {
        &self.parents
    }

    /// The solid that a link belongs to.
    ///
    /// # Panics
    /// If the link is not in the tree.
    #[must_use]
    pub fn owner(&self, link: usize) -> usize {
        self.owner[link]
    }

    /// Degrees of freedom that belong to each solid, which are its links': they cover the state once. A second solid of one link has none.
    #[must_use]
    pub fn coordinates(&self, tree: &KinematicTree) -> Vec<Vec<usize>> {
        let mut coordinates = vec![vec![]; self.solids.len()];
        for (link, &owner) in self.owner.iter().enumerate() {
            let first = tree.first_dof(link);
            coordinates[owner].extend(first..first + tree.links()[link].joints.len());
        }
        coordinates
    }

    /// The tree with four points for each solid, and the index of the first of them: the centre of its base, the ends of its unit vectors x and y, the centre of its top.
    ///
    /// # Errors
    /// Names of points that are taken.
    pub fn with_frames(&self, tree: &KinematicTree) -> Result<(KinematicTree, usize), Error> {
        let mut points = tree.points().to_vec();
        let first = points.len();
        for solid in &self.solids {
            let [x, y, z] = solid.axes;
            let top = z.map(|z| z * solid.frustum.height);
            for (name, arm) in [("base", [0.0; 3]), ("x", x), ("y", y), ("top", top)] {
                let offset = [0, 1, 2].map(|k| solid.base[k] + arm[k]);
                points.push(Point { name: format!("{}/{name}", solid.name), link: solid.link, offset });
            }
        }
        Ok((KinematicTree::new(tree.links().to_vec(), points)?, first))
    }
}

fn check(solid: &Solid, tree: &KinematicTree) -> Result<(), &'static str> {
    let Frustum { height, radii, ratio } = solid.frustum;
    let [x, y, z] = solid.axes;
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let turn = [y[1] * z[2] - y[2] * z[1], y[2] * z[0] - y[0] * z[2], y[0] * z[1] - y[1] * z[0]];
    let errors = [dot(x, turn) - 1.0, dot(x, x) - 1.0, dot(y, y) - 1.0, dot(z, z) - 1.0, dot(y, z)];
    if solid.link >= tree.links().len() {
        Err("its link is not there")
    } else if !solid.base.iter().chain(solid.axes.iter().flatten()).all(|x| x.is_finite()) {
        Err("a number is not finite")
    } else if ![height, radii[0], radii[1], ratio].iter().all(|x| *x > 0.0 && x.is_finite()) {
        Err("height, radii and ratio must be positive and finite")
    } else if errors.iter().any(|error| error.abs() > ORTHONORMAL) {
        Err("its axes are no right-handed frame of unit vectors")
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::{Proportions, h32};

    fn solid(name: &str, link: usize) -> Solid {
        let frustum = Frustum { height: 0.3, radii: [0.1, 0.08], ratio: 0.9 };
        Solid { name: name.into(), link, base: [0.0; 3], axes: UPWARDS, frustum }
    }

    #[test]
    fn solids_hang_on_the_nearest_one_towards_the_root() {
        let tree = h32(&Proportions::default());
        let at = |name: &str| tree.link_index(name).expect("a link");
        let solids = vec![
            solid("chest", at("spine")),
            solid("arm", at("l_upper_arm")),
            solid("shin", at("l_shin")),
            solid("hand", at("l_upper_arm")),
        ];
        let flesh = Flesh::new(&tree, solids).expect("valid");
        assert_eq!(flesh.parents(), [None, Some(0), Some(0), Some(1)]);
        let coordinates = flesh.coordinates(&tree);
        let mut all: Vec<usize> = coordinates.iter().flatten().copied().collect();
        all.sort_unstable();
        assert!(all.into_iter().eq(0..tree.dof()), "every coordinate once: {coordinates:?}");
        assert_eq!((coordinates[1].len(), coordinates[3].len()), (4, 0));
    }

    #[test]
    fn faulty_solids_are_named() {
        let tree = h32(&Proportions::default());
        let refused = |change: &dyn Fn(&mut Solid)| {
            let mut faulty = solid("faulty", 0);
            change(&mut faulty);
            Flesh::new(&tree, vec![solid("good", 0), faulty]).expect_err("refused").to_string()
        };
        assert!(refused(&|s| s.link = 99).contains("faulty"));
        assert!(refused(&|s| s.frustum.ratio = 0.0).contains("positive"));
        assert!(refused(&|s| s.base[1] = f64::NAN).contains("finite"));
        assert!(refused(&|s| s.axes[0] = [-1.0, 0.0, 0.0]).contains("right-handed"));
        assert!(refused(&|s| s.name = "good".into()).contains("good"));
    }

    #[test]
    fn frames_are_points_of_the_tree() {
        let tree = h32(&Proportions::default());
        let flesh = Flesh::new(&tree, vec![Solid { axes: FORWARDS, ..solid("foot", 0) }]).expect("valid");
        let (with, first) = flesh.with_frames(&tree).expect("new names");
        let offsets: Vec<[f64; 3]> = with.points()[first..].iter().map(|point| point.offset).collect();
        assert_eq!(offsets, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.3, 0.0]]);
    }
}
