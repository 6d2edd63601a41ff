"""A small atlas of elastic and yielding pairs."""

import stochlin as sl

sweep = {"start": 0.25, "stop": 4.0, "count": 9, "spacing": "log"}
parameters = {
    "period_1": sweep,
    "period_2": [1.0],
    "damping": 0.05,
    "hardening": [0.05, 0.2],
    "reduction_factor": 3,
}
sl.write_atlas({"ground": "white_noise", "parameters": parameters}, "atlas.zarr")
atlas = sl.open_atlas("atlas.zarr").load()
atlas.to_netcdf("atlas.nc")
sl.lookup(atlas, period_1=[0.3, 0.9, 5.0], period_2=1.0, hardening=0.1).to_netcdf("cases.nc")
