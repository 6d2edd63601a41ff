"""Correlation over the ratio of periods on a lake bed, simulated and by the drift closure."""

import xarray as xr

import stochlin as sl

lakebed = sl.KanaiTajimi(period=2.0, damping=0.05)
ratio = xr.DataArray([0.5, 0.8, 1.25], dims="ratio", coords={"ratio": [0.5, 0.8, 1.25]})
first = sl.Bilinear(2.0 * ratio, 0.05, 0.05, reduction_factor=4)
second = sl.Bilinear(2.0, 0.05, 0.05, reduction_factor=4)
sl.correlate(first, second, lakebed, "simulation", paths=64, seed=3).to_netcdf("simulated.nc")
sl.correlate(first, second, lakebed, closure="drift").to_netcdf("drift.nc")
