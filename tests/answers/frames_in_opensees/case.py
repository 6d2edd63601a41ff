"""A building of five storeys beside one of eight, of unequal storeys that yield."""

import numpy as np
import xarray as xr

import stochlin as sl

time = 0.02 * np.arange(401)
shaking = 4.0 * np.sin(2 * np.pi * time * (0.6 + 0.1 * time)) * np.sin(np.pi * time / 8)
motion = xr.DataArray(shaking, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
five = sl.ShearBuilding(
    [2.5e5, 2.5e5, 2.2e5, 2.2e5, 1.8e5],
    [4e8, 3.6e8, 3e8, 2.4e8, 1.6e8],
    [3.5] * 5,
    0.05,
    hardening=0.05,
    yield_drifts=[0.009, 0.008, 0.008, 0.007, 0.006],
)
eight = sl.ShearBuilding(
    [3e5] * 7 + [2.4e5],
    [3.6e8, 3.4e8, 3.1e8, 2.8e8, 2.4e8, 2e8, 1.6e8, 1.1e8],
    [3.5] * 8,
    0.05,
    hardening=0.03,
    yield_drifts=[0.012, 0.011, 0.011, 0.01, 0.01, 0.009, 0.009, 0.008],
)
table = sl.pound([five, eight], 0.01, sl.LinearSpring(5e8), motion, steps_per_contact=128)
table = table.assign_coords(impact=np.arange(table.sizes["impact"]) + 1)
table[["impact_time", "peak", "peak_alone"]].to_netcdf("answer.nc")
