"""An oscillator at rest when the noise begins."""

import stochlin as sl

table = sl.transient_response(sl.Bilinear(1.0, 0.05), sl.WhiteNoise(0.01), duration=6.0, points=13)
table.sel(time=[0.5, 1.0, 2.0, 6.0]).to_netcdf("answer.nc")
