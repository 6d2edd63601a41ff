"""A yielding building in a motion of 20 s, and one that degrades."""

import stochlin as sl

building = sl.Bilinear(0.8, 0.05, 0.1, yield_displacement=0.02)
envelope = sl.ShinozukaSato(0.13, 0.45)
table = sl.transient_response(
    building, sl.named_ground("firm", 0.01), 20.0, envelope=envelope, points=21
)
table.to_netcdf("response.nc")
strong = {"period": 0.8, "damping": 0.05, "hardening": 0.1, "yield_displacement": 0.02}
worn = sl.BoucWenBaberNoori(**strong, strength_decay=0.05, stiffness_decay=0.1, pinching=0.8)
table = sl.transient_response(
    worn, sl.named_ground("firm", 0.01), 10.0, envelope=envelope, points=6
)
table.to_netcdf("worn.nc")
ground = sl.named_ground("firm", 0.01)
table = sl.peak_response(building, ground, 20.0, model="derkiureghian", closure="drift")
table.to_netcdf("peak.nc")
