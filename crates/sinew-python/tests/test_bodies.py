"""Kinematics against a chain of matrices in NumPy, Jacobians against differences."""

import numpy as np
import pytest

import sinew
from conftest import BVH

BODIES = ["h32", "cf28", "hppf24", "hapf31"]


def turn(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    turned = np.eye(3)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    turned[j, j], turned[j, k], turned[k, j], turned[k, k] = c, -s, s, c
    return turned


def chain(body, pose):
    """Positions of the points, link by link."""
    frames = []
    for link, (parent, offset) in enumerate(zip(body.parents, body.offsets, strict=True)):
        rotation, origin = (np.eye(3), np.zeros(3)) if parent is None else frames[parent]
        origin = origin + rotation @ offset
        for (of, kind, axis), value in zip(body.joints, pose, strict=True):
            if of == link and kind == "translate":
                origin = origin + rotation[:, axis] * value
            elif of == link:
                rotation = rotation @ turn(axis, value)
        frames.append((rotation, origin))
    places = zip(body.point_links, body.point_offsets, strict=True)
    return np.array([frames[link][1] + frames[link][0] @ offset for link, offset in places])


@pytest.mark.parametrize("name", BODIES)
def test_positions_are_a_chain_of_matrices(name):
    body = sinew.Body(name)
    poses = np.random.default_rng(1).normal(0, 0.7, (11, body.dof))
    expected = np.array([chain(body, pose) for pose in poses])
    np.testing.assert_allclose(body.positions(poses), expected, atol=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_jacobians_are_differences_of_positions(name):
    body = sinew.Body(name)
    poses = np.random.default_rng(2).normal(0, 0.7, (2, 5, body.dof))
    positions, jacobian = body.jacobian(poses)
    np.testing.assert_array_equal(positions, body.positions(poses))
    assert jacobian.shape == (2, 5, len(body.points), 3, body.dof)
    step = 1e-6
    for j in range(body.dof):
        by = np.zeros(body.dof)
        by[j] = step
        numeric = (body.positions(poses + by) - body.positions(poses - by)) / (2 * step)
        np.testing.assert_allclose(jacobian[..., j], numeric, atol=1e-8)


def test_a_batch_is_its_poses_one_by_one():
    body = sinew.Body()
    poses = np.random.default_rng(3).normal(0, 0.5, (1030, body.dof))
    together = body.positions(poses)
    assert together.shape == (1030, len(body.points), 3)
    for at in (0, 7, 8, 511, 512, 1029):
        np.testing.assert_allclose(body.positions(poses[at]), together[at], atol=1e-14)
    assert body.positions(poses[:0]).shape == (0, len(body.points), 3)
    # Any memory layout and any kind of number.
    np.testing.assert_array_equal(body.positions(np.asfortranarray(poses)), together)
    np.testing.assert_array_equal(body.positions(poses[::2]), together[::2])
    np.testing.assert_allclose(body.positions(poses.astype(np.float32)), together, atol=1e-5)
    np.testing.assert_array_equal(body.positions(poses[3].tolist()), body.positions(poses[3]))
    np.testing.assert_array_equal(body.positions(misaligned(poses)), together)


def misaligned(values):
    """The same numbers, from the second byte of a buffer on."""
    place = np.zeros(values.nbytes + 1, np.uint8)[1:].view(np.float64).reshape(values.shape)
    place[...] = values
    assert not place.flags.aligned
    return place


def test_positions_go_where_they_are_wanted():
    body = sinew.Body()
    poses = np.random.default_rng(4).normal(0, 0.5, (20, body.dof))
    out = np.empty((20, len(body.points), 3))
    assert body.positions(poses, out=out) is out
    np.testing.assert_array_equal(out, body.positions(poses))
    for wrong in (out[:10], np.empty((20, len(body.points), 3), np.float32), out.swapaxes(0, 1), misaligned(out)):
        with pytest.raises(sinew.InputError, match="`out` must be an array of float64 in C order of the shape"):
            body.positions(poses, out=wrong)


def test_sizes_are_those_given():
    body = sinew.Body("h32", scale=1.1, sizes={"thigh": 0.5})
    assert body.sizes["thigh"] == 0.5
    assert body.sizes["shin"] == pytest.approx(1.1 * sinew.Body().sizes["shin"])
    at = dict(zip(body.points, body.positions(np.zeros(body.dof)), strict=True))
    assert np.linalg.norm(at["RHip"] - at["RKnee"]) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda body: body.positions(np.zeros((2, 31))), r"`poses` has the shape \(2, 31\); expected .* = 32"),
        (lambda body: body.positions("standing"), "`poses` is no array of numbers"),
        (lambda body: body.positions(None), r"`poses` has the shape \(\)"),
        (lambda body: sinew.Body("h32", scale=-1), "`scale` is -1; it must be positive"),
        (lambda body: sinew.Body("hppf24", scale=1e308), "a size of the body is more than 1000000 m"),
        (lambda body: sinew.Body("h32", sizes={"nose": 1}), "unknown size `nose`; known: spine, "),
        (lambda body: sinew.Body("h32", sizes={"thigh": -1}), "thigh is -1; it must be positive"),
    ],
)
def test_wrong_arguments_are_named(call, words):
    with pytest.raises(sinew.InputError, match=words):
        call(sinew.Body())


def test_bodies_of_files_may_be_bare(tmp_path):
    file = tmp_path / "body.toml"
    file.write_text('[[link]]\nname = "arm"\njoints = ["rz"]\n')
    assert sinew.Body(str(file)).positions(np.zeros((3, 1))).shape == (3, 0, 3)
    assert sinew.Body(str(file)).jacobian(np.zeros((3, 1)))[1].shape == (3, 0, 3, 1)
    file.write_text('[[link]]\nname = "arm"\n')
    with pytest.raises(sinew.InputError, match="has no degree of freedom"):
        sinew.Body(str(file))


def test_a_table_of_offsets_is_a_body():
    offsets = [[0, 0, 0.9], [0.1, 0, -0.4], [0, 0.05, -0.4], [0, 0, 0.5]]
    links, parents = ["hip", "knee", "ankle", "head"], [None, "hip", "knee", "hip"]
    body = sinew.Body.from_offsets(links, parents, offsets, ["tx ty tz rz ry rx", "rx", "", "ry"])
    assert body.points == body.links == links and body.parents == [None, 0, 1, 0]
    assert body.dof_names[5:] == ["hip.rx", "knee.rx", "head.ry"]
    poses = np.random.default_rng(5).normal(size=(4, body.dof))
    np.testing.assert_allclose(body.positions(poses), [chain(body, pose) for pose in poses], atol=1e-12)
    for change, words in [
        ({"parents": [None, "hip", "knee"]}, "`parents` has 3 entries; expected links = 4"),
        ({"offsets": offsets[:3]}, r"`offsets` has the shape \(3, 3\); expected \(links = 4"),
        ({"parents": [None, "ankle", "knee", "hip"]}, "no link before it is named `ankle`"),
        ({"joints": ["rq", "", "", ""]}, "unknown joint `rq`"),
    ]:
        given = {"links": links, "parents": parents, "offsets": offsets, "joints": ["tx", "", "", ""]} | change
        with pytest.raises(sinew.InputError, match=words):
            sinew.Body.from_offsets(**given)


@pytest.mark.filterwarnings("ignore::sinew.SinewWarning")
def test_robots_and_skeletons_are_bodies(tmp_path):
    """A quarter turn about y takes the forearm from below the elbow to behind it; a BVH file's points are its motion's."""
    ends = '<parent link="base"/><child link="arm"/><origin xyz="0 0 1.4"/><axis xyz="0 1 0"/>'
    tip = '<parent link="arm"/><child link="hand"/><origin xyz="0 0 -0.3"/>'
    links = '<link name="base"/><link name="arm"/><link name="hand"/>'
    joints = f'<joint name="a" type="revolute">{ends}</joint><joint name="b" type="fixed">{tip}</joint>'
    (tmp_path / "arm.urdf").write_text(f'<robot name="r">{links}{joints}</robot>')
    for arm in (sinew.Body(str(tmp_path / "arm.urdf")), sinew.read(tmp_path / "arm.urdf", sinew.Body)):
        assert arm.dof_names == ["arm.ry"]
        np.testing.assert_allclose(arm.positions([np.pi / 2])[2], [-0.3, 0, 1.4], atol=1e-12)
    file = tmp_path / "walk.bvh"
    file.write_text(BVH)
    body, motion = sinew.Body.from_bvh(file, unit_m=0.01), sinew.read(file, sinew.Motion)
    assert body.points == motion.names
    pose = [0.1, 0.05, 0, *np.deg2rad([30, 20, 10])]
    np.testing.assert_allclose(body.positions(pose), 0.01 * motion.values[1], atol=1e-12)


def test_an_unknown_body_has_the_words_of_the_program():
    with pytest.raises(sinew.UsageError, match=r"no body `h33`; .*; did you mean `h32`\?\nhelp: give one of") as raised:
        sinew.Body("h33")
    assert raised.value.exit_code == 2
    assert raised.value.help is not None
