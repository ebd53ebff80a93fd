"""Angles of joints from the body's degrees of freedom, by SciPy's rotations and the definitions of `docs/reference/angles.md`."""

import numpy as np
from scipy.spatial.transform import Rotation

# Ball joints: names of the turns about x, y and z, and the sign of the last two.
BALLS = {
    "pelvis": (("pelvis_tilt", "pelvis_list", "pelvis_rotation"), 1),
    "spine": ((None, "lumbar_bending", "lumbar_rotation"), 1),
    "r_thigh": (("hip_flexion_r", "hip_adduction_r", "hip_rotation_r"), 1),
    "l_thigh": (("hip_flexion_l", "hip_adduction_l", "hip_rotation_l"), -1),
    "r_upper_arm": (("arm_flex_r", "arm_add_r", "arm_rot_r"), 1),
    "l_upper_arm": (("arm_flex_l", "arm_add_l", "arm_rot_l"), -1),
}
HINGES = {"shin.rx": ("knee_angle_{}", -1), "forearm.rx": ("elbow_flex_{}", 1), "foot.rx": ("ankle_angle_{}", 1)}
# Links with their parents.
PARENTS = {
    "pelvis": None,
    "spine": "pelvis",
    "head": "spine",
    "girdle": "spine",
    **{f"{side}_upper_arm": "girdle" for side in "rl"},
    **{f"{side}_forearm": f"{side}_upper_arm" for side in "rl"},
    **{f"{side}_thigh": "pelvis" for side in "rl"},
    **{f"{side}_shin": f"{side}_thigh" for side in "rl"},
    **{f"{side}_foot": f"{side}_shin" for side in "rl"},
}


def turn(link, dofs, angles):
    """Rotation of a link in its parent; `angles` (rad) end with the degrees of freedom `dofs`, and are flattened before them."""
    own = [dof for dof in dofs if dof.startswith(f"{link}.r")]
    order = "".join(dof[-1] for dof in own).upper()
    values = np.stack([angles[..., dofs.index(dof)] for dof in own], -1).reshape(-1, len(own))
    return Rotation.from_euler(order, values)


def in_the_world(dofs, angles):
    """Rotations of all links in the world, by their names."""
    turned = {}
    for link, parent in PARENTS.items():
        own = turn(link, dofs, angles)
        turned[link] = own if parent is None else turned[parent] * own
    return turned


def joint_angles(dofs, angles):
    """All angles of `--angles opensim` in degrees, by name, in the shape of `angles` (rad) without its last axis."""
    shape = angles.shape[:-1]
    named = {}
    for link, (names, side) in BALLS.items():
        about = turn(link, dofs, angles).as_euler("XYZ", degrees=True).reshape(*shape, 3)
        for k, name in enumerate(names):
            if name is not None:
                named[name] = about[..., k] * (1 if k == 0 else side)
    degrees = np.degrees(angles)
    for side in "rl":
        for dof, (name, sign) in HINGES.items():
            named[name.format(side)] = sign * degrees[..., dofs.index(f"{side}_{dof}")]
        named[f"{side}_foot_ry"] = degrees[..., dofs.index(f"{side}_foot.ry")]
    for dof in ("head.rz", "head.ry", "head.rx", "girdle.rz"):
        named[dof.replace(".", "_")] = degrees[..., dofs.index(dof)]
    return named
