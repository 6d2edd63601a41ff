"""Inelastic over elastic displacement."""

import xarray as xr

import stochlin as sl

period = xr.DataArray([0.5, 1.0, 2.0], dims="period", coords={"period": [0.5, 1.0, 2.0]})
building = sl.Bilinear(period, 0.05, 0.05, reduction_factor=4)
ground = sl.KanaiTajimi(1.0, 0.3, intensity=0.01)
sl.amplification(building, ground, closure="drift").to_netcdf("linearized.nc")
sl.amplification(
    building, ground, of="peak", duration=15.0, envelope=sl.AminAng(2.0, 8.0, 0.5), paths=64
).to_netcdf("peaks.nc")
