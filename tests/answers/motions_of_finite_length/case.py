"""Three buildings in 20 s of motion that rises and falls."""

import stochlin as sl

ground = sl.named_ground("medium", intensity=0.01)
buildings = [
    sl.Bilinear(0.6, 0.05, 0.05, reduction_factor=4),
    sl.BoucWen(1.0, 0.05, 0.1, yield_displacement=0.03),
    sl.Bilinear(1.5, 0.02),
]
motion = {"duration": 20.0, "envelope": sl.GammaEnvelope(1.0, 0.2)}
table = sl.simulate(buildings, ground, paths=64, seed=7, quantiles=[0.5, 0.9], **motion)
table.to_netcdf("motions.nc")
sl.exceedance(table.separation[:, 0, 1], 0.1).to_netcdf("exceedance.nc")
