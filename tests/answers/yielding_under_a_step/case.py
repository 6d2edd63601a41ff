"""A yielding oscillator that the ground leaves at once: what `pound` says of it standing alone."""

import warnings

import numpy as np
import xarray as xr

import stochlin as sl

warnings.filterwarnings("ignore", "Bilinear: damping")  # hardly any, on purpose
warnings.filterwarnings("ignore", "pound: gaps")  # far apart, on purpose
time = 0.02 * np.arange(100)
step = xr.DataArray(
    np.full(100, -3.2), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
)
building = sl.Bilinear(1.0, 1e-12, hardening=0.1, yield_displacement=4 / (2 * np.pi) ** 2, mass=1e5)
stiff = sl.Bilinear(0.1, 1e-12, mass=1e5)
table = sl.pound(
    [building, stiff], 10.0, sl.LinearSpring(1e8), step, steps_per_contact=128
)  # far apart
table[["peak_alone"]].to_netcdf("answer.nc")
