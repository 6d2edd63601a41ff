"""Linked pair: linearized over the link's damping, simulated for one."""

import xarray as xr

import stochlin as sl

pair = [
    sl.Bilinear(T, 0.05, 0.1, yield_displacement=u, mass=m)
    for T, u, m in ((0.6, 0.015, 2e5), (1.0, 0.03, 3e5))
]
ground = sl.KanaiTajimi(0.5, 0.5, intensity=0.01)
constant = xr.DataArray([1e4, 1e5, 1e6], dims="dashpot", coords={"dashpot": [1e4, 1e5, 1e6]})
table = sl.linearize_system(pair, ground, [sl.Link(1e6, constant)])
rounding = ["covariance", "covariance_change", "coefficient_change"]
table.drop_vars(rounding).to_netcdf("linearized.nc")
sl.simulate(pair, ground, paths=64, link=sl.Link(1e6, 1e5)).to_netcdf("simulated.nc")
