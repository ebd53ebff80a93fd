"""Opens the store of tests/zarr_store.rs with the programs that users have, and checks values and names."""

import sys
import warnings

import numpy as np
import xarray as xr
import zarr

path = sys.argv[1]

with warnings.catch_warnings():
    warnings.simplefilter("error")
    root = zarr.open_group(path, mode="r", use_consolidated=True)
    # Without a group there are no variables; the attributes tell where they are.
    whole = xr.open_zarr(path)
assert whole.attrs["groups"] == ["posterior", "sample_stats", "constant_data"] and "group=" in whole.attrs["open_with"]
assert root["posterior/angle"].shape == (2, 20, 150, 3)

tree = xr.open_datatree(path, engine="zarr").load()
posterior = tree["posterior"].to_dataset()
assert set(posterior.data_vars) == {"angle", "root", "marker_position"}, posterior
assert "time" in posterior.coords and posterior["angle"].coords["time"].dims == ("frame",)
assert list(posterior["marker_position"].coords["marker"].values) == ["Nose", "Größe"]
assert list(posterior["axis"].values) == ["x", "y", "z"]
assert posterior["frame"].values[0] == 100 and posterior["frame"].values[-1] == 249
frame, index = 130, 7 * 3 + 2
expected = np.float32(frame + (index * 7919) % 1000 / 1000)
assert posterior["angle"].values.reshape(40, 150, 3)[7, frame, 2] == expected
assert not np.isnan(posterior["marker_position"].values).any()
stats = tree["sample_stats"].to_dataset()
assert stats["diverging"].dtype == bool and stats["n_steps"].dtype == np.int64
assert list(tree["constant_data"]["camera_centre"].values[0]) == [1.0, 2.0, 3.0]
assert posterior.attrs["inference_library"] == "sinew" and posterior.attrs["kind"] == "filtered"

killed = xr.open_datatree(sys.argv[2], engine="zarr", consolidated=False).load()["posterior"]
assert killed.sizes["frame"] == 64 and not np.isnan(killed["angle"].values).any()
print("xarray opens the store, and what a killed run left")


def check_arviz():
    import arviz as az

    # ArviZ 1.x works on the tree itself; its InferenceData is another name of DataTree.
    convert = getattr(getattr(az, "InferenceData", None), "from_datatree", None)
    data = convert(tree) if convert else tree
    one = data.posterior.to_dataset() if hasattr(data.posterior, "to_dataset") else data.posterior
    summary = az.summary(one.isel(frame=10), var_names=["angle", "root"])
    assert len(summary) == 6, summary
    assert len(az.summary(data, var_names=["root"])) == 150 * 3
    print("ArviZ", az.__version__, "summarises the store")
