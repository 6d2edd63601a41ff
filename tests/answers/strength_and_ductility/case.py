"""The strength that a mean peak ductility of 2 to 6 asks for."""

import xarray as xr

import stochlin as sl

ductility = xr.DataArray([2.0, 4.0, 6.0], dims="ductility", coords={"ductility": [2.0, 4.0, 6.0]})
building, ground = sl.Bilinear(0.8, 0.05, 0.1), sl.named_ground("firm", intensity=0.01)
table = sl.strength_for_ductility(building, ground, ductility, closure="drift")
table.to_netcdf("strength.nc")
strong = sl.Bilinear(0.8, 0.05, 0.1, yield_displacement=table.yield_displacement)
sl.reduction_factor(strong, ground).to_netcdf("factor.nc")
