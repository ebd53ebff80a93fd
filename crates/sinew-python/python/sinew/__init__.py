"""Markerless human motion capture with a posterior over 3D poses.

Lengths are metres, angles radians, times seconds, image places pixels; the world has z up. Arrays are NumPy's, and
named results are xarray's.
"""

from . import particles, samplers
from ._errors import DiagnosticWarning, FileError, InputError, SinewError, SinewWarning, UsageError
from ._files import Keypoints, Layout, layouts, read, read_calibration, read_mask, write
from ._records import ChainDraws, Simulated, Triangulated
from ._result import Result
from ._settings import Settings
from ._sinew import Body, Camera, Motion, __version__, simulate, triangulate
from ._track import settings, track

__all__ = [
    "Body",
    "Camera",
    "ChainDraws",
    "DiagnosticWarning",
    "FileError",
    "InputError",
    "Keypoints",
    "Layout",
    "Motion",
    "Result",
    "Settings",
    "Simulated",
    "SinewError",
    "SinewWarning",
    "Triangulated",
    "UsageError",
    "__version__",
    "layouts",
    "particles",
    "read",
    "read_calibration",
    "read_mask",
    "samplers",
    "settings",
    "simulate",
    "track",
    "triangulate",
    "write",
]
