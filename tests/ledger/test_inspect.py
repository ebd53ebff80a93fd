"""What `sinew inspect` says of clocks: a camera is as late as the test makes it."""

import re

import laws
import numpy as np
import pytest
import results
from cameras import Cameras

FPS, SECONDS, NOISE_PX, LARGER = 30.0, 4, 1.0, 4
# The person walks from then on; the frames before and after are for the camera that is late or early.
FIRST, FRAMES = 36, 80
# Lags are printed to so many frames.
DIGIT = 0.1


@pytest.fixture(scope="module")
def walking(call, tmp_path_factory):
    """A simulated walk that is long enough for clocks, with places of its keypoints, frames × keypoints × 3."""
    folder = tmp_path_factory.mktemp("walking")
    call(folder, "simulate", "--duration", SECONDS, "--images", "none", "--seed", 3, "-o", "walk")
    truth = results.read_trc(folder / "walk/truth.trc")
    return laws.read(folder / "walk", FPS), np.stack([truth[[f"{name}.Z", f"{name}.X", f"{name}.Y"]].to_numpy() for name in laws.NAMES], 1)


def with_a_late_camera(recording, points, late):
    """The walk in images four times as large, with the errors of a good detector; of the second camera `late` frames late."""
    tables = {name: camera | {"size": [LARGER * x for x in camera["size"]], "matrix": [[LARGER * x for x in row] for row in camera["matrix"][:2]] + [camera["matrix"][2]]} for name, camera in recording.cameras.items()}
    rng = np.random.default_rng(1)
    keypoints = {}
    for index, name in enumerate(tables):
        first = FIRST - (late if index == 1 else 0)
        pixels = Cameras([tables[name]]).pixels(points[first : first + FRAMES])[:, :, 0]
        pixels += NOISE_PX * rng.normal(size=pixels.shape)
        keypoints[name] = {frame: np.insert(own, 2, 0.9, axis=1) for frame, own in enumerate(pixels)}
    return laws.Recording(tables, keypoints, FPS)


@pytest.mark.parametrize("late", [2, -3])
def test_a_camera_is_as_late_as_it_was_made(call, walking, tmp_path, late):
    laws.write(tmp_path / "late", with_a_late_camera(*walking, late))
    said = call(tmp_path, "inspect", "late/Calib.toml", "late/keypoints", "--layout", "BODY_25B", "--fps", FPS)
    lags = re.findall(r"^  (\S+) .* lag ([+-][\d.]+) ± ([\d.]+) frames$", said, re.MULTILINE)
    assert len(lags) == 4, said
    for (_, frames, sd), exact in zip(lags, (0, late, 0, 0)):
        assert abs(float(frames) - exact) < 1.01 * DIGIT and float(sd) < 1.01 * DIGIT, said
