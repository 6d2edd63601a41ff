"""A building of four storeys beside one of two; the same with a link; a table of coefficients."""

import numpy as np
import xarray as xr

import stochlin as sl

tall = sl.ShearBuilding(
    [2e5, 2e5, 2e5, 1.5e5],
    [4e8, 3.6e8, 3e8, 2.2e8],
    [3.0] * 4,
    0.05,
    0.05,
    [0.010, 0.010, 0.009, 0.008],
)
low = sl.ShearBuilding([1.5e5, 1.5e5], [2.5e8, 2e8], [3.0] * 2, 0.05, 0.1, yield_drifts=0.006)
ground = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.02)
sl.linearize_system([tall, low], ground).to_netcdf("apart.nc")
link = sl.Link(5e7, 1e5, hardening=0.02, yield_displacement=0.002)
sl.linearize_system([tall, low], ground, [link]).to_netcdf("linked.nc")
z_std = xr.DataArray([0.5, 1.0, 2.0], dims="z_std", coords={"z_std": [0.5, 1.0, 2.0]})
sl.equivalent_coefficients(1.0, z_std, 0.3).to_netcdf("bilinear.nc")
sl.equivalent_coefficients(1.0, z_std, 0.3, "bouc_wen", exponent=2.0).to_netcdf("bouc_wen.nc")
