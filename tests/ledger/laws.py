"""Recordings that are changed in a way that changes results by a known law."""

import json
import shutil
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

# BODY_25B, as `docs/reference/formats.md` orders it.
NAMES = "Nose LEye REye LEar REar LShoulder RShoulder LElbow RElbow LWrist RWrist LHip RHip LKnee RKnee LAnkle RAnkle Neck Head LBigToe LSmallToe LHeel RBigToe RSmallToe RHeel".split()
SIDE = {"L": "R", "R": "L"}


@dataclass
class Recording:
    """Cameras of a calibration file by name, and keypoints (u, v, confidence) by camera and frame."""

    cameras: dict
    keypoints: dict[str, dict[int, np.ndarray | None]]
    fps: float
    options: list[str] = field(default_factory=list)


def read(folder: Path, fps: float) -> Recording:
    """A recording that `sinew simulate` wrote."""
    calibration = tomllib.loads((folder / "Calib.toml").read_text())
    cameras = {name: camera for name, camera in calibration.items() if isinstance(camera, dict) and "matrix" in camera}
    keypoints = {name: {} for name in cameras}
    for name, frames in keypoints.items():
        for path in sorted((folder / f"keypoints/{name}_json").iterdir()):
            people = json.loads(path.read_text())["people"]
            frames[int(path.stem.rsplit(".", 1)[1])] = np.array(people[0]["pose_keypoints_2d"]).reshape(-1, 3) if people else None
    return Recording(cameras, keypoints, fps)


def write(folder: Path, recording: Recording):
    """Files for `sinew track`."""
    shutil.rmtree(folder, ignore_errors=True)
    lines = []
    for name, camera in recording.cameras.items():
        lines.append(f"[{name}]\nname = {json.dumps(name)}")
        lines += [f"{key} = {json.dumps(value)}" for key, value in camera.items() if key != "name"]
    folder.mkdir()
    (folder / "Calib.toml").write_text("\n".join(lines) + "\n")
    for name, frames in recording.keypoints.items():
        (folder / f"keypoints/{name}_json").mkdir(parents=True)
        for number, points in frames.items():
            people = [] if points is None else [{"pose_keypoints_2d": points.reshape(-1).tolist()}]
            (folder / f"keypoints/{name}_json/{name}.{number:04}.json").write_text(json.dumps({"version": 1.3, "people": people}))


def later(recording, by):
    """The same frames under numbers that begin later."""
    keypoints = {name: {number + by: points for number, points in frames.items()} for name, frames in recording.keypoints.items()}
    return Recording(recording.cameras, keypoints, recording.fps)


def renamed(recording, names):
    """Cameras under other names, in another order."""
    order = sorted(names, key=names.get)
    return Recording({names[name]: recording.cameras[name] for name in order}, {names[name]: recording.keypoints[name] for name in order}, recording.fps)


def with_a_blind_camera(recording):
    """One camera more, which never sees anybody."""
    first = next(iter(recording.cameras))
    blind = {number: None for number in recording.keypoints[first]}
    return Recording({**recording.cameras, "Blind": recording.cameras[first]}, {**recording.keypoints, "Blind": blind}, recording.fps)


def moved(recording, turn, shift):
    """The world turned by a rotation and then shifted, with its cameras."""
    cameras = {}
    for name, camera in recording.cameras.items():
        own = Rotation.from_rotvec(camera["rotation"])
        new = own * turn.inv()
        cameras[name] = {**camera, "rotation": new.as_rotvec().tolist(), "translation": (np.array(camera["translation"]) - new.apply(shift)).tolist()}
    return Recording(cameras, recording.keypoints, recording.fps)


def mirrored(recording):
    """x to −x, left to right: cameras on the other side, pictures turned round, names of sides exchanged."""
    flip = np.diag([-1.0, 1.0, 1.0])
    other = [NAMES.index(SIDE.get(name[0], name[0]) + name[1:] if name[0] in SIDE else name) for name in NAMES]
    cameras, keypoints = {}, {}
    for name, camera in recording.cameras.items():
        width = camera["size"][0]
        turned = flip @ Rotation.from_rotvec(camera["rotation"]).as_matrix() @ flip
        matrix = np.array(camera["matrix"])
        matrix[0, 2] = width - matrix[0, 2]
        cameras[name] = {**camera, "rotation": Rotation.from_matrix(turned).as_rotvec().tolist(), "translation": (flip @ camera["translation"]).tolist(), "matrix": matrix.tolist()}
        keypoints[name] = {}
        for number, points in recording.keypoints[name].items():
            if points is not None:
                points = points[other].copy()
                points[:, 0] = np.where(points[:, 2] > 0, width - points[:, 0], points[:, 0])
            keypoints[name][number] = points
    return Recording(cameras, keypoints, recording.fps)


def at_twice_the_rate(recording):
    """Every second frame of a camera of twice the rate is empty."""
    keypoints = {}
    for name, frames in recording.keypoints.items():
        keypoints[name] = {}
        for number, points in frames.items():
            keypoints[name][2 * number], keypoints[name][2 * number + 1] = points, None
    return Recording(recording.cameras, keypoints, 2 * recording.fps)


def reversed_in_time(recording):
    """The last frame first, within the numbers that there are."""
    keypoints = {name: dict(zip(frames, list(frames.values())[::-1])) for name, frames in recording.keypoints.items()}
    return Recording(recording.cameras, keypoints, recording.fps)


def without(recording, point):
    """No camera sees a point."""
    keypoints = {name: {} for name in recording.keypoints}
    for name, frames in recording.keypoints.items():
        for number, points in frames.items():
            if points is not None:
                points = points.copy()
                points[NAMES.index(point)] = 0
            keypoints[name][number] = points
    return Recording(recording.cameras, keypoints, recording.fps)
