"""State space of two yielding buildings on Clough-Penzien ground, linked."""

import stochlin as sl

pair = [sl.Bilinear(T, 0.05, 0.1, yield_displacement=0.02, mass=2e5) for T in (0.6, 1.0)]
ground = sl.named_ground("firm", intensity=0.01)
space = sl.statespace(pair, ground, c_eq=[-0.9, -0.8], k_eq=[1.5, 1.0], links=[sl.Link(1e6, 1e4)])
space.to_netcdf("space.nc")
sl.stationary_covariance(space).rename("covariance").to_netcdf("covariance.nc")
