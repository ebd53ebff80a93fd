"""What is written is read again, in every format."""

import numpy as np
import pytest

import sinew

pytestmark = pytest.mark.filterwarnings("ignore::sinew.SinewWarning")


@pytest.mark.parametrize("name", ["Calib.toml", "camera_array.toml", "cameras.yml", "cameras.qca.txt"])
def test_calibrations(walk, tmp_path, name):
    sinew.write(tmp_path / name, walk.cameras)
    for read, written in zip(sinew.read(tmp_path / name), walk.cameras, strict=True):
        assert name == "camera_array.toml" or read.name == written.name
        np.testing.assert_allclose(read.matrix, written.matrix, rtol=1e-9, atol=1e-6)
    with pytest.raises(sinew.FileError, match="exists\nhelp: .*`force=True`"):
        sinew.write(tmp_path / name, walk.cameras)
    sinew.write(tmp_path / name, walk.cameras, force=True)


@pytest.mark.parametrize(("name", "error_m"), [("a.trc", 1e-6), ("a.c3d", 1e-6), ("a.csv", 1e-9)])
def test_points(walk, tmp_path, name, error_m):
    points = walk.truth.copy()
    points[3, 5] = np.nan
    sinew.write(tmp_path / name, sinew.Motion.from_points(walk.points, points, walk.rate_hz))
    read = sinew.read(tmp_path / name)
    assert (read.kind, read.names, read.rate_hz) == ("points", walk.points, walk.rate_hz)
    np.testing.assert_allclose(read.values, points, atol=error_m)
    np.testing.assert_allclose(read.time_s, np.arange(len(points)) / walk.rate_hz, atol=1e-6)


def test_coordinates(tmp_path):
    values = np.random.default_rng(1).normal(0, 30, (5, 2))
    sinew.write(tmp_path / "a.mot", sinew.Motion.from_coordinates(["knee_angle_r", "pelvis_tx"], values, 50))
    read = sinew.read(tmp_path / "a.mot")
    assert (read.kind, read.names, read.rate_hz) == ("coordinates", ["knee_angle_r", "pelvis_tx"], 50)
    np.testing.assert_allclose(read.values, values, atol=1e-6)
    with pytest.raises(sinew.SinewError, match="MOT cannot become TRC"):
        sinew.write(tmp_path / "a.trc", read)


def test_skeletons_of_others(data, tmp_path):
    amc = next((data / "cmu_amc").rglob("*.amc"))
    asf = next(amc.parent.rglob("*.asf"))
    motion = sinew.read(amc, skeleton=asf, fps=120)
    assert motion.kind == "skeleton" and motion.values.shape[1] == len(motion.names)
    sinew.write(tmp_path / "a.bvh", motion)
    np.testing.assert_allclose(sinew.read(tmp_path / "a.bvh").values, motion.values, atol=1e-4)


def test_keypoints(walk, tmp_path):
    names = [camera.name for camera in walk.cameras]
    sinew.write(tmp_path / "pose", sinew.Keypoints(names, walk.keypoints, first_frame=7))
    read = sinew.read(tmp_path / "pose")
    assert (read.cameras, read.first_frame) == (names, 7)
    np.testing.assert_array_equal(read.values, walk.keypoints)
    with pytest.raises(sinew.InputError, match="`first_frame` is -1; expected a whole number"):
        sinew.write(tmp_path / "negative", sinew.Keypoints(names, walk.keypoints, first_frame=-1))


def test_keypoints_of_others(data):
    folder = data / "pose2sim_single"
    read = sinew.read(folder / "T01_BalancingTrial" / "pose", calibration=folder / "Calib.toml")
    assert read.cameras == [camera.name for camera in sinew.read_calibration(folder / "Calib.toml")]
    assert read.values.shape == (100, 4, 3, 25, 3)
    table = sinew.read(next((data / "caliscope_gesture").rglob("xy_*.csv")))
    assert table.values.shape[-1] == 3 and table.rate_hz > 0 and "Nose" in table.layout


def test_pictures_and_masks(tmp_path):
    picture = np.random.default_rng(1).integers(0, 256, (5, 7, 3)).astype(np.uint8)
    sinew.write(tmp_path / "picture.png", picture)
    np.testing.assert_array_equal(sinew.read(tmp_path / "picture.png"), picture)
    mask = picture[:, :, 0] > 128
    sinew.write(tmp_path / "mask.png", mask)
    np.testing.assert_array_equal(sinew.read_mask(tmp_path / "mask.png"), mask)


def test_bodies_and_layouts(tmp_path):
    body = sinew.Body("h32", sizes={"thigh": 0.5})
    sinew.write(tmp_path / "body.toml", body)
    read, pose = sinew.read(tmp_path / "body.toml"), np.random.default_rng(1).normal(0, 0.3, 32)
    np.testing.assert_allclose(read.positions(pose), body.positions(pose), atol=1e-12)
    assert sinew.layouts()["BODY_25B"][0] == "Nose"


def test_what_is_no_file_of_ours_is_said(tmp_path):
    (tmp_path / "a.txt").write_text("hello")
    with pytest.raises(sinew.SinewError, match="a.txt"):
        sinew.read(tmp_path / "a.txt")
    with pytest.raises(sinew.FileError, match="cannot read"):
        sinew.read(tmp_path / "b.toml")
    with pytest.raises(sinew.UsageError, match="`value` is a int; expected cameras"):
        sinew.write(tmp_path / "c.toml", 3)
    with pytest.raises(sinew.UsageError, match="is no name of a calibration"):
        sinew.write(tmp_path / "c.json", sinew.simulate(duration_s=0.2).cameras)
    with pytest.raises(sinew.InputError, match="holds no results"):
        sinew.Result(tmp_path)
