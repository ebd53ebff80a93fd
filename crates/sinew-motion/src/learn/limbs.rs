//! The tree of limbs by which a hierarchical latent model takes a body apart.
//!
//! Root → legs, arms, trunk → each limb (Lawrence & Moore 2007). A coordinate belongs to the limb whose link carries it or is the nearest above that link; the trunk, which names no link, has what is left. A body with other names or another
//! hierarchy states a table of its own in [`limbs_of`].

use super::LearnError;
use super::features::pose_coordinates;
use crate::follow::NamedBody;
use sinew_body::hapf31::LatentSpace;
use sinew_body::{KinematicTree, hapf31};
use sinew_dynamics::pca::{Keep, fit};
use sinew_latent::hgplvm::PlannedNode;
use sinew_latent::model::{LatentModel, Outputs};
use sinew_latent::outputs::{Preparation, Standard};
use std::ops::Range;

/// A node of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limb {
    /// Its name.
    pub name: &'static str,
    /// The node above it; none for the first.
    pub parent: Option<usize>,
    /// Links with which a limb begins; none for a node above others, and for the limb that has what is left.
    pub links: &'static [&'static str],
    /// Coordinates of its latent at most.
    pub most: usize,
}

const fn limb(name: &'static str, parent: usize, links: &'static [&'static str]) -> Limb {
    Limb { name, parent: Some(parent), links, most: usize::MAX }
}

/// Bodies whose limbs begin with thighs and upper arms.
const BY_LIMBS: [Limb; 8] = [
    Limb { name: "body", parent: None, links: &[], most: usize::MAX },
    limb("legs", 0, &[]),
    limb("arms", 0, &[]),
    limb("trunk", 0, &[]),
    limb("l_leg", 1, &["l_thigh"]),
    limb("r_leg", 1, &["r_thigh"]),
    limb("l_arm", 2, &["l_upper_arm"]),
    limb("r_arm", 2, &["r_upper_arm"]),
];

/// The latent spaces of H-APF ([`hapf31::HIERARCHY`]).
const HAPF31: [Limb; 10] = {
    const fn space(n: usize, links: &'static [&'static str]) -> Limb {
        let LatentSpace { name, parent, latent_dim, .. } = hapf31::HIERARCHY[n];
        Limb { name, parent, links, most: latent_dim }
    }
    [
        space(0, &[]),
        space(1, &[]),
        space(2, &[]),
        space(3, &[]),
        space(4, &["l_thigh"]),
        space(5, &["r_thigh"]),
        space(6, &["l_clavicle"]),
        space(7, &["r_clavicle"]),
        space(8, &["thorax"]),
        space(9, &["head"]),
    ]
};

/// The table of a body.
#[must_use]
pub const fn limbs_of(body: NamedBody) -> &'static [Limb] {
    match body {
        NamedBody::H32 | NamedBody::Cf28 | NamedBody::Hppf24 => &BY_LIMBS,
        NamedBody::Hapf31 => &HAPF31,
    }
}

/// Whether others stand below a node.
fn is_inner(limbs: &[Limb], n: usize) -> bool {
    limbs.iter().any(|limb| limb.parent == Some(n))
}

/// Coordinates of each node, of those that are chosen and counted among them; a node above others has all that the nodes below it have.
fn columns(limbs: &[Limb], tree: &KinematicTree, chosen: &Range<usize>) -> Vec<Vec<usize>> {
    let left = (0..limbs.len()).find(|&n| limbs[n].links.is_empty() && !is_inner(limbs, n));
    let mut columns = vec![Vec::new(); limbs.len()];
    let mut owners: Vec<Option<usize>> = vec![];
    for (l, link) in tree.links().iter().enumerate() {
        let named = limbs.iter().position(|limb| limb.links.contains(&link.name.as_str()));
        let owner = named.or_else(|| link.parent.and_then(|parent| owners[parent]));
        owners.push(owner);
        let first = tree.first_dof(l);
        let own = (first..first + link.joints.len()).filter(|j| chosen.contains(j)).map(|j| j - chosen.start);
        let mut node = owner.or(left);
        while let Some(n) = node {
            columns[n].extend(own.clone());
            node = limbs[n].parent;
        }
    }
    columns.iter_mut().for_each(|columns| columns.sort_unstable());
    columns
}

/// Share of the variance, and variance in square radians, below which a principal component counts as none.
const STILL: f64 = 1e-9;
const STILL_RAD2: f64 = 1e-12;

/// Principal components of some columns of rows, at most `most`.
pub(super) fn components(rows: &[f64], width: usize, columns: &[usize], most: usize) -> usize {
    let chosen: Vec<f64> = rows.chunks_exact(width).flat_map(|row| columns.iter().map(|&j| row[j])).collect();
    let found = fit(&chosen, columns.len(), Keep { share: 1.0, most });
    found
        .map_or(0, |pca| pca.variances.iter().filter(|&&variance| variance > STILL_RAD2.max(STILL * pca.total)).count())
}

/// The tree of a hierarchical model of rows of a body's coordinates ([`pose_coordinates`]), with `dim` coordinates in each latent, fewer where a limb moves in fewer ways.
///
/// # Errors
/// [`LearnError::StillLimb`] where a limb does not move, [`LearnError::Latent`] for rows that are none.
pub fn branches(body: NamedBody, rows: &[f64], dim: usize) -> Result<Vec<PlannedNode>, LearnError> {
    let (tree, limbs, chosen) = (body.tree(), limbs_of(body), pose_coordinates(body));
    let (width, all) = (chosen.len(), columns(limbs, &tree, &chosen));
    let rows = Standard::new(rows, width, Preparation::Standardised).map_err(LearnError::Latent)?.apply(rows);
    let kept: Vec<usize> = (0..limbs.len()).filter(|&n| !all[n].is_empty()).collect();
    let place = |n: usize| kept.iter().position(|&other| other == n);
    let mut branches = Vec::new();
    for &n in &kept {
        let most = components(&rows, width, &all[n], dim.min(limbs[n].most));
        if most == 0 {
            return Err(LearnError::StillLimb { limb: limbs[n].name });
        }
        let columns = if is_inner(limbs, n) { vec![] } else { all[n].clone() };
        branches.push(PlannedNode { parent: limbs[n].parent.and_then(place), dim: most, columns });
    }
    Ok(branches)
}

/// Coordinates of the data that a node generates, itself or through others, ascending.
#[must_use]
pub fn columns_below(model: &LatentModel, node: usize) -> Vec<usize> {
    let mut columns: Vec<usize> = match &model.nodes[node].outputs {
        Outputs::Columns(columns) => columns.clone(),
        Outputs::Nodes(nodes) => nodes.iter().flat_map(|&c| columns_below(model, c)).collect(),
    };
    columns.sort_unstable();
    columns
}

/// The name of a node of a model of a body, by the coordinates that it generates; its number where no limb has these. Its rows are named where they are not all.
#[must_use]
pub fn name_of(body: Option<NamedBody>, model: &LatentModel, node: usize) -> String {
    let below = columns_below(model, node);
    let limbs = body.map_or(&[][..], limbs_of);
    let all = body.map_or(vec![], |body| columns(limbs, &body.tree(), &pose_coordinates(body)));
    let found = limbs.iter().zip(&all).find(|(_, columns)| **columns == below);
    let name = found.map_or_else(|| format!("node {node}"), |(limb, _)| limb.name.to_owned());
    let rows = &model.nodes[node].rows;
    if rows.len() == model.rows() { name } else { format!("{name} of rows {} to {}", rows.start, rows.end - 1) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_coordinate_of_a_pose_belongs_to_one_limb() {
        for body in NamedBody::ALL {
            let (limbs, tree) = (limbs_of(body), body.tree());
            let chosen = pose_coordinates(body);
            let all = columns(limbs, &tree, &chosen);
            let leaves = (0..limbs.len()).filter(|&n| !is_inner(limbs, n));
            let mut covered: Vec<usize> = leaves.flat_map(|n| all[n].clone()).collect();
            covered.sort_unstable();
            assert_eq!(covered, (0..chosen.len()).collect::<Vec<_>>(), "{}", body.name());
            assert_eq!(all[0], covered, "{}", body.name());
        }
        let shown = |body: NamedBody| columns(limbs_of(body), &body.tree(), &pose_coordinates(body))[3..].to_vec();
        let hppf24: [&[usize]; 5] = [&[0, 1], &[10, 11, 12, 13], &[14, 15, 16, 17], &[2, 3, 4, 5], &[6, 7, 8, 9]];
        assert_eq!(shown(NamedBody::Hppf24), hppf24);
        let h32 = shown(NamedBody::H32);
        assert_eq!(h32.iter().map(Vec::len).collect::<Vec<_>>(), [6, 4, 4, 4, 4]);
    }

    #[test]
    fn limbs_that_move_in_few_ways_have_few_coordinates() {
        let angle = |n: usize, j: usize| match j {
            10..14 => (j + 1) as f64 * (0.3 * n as f64).sin(),
            _ => (0.3 * n as f64 * (1.0 + 0.1 * j as f64)).sin(),
        };
        let rows: Vec<f64> = (0..40 * 18).map(|k| angle(k / 18, k % 18)).collect();
        let branches = branches(NamedBody::Hppf24, &rows, 3).unwrap();
        assert_eq!(branches.iter().map(|branch| branch.dim).collect::<Vec<_>>(), [3, 3, 3, 2, 1, 3, 3, 3]);
        assert_eq!(branches[4].parent, Some(1));
        let still = vec![0.5; 40 * 18];
        assert!(matches!(super::branches(NamedBody::Hppf24, &still, 3), Err(LearnError::StillLimb { limb: "body" })));
    }
}
