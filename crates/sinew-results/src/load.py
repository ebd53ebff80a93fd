"""Opens the results beside this file: python load.py [frame]

Needs the wheels numpy, pandas and xarray, and zarr from version 3 on (Python 3.11 or later) to read only what is looked
at; without it, all of posterior.zarr is read. `tree()` and `inference_data()` are what notebooks want; the latter is what
the installed ArviZ works on. With the wheel rerun-sdk the draws are shown, too.
"""

import importlib.metadata
import importlib.util
import json
import pathlib
import sys

import numpy as np
import pandas as pd
import xarray as xr

here = pathlib.Path(__file__).resolve().parent


def tree(store=here / "posterior.zarr"):
    """posterior, sample_stats, observed_data and constant_data as one xarray.DataTree."""
    is_there = importlib.util.find_spec("zarr") is not None
    if is_there and int(importlib.metadata.version("zarr").split(".")[0]) >= 3:
        return xr.open_datatree(store, engine="zarr")
    groups = {path.parent.name: path.parent for path in sorted(store.glob("*/zarr.json"))}
    return xr.DataTree.from_dict({name: dataset(folder) for name, folder in groups.items()})


def inference_data(data=None):
    """arviz.InferenceData for ArviZ 0.x; the DataTree itself for ArviZ 1.x, which has no class of its own any more."""
    import arviz

    data = tree() if data is None else data
    convert = getattr(getattr(arviz, "InferenceData", None), "from_datatree", None)
    return convert(data) if convert else data


def dataset(folder):
    """A group of the store."""
    arrays = {path.parent.name: array(path.parent) for path in sorted(folder.glob("*/zarr.json"))}
    attributes = json.loads((folder / "zarr.json").read_text(encoding="utf-8"))["attributes"]
    found = xr.Dataset(arrays, attrs=attributes)
    return found.set_coords([name for name in ["time"] if name in found])


def array(folder):
    """An array of the store: chunks of plain little-endian numbers, or texts with their lengths."""
    meta = json.loads((folder / "zarr.json").read_text(encoding="utf-8"))
    shape, chunk = meta["shape"], meta["chunk_grid"]["configuration"]["chunk_shape"]
    attributes = {key: value for key, value in meta["attributes"].items() if key != "coordinates"}
    if meta["data_type"] == "string":
        data, at, values = (folder / "c.0").read_bytes(), 4, []
        while at < len(data):
            end = at + 4 + int.from_bytes(data[at : at + 4], "little")
            values.append(data[at + 4 : end].decode())
            at = end
        return xr.Variable(meta["dimension_names"], np.array(values), attributes)
    kind = np.dtype(meta["data_type"]).newbyteorder("<")
    values = np.empty(shape, kind)
    for number in np.ndindex(*(-(-size // part) for size, part in zip(shape, chunk))):
        place = tuple(slice(n * part, (n + 1) * part) for n, part in zip(number, chunk))
        read = np.fromfile(folder / ".".join(["c", *map(str, number)]), kind).reshape(chunk)
        values[place] = read[tuple(slice(size) for size in values[place].shape)]
    return xr.Variable(meta["dimension_names"], values, attributes)


def show(posterior):
    """The draws over time, in the viewer of rerun."""
    import rerun

    rerun.init("sinew", spawn=True)
    for number in posterior.frame.values:
        at = posterior.marker_position.sel(frame=number)
        rerun.set_time("frame", sequence=int(number))
        rerun.log("draws", rerun.Points3D(at.values.reshape(-1, 3), radii=0.005))
        rerun.log("mean", rerun.Points3D(at.mean(["chain", "draw"]).values, labels=list(posterior.marker.values)))


if __name__ == "__main__":
    posterior = tree()["posterior"].to_dataset()
    joints = pd.read_csv(here / "joints.csv")  # one row per frame and joint, metres, Z up
    frame = int(sys.argv[1]) if len(sys.argv) > 1 else int(posterior.frame[0])
    print(joints[joints.frame == frame].to_string(index=False), posterior.sel(frame=frame), sep="\n")
    if importlib.util.find_spec("rerun"):
        show(posterior)
