//! The document of a glTF file and the bytes that it points into.

use super::bones;
use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf_json::buffer::{Target as Purpose, View};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Animation, Asset, Buffer, Index, Mesh, Node, Root, Scene, Skin};
use sinew_formats::bvh::{self, Bvh, local_transform};
use sinew_formats::rotation::to_quaternion;
use std::io;

/// A document and its only buffer.
pub(super) struct Document {
    pub(super) root: Root,
    pub(super) bytes: Vec<u8>,
}

/// The document of a moving skeleton.
pub(super) fn document(skeleton: &Bvh) -> io::Result<Document> {
    let asset = Asset { generator: Some("sinew".into()), ..Asset::default() };
    let mut document = Document { root: Root { asset, ..Root::default() }, bytes: Vec::new() };
    let joints = document.nodes(skeleton);
    let origins = origins_at_rest(skeleton);
    let bones = bones::mesh(&skeleton.joints, &origins);
    let mut nodes = vec![];
    // A point without bones has nothing to draw; then it only moves.
    if !bones.joints.is_empty() {
        let skin = Some(document.skin(&joints, &origins)?);
        let mesh = Some(document.mesh(&bones)?);
        nodes.push(document.root.push(Node { name: Some("bones".into()), mesh, skin, ..Node::default() }));
    }
    let roots = joints.iter().zip(&skeleton.joints).filter(|(_, joint)| joint.parent.is_none());
    let children = Some(roots.map(|(node, _)| *node).collect());
    let holder = document.root.push(Node { name: Some("skeleton".into()), children, ..Node::default() });
    nodes.push(holder);
    let scene = Scene { name: None, nodes, extensions: None, extras: Default::default() };
    document.root.scene = Some(document.root.push(scene));
    if !skeleton.frames.is_empty() {
        document.animation(skeleton, &joints)?;
    }
    // The format has no empty buffers.
    if !document.bytes.is_empty() {
        let byte_length = document.bytes.len().into();
        let buffer = Buffer { byte_length, name: None, uri: None, extensions: None, extras: Default::default() };
        document.root.push(buffer);
    }
    Ok(document)
}

/// Origins of all joints with all channels 0.
fn origins_at_rest(skeleton: &Bvh) -> Vec<[f64; 3]> {
    let mut origins: Vec<[f64; 3]> = Vec::with_capacity(skeleton.joints.len());
    for joint in &skeleton.joints {
        let parent = joint.parent.and_then(|parent| origins.get(parent)).copied().unwrap_or_default();
        origins.push([0, 1, 2].map(|k| parent[k] + joint.offset[k]));
    }
    origins
}

impl Document {
    /// A node for each joint, in the order of the joints.
    fn nodes(&mut self, skeleton: &Bvh) -> Vec<Index<Node>> {
        let mut nodes: Vec<Index<Node>> = Vec::with_capacity(skeleton.joints.len());
        for joint in &skeleton.joints {
            let translation = Some(joint.offset.map(|x| x as f32));
            let node = self.root.push(Node { name: Some(joint.name.clone()), translation, ..Node::default() });
            if let Some(parent) = joint.parent.and_then(|parent| self.root.nodes.get_mut(nodes[parent].value())) {
                parent.children.get_or_insert_default().push(node);
            }
            nodes.push(node);
        }
        nodes
    }

    /// The bones that move the mesh: what takes a place of the rest pose into the frame of each joint.
    fn skin(&mut self, joints: &[Index<Node>], origins: &[[f64; 3]]) -> io::Result<Index<Skin>> {
        let matrices: Vec<f32> = origins
            .iter()
            .flat_map(|&[x, y, z]| [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., -x, -y, -z, 1.0].map(|v| v as f32))
            .collect();
        let matrices = self.numbers(&matrices, Type::Mat4, None)?;
        Ok(self.root.push(Skin {
            inverse_bind_matrices: Some(matrices),
            joints: joints.to_vec(),
            name: None,
            skeleton: None,
            extensions: None,
            extras: Default::default(),
        }))
    }

    fn mesh(&mut self, bones: &bones::Mesh) -> io::Result<Index<Mesh>> {
        let corners = Some(Purpose::ArrayBuffer);
        let positions = self.numbers(bones.positions.as_flattened(), Type::Vec3, corners)?;
        let normals = self.numbers(bones.normals.as_flattened(), Type::Vec3, corners)?;
        let weights: Vec<f32> = bones.joints.iter().flat_map(|_| [1.0, 0.0, 0.0, 0.0]).collect();
        let weights = self.numbers(&weights, Type::Vec4, corners)?;
        let joints: Vec<u8> =
            bones.joints.iter().flat_map(|joint| [*joint, 0, 0, 0]).flat_map(u16::to_le_bytes).collect();
        let joints = self.accessor(&joints, ComponentType::U16, Type::Vec4, corners);
        let attributes = [
            (Semantic::Positions, positions),
            (Semantic::Normals, normals),
            (Semantic::Joints(0), joints),
            (Semantic::Weights(0), weights),
        ];
        let primitive = Primitive {
            attributes: attributes.map(|(semantic, accessor)| (Valid(semantic), accessor)).into(),
            indices: None,
            material: None,
            mode: Valid(Mode::Triangles),
            targets: None,
            extensions: None,
            extras: Default::default(),
        };
        let (name, primitives) = (Some("bones".into()), vec![primitive]);
        Ok(self.root.push(Mesh { name, primitives, weights: None, extensions: None, extras: Default::default() }))
    }

    fn animation(&mut self, skeleton: &Bvh, joints: &[Index<Node>]) -> io::Result<()> {
        let times: Vec<f32> = (0..skeleton.frames.len()).map(|k| (k as f64 * skeleton.frame_time_s) as f32).collect();
        if !times.is_sorted_by(|a, b| a < b) {
            return Err(invalid("frames follow each other more closely than single precision can tell apart"));
        }
        let input = self.numbers(&times, Type::Scalar, None)?;
        let (mut channels, mut samplers) = (vec![], vec![]);
        let mut column = 0;
        for (joint, &node) in skeleton.joints.iter().zip(joints) {
            let columns = column..column + joint.channels.len();
            column = columns.end;
            let mut rotations: Vec<f32> = Vec::with_capacity(4 * skeleton.frames.len());
            let mut translations: Vec<f32> = Vec::with_capacity(3 * skeleton.frames.len());
            let mut before = [1.0, 0.0, 0.0, 0.0];
            for row in &skeleton.frames {
                let values = row.get(columns.clone()).unwrap_or_default();
                let (shift, rotation) = local_transform(joint, &mut values.iter().copied());
                before = nearer(to_quaternion(&rotation), before);
                let [w, x, y, z] = before;
                rotations.extend([x, y, z, w].map(|v| v as f32));
                translations.extend(shift.map(|v| v as f32));
            }
            let moves = joint.channels.iter().any(|channel| matches!(channel, bvh::Channel::Position(_)));
            let turned = (Property::Rotation, Type::Vec4, rotations);
            let moved = moves.then_some((Property::Translation, Type::Vec3, translations));
            for (path, type_, values) in [Some(turned), moved].into_iter().flatten() {
                let output = self.numbers(&values, type_, None)?;
                let interpolation = Valid(Interpolation::Linear);
                let sampler = Sampler { input, interpolation, output, extensions: None, extras: Default::default() };
                let sampler = Index::push(&mut samplers, sampler);
                let target = Target { node, path: Valid(path), extensions: None, extras: Default::default() };
                channels.push(Channel { sampler, target, extensions: None, extras: Default::default() });
            }
        }
        let name = Some("motion".into());
        self.root.push(Animation { name, channels, samplers, extensions: None, extras: Default::default() });
        Ok(())
    }

    /// Stores numbers, with the least and the greatest of each component.
    fn numbers(&mut self, values: &[f32], type_: Type, target: Option<Purpose>) -> io::Result<Index<Accessor>> {
        if !values.iter().all(|value| value.is_finite()) {
            return Err(invalid("a number is not finite in single precision"));
        }
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let accessor = self.accessor(&bytes, ComponentType::F32, type_, target);
        let width = type_.multiplicity();
        let bound = |start: f32, pick: fn(f32, f32) -> f32| {
            let of = |k| values.iter().skip(k).step_by(width).fold(start, |bound, &value| pick(bound, value));
            Some((0..width).map(of).collect::<Vec<f32>>().into())
        };
        let stored = &mut self.root.accessors[accessor.value()];
        stored.min = bound(f32::INFINITY, f32::min);
        stored.max = bound(f32::NEG_INFINITY, f32::max);
        Ok(accessor)
    }

    /// Stores bytes as an array; every array begins at a multiple of four, since all its elements are as long.
    fn accessor(
        &mut self,
        bytes: &[u8],
        component: ComponentType,
        type_: Type,
        target: Option<Purpose>,
    ) -> Index<Accessor> {
        let byte_offset = Some(self.bytes.len().into());
        self.bytes.extend(bytes);
        let view = self.root.push(View {
            buffer: Index::new(0),
            byte_length: bytes.len().into(),
            byte_offset,
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: Default::default(),
        });
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: (bytes.len() / (component.size() * type_.multiplicity())).into(),
            component_type: Valid(GenericComponentType(component)),
            type_: Valid(type_),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
            extensions: None,
            extras: Default::default(),
        })
    }
}

/// What the format cannot hold.
pub(super) fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, what)
}

/// Of the two quaternions of a rotation, the one nearer to that before: programs interpolate from one to the next.
fn nearer(quaternion: [f64; 4], before: [f64; 4]) -> [f64; 4] {
    let cosine: f64 = quaternion.iter().zip(before).map(|(a, b)| a * b).sum();
    if cosine < 0.0 { quaternion.map(|x| -x) } else { quaternion }
}
