//! Bones as octahedra, as programs for animation draw them: pointed at both ends, thickest near their beginning.

use sinew_formats::bvh::BvhJoint;

/// Where along a bone it is thickest, and half its thickness there, in lengths of the bone.
const THICKEST: f64 = 0.15;
const HALF_THICKNESS: f64 = 0.08;

/// Corners of triangles, three a triangle, counter-clockwise from outside.
pub(super) struct Mesh {
    /// Places in the rest pose.
    pub(super) positions: Vec<[f32; 3]>,
    /// Directions outwards, of length one.
    pub(super) normals: Vec<[f32; 3]>,
    /// Joint that carries each corner.
    pub(super) joints: Vec<u16>,
}

/// All bones of a skeleton: from each joint to each of its children, and to its end site.
pub(super) fn mesh(joints: &[BvhJoint], origins: &[[f64; 3]]) -> Mesh {
    let mut mesh = Mesh { positions: vec![], normals: vec![], joints: vec![] };
    for (joint, number) in joints.iter().zip(0_u16..) {
        let ends = joint.end_site.into_iter().map(|end| (number, end));
        let from_parent = joint.parent.and_then(|parent| u16::try_from(parent).ok());
        let begins = from_parent.into_iter().map(|parent| (parent, joint.offset));
        for (carrier, bone) in ends.chain(begins) {
            let start = origins[usize::from(carrier)];
            for triangle in octahedron(bone) {
                push(&mut mesh, carrier, triangle.map(|corner| add(start, corner)));
            }
        }
    }
    mesh
}

fn push(mesh: &mut Mesh, joint: u16, [a, b, c]: [[f64; 3]; 3]) {
    let normal = unit(cross(subtract(b, a), subtract(c, a)));
    for corner in [a, b, c] {
        mesh.positions.push(corner.map(|x| x as f32));
        mesh.normals.push(normal.map(|x| x as f32));
        mesh.joints.push(joint);
    }
}

/// The eight faces of a bone from the origin; none where it has no length.
fn octahedron(bone: [f64; 3]) -> Vec<[[f64; 3]; 3]> {
    let length = dot(bone, bone).sqrt();
    if length == 0.0 {
        return vec![];
    }
    let along = unit(bone);
    // The axis that is farthest from the bone gives two directions across it.
    let least = (0..3).min_by(|&i, &j| along[i].abs().total_cmp(&along[j].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let across = unit(cross(along, axis));
    let over = cross(along, across);
    let corner = |u: f64, v: f64| {
        [0, 1, 2].map(|k| THICKEST * bone[k] + HALF_THICKNESS * length * (u * across[k] + v * over[k]))
    };
    let ring = [corner(1.0, 0.0), corner(0.0, 1.0), corner(-1.0, 0.0), corner(0.0, -1.0)];
    let sides = (0..4).map(|k| (ring[k], ring[(k + 1) % 4]));
    sides.flat_map(|(a, b)| [[a, b, bone], [b, a, [0.0; 3]]]).collect()
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By Gauss: a third of the flux of the place through a closed surface is the volume inside, if all faces look out.
    #[test]
    fn a_bone_is_closed_and_looks_outwards() {
        for bone in [[0.0, 0.0, 0.4], [0.3, -0.1, 0.05], [-0.2, 0.2, 0.2]] {
            let faces = octahedron(bone);
            let flux: f64 = faces.iter().map(|[a, b, c]| dot(*a, cross(*b, *c)) / 6.0).sum();
            let length = dot(bone, bone).sqrt();
            // Two pyramids over a square of diagonal 2 h, together as high as the bone is long.
            let expected = 2.0 * (HALF_THICKNESS * length).powi(2) * length / 3.0;
            assert!((flux / expected - 1.0).abs() < 1e-12, "{flux} {expected}");
        }
        assert!(octahedron([0.0; 3]).is_empty());
    }
}
