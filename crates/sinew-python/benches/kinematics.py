"""Points of 100,000 poses from Python, beside Rust, Pinocchio and MuJoCo, on one thread.

    RAYON_NUM_THREADS=1 python crates/sinew-python/benches/kinematics.py target/release/examples/batch_positions

The argument is the Rust example of `sinew-body`, built before. All libraries get the same tree: h32, its 32 degrees of
freedom one joint each, its 26 points as frames (Pinocchio) or sites (MuJoCo). Neither of the two has a call for a batch
of poses in Python, so that they are called pose by pose, as their users do; what they compute is checked against ours.
Times are nanoseconds a pose: the least and the median of the rounds.
"""

import statistics
import subprocess
import sys
import time

import numpy as np

import sinew

POSES, ONE_BY_ONE, WITH_JACOBIAN, ROUNDS = 100_000, 2_000, 10_000, 15
AXES = np.eye(3)


def measured(what, poses, call, rounds=ROUNDS):
    times = []
    for _ in range(rounds):
        begun = time.perf_counter()
        call()
        times.append((time.perf_counter() - begun) * 1e9 / poses)
    print(f"{what:42} {min(times):10.1f} {statistics.median(times):10.1f}")


def joints(body):
    """For each degree of freedom its parent degree of freedom (-1: the world), offset, kind and axis."""
    last, found = {}, []
    for number, (link, kind, axis) in enumerate(body.joints):
        if link in last:
            parent, offset = last[link], np.zeros(3)
        else:
            of = body.parents[link]
            parent, offset = (-1 if of is None else last[of]), body.offsets[link]
        found.append((parent, offset, kind, axis))
        last[link] = number
    return found, last


def in_pinocchio(body):
    import pinocchio

    model = pinocchio.Model()
    made = {
        "rotate": [pinocchio.JointModelRX, pinocchio.JointModelRY, pinocchio.JointModelRZ],
        "translate": [pinocchio.JointModelPX, pinocchio.JointModelPY, pinocchio.JointModelPZ],
    }
    found, last = joints(body)
    for number, (parent, offset, kind, axis) in enumerate(found):
        place = pinocchio.SE3(np.eye(3), offset)
        model.addJoint(parent + 1, made[kind][axis](), place, f"q{number}")
    frames = []
    for name, link, offset in zip(body.points, body.point_links, body.point_offsets, strict=True):
        place = pinocchio.SE3(np.eye(3), offset)
        frames.append(model.addFrame(pinocchio.Frame(name, last[link] + 1, place, pinocchio.FrameType.OP_FRAME)))
    data = model.createData()
    order = [model.joints[number + 1].idx_q for number in range(body.dof)]
    assert order == list(range(body.dof))

    def positions(pose):
        pinocchio.framesForwardKinematics(model, data, pose)
        return np.array([data.oMf[frame].translation for frame in frames])

    def bare(pose):
        pinocchio.framesForwardKinematics(model, data, pose)

    return positions, bare


def in_mujoco(body):
    import mujoco

    spec = mujoco.MjSpec()
    found, last = joints(body)
    bodies, kinds = [], {"rotate": mujoco.mjtJoint.mjJNT_HINGE, "translate": mujoco.mjtJoint.mjJNT_SLIDE}
    for number, (parent, offset, kind, axis) in enumerate(found):
        above = spec.worldbody if parent < 0 else bodies[parent]
        of = above.add_body(name=f"b{number}", pos=offset, mass=1.0, inertia=[1.0, 1.0, 1.0])
        of.add_joint(name=f"q{number}", type=kinds[kind], axis=AXES[axis])
        bodies.append(of)
    for name, link, offset in zip(body.points, body.point_links, body.point_offsets, strict=True):
        bodies[last[link]].add_site(name=name, pos=offset)
    model = spec.compile()
    data = mujoco.MjData(model)
    sites = [model.site(name).id for name in body.points]
    # Its coordinates are in the order of the depth of the tree.
    order = np.array([model.joint(f"q{number}").qposadr[0] for number in range(body.dof)])

    def bare(pose):
        data.qpos[order] = pose
        mujoco.mj_kinematics(model, data)

    def positions(pose):
        bare(pose)
        return data.site_xpos[sites]

    return positions, bare


def main():
    body = sinew.Body("h32")
    poses = 0.3 * np.sin(np.arange(POSES * body.dof, dtype=np.float64)).reshape(POSES, body.dof)
    expected = body.positions(poses)
    print(f"{'ns a pose':42} {'least':>10} {'median':>10}")
    for line in subprocess.run(sys.argv[1:2], capture_output=True, text=True, check=True).stdout.splitlines():
        what, least, median = line.split()
        print(f"{'Rust, ' + what.replace('_', ' '):42} {float(least):10.1f} {float(median):10.1f}")
    measured("sinew, positions of a batch", POSES, lambda: body.positions(poses))
    out = np.empty_like(expected)
    measured("sinew, positions into memory that is there", POSES, lambda: body.positions(poses, out=out))
    some = poses[:WITH_JACOBIAN]
    measured("sinew, Jacobians of a batch", WITH_JACOBIAN, lambda: body.jacobian(some))
    few = poses[:ONE_BY_ONE]
    measured("sinew, positions pose by pose", ONE_BY_ONE, lambda: [body.positions(pose) for pose in few])
    for name, made in [("Pinocchio", in_pinocchio), ("MuJoCo", in_mujoco)]:
        try:
            positions, bare = made(body)
        except ImportError:
            print(f"skipped: no {name}")
            continue
        found = np.array([positions(pose) for pose in few])
        np.testing.assert_allclose(found, expected[:ONE_BY_ONE], atol=1e-9)
        measured(f"{name}, positions pose by pose", ONE_BY_ONE, lambda: [positions(pose) for pose in few])
        measured(f"{name}, the call alone", ONE_BY_ONE, lambda: [bare(pose) for pose in few])


if __name__ == "__main__":
    main()
