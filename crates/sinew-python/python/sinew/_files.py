"""Files of every known format, read by what they contain and written by their names."""

from __future__ import annotations

import os
import tomllib
import warnings as python_warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar, overload

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from . import _sinew, _store, _tables
from ._errors import FileError, InputError, SinewWarning, UsageError
from ._result import Result
from ._sinew import Body, Camera, Motion
from ._words import in_python

_PICTURES = (".png", ".jpg", ".jpeg")


@dataclass(frozen=True)
class Keypoints:
    """Keypoints of a recording, of any detector."""

    cameras: list[str]
    """Names of the cameras, in the order of the calibration if one was given."""
    values: NDArray[np.float64]
    """(frames, cameras, people, points, 3): u, v in pixels and confidence, 0 to 1; NaN where nothing was seen."""
    layout: list[str | None] | None = None
    """Names of the points; None where the files do not say them."""
    first_frame: int = 0
    """Number of the first frame."""
    rate_hz: float | None = None
    """Frames per second, where the files have times."""


@dataclass(frozen=True)
class Layout:
    """Meaning of a detector's keypoints."""

    name: str
    points: list[str | None]
    """Names of the points in the detector's order; None where a point has no use."""


Content = (
    list[Camera]
    | Body
    | Motion
    | Keypoints
    | Layout
    | Result
    | NDArray[np.uint8]
    | dict[str, xr.Dataset]
    | dict[str, NDArray[Any]]
    | dict[str, Any]
)
"""What `read` returns where nobody says what is expected."""

T = TypeVar("T", Body, Motion, Keypoints, Layout, Result)


@overload
def read(
    path: str | Path,
    expected: type[T],
    *,
    calibration: str | Path | None = None,
    layout: str | None = None,
    skeleton: str | Path | None = None,
    fps: float | None = None,
    confidence_scale: float = 1.0,
) -> T: ...
@overload
def read(
    path: str | Path,
    expected: None = None,
    *,
    calibration: str | Path | None = None,
    layout: str | None = None,
    skeleton: str | Path | None = None,
    fps: float | None = None,
    confidence_scale: float = 1.0,
) -> Content: ...
def read(
    path: str | Path,
    expected: type[Any] | None = None,
    *,
    calibration: str | Path | None = None,
    layout: str | None = None,
    skeleton: str | Path | None = None,
    fps: float | None = None,
    confidence_scale: float = 1.0,
) -> Any:
    """Read a file or folder of any known format, by what it contains.

    Parameters
    ----------
    path
        A calibration, a body, a motion, keypoints, a picture or mask, a table, results, or draws.
    expected
        Class of what it must be, `sinew.Motion` for instance, which type checkers then know: anything else is an
        `InputError`. Without it the content decides.
    calibration
        For keypoints: the order of the cameras, and their sizes in pixels where files have shares of the image.
    layout
        For keypoints: name of their layout.
    skeleton
        For motions: the ASF file of an AMC file.
    fps
        For motions: frames per second of files that state none.
    confidence_scale
        For keypoints: the confidence that means certainty.

    Returns
    -------
    A list of `Camera` (`read_calibration` for type checkers), a `Body`, a `Motion`, `Keypoints`, a `Layout`, an array
    of pixels, a `Result`, a dict of xarray datasets (draws), of columns (tables), or of values (TOML of settings and
    set-ups).
    """
    found = _read(Path(path), calibration, layout, skeleton, fps, confidence_scale)
    if expected is not None and not isinstance(found, expected):
        raise InputError(f"`{path}` holds a {type(found).__name__}; expected a {expected.__name__}")
    return found


def _read(
    path: Path,
    calibration: str | Path | None,
    layout: str | None,
    skeleton: str | Path | None,
    fps: float | None,
    confidence_scale: float,
) -> Content:
    if path.is_file() and path.suffix.lower() in _PICTURES:
        return _sinew.read_picture(path)
    if path.is_file() and path.suffix.lower() == ".urdf":
        return Body(str(path))
    if path.is_file() and path.suffix.lower() == ".amc":
        return _motion(path, skeleton, fps)
    kind = _sinew.kind(path)
    if kind == "calibration":
        return read_calibration(path)
    if kind == "body":
        return Body(str(path))
    if kind == "layout":
        return Layout(*_sinew.read_layout(path))
    if kind == "keypoints":
        seen = _sinew.read_keypoints(path, None if calibration is None else Path(calibration), layout, confidence_scale)
        cameras, first, names, rate_hz, values = seen
        return Keypoints(cameras, values, names, first, rate_hz)
    if kind == "results":
        return Result(path)
    if kind == "draws":
        return {name: _store.group(path, name) for name in _store.groups(path)}
    if kind == "toml":
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    if kind == "motion":
        return _motion_or_table(path, skeleton, fps)
    if kind == "table":
        return _tables.columns(path)
    raise InputError(f"`{path}` holds {kind}, which this function does not read")


def _motion(path: Path, skeleton: str | Path | None, fps: float | None) -> Motion:
    motion = _sinew.read_motion(path, None if skeleton is None else Path(skeleton), fps)
    for text in motion.warnings:
        python_warnings.warn(in_python(text), SinewWarning, stacklevel=5)
    return motion


def _motion_or_table(path: Path, skeleton: str | Path | None, fps: float | None) -> Motion | dict[str, NDArray[Any]]:
    try:
        return _motion(path, skeleton, fps)
    except InputError:
        if path.suffix.lower() != ".csv":
            raise
        return _tables.columns(path)


def read_calibration(path: str | Path) -> list[Camera]:
    """Read the cameras of a calibration file of Pose2Sim, Caliscope, Anipose, FreeMoCap, Qualisys or OpenCV."""
    cameras, odd = _sinew.read_calibration(Path(path))
    for text in odd:
        python_warnings.warn(in_python(text), SinewWarning, stacklevel=3)
    return cameras


def read_mask(path: str | Path) -> NDArray[np.bool_]:
    """Read a mask (PNG): (rows, columns), true in the person."""
    return _sinew.read_mask(Path(path))


def write(path: str | Path, value: Any, *, force: bool = False) -> None:
    """Write a value in the format of the file name.

    Parameters
    ----------
    path
        `.toml` (Pose2Sim), `camera_array.toml` (Caliscope), `.yml` (OpenCV) or `.qca.txt` (Qualisys) for cameras;
        `.toml` for a body; `.trc`, `.c3d`, `.csv`, `.mot`, `.bvh` or `.glb` for a motion; `.png` for a picture or a
        mask; a folder for keypoints, which become OpenPose files, a folder a camera.
    value
        A sequence of `Camera`, a `Body`, a `Motion`, `Keypoints`, or an array of pixels: (rows, columns, 3) of uint8,
        or (rows, columns) of bool.
    force
        Replace what is there.
    """
    path = Path(os.fspath(path))
    if path.exists() and not force:
        raise FileError(f"`{path}` exists\nhelp: choose another place, or replace it with `force=True`")
    if isinstance(value, Body):
        _sinew.write_body(path, value)
    elif isinstance(value, Motion):
        _sinew.write_motion(path, value)
    elif isinstance(value, Keypoints):
        _sinew.write_keypoints(path, value.cameras, value.values, value.first_frame)
    elif isinstance(value, np.ndarray) and value.ndim == 3 and value.dtype == np.uint8:
        _sinew.write_picture(path, value)
    elif isinstance(value, np.ndarray) and value.ndim == 2 and value.dtype == np.bool_:
        _sinew.write_mask(path, value)
    elif _is_cameras(value):
        _sinew.write_calibration(path, list(value))
    else:
        raise UsageError(
            f"`value` is a {type(value).__name__}; expected cameras, a Body, a Motion, Keypoints, or pixels "
            "(uint8 with three channels, or bool)"
        )


def _is_cameras(value: object) -> bool:
    return isinstance(value, Sequence) and len(value) > 0 and all(isinstance(of, Camera) for of in value)


def layouts() -> dict[str, list[str | None]]:
    """Keypoint layouts by name: the points in the order of the detector, None where a point has no use."""
    return dict(_sinew.layouts())
