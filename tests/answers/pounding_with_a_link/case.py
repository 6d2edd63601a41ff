"""A linked row through a motion; what one hit at full energy would do."""

import warnings

import numpy as np
import xarray as xr

import stochlin as sl

warnings.filterwarnings("ignore", "pound: a contact")  # a soft one, on purpose
time = 0.02 * np.arange(200)
motion = xr.DataArray(
    2.5 * np.sin(7 * time) * np.sin(np.pi * time / 4),
    dims="time",
    coords={"time": time},
    attrs={"units": "m/s^2"},
)
row = [sl.Bilinear(T, 0.05, mass=m) for T, m in ((1.0, 2e5), (0.5, 3e5), (0.8, 1e5))]
bumper = sl.Kelvin(1e8, restitution=0.65)
link = sl.Link(damping_constant=2e5)
table = sl.pound(row, [0.01, 0.02], bumper, motion, link=[link, None])
table.isel(time=slice(None, None, 10)).to_netcdf("row.nc")
estimate = sl.pounding_estimate(*row[:2], 0.02, bumper, radius_1=0.08, radius_2=0.05)
estimate.isel(point=slice(None, None, 6)).to_netcdf("estimate.nc")
print(*sl.pound(row[:1], motion=motion).peak_base_shear.values)
