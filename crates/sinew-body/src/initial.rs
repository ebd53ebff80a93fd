//! A first pose from points alone, for any heading: where Levenberg–Marquardt can start.
//!
//! 1. **Root**: the rigid motion that takes the trunk of the zero pose (hips, shoulders, and the points of the links that carry them) to its measured place, by
//!    the singular value decomposition of the cross-covariance (Kabsch 1976, with the determinant kept at +1). Without a trunk all points serve.
//! 2. **Limbs**: where a link turns about z, y, x, its only child hinges about x, and both of them point along −z, the measured ends of the two say everything:
//!    the upper part's −z axis points to the middle joint, and its x axis is normal to the plane of the limb, on the side on which the hinge bends naturally
//!    (arms forward, legs backward). Where it bends by less than `NEARLY_STRAIGHT` to the other side as the trunk sees it, errors of the points do that, and not a limb turned by half a turn:
//!    then the x axis stays on the trunk's side, and the hinge starts a little beyond straight.
//! 3. Everything else starts at 0.

use crate::fit::{Target, measured};
use crate::kinematics::{Plan, point_positions};
use crate::tree::{Axis, Joint, KinematicTree};
use nalgebra::{Matrix3, Vector3};
use sinew_core::lanes::Isa;

/// Points that turn with the root; enough of them give position and heading.
const TRUNK: [&str; 7] = ["LHip", "RHip", "LShoulder", "RShoulder", "Neck", "MidHip", "Spine"];
const FEWEST: usize = 3;
/// Bends below which errors of the points can turn the plane of a limb round, radians: 40°.
const NEARLY_STRAIGHT: f64 = 40.0 * core::f64::consts::PI / 180.0;

/// A pose near the measured points (one entry per point of the tree); `None` where fewer than three are known or all lie on a line, or where the root does not
/// move as in the standard bodies (translations, then rotations about z, y, x).
#[must_use]
pub fn initial_pose(tree: &KinematicTree, targets: &[Option<Target>]) -> Option<Vec<f64>> {
    use Axis::{X, Y, Z};
    let free = [Joint::Translate(X), Joint::Translate(Y), Joint::Translate(Z)];
    let turning = [Joint::Rotate(Z), Joint::Rotate(Y), Joint::Rotate(X)];
    let root = tree.links().first()?;
    if root.plain_joints() != Some(&[free, turning].concat()[..]) || targets.len() > tree.points().len() {
        return None;
    }
    let mut rest = vec![0.0; 3 * tree.points().len()];
    point_positions(&Plan::with_all_points(tree), Isa::baseline(), &vec![0.0; tree.dof()], &mut rest);
    let all: Vec<(usize, Target)> = measured(targets).collect();
    let trunk: Vec<(usize, Target)> =
        all.iter().filter(|(k, _)| TRUNK.contains(&tree.points()[*k].name.as_str())).copied().collect();
    let (rotation, translation) = rigid_motion(&trunk, &rest).or_else(|| rigid_motion(&all, &rest))?;

    let mut pose = vec![0.0; tree.dof()];
    pose[..3].copy_from_slice(translation.as_slice());
    pose[3..6].copy_from_slice(&zyx(&rotation));
    for (index, link) in tree.links().iter().enumerate().skip(1) {
        let children: Vec<usize> = (0..tree.links().len()).filter(|&c| tree.links()[c].parent == Some(index)).collect();
        let [child] = children[..] else { continue };
        let hinge = &tree.links()[child];
        if link.plain_joints() != Some(&turning[..]) || hinge.plain_joints() != Some(&[Joint::Rotate(X)][..]) {
            continue;
        }
        let at = |link: usize, offset: Option<[f64; 3]>| {
            let on = |k: usize| {
                let point = &tree.points()[k];
                point.link == link && offset.is_none_or(|o| o == point.offset)
            };
            all.iter().find(|(k, _)| on(*k)).map(|(_, t)| Vector3::from(t.position))
        };
        let (Some(middle), Some(end)) = (at(index, Some(hinge.offset)), at(child, None)) else { continue };
        let Some(zero) = zero_origin(tree, index) else { continue };
        let origin = at(link.parent?, Some(link.offset)).unwrap_or_else(|| rotation * zero + translation);
        // Legs hang from below the root's origin, arms from above it.
        let bends_forward = zero[2] > 0.0;
        if let Some((limb, bend)) = limb_rotation(middle - origin, end - middle, &rotation, bends_forward) {
            let first = tree.first_dof(index);
            pose[first..first + 3].copy_from_slice(&zyx(&(rotation.transpose() * limb)));
            pose[tree.first_dof(child)] = if bends_forward { bend } else { -bend };
        }
    }
    Some(pose)
}

/// Origin of a link at the zero pose; `None` where a rest rotation stands above it.
fn zero_origin(tree: &KinematicTree, link: usize) -> Option<Vector3<f64>> {
    let mut origin = Vector3::zeros();
    let mut at = Some(link);
    while let Some(index) = at {
        let link = &tree.links()[index];
        link.plain_joints()?;
        origin += Vector3::from(link.offset);
        at = link.parent;
    }
    Some(origin)
}

/// World rotation of the upper part of a limb with the given directions of its two parts, and the bend of its hinge, radians, positive the natural way.
fn limb_rotation(
    upper: Vector3<f64>,
    lower: Vector3<f64>,
    trunk: &Matrix3<f64>,
    bends_forward: bool,
) -> Option<(Matrix3<f64>, f64)> {
    let z = -upper.try_normalize(1e-9)?;
    // A turn about +x takes −z towards +y, forward.
    let normal = if bends_forward { upper.cross(&lower) } else { lower.cross(&upper) };
    let hint = trunk.column(0).into_owned();
    // A straight limb has no plane: then the trunk's x axis is as good as any.
    let straight = normal.norm() < 0.1 * upper.norm() * lower.norm();
    let bend = upper.angle(&lower);
    let is_turned_round = bend < NEARLY_STRAIGHT && normal.dot(&hint) < 0.0;
    let (normal, bend) = if is_turned_round { (-normal, -bend) } else { (normal, bend) };
    let x = if straight { hint - z * z.dot(&hint) } else { normal };
    let x = x.try_normalize(1e-6).or_else(|| {
        let forward = trunk.column(1).into_owned();
        forward.cross(&z).try_normalize(1e-6)
    })?;
    Some((Matrix3::from_columns(&[x, z.cross(&x), z]), bend))
}

fn rigid_motion(targets: &[(usize, Target)], rest: &[f64]) -> Option<(Matrix3<f64>, Vector3<f64>)> {
    if targets.len() < FEWEST {
        return None;
    }
    let from = |k: usize| Vector3::new(rest[3 * k], rest[3 * k + 1], rest[3 * k + 2]);
    let count = targets.len() as f64;
    let middle_from = targets.iter().map(|(k, _)| from(*k)).sum::<Vector3<f64>>() / count;
    let middle_to = targets.iter().map(|(_, t)| Vector3::from(t.position)).sum::<Vector3<f64>>() / count;
    let mut covariance = Matrix3::zeros();
    for (k, target) in targets {
        covariance += (Vector3::from(target.position) - middle_to) * (from(*k) - middle_from).transpose();
    }
    let svd = covariance.try_svd(true, true, f64::EPSILON, 1000)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut sizes: Vec<f64> = svd.singular_values.iter().copied().collect();
    sizes.sort_by(f64::total_cmp);
    if sizes[1].is_nan() || sizes[1] <= 1e-6 * sizes[2] {
        return None;
    }
    let mut sign = Matrix3::identity();
    sign[(svd.singular_values.imin(), svd.singular_values.imin())] = (u * v_t).determinant().signum();
    let rotation = u * sign * v_t;
    Some((rotation, middle_to - rotation * middle_from))
}

/// Angles with `R = R_Z R_Y R_X`.
fn zyx(r: &Matrix3<f64>) -> [f64; 3] {
    let cos_y = r[(0, 0)].hypot(r[(1, 0)]);
    if cos_y < 1e-9 {
        return [(-r[(0, 1)]).atan2(r[(1, 1)]), (-r[(2, 0)]).atan2(cos_y), 0.0];
    }
    [r[(1, 0)].atan2(r[(0, 0)]), (-r[(2, 0)]).atan2(cos_y), r[(2, 1)].atan2(r[(2, 2)])]
}
