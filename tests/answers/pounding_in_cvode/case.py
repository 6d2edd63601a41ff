"""Two yielding buildings with a damped Hertz contact between them, in a motion of 8 s."""

import warnings

import numpy as np
import xarray as xr

import stochlin as sl

warnings.filterwarnings("ignore", "pound: a contact")  # a soft one, on purpose
time = 0.02 * np.arange(401)
shaking = 2.5 * np.sin(2 * np.pi * time * (0.6 + 0.1 * time)) * np.sin(np.pi * time / 8)
motion = xr.DataArray(shaking, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
soft = sl.Bilinear(1.1, 0.05, 0.05, yield_displacement=0.04, mass=2e5)
stiff = sl.Bilinear(0.5, 0.03, 0.1, yield_displacement=0.015, mass=3e5)
contact = sl.HertzDamp(3e8, damping_factor=0.6)
table = sl.pound([soft, stiff], 0.02, contact, motion, steps_per_contact=128)
table = table.assign_coords(impact=np.arange(table.sizes["impact"]) + 1)
impacts = ["impact_time", "approach_velocity", "largest_force", "impact_duration", "energy_lost"]
table[[*impacts, "peak"]].to_netcdf("answer.nc")
