"""Plots of results over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import xarray as xr

if TYPE_CHECKING:
    from ._result import Result


def plot(result: Result, name: str) -> list[Any]:
    """Axes with the mean of a point or an angle and its 90 % band, a colour a person."""
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        text = "plots need Matplotlib\nhelp: install it, for example with `python -m pip install matplotlib`"
        raise ImportError(text, name="matplotlib") from error
    table, series = _found(result, name)
    _, axes = plt.subplots(len(series), 1, sharex=True, squeeze=False)
    people = [table.sel(person=number) for number in table.person.values] if "person" in table.dims else [table]
    for axis, (prefix, unit, label) in zip(axes[:, 0], series, strict=True):
        for one in people:
            number = {"label": f"person {int(one.person)}"} if len(people) > 1 else {}
            (line,) = axis.plot(one.time, one[f"{prefix}mean_{unit}"], **number)
            band = one[f"{prefix}q05_{unit}"], one[f"{prefix}q95_{unit}"]
            axis.fill_between(one.time, *band, color=line.get_color(), alpha=0.3, linewidth=0)
        axis.set_ylabel(label)
    axes[0, 0].set_title(f"{name}, mean and 90 % band")
    axes[-1, 0].set_xlabel("time (s)")
    if len(people) > 1:
        axes[0, 0].legend()
    return list(axes[:, 0])


def _found(result: Result, name: str) -> tuple[xr.Dataset, list[tuple[str, str, str]]]:
    """The table with the name, and of each series: prefix and unit of the columns, label."""
    known: list[str] = []
    for table, label in ((result.joints, "joint"), (result.keypoints, "keypoint"), (result.angles, "name")):
        names = table[label].values.tolist()
        known += [of for of in names if of not in known]
        if name in names and label == "name":
            return table.sel(name=name), [("", "deg", "angle (degrees)")]
        if name in names:
            return table.sel({label: name}), [(f"{axis}_", "m", f"{axis} (m)") for axis in "xyz"]
    raise KeyError(f"no joint, keypoint or angle `{name}`; known: {', '.join(known)}")
