//! What a detector takes for something else: limbs whose sides it exchanges, keypoints of other people.

use sinew_body::KinematicTree;

/// Distance on a link of a point from the joint that it stands for, at most, metres.
const AT_JOINT_M: f64 = 0.05;

/// The mistakes of some detectors. Without any: the default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mistakes {
    /// Pairs of limbs, each the pairs (left, right) of its points.
    pub limbs: Vec<Vec<(usize, usize)>>,
    /// For each view the probability that it exchanges the sides of a pair of limbs in a frame; none where it is missing.
    pub exchanged: Vec<f64>,
    /// For each view the probability that a keypoint is somebody else's, in a frame that shows others.
    pub elsewhere: Vec<f64>,
}

impl Mistakes {
    /// Probability that a view exchanges the sides of a pair of limbs in a frame.
    #[must_use]
    pub fn exchanged(&self, view: usize) -> f64 {
        self.exchanged.get(view).copied().unwrap_or(0.0)
    }

    /// Probability that a keypoint of a view is somebody else's.
    #[must_use]
    pub fn elsewhere(&self, view: usize) -> f64 {
        self.elsewhere.get(view).copied().unwrap_or(0.0)
    }

    /// For each of some points the one of the other side, with the pair of limbs that both are of.
    #[must_use]
    pub fn partners(&self, points: usize) -> Vec<Option<(usize, usize)>> {
        let mut partners = vec![None; points];
        for (limb, pairs) in self.limbs.iter().enumerate() {
            for &(left, right) in pairs {
                (partners[left], partners[right]) = (Some((right, limb)), Some((left, limb)));
            }
        }
        partners
    }
}

/// The pairs of limbs of a body: of the pairs (left, right) of its points, those on the same two limbs together. `points` are indices of the tree's points, `pairs` count in `points`.
///
/// Limbs part at the link where the branches to left and right part; a point on the link that both hang on belongs to the limb whose joint it is. Points of the head belong to no limb.
#[must_use]
pub fn paired_limbs(tree: &KinematicTree, points: &[usize], pairs: &[(usize, usize)]) -> Vec<Vec<(usize, usize)>> {
    let mut known: Vec<(usize, usize)> = vec![];
    let mut limbs: Vec<Vec<(usize, usize)>> = vec![];
    for &(left, right) in pairs {
        let Some(roots) = limb_of(tree, points[left]).zip(limb_of(tree, points[right])) else { continue };
        if roots.0 == roots.1 {
            continue;
        }
        let limb = known.iter().position(|own| *own == roots).unwrap_or_else(|| {
            known.push(roots);
            limbs.push(vec![]);
            limbs.len() - 1
        });
        limbs[limb].push((left, right));
    }
    limbs
}

/// The first link of the limb that a point belongs to: below a link with several children; `None` on a link that has several, away from their joints.
fn limb_of(tree: &KinematicTree, point: usize) -> Option<usize> {
    let point = &tree.points()[point];
    let links = tree.links();
    let children = |link: usize| (0..links.len()).filter(move |&child| links[child].parent == Some(link));
    if children(point.link).count() > 1 {
        let distance = |child: &usize| (0..3).map(|k| (links[*child].offset[k] - point.offset[k]).powi(2)).sum::<f64>();
        let nearest = children(point.link).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        return (distance(&nearest).sqrt() < AT_JOINT_M).then_some(nearest);
    }
    let mut link = point.link;
    while let Some(parent) = links[link].parent.filter(|&parent| children(parent).count() == 1) {
        link = parent;
    }
    links[link].parent.map(|_| link)
}
