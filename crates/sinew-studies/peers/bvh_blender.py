"""Blender's reading of a result's motion.bvh beside the result's own tables.

    python bvh_blender.py RESULT [FILE]     # in an environment with the package bpy (Blender as a Python module)

RESULT is a result folder; FILE another file of the same motion, such as one with `sinew convert --bones`, BVH or glTF.
The file is imported with Blender's defaults (forward -Z, up Y), which must restore the world: z up, metres. Checked are

- the rest pose of BVH: both arms level, toes ahead (along -y with renamed bones, else +y), all bones with a length, every bone
  beginning where its parent ends;
- places of joints in every frame against `markers.trc` (points of the mean pose): shoulders, elbows, hips, knees, ankles;
- the frame rate with "Update Scene FPS" (glTF has times, and the scene gets the rate first), the number of frames;
- of glTF, that each bone's mesh goes with it: a corner of the mesh lies at each joint.

It says the largest distance of each joint and fails above 1 mm, or where the arms are off level by more than 0.1 degrees.
"""

import math
import sys
from pathlib import Path

import bpy

MOST_MM, MOST_DEG = 1.0, 0.1
# Our bones with their names for Mixamo, Unreal and Rigify, and the point at the head of each.
BONES = [
    (("l_upper_arm", "LeftArm", "upperarm_l", "upper_arm.L"), "LShoulder"),
    (("l_forearm", "LeftForeArm", "lowerarm_l", "forearm.L"), "LElbow"),
    (("r_upper_arm", "RightArm", "upperarm_r", "upper_arm.R"), "RShoulder"),
    (("r_forearm", "RightForeArm", "lowerarm_r", "forearm.R"), "RElbow"),
    (("l_thigh", "LeftUpLeg", "thigh_l", "thigh.L"), "LHip"),
    (("l_shin", "LeftLeg", "calf_l", "shin.L"), "LKnee"),
    (("l_foot", "LeftFoot", "foot_l", "foot.L"), "LAnkle"),
    (("r_thigh", "RightUpLeg", "thigh_r", "thigh.R"), "RHip"),
    (("r_shin", "RightLeg", "calf_r", "shin.R"), "RKnee"),
    (("r_foot", "RightFoot", "foot_r", "foot.R"), "RAnkle"),
]


def read_trc(path):
    """Rate, names, and points of each frame in the world (z up)."""
    lines = path.read_text().splitlines()
    rate = float(lines[2].split("\t")[0])
    names = [name for name in lines[3].split("\t")[2:] if name.strip()]
    frames = []
    for line in lines[5:]:
        if line.strip():
            cells = [float(cell) for cell in line.split("\t")[2 : 2 + 3 * len(names)]]
            frames.append([(cells[k + 2], cells[k], cells[k + 1]) for k in range(0, len(cells), 3)])
    return rate, names, frames


def main():
    result = Path(sys.argv[1])
    file = Path(sys.argv[2]) if len(sys.argv) > 2 else result / "motion.bvh"
    rate, names, frames = read_trc(result / "markers.trc")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    is_gltf = file.suffix == ".glb"
    if is_gltf:
        scene.render.fps = round(rate)
        assert bpy.ops.import_scene.gltf(filepath=str(file)) == {"FINISHED"}
        armature = next(o for o in bpy.data.objects if o.type == "ARMATURE")
        mesh = next(o for o in bpy.data.objects if o.type == "MESH" and o.parent == armature)
    else:
        scene.frame_end = 1  # the importer makes a scene longer, never shorter
        done = bpy.ops.import_anim.bvh(filepath=str(file), update_scene_fps=True, update_scene_duration=True)
        assert done == {"FINISHED"}
        armature = bpy.context.object
    bones = armature.data.bones
    print(f"Blender {bpy.app.version_string}, {len(bones)} bones: {', '.join(bone.name for bone in bones)}")

    failures = []
    found = [next((bone for bone in bones if bone.name in known), None) for known, _ in BONES]
    failures += [f"no bone {known[0]}" for (known, _), bone in zip(BONES, found) if bone is None]
    pairs = [(bone, point) for bone, (_, point) in zip(found, BONES) if bone is not None]
    failures += [] if is_gltf else resting(armature, pairs)

    fps = scene.render.fps / scene.render.fps_base
    first, last = armature.animation_data.action.frame_range
    print(f"keys from frame {first:g} to {last:g}, {fps:g} a second; markers.trc has {len(frames)}, {rate:g}")
    if abs(fps - rate) > 1e-3 * rate:
        failures.append(f"{fps} frames a second, not {rate}")
    if abs(last - first + 1 - len(frames)) > 1e-3:
        failures.append("the number of frames")
    farthest = {point: 0.0 for _, point in pairs}
    for number, points in enumerate(frames):
        scene.frame_set(round(first) + number)
        corners = world_corners(mesh) if is_gltf else None
        for bone, point in pairs:
            head = armature.matrix_world @ armature.pose.bones[bone.name].head
            own = points[names.index(point)]
            farthest[point] = max(farthest[point], 1000 * math.dist(head, own))
            if is_gltf:
                farthest[point] = max(farthest[point], 1000 * min(math.dist(corner, own) for corner in corners))
    print("farthest from markers.trc, mm:", ", ".join(f"{point} {far:.3f}" for point, far in farthest.items()))
    failures += [f"{point} is {far:.2f} mm off" for point, far in farthest.items() if not far <= MOST_MM]
    print("\n".join(failures) or "as it should be")
    sys.exit(bool(failures))


def world_corners(mesh):
    """Corners of a mesh as its bones carry it in this frame."""
    drawn = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return [mesh.matrix_world @ vertex.co for vertex in drawn.data.vertices]


def resting(armature, pairs):
    """What is wrong with the rest pose."""
    bones, failures = armature.data.bones, []
    at_rest = lambda bone: armature.matrix_world.to_3x3() @ (bone.tail_local - bone.head_local)
    for bone, _ in pairs[:4]:
        along = at_rest(bone)
        slope = math.degrees(math.asin(along.z / along.length))
        if abs(slope) > MOST_DEG:
            failures.append(f"{bone.name} is {slope:.2f} degrees off level at rest")
    feet = [bone for bone, point in pairs if point.endswith("Ankle")]
    for bone in feet:
        # Characters look along -y, the front view; motion.bvh as the world has it, along +y.
        along, sign = at_rest(bone), 1 if bone.name.endswith("_foot") else -1
        print(f"at rest {bone.name} points to {along.y / along.length:+.2f} along y of Blender's world")
        if along.y * sign < 0.8 * along.length:
            failures.append(f"{bone.name} points elsewhere at rest")
    failures += [f"{bone.name} has no length" for bone in bones if bone.length < 1e-3]
    apart = [bone for bone in bones if bone.parent and (bone.head_local - bone.parent.tail_local).length > 1e-5]
    failures += [f"{bone.name} does not begin where {bone.parent.name} ends" for bone in apart]
    return failures


main()
