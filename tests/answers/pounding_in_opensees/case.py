"""A building of three storeys beside one of two, both yielding, with springs where floors meet."""

import numpy as np
import xarray as xr

import stochlin as sl

time = 0.02 * np.arange(401)
shaking = 4.0 * np.sin(2 * np.pi * time * (0.6 + 0.1 * time)) * np.sin(np.pi * time / 8)
motion = xr.DataArray(shaking, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
tower = sl.ShearBuilding(
    [2e5] * 3, [8e7, 7e7, 5e7], [3.0] * 3, 0.05, hardening=0.05, yield_drifts=0.012
)
annex = sl.ShearBuilding(
    [2e5] * 2, [1.5e8, 1.2e8], [3.0] * 2, 0.05, hardening=0.05, yield_drifts=0.006
)
table = sl.pound([tower, annex], 0.01, sl.LinearSpring(2e8), motion, steps_per_contact=128)
table = table.assign_coords(impact=np.arange(table.sizes["impact"]) + 1)
table[["impact_time", "peak", "peak_alone"]].to_netcdf("answer.nc")
