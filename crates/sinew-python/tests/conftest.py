"""What the tests share: a simulated walk, the program if it is there, the data if they are there."""

import os
import warnings
from pathlib import Path

import pytest

import sinew

WORKSPACE = Path(__file__).resolve().parents[3]
BVH = """HIERARCHY
ROOT Hip
{
OFFSET 0 90 0
CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
End Site
{
OFFSET 0 80 10
}
}
MOTION
Frames: 2
Frame Time: .04
0 0 0 0 0 0
10 5 0 30 20 10
"""


@pytest.fixture(scope="session")
def walk():
    """Half a second of a walk before four cameras."""
    return sinew.simulate(duration_s=1.5, fps=20.0, seed=3)


@pytest.fixture(scope="session")
def program():
    """The program `sinew`, built from the same sources."""
    named = os.environ.get("SINEW_PROGRAM")
    if named is None or not Path(named).is_file():
        pytest.skip("no program: SINEW_PROGRAM names it")
    return named


@pytest.fixture(scope="session")
def data():
    """The folder of shared data."""
    folder = Path(os.environ.get("SINEW_DATA", WORKSPACE.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip("no data: SINEW_DATA names them")
    return folder


@pytest.fixture(scope="session")
def result(recording, walk, tmp_path_factory):
    """The first eight frames of the walk, tracked from its files."""
    out = tmp_path_factory.mktemp("out") / "files"
    options = {"layout": "BODY_25B", "fps": walk.rate_hz, "frames": (0, 8), "seed": 4}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sinew.track(recording / "Calib.toml", recording / "pose", out=out, **options)


@pytest.fixture(scope="session")
def setup(result):
    """The set-up of that run, which spares others most of their time."""
    return result.path / "setup.toml"


@pytest.fixture(scope="session")
def recording(walk, tmp_path_factory):
    """The walk as files: calibration and a folder of keypoints."""
    folder = tmp_path_factory.mktemp("recording")
    sinew.write(folder / "Calib.toml", walk.cameras)
    names = [camera.name for camera in walk.cameras]
    sinew.write(folder / "pose", sinew.Keypoints(names, walk.keypoints))
    return folder
