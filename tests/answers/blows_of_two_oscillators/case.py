"""Two elastic oscillators that meet by eq. (13) under a constant ground acceleration."""

import numpy as np
import xarray as xr

import stochlin as sl

time = 0.02 * np.arange(101)
step = xr.DataArray(
    np.full(101, -2.0), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
)
left, right = sl.Bilinear(1.2, 0.05, mass=2e5), sl.Bilinear(0.5, 0.02, mass=3e5)
table = sl.pound(
    [left, right], 0.07, sl.Stereomechanical(restitution=0.65), step, steps_per_contact=128
)
blows = ["impact_time", "approach_velocity", "energy_lost"]
table[[*blows, "peak", "peak_alone"]].assign_coords(
    impact=np.arange(table.sizes["impact"]) + 1
).to_netcdf("answer.nc")
