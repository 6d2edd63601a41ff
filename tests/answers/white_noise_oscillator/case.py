"""The standard deviations of an elastic oscillator on white noise."""

import stochlin as sl

oscillator = sl.Bilinear(period=1.0, damping=0.05)
sl.linearize(oscillator, sl.WhiteNoise(intensity=0.01)).to_netcdf("answer.nc")
