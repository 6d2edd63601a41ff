"""Two yielding buildings in a motion of 10 s: how far apart would have been enough."""

import numpy as np
import xarray as xr

import stochlin as sl

time = 0.02 * np.arange(501)
shaking = 3.0 * np.sin(2 * np.pi * time * (0.5 + 0.1 * time)) * np.sin(np.pi * time / 10)
motion = xr.DataArray(shaking, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
left = sl.Bilinear(1.0, 0.05, 0.05, yield_displacement=0.03)
right = sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=0.012)
sl.recorded_gap(left, right, motion).to_netcdf("answer.nc")
