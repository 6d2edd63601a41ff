"""A yielding building on white noise, by statistical linearization."""

import stochlin as sl

building = sl.Bilinear(period=0.7, damping=0.05, hardening=0.1, yield_displacement=0.02)
sl.linearize(building, sl.WhiteNoise(intensity=0.02)).to_netcdf("answer.nc")
