"""A wall that yields in its first mode beside a chain of storeys."""

import numpy as np
import scipy.linalg

import stochlin as sl

levels, masses = 3.0 * np.arange(1, 5), np.array([2.4e5, 2.4e5, 2.4e5, 1.2e5])
low, high = np.minimum.outer(levels, levels), np.maximum.outer(levels, levels)
flexibility = low**2 * (3 * high - low) / (6 * 3e10)  # of a cantilever with EI = 3e10 N m^2
square, shapes = scipy.linalg.eigh(np.linalg.inv(flexibility), np.diag(masses))
wall = sl.ModalBuilding(
    periods=2 * np.pi / np.sqrt(square),
    shapes=(shapes / shapes[-1]).T,
    masses=masses,
    heights=[3.0] * 4,
    damping=0.05,
    hardening=0.05,
    yield_displacements=0.01,
)
chain = sl.ShearBuilding(  # its first mode is 0.3, 0.65, 1 with 0.6 s
    masses=[2e5] * 3,
    stiffnesses=[142560952.46017963, 103395855.63045995, 62664154.92755149],
    heights=[3.0] * 3,
    damping=0.05,
    hardening=0.1,
    yield_drifts=0.01,
)
ground = sl.named_ground("firm")
sl.linearize_system([wall, chain], ground).drop_dims(["state", "iteration"]).to_netcdf(
    "linearized.nc"
)
table = sl.simulate([wall, chain], ground, duration=12.0, paths=128)
table.drop_dims("path").to_netcdf("simulated.nc")
