"""Mean peaks of 20 s of stationary motion, by the three formulas."""

import xarray as xr

import stochlin as sl

building = sl.Bilinear(period=0.5, damping=0.05)
ground = sl.KanaiTajimi(period=0.4, damping=0.6, intensity=0.01)
tables = [
    sl.peak_response(building, ground, 20.0, model=name) for name in sl.rules.peak_factor_names()
]
model = xr.DataArray(
    list(sl.rules.peak_factor_names()), dims="model", name="model", attrs={"long_name": "model"}
)
xr.concat(tables, model, data_vars=["peak_mean", "peak_std", "peak_factor"]).to_netcdf("answer.nc")
