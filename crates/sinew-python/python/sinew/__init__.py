"""Markerless human motion capture with a posterior over 3D poses.

Lengths are metres, angles radians, times seconds, image places pixels; the world has z up. Arrays are NumPy's, and
named results are xarray's.
"""

from . import particles, samplers
from ._errors import DiagnosticWarning, FileError, InputError, SinewError, SinewWarning, UsageError
from ._result import People, Result
from ._sinew import Body, Camera, ChainDraws, Triangulated, __version__, triangulate
from ._track import settings, track

__all__ = [
    "Body",
    "Camera",
    "ChainDraws",
    "DiagnosticWarning",
    "FileError",
    "InputError",
    "People",
    "Result",
    "SinewError",
    "SinewWarning",
    "Triangulated",
    "UsageError",
    "__version__",
    "particles",
    "samplers",
    "settings",
    "track",
    "triangulate",
]
