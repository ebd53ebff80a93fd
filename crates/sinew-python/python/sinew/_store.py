"""Groups of a Zarr store as xarray datasets, without the package zarr."""

from __future__ import annotations

import json
from pathlib import Path

import xarray as xr

from ._sinew import zarr_group, zarr_groups


def group(store: Path, name: str) -> xr.Dataset:
    """A group of the store over the arrays that were read, which are not copied."""
    attributes, arrays = zarr_group(store, name)
    variables: dict[str, xr.Variable] = {}
    for array, (dimensions, values, own) in arrays.items():
        kept = {key: value for key, value in json.loads(own).items() if key != "coordinates"}
        variables[array] = xr.Variable(dimensions, values, kept)
    dataset = xr.Dataset(variables, attrs=json.loads(attributes))
    return dataset.set_coords([name for name in ["time"] if name in dataset])


def groups(store: Path) -> list[str]:
    """Names of the groups of the store."""
    return zarr_groups(store)
