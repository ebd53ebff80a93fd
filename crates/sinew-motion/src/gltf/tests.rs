//! What is written, as another reader of the format understands it.

use super::*;
use gltf::animation::util::ReadOutputs;
use gltf::mesh::util::{ReadJoints, ReadWeights};
use sinew_formats::bvh::{BvhJoint, Channel, forward_kinematics};
use std::collections::BTreeMap;

/// A trunk that walks and turns, with an arm and a leg, and a second root.
fn skeleton() -> Bvh {
    let turns = [2, 1, 0].map(Channel::Rotation).to_vec();
    let joint = |name: &str, parent, offset, channels: &[Channel], end_site| BvhJoint {
        name: name.into(),
        parent,
        offset,
        channels: channels.to_vec(),
        end_site,
    };
    let places = [0, 1, 2].map(Channel::Position).to_vec();
    let root = [places, turns.clone()].concat();
    let joints = vec![
        joint("trunk", None, [0.0, 0.9, 0.0], &root, None),
        joint("arm", Some(0), [0.2, 0.4, 0.0], &turns, Some([0.3, 0.0, 0.0])),
        joint("thigh", Some(0), [0.1, -0.1, 0.0], &turns, None),
        joint("shin", Some(2), [0.0, -0.4, 0.0], &[Channel::Rotation(0)], Some([0.0, -0.4, 0.1])),
        joint("ball", None, [1.0, 0.0, 0.0], &[Channel::Position(1)], Some([0.0, 0.2, 0.0])),
    ];
    let frames = (0..4_u8).map(|k| (0..14_u8).map(|c| f64::from(k) * (f64::from(c) - 5.5) * 17.0).collect()).collect();
    Bvh { joints, frame_time_s: 0.04, frames, warnings: vec![] }
}

type Affine = [[f32; 4]; 4];

fn times(a: Affine, b: Affine) -> Affine {
    std::array::from_fn(|column| std::array::from_fn(|row| (0..4).map(|k| a[k][row] * b[column][k]).sum()))
}

/// Transforms of all nodes in one frame of the first animation, by their names.
fn globals(file: &gltf::Gltf, frame: usize) -> BTreeMap<String, Affine> {
    let mut own: BTreeMap<usize, ([f32; 3], [f32; 4])> = BTreeMap::new();
    for node in file.nodes() {
        let (translation, rotation, _) = node.transform().decomposed();
        own.insert(node.index(), (translation, rotation));
    }
    for channel in file.animations().next().unwrap().channels() {
        let reader = channel.reader(|_| file.blob.as_deref());
        let local = own.get_mut(&channel.target().node().index()).unwrap();
        match reader.read_outputs().unwrap() {
            ReadOutputs::Rotations(values) => local.1 = values.into_f32().nth(frame).unwrap(),
            ReadOutputs::Translations(mut values) => local.0 = values.nth(frame).unwrap(),
            _ => panic!("neither turned nor moved"),
        }
    }
    let mut found = BTreeMap::new();
    let identity: Affine = std::array::from_fn(|i| std::array::from_fn(|j| f32::from(u8::from(i == j))));
    let mut open: Vec<(gltf::Node<'_>, Affine)> =
        file.scenes().next().unwrap().nodes().map(|node| (node, identity)).collect();
    while let Some((node, parent)) = open.pop() {
        let (translation, rotation) = own[&node.index()];
        let transform = gltf::scene::Transform::Decomposed { translation, rotation, scale: [1.0; 3] }.matrix();
        let global = times(parent, transform);
        found.insert(node.name().unwrap().to_owned(), global);
        open.extend(node.children().map(|child| (child, global)));
    }
    found
}

fn near(found: &[f32], expected: [f64; 3], tolerance: f64) -> bool {
    found.iter().zip(expected).all(|(a, b)| (f64::from(*a) - b).abs() < tolerance)
}

fn written(skeleton: &Bvh) -> gltf::Gltf {
    let mut bytes = Vec::new();
    write(&mut bytes, skeleton).unwrap();
    // Reading checks the document against the rules of the format.
    gltf::Gltf::from_slice(&bytes).unwrap()
}

#[test]
fn joints_are_where_the_skeleton_has_them() {
    let skeleton = skeleton();
    let file = written(&skeleton);
    let animation = file.animations().next().unwrap();
    let times: Vec<f32> =
        animation.channels().next().unwrap().reader(|_| file.blob.as_deref()).read_inputs().unwrap().collect();
    assert_eq!(times, [0.0, 0.04, 0.08, 0.12]);
    for (frame, row) in skeleton.frames.iter().enumerate() {
        let nodes = globals(&file, frame);
        let points = skeleton.point_names().into_iter().zip(forward_kinematics(&skeleton.joints, row));
        for (name, place) in points.filter(|(name, _)| !name.ends_with("_End")) {
            assert!(near(&nodes[&name][3][..3], place, 1e-4), "{frame} {name} {:?} {place:?}", nodes[&name][3]);
        }
    }
}

/// The farthest corner of a bone that ends at an end site lies there in every frame, once it is carried by its joint.
#[test]
fn bones_move_with_their_joints() {
    let skeleton = skeleton();
    let file = written(&skeleton);
    let blob = file.blob.as_deref();
    let skin = file.skins().next().unwrap();
    let names: Vec<&str> = skin.joints().map(|node| node.name().unwrap()).collect();
    let inverses: Vec<Affine> = skin.reader(|_| blob).read_inverse_bind_matrices().unwrap().collect();
    let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| blob);
    let places: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    let Some(ReadJoints::U16(joints)) = reader.read_joints(0) else { panic!("joints") };
    let Some(ReadWeights::F32(mut weights)) = reader.read_weights(0) else { panic!("weights") };
    let joints: Vec<u16> = joints.map(|[joint, ..]| joint).collect();
    assert!(weights.all(|weight| weight == [1.0, 0.0, 0.0, 0.0]) && joints.len() == places.len());
    for (frame, row) in skeleton.frames.iter().enumerate() {
        let nodes = globals(&file, frame);
        let carried: Vec<(usize, [f32; 4])> = joints
            .iter()
            .zip(&places)
            .map(|(&joint, &[x, y, z])| {
                let joint = usize::from(joint);
                let matrix = times(nodes[names[joint]], inverses[joint]);
                (joint, std::array::from_fn(|k| matrix[0][k] * x + matrix[1][k] * y + matrix[2][k] * z + matrix[3][k]))
            })
            .collect();
        let ends = skeleton.point_names().into_iter().zip(forward_kinematics(&skeleton.joints, row));
        for (name, end) in ends.filter_map(|(name, end)| Some((name.strip_suffix("_End")?.to_owned(), end))) {
            let joint = names.iter().position(|joint| *joint == name).unwrap();
            assert!(carried.iter().any(|(carrier, place)| *carrier == joint && near(&place[..3], end, 1e-4)), "{name}");
        }
    }
}

/// A ball that is tracked as one point.
#[test]
fn a_point_moves_without_bones() {
    let mut ball = skeleton();
    ball.joints.truncate(1);
    ball.frames.iter_mut().for_each(|row| row.truncate(6));
    let file = written(&ball);
    assert_eq!((file.meshes().len(), file.skins().len()), (0, 0));
    assert_eq!(written(&Bvh { frames: vec![], ..ball.clone() }).buffers().len(), 0);
    assert!(near(&globals(&file, 2)["trunk"][3], forward_kinematics(&ball.joints, &ball.frames[2])[0], 1e-4));
}

#[test]
fn turns_take_the_short_way() {
    let file = written(&skeleton());
    for channel in file.animations().next().unwrap().channels() {
        if let Some(ReadOutputs::Rotations(turns)) = channel.reader(|_| file.blob.as_deref()).read_outputs() {
            let turns: Vec<[f32; 4]> = turns.into_f32().collect();
            let cosine = |pair: &[[f32; 4]]| pair[0].iter().zip(pair[1]).map(|(a, b)| a * b).sum::<f32>();
            assert!(turns.windows(2).all(|pair| cosine(pair) >= 0.0), "{turns:?}");
        }
    }
}

#[test]
fn what_the_format_cannot_hold_is_refused() {
    let still = Bvh { frames: vec![], ..skeleton() };
    assert_eq!(written(&still).animations().len(), 0);
    let refused = |skeleton: Bvh| write(&mut Vec::new(), &skeleton).unwrap_err().to_string();
    assert!(refused(Bvh { joints: vec![], ..skeleton() }).contains("at least one joint"));
    let mut turned = skeleton();
    turned.joints.swap(1, 2);
    turned.joints[1].parent = Some(3);
    assert_eq!(refused(turned), "joints must follow their parents");
    let mut far = skeleton();
    far.frames[0][0] = 1e39;
    assert_eq!(refused(far), "frame 1 of `trunk` has 1e39, which single precision does not reach");
    assert!(refused(Bvh { frame_time_s: 1e-300, ..skeleton() }).starts_with("frames follow each other more closely"));
}
