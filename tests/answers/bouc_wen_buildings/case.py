"""Bouc-Wen buildings alone and beside a bilinear one."""

import xarray as xr

import stochlin as sl

exponent = xr.DataArray([1.0, 1.5, 2.0], dims="exponent", coords={"exponent": [1.0, 1.5, 2.0]})
smooth = sl.BoucWen(0.8, 0.05, 0.1, reduction_factor=3, beta=0.7, gamma=0.3, exponent=exponent)
sharp = sl.Bilinear(1.0, 0.05, 0.1, reduction_factor=3)
ground = sl.named_ground("firm", intensity=0.01)
sl.linearize(smooth, ground).to_netcdf("alone.nc")
sl.correlate(smooth, sharp, ground).to_netcdf("pair.nc")
