"""Standard deviations of yielding buildings by every closure; one of them has a negative period."""

import numpy as np
import xarray as xr

import stochlin as sl

strength = xr.DataArray(
    [1.0, 2.0, 4.0, 6.0], dims="factor", coords={"factor": [1.0, 2.0, 4.0, 6.0]}
)
period = xr.DataArray(
    [0.3, 1.0, -1.0, 3.0], dims="period", coords={"period": [0.3, 1.0, -1.0, 3.0]}
)
building = sl.Bilinear(period, 0.05, 0.1, reduction_factor=strength)
ground = sl.CloughPenzien(0.5, 0.6, 5.0, 0.6, intensity=0.01)
for closure in ("gaussian", "clipped", "drift"):
    table = sl.linearize(building, ground, closure)
    assert np.isnan(table.displacement_std.sel(period=-1.0)).all()
    table.to_netcdf(f"{closure}.nc")
