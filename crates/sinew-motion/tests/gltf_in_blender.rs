//! What Blender reads of a written file.
//!
//! Where the Python named by `SINEW_PYTHON`, or `python3`, has Blender as a module.

use sinew_formats::bvh;
use sinew_motion::gltf;
use std::process::Command;

/// An arm hangs and is then raised sideways; the rest pose has it raised.
const ARM: &str = "HIERARCHY
ROOT trunk
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
  JOINT upper_arm
  {
    OFFSET 0.18 0.42 0
    CHANNELS 3 Zrotation Yrotation Xrotation
    JOINT forearm
    {
      OFFSET 0.3 0 0
      CHANNELS 3 Zrotation Yrotation Xrotation
      End Site
      {
        OFFSET 0.26 0 0
      }
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.0333333
1 1.02 -2 0 0 0 -90 0 0 0 0 0
1 1.02 -2 0 0 0 0 0 0 0 0 0
";

/// Blender's world has z up: (x, y, z) is (x, −z, y) of the file. A corner of the mesh lies at the wrist.
const SCRIPT: &str = "import sys, bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = 30
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
rig = next(o for o in bpy.data.objects if o.type == 'ARMATURE')
mesh = next(o for o in bpy.data.objects if o.type == 'MESH' and o.parent == rig)
assert sorted(bone.name for bone in rig.pose.bones) == ['forearm', 'trunk', 'upper_arm']
for frame, wrist in [(0, (1.18, 2.0, 0.88)), (1, (1.74, 2.0, 1.44))]:
    bpy.context.scene.frame_set(frame)
    drawn = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
    corners = [mesh.matrix_world @ v.co for v in drawn.data.vertices]
    far = min(sum((a - b) ** 2 for a, b in zip(corner, wrist)) ** .5 for corner in corners)
    assert far < 1e-5, (frame, far)
";

#[test]
fn bones_and_mesh_move() {
    let python = std::env::var_os("SINEW_PYTHON").unwrap_or_else(|| "python3".into());
    let found = Command::new(&python).args(["-c", "import bpy"]).output();
    if !found.is_ok_and(|output| output.status.success()) {
        println!("skipped: no bpy");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("arm.glb");
    let mut bytes = Vec::new();
    gltf::write(&mut bytes, &bvh::read("arm.bvh", ARM).unwrap()).unwrap();
    std::fs::write(&file, bytes).unwrap();
    let output = Command::new(&python).current_dir(&folder).args(["-c", SCRIPT]).arg(&file).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
}
