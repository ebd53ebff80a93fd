"""What a run came to: the files of its folder, read when they are looked at."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Any

import xarray as xr

from . import _arviz, _plot, _store, _tables
from ._errors import InputError
from ._words import in_python


class Result:
    """Results of a run, of one person or several.

    Everything is read from the folder when it is first looked at, and kept. Bands and draws say what the model
    believes: given the model, a value lies in its 90 % band with 90 % probability. Of several people every dataset has
    a first dimension `person`, by their numbers in the order of coming; `result[2]` is the `Result` of person 2 alone.

    Parameters
    ----------
    path
        A result folder, of this package or of the program `sinew`.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.notes: list[str] = []
        """What the run noted, in order."""
        self._kept: tempfile.TemporaryDirectory[str] | None = None
        self._read: dict[str, xr.Dataset] = {}
        self._is_of_several = not _is_of_one(self.path)
        if self._is_of_several and not (self.path / "people.csv").is_file():
            raise InputError(f"`{self.path}` holds no results")

    @cached_property
    def summary(self) -> dict[str, Any]:
        """`summary.json`: versions, settings with their origin, what became of whom, whether it is complete."""
        summary: dict[str, Any] = json.loads((self.path / "summary.json").read_text(encoding="utf-8"))
        return summary

    @property
    def complete(self) -> bool:
        """Whether all came to their end."""
        return bool(self.summary["complete"])

    @property
    def failed_diagnostics(self) -> list[str]:
        """Diagnostics that failed, in words; empty where the intervals are to be trusted."""
        if not self._is_of_several:
            return [in_python(text) for text in self.summary["failed_diagnostics"]]
        people = self.summary["people"]
        return [f"person {of['person']}: {in_python(text)}" for of in people for text in of["failed_diagnostics"]]

    @cached_property
    def people(self) -> dict[int, Result]:
        """Results of each person by number, from 1 on; who could not be tracked is not there."""
        if not self._is_of_several:
            return {1: self}
        folders = {of["person"]: self.path / of["folder"] for of in self.summary["people"]}
        found = {number: Result(folder) for number, folder in folders.items() if _is_of_one(folder)}
        for result in found.values():
            result._kept = self._kept
        return found

    def __getitem__(self, person: int) -> Result:
        """Results of one person."""
        if person not in self.people:
            raise KeyError(f"no results of person {person}; there are {list(self.people)}")
        return self.people[person]

    @property
    def posterior(self) -> xr.Dataset:
        """Draws over (chain, draw, frame, …): root and marker positions in metres, angles in radians."""
        return self._group("posterior")

    @property
    def sample_stats(self) -> xr.Dataset:
        """Statistics of draws and frames, by ArviZ's names."""
        return self._group("sample_stats")

    @property
    def joints(self) -> xr.Dataset:
        """Places of the joints over (frame, joint): mean, sd and 5 % and 95 % quantiles of x, y, z, metres."""
        return self._dataset("joints", lambda path: _tables.by_frame(path / "joints.csv", "joint"))

    @property
    def keypoints(self) -> xr.Dataset:
        """The body's points in space over (frame, keypoint), as `joints`."""
        return self._dataset("keypoints", lambda path: _tables.by_frame(path / "keypoints.csv", "keypoint"))

    @property
    def angles(self) -> xr.Dataset:
        """Angles over (frame, name): mean and 5 % and 95 % quantiles, degrees, by OpenSim's names or the ISB's."""
        return self._dataset("angles", lambda path: _tables.by_frame(path / "angles.csv", "name"))

    @property
    def state(self) -> xr.Dataset:
        """Degrees of freedom over (frame, name), in the units that the table states."""
        return self._dataset("state", lambda path: _tables.by_frame(path / "state.csv", "name"))

    @property
    def frames(self) -> xr.Dataset:
        """What is known of each frame: effective number of draws, divergences, residual in pixels, and more."""
        return self._dataset("frames", lambda path: _tables.per_frame(path / "frames.csv"))

    def to_datasets(self) -> dict[str, xr.Dataset]:
        """Every group of `posterior.zarr` by name."""
        groups = [_store.groups(person.path / "posterior.zarr") for person in self.people.values()]
        return {name: self._group(name) for name in (groups[0] if groups else [])}

    def to_arviz(self) -> Any:
        """`arviz.InferenceData` for ArviZ 0.x, `xarray.DataTree` for ArviZ 1.x, over the same arrays."""
        return _arviz.tree(self.to_datasets())

    def plot(self, name: str) -> list[Any]:
        """Plot a joint, keypoint (metres) or angle (degrees) over time: mean and 90 % band.

        Needs Matplotlib (`python -m pip install matplotlib`, or the extra `plot` of this package).

        Parameters
        ----------
        name
            As `joints`, `keypoints` or `angles` have it.

        Returns
        -------
        Axes of Matplotlib: one each for x, y and z, or one for an angle.
        """
        return _plot.plot(self, name)

    def _group(self, name: str) -> xr.Dataset:
        return self._dataset(f"posterior.zarr/{name}", lambda path: _store.group(path / "posterior.zarr", name))

    def _dataset(self, name: str, read: Callable[[Path], xr.Dataset]) -> xr.Dataset:
        """What `read` reads, of several people along `person`."""
        if name not in self._read:
            each = {number: person._dataset(name, read) for number, person in self.people.items() if person is not self}
            self._read[name] = _stacked(each) if self._is_of_several else read(self.path)
        return self._read[name]

    def __reduce__(self) -> tuple[Any, ...]:
        return Result, (self.path,), {"notes": self.notes}

    def __deepcopy__(self, memo: dict[int, Any]) -> Result:
        return self

    def __repr__(self) -> str:
        state = "complete" if self.complete else "incomplete"
        held = f"{len(self.people)} people" if self._is_of_several else f"{self.summary['frame_count']} frames"
        return f"Result({str(self.path)!r}: {held}, {state})"


def _stacked(people: dict[int, xr.Dataset]) -> xr.Dataset:
    """Datasets of each person along `person`; frames that one of them lacks are NaN, or false."""
    if not people:
        raise InputError("nobody was tracked")
    sets = list(people.values())
    absent = {name: False for name, of in sets[0].data_vars.items() if of.dtype == bool}
    number = xr.DataArray(list(people), dims="person", name="person")
    how: dict[str, Any] = {"join": "outer", "compat": "no_conflicts", "coords": "minimal", "data_vars": "all"}
    return xr.concat(sets, number, fill_value=absent, **how)


def _is_of_one(path: Path) -> bool:
    return (path / "joints.csv").is_file()
