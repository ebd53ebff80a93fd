"""Opens the results beside this file: python load.py [frame]; with the wheel rerun-sdk the draws are shown too."""
import pathlib, sys
import pandas as pd, xarray as xr

here = pathlib.Path(__file__).parent
draws = xr.open_datatree(here / "posterior.zarr", engine="zarr")  # ArviZ >= 1: az.from_zarr(here / "posterior.zarr")
joints = pd.read_csv(here / "joints.csv")                         # one row per frame and joint, metres, Z up
posterior = draws["posterior"].to_dataset()
frame = int(sys.argv[1]) if len(sys.argv) > 1 else int(posterior.frame[0])
print(joints[joints.frame == frame].drop(columns=["person", "time_s"]).to_string(index=False))
print(posterior.sel(frame=frame))
try:
    import rerun as rr
except ImportError:
    sys.exit()
rr.init("sinew", spawn=True)
for number in posterior.frame.values:
    rr.set_time("frame", sequence=int(number))
    at = posterior.marker_position.sel(frame=number)
    rr.log("draws", rr.Points3D(at.values.reshape(-1, 3), radii=0.005))
    rr.log("mean", rr.Points3D(at.mean(["chain", "draw"]).values, labels=list(posterior.marker.values)))
