"""Datasets as what the installed ArviZ works on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray as xr


def tree(datasets: Mapping[str, xr.Dataset]) -> Any:
    """`arviz.InferenceData` for ArviZ 0.x, `xarray.DataTree` for ArviZ 1.x and where there is none. Nothing is copied."""
    try:
        import arviz

        inference_data: Any = getattr(arviz, "InferenceData", None)
    except ImportError:
        inference_data = None
    if isinstance(inference_data, type) and not issubclass(inference_data, xr.DataTree):
        return inference_data(**datasets)
    return xr.DataTree.from_dict(dict(datasets))
