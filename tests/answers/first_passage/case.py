"""How likely two elastic buildings do not meet in 20 s of white noise."""

import stochlin as sl

first, second = sl.Bilinear(1.0, 0.05), sl.Bilinear(0.6, 0.03)
table = sl.pounding_probability(first, second, sl.WhiteNoise(0.01), 0.12, duration=20.0, paths=0)
shown = ["confidence_of_no_pounding_poisson", "instantaneous_probability", "difference_std"]
table[shown].sel(time=[2.0, 5.0, 20.0]).to_netcdf("answer.nc")
