"""Tables of a result folder as xarray datasets."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray


def columns(path: Path) -> dict[str, NDArray[Any]]:
    """Columns of a table: numbers where all cells are numbers or empty, else texts."""
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    header, body = rows[0], rows[1:]
    found: dict[str, NDArray[Any]] = {}
    for name, cells in zip(header, zip(*body, strict=True) if body else [()] * len(header), strict=True):
        try:
            found[name] = np.array([float(cell) if cell else np.nan for cell in cells])
        except ValueError:
            found[name] = np.array(cells, dtype=np.str_)
    return found


def by_frame(path: Path, label: str) -> xr.Dataset:
    """A table with a row a frame and `label`, as variables over (frame or time, label)."""
    table = columns(path)
    names = list(dict.fromkeys(table[label].tolist()))
    count = len(names)
    time_s = table["time_s"][::count]
    dropped = {label, "time_s", "frame", "person"}
    variables = {
        name: (("frame", label), values.reshape(-1, count)) for name, values in table.items() if name not in dropped
    }
    frames = table["frame"][::count].astype(int) if "frame" in table else np.arange(len(time_s))
    coordinates = {label: names, "frame": frames, "time": ("frame", time_s, {"units": "s"})}
    return xr.Dataset(variables, coords=coordinates)


def per_frame(path: Path) -> xr.Dataset:
    """A table with a row a frame, as variables over it."""
    table = columns(path)
    variables = {
        name: ("frame", values) for name, values in table.items() if name not in {"time_s", "frame", "person"}
    }
    coordinates = {"frame": table["frame"].astype(int), "time": ("frame", table["time_s"], {"units": "s"})}
    return xr.Dataset(variables, coords=coordinates)
