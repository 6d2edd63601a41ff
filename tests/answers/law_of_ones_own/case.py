"""A law of one's own: z' = v (1 - z^2/2) while it grows, v else."""

import sympy

import stochlin as sl

v, z = sympy.symbols("v z", real=True)
law = v - z**2 * sympy.Abs(v) * z / 2 - v * z**2 / 2
building = sl.Hysteretic(0.7, 0.05, 0.1, reduction_factor=3, law=law)
ground = sl.WhiteNoise(0.01)
sl.linearize(building, ground).to_netcdf("linearized.nc")
sl.simulate([building, sl.Bilinear(1.0, 0.05)], ground, paths=64).to_netcdf("simulated.nc")
