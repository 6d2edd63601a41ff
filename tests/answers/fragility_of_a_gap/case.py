"""Fragility of a gap of 10 cm; confidence over time of yielding buildings."""

import xarray as xr

import stochlin as sl

one, two = (sl.Bilinear(T, 0.05, 0.1, yield_displacement=0.03) for T in (0.6, 1.0))
ground, motion = (
    sl.named_ground("firm"),
    {"duration": 15.0, "envelope": sl.AminAng(3.0, 10.0, 0.35)},
)
sl.pounding_fragility(
    one, two, ground, 0.1, [0.002, 0.005, 0.01, 0.02], paths=64, **motion
).to_netcdf("fragility.nc")
firm = sl.named_ground("firm", intensity=0.01)
gap = xr.DataArray([0.05, 0.1], dims="gap", coords={"gap": [0.05, 0.1]})
table = sl.pounding_probability(one, two, firm, gap, points=11, paths=64, **motion)
table.to_netcdf("probability.nc")
