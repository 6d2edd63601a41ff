"""Two elastic buildings on white noise, simulated, where the answer is known."""

import stochlin as sl

pair = [sl.Bilinear(1.0, 0.05), sl.Bilinear(0.8, 0.03)]
sl.simulate(pair, sl.WhiteNoise(0.01), paths=2048).to_netcdf("answer.nc")
