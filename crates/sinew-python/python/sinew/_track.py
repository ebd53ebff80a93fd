"""Tracking: settings as keyword arguments, recordings from files or arrays."""

from __future__ import annotations

import logging
import os
import tempfile
import warnings as python_warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from . import _sinew
from ._errors import DiagnosticWarning, InputError, SinewWarning, UsageError
from ._progress import Progress, chosen
from ._result import Result
from ._settings import Settings
from ._sinew import Camera
from ._words import in_python

_log = logging.getLogger("sinew")


def track(
    calibration: str | Path | Sequence[Camera] | None = None,
    keypoints: str | Path | ArrayLike | None = None,
    *,
    layout: str | Path | Sequence[str | None] | None = None,
    first_frame: int = 0,
    out: str | Path | None = None,
    config: str | Path | None = None,
    resume: bool = False,
    page: bool = False,
    write_calibration: str | Path | None = None,
    progress: bool | Progress | None = None,
    **settings: Unpack[Settings],
) -> Result:
    """Track the people in a recording; what `sinew track` does, with the same bytes in the same files.

    Parameters
    ----------
    calibration
        Calibration file of any known program, or cameras.
    keypoints
        Folder or file of keypoints, or an array (frames, cameras, people, points, 3), or (frames, cameras, points, 3)
        for one person: u and v in pixels and the detector's confidence, 0 to 1. NaN or a confidence of 0 is a point
        that was not seen. An array needs cameras, in the order of its second dimension.
    layout
        Name of a keypoint layout or a mapping file; for arrays also the names of the points. Guessed by default.
    first_frame
        Number of the first frame of an array.
    out
        Folder for the results. By default a temporary one, which lives as long as the result.
    config
        A file of settings, as `sinew track --config` takes it.
    resume
        Continue a run that was stopped in the folder `out`.
    page
        Write `report.html` into the folder.
    write_calibration
        File for the calibration as the set-up refined it.
    progress
        True, False or a function of (what, unit, done, total); by default a line in notebooks and on terminals.
    **settings
        Any setting by its key: `fps=60, method="hmc", frames=(0, 500), seed=7, smooth=True, threads=2`;
        `sinew.settings()` lists them.

    Returns
    -------
    A `Result`, of one person as of several: `result.joints`, `result.people`, `result[2]`.

    Raises
    ------
    UsageError, InputError, FileError, SinewError
        As the program's errors. Ctrl-C finishes the frame at hand, keeps what is done in `out`, and raises
        KeyboardInterrupt; `resume=True` continues from there.
    """
    kept = tempfile.TemporaryDirectory(prefix="sinew-") if out is None else None
    folder = Path(kept.name, "results") if kept is not None else Path(os.fspath(out))  # type: ignore[arg-type]
    if resume and kept is not None:
        raise UsageError("`resume` needs the folder `out` of the run that was stopped")
    given = None
    all_settings: dict[str, Any] = dict(settings)
    if _is_array(keypoints) or _is_cameras(calibration):
        given = _given(calibration, keypoints, layout, first_frame)
        if write_calibration is not None:
            raise UsageError("`write_calibration` refines a calibration file; here cameras are given")
        layout = layout if isinstance(layout, (str, Path)) else None
    else:
        all_settings |= {"calibration": calibration, "keypoints": keypoints}
    all_settings["layout"] = layout
    typed = [(key, _typed(key, value)) for key, value in all_settings.items() if value is not None]
    typed.append(("out", _typed("out", folder)))
    heard = _Heard()
    path, failed = _sinew.track(
        typed,
        given,
        None if config is None else Path(config),
        resume,
        page,
        None if write_calibration is None else Path(write_calibration),
        heard,
        chosen(progress),
    )
    if failed:
        text = "\n".join(["a diagnostic failed; do not trust the intervals there", *failed])
        python_warnings.warn(in_python(text), DiagnosticWarning, stacklevel=2)
    result = Result(path)
    result.notes = heard.notes
    result._kept = kept
    return result


class _Heard:
    """Warnings become Python's, notes go to the log."""

    def __init__(self) -> None:
        self.notes: list[str] = []

    def __call__(self, kind: str, text: str) -> None:
        text = in_python(text)
        if kind == "warning":
            python_warnings.warn(text, SinewWarning, stacklevel=3)
        else:
            self.notes.append(text)
            _log.info(text)


def settings() -> dict[str, str]:
    """All settings of a run with their meaning, in the order of the reference."""
    return {key: meaning for key, meaning, _, _ in _sinew.settings_table()}


def _is_array(keypoints: object) -> bool:
    return keypoints is not None and not isinstance(keypoints, (str, os.PathLike))


def _is_cameras(calibration: object) -> bool:
    return calibration is not None and not isinstance(calibration, (str, os.PathLike))


def _given(
    calibration: Any, keypoints: Any, layout: Any, first_frame: int
) -> tuple[list[Camera], Any, list[str | None] | None, int]:
    """Cameras and keypoints of arrays."""
    if isinstance(calibration, (str, os.PathLike)):
        calibration, _ = _sinew.read_calibration(Path(calibration))
    if calibration is None or not _is_array(keypoints):
        raise UsageError("arrays of keypoints and cameras (or a calibration file) belong together; one of them is missing")
    cameras = list(calibration)
    for camera in cameras:
        if not isinstance(camera, Camera):
            raise UsageError(f"`calibration` holds a {type(camera).__name__}; expected cameras (`sinew.Camera`)")
    try:
        values = np.asarray(keypoints, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"`keypoints` is no array of numbers\ncaused by: {error}") from error
    if values.ndim == 4:
        values = values[:, :, np.newaxis]
    names = None if layout is None or isinstance(layout, (str, Path)) else list(layout)
    return cameras, values, names, first_frame


def _typed(key: str, value: Any) -> str:
    """A setting as it is typed on the command line."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, range):
        value = (value.start, value.stop)
    if key in ("frames", "setup_frames") and isinstance(value, Sequence) and not isinstance(value, str):
        if len(value) != 2:
            raise UsageError(f"`{key}` has {len(value)} numbers; expected (first, end), the end not included")
        return f"{int(value[0])}..{int(value[1])}"
    if isinstance(value, Mapping):
        return ",".join(f"{name}={_typed(key, of)}" for name, of in value.items())
    if isinstance(value, (list, tuple, np.ndarray)):
        return ",".join(_typed(key, of) for of in value)
    if isinstance(value, (float, np.floating)):
        value = float(value)
        return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    text = os.fspath(value) if isinstance(value, os.PathLike) else str(value)
    try:
        text.encode()
    except UnicodeEncodeError:
        raise UsageError(f"`{key}` is {text!r}, which is not UTF-8; rename it, or give a link with another name") from None
    return text
