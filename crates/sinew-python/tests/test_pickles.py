"""Values go through pickle and copy as they are."""

import copy
import pickle

import numpy as np
import pytest

import sinew
from conftest import BVH

pytestmark = pytest.mark.filterwarnings("ignore::sinew.SinewWarning", "ignore::RuntimeWarning")

PICKLED = [lambda value: pickle.loads(pickle.dumps(value)), copy.deepcopy]

@pytest.mark.parametrize("again", PICKLED, ids=["pickle", "deepcopy"])
def test_bodies(again, tmp_path):
    (tmp_path / "arm.toml").write_text('[[link]]\nname = "arm"\njoints = ["rz"]\n[[point]]\nname = "hand"\nlink = "arm"\noffset = [0.1, 0.2, 0.3]\n')
    table = sinew.Body.from_offsets(["hip", "knee"], [None, "hip"], [[0, 0, 0.9], [0.01, 0, -0.4]], ["tx rz rx", "rx"])
    for body in (sinew.Body("cf28", scale=1.07, sizes={"thigh": 0.5}), sinew.Body(str(tmp_path / "arm.toml")), table):
        found = again(body)
        poses = np.random.default_rng(1).normal(size=(3, body.dof))
        np.testing.assert_array_equal(found.positions(poses), body.positions(poses))
        assert (found.name, found.points, found.sizes) == (body.name, body.points, body.sizes)
        assert found.to_toml() == body.to_toml()


@pytest.mark.parametrize("again", PICKLED, ids=["pickle", "deepcopy"])
def test_cameras(again):
    size = {"image_size_px": (640, 480), "focal_px": (500, 510), "rotation": np.eye(3), "translation": (1, 2, 3)}
    brown = sinew.Camera("C1", **size, centre_px=(322, 238), distortion=[-0.1, 0.02, 1e-3, -5e-4])
    fisheye = sinew.Camera("C2", **size, distortion=[0.1, 0.0, 0.0, 0.0], fisheye=True)
    assert again([brown, fisheye]) == [brown, fisheye]


@pytest.mark.parametrize("again", PICKLED, ids=["pickle", "deepcopy"])
def test_motions(again, walk, tmp_path):
    points = walk.truth.copy()
    points[3, 5] = np.nan
    (tmp_path / "a.bvh").write_text(BVH)
    motions = [
        sinew.Motion.from_points(walk.points, points, walk.rate_hz, start_frame=7),
        sinew.Motion.from_coordinates(["knee_angle_r", "pelvis_tx"], [[1.5, np.nan], [2, 3]], 50),
        sinew.read(tmp_path / "a.bvh", sinew.Motion),
    ]
    for motion in motions:
        found = again(motion)
        for name in ("kind", "format", "rate_hz", "start_frame", "warnings", "names"):
            assert getattr(found, name) == getattr(motion, name)
        np.testing.assert_array_equal(found.values, motion.values)
        np.testing.assert_array_equal(found.time_s, motion.time_s)


@pytest.mark.parametrize("again", PICKLED, ids=["pickle", "deepcopy"])
def test_records_and_errors(again, walk):
    draws = sinew.samplers.nuts(lambda x: (-0.5 * (x**2).sum(1), -x), np.zeros((4, 1)), draws=200, warm_up=170, seed=1)
    seen = walk.keypoints[:2, :, 0].swapaxes(1, 2)
    for value in (draws, walk, sinew.triangulate(walk.cameras, seen)):
        found = again(value)
        for name, of in vars(value).items():
            np.testing.assert_array_equal(getattr(found, name), of, err_msg=name)
    with pytest.raises(sinew.UsageError) as raised:
        sinew.Body("h33")
    found = again(raised.value)
    assert (type(found), str(found), found.help) == (sinew.UsageError, str(raised.value), raised.value.help)


@pytest.mark.parametrize("again", PICKLED, ids=["pickle", "deepcopy"])
def test_results(again, result):
    found = again(result)
    assert (found.path, found.notes) == (result.path, result.notes)
    assert found.joints.equals(result.joints)
