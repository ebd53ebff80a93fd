"""What a run came to: the files of its folder, read when they are looked at."""

from __future__ import annotations

import json
import tempfile
from functools import cached_property
from pathlib import Path
from typing import Any

import xarray as xr

from . import _arviz, _store, _tables
from ._errors import InputError


class _Stored:
    """What a folder of results says of itself."""

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.notes: list[str] = []
        """What the run noted, in order."""
        self._kept: tempfile.TemporaryDirectory[str] | None = None

    @cached_property
    def summary(self) -> dict[str, Any]:
        """`summary.json`: versions, settings with their origin, what became of whom, whether it is complete."""
        return json.loads((self.path / "summary.json").read_text(encoding="utf-8"))

    @property
    def complete(self) -> bool:
        """Whether all came to their end."""
        return bool(self.summary["complete"])


class Result(_Stored):
    """Results of one person.

    Everything is read from the folder when it is first looked at, and kept. Bands and draws say what the model
    believes: given the model, a value lies in its 90 % band with 90 % probability.

    Parameters
    ----------
    path
        A result folder, of this package or of the program `sinew`.
    """

    def __init__(self, path: str | Path) -> None:
        super().__init__(path)
        if not (self.path / "joints.csv").is_file():
            partial = " (it holds several people; `sinew.People` reads it)" if _is_of_several(self.path) else ""
            raise InputError(f"`{self.path}` holds no results of one person{partial}")

    @property
    def failed_diagnostics(self) -> list[str]:
        """Diagnostics that failed, in words; empty where the intervals are to be trusted."""
        return list(self.summary["failed_diagnostics"])

    @cached_property
    def posterior(self) -> xr.Dataset:
        """Draws over (chain, draw, frame, …): root and marker positions in metres, angles in radians."""
        return _store.group(self.path / "posterior.zarr", "posterior")

    @cached_property
    def sample_stats(self) -> xr.Dataset:
        """Statistics of draws and frames, by ArviZ's names."""
        return _store.group(self.path / "posterior.zarr", "sample_stats")

    @cached_property
    def joints(self) -> xr.Dataset:
        """Places of the joints over (frame, joint): mean, sd and 5 % and 95 % quantiles of x, y, z, metres."""
        return _tables.by_frame(self.path / "joints.csv", "joint")

    @cached_property
    def keypoints(self) -> xr.Dataset:
        """The body's points in space over (frame, keypoint), as `joints`."""
        return _tables.by_frame(self.path / "keypoints.csv", "keypoint")

    @cached_property
    def angles(self) -> xr.Dataset:
        """Angles over (frame, name): mean and 5 % and 95 % quantiles, degrees, by OpenSim's names or the ISB's."""
        return _tables.by_frame(self.path / "angles.csv", "name")

    @cached_property
    def state(self) -> xr.Dataset:
        """Degrees of freedom over (frame, name), in the units that the table states."""
        return _tables.by_frame(self.path / "state.csv", "name")

    @cached_property
    def frames(self) -> xr.Dataset:
        """What is known of each frame: effective number of draws, divergences, residual in pixels, and more."""
        return _tables.per_frame(self.path / "frames.csv")

    def to_datasets(self) -> dict[str, xr.Dataset]:
        """Every group of `posterior.zarr` by name."""
        store = self.path / "posterior.zarr"
        read = {"posterior": lambda: self.posterior, "sample_stats": lambda: self.sample_stats}
        return {name: read[name]() if name in read else _store.group(store, name) for name in _store.groups(store)}

    def to_arviz(self) -> Any:
        """`arviz.InferenceData` for ArviZ 0.x, `xarray.DataTree` for ArviZ 1.x, over the same arrays."""
        return _arviz.tree(self.to_datasets())

    def __repr__(self) -> str:
        state = "complete" if self.complete else "incomplete"
        return f"Result({str(self.path)!r}: {self.summary['frame_count']} frames, {state})"


class People(_Stored):
    """Results of several people, each of them a `Result`.

    Parameters
    ----------
    path
        A folder of results of several people.
    """

    def __init__(self, path: str | Path) -> None:
        super().__init__(path)
        if not _is_of_several(self.path):
            raise InputError(f"`{self.path}` holds no results of several people")

    @property
    def failed_diagnostics(self) -> list[str]:
        """Diagnostics that failed, in words, with the person of whom."""
        people = self.summary["people"]
        return [f"person {of['person']}: {text}" for of in people for text in of["failed_diagnostics"]]

    @cached_property
    def people(self) -> list[Result | None]:
        """Everybody, in the order of coming; None who could not be tracked."""
        return [self._one(of["folder"]) for of in self.summary["people"]]

    def _one(self, folder: str) -> Result | None:
        path = self.path / folder
        if not (path / "joints.csv").is_file():
            return None
        result = Result(path)
        result._kept = self._kept
        return result

    def __repr__(self) -> str:
        return f"People({str(self.path)!r}: {len(self.summary['people'])} people)"


def opened(path: Path) -> Result | People:
    """The results in a folder."""
    return People(path) if _is_of_several(path) else Result(path)


def _is_of_several(path: Path) -> bool:
    return (path / "people.csv").is_file()


__all__ = ["People", "Result", "opened"]
