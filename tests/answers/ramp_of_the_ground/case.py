"""An oscillator while the ground's acceleration rises, and when it has risen."""

import numpy as np
import xarray as xr

import stochlin as sl

time = 0.05 * np.arange(41)
acceleration = xr.DataArray(
    -2.0 * np.minimum(time, 0.5), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
)
history = sl.respond(sl.Bilinear(period=0.8, damping=0.05), acceleration)
history.isel(time=[4, 8, 16, 30]).to_netcdf("answer.nc")
