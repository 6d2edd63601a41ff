"""A yielding building in a motion of 20 s."""

import stochlin as sl

building = sl.Bilinear(0.8, 0.05, 0.1, yield_displacement=0.02)
envelope = sl.ShinozukaSato(0.13, 0.45)
table = sl.transient_response(
    building, sl.named_ground("firm", 0.01), 20.0, envelope=envelope, points=21
)
table.to_netcdf("response.nc")
sl.peak_response(building, sl.named_ground("firm", 0.01), 20.0, model="DK80", sides=1).to_netcdf(
    "peak.nc"
)
