"""Opens the results beside this file: python load.py [frame]; with the wheel rerun-sdk the draws are shown too."""
import importlib.util, pathlib, sys
import pandas as pd, xarray as xr
here = pathlib.Path(__file__).parent
posterior = xr.open_datatree(here / "posterior.zarr", engine="zarr")["posterior"].to_dataset()  # or ArviZ's az.from_zarr
joints = pd.read_csv(here / "joints.csv")  # one row per frame and joint, metres, Z up
frame = int(sys.argv[1]) if len(sys.argv) > 1 else int(posterior.frame[0])
print(joints[joints.frame == frame].to_string(index=False), posterior.sel(frame=frame), sep="\n")
if importlib.util.find_spec("rerun"):
    import rerun as rr
    rr.init("sinew", spawn=True)
    for number, at in ((n, posterior.marker_position.sel(frame=n)) for n in posterior.frame.values):
        rr.set_time("frame", sequence=int(number))
        rr.log("draws", rr.Points3D(at.values.reshape(-1, 3), radii=0.005))
        rr.log("mean", rr.Points3D(at.mean(["chain", "draw"]).values, labels=list(posterior.marker.values)))
