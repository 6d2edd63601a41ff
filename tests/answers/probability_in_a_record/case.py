"""Confidence of no pounding of two buildings in a record, with a random phase."""

import stochlin as sl

strength = {"damping": 0.05, "hardening": 0.05, "reduction_factor": 4}
office, annex = (sl.Bilinear(period, **strength) for period in (1.0, 0.6))
ground = sl.named_ground("firm", intensity=0.01)
record = sl.read_record("wave.txt", dt=0.02, units="g")
table = sl.pounding_probability(office, annex, ground, 0.15, method="hybrid", record=record)
table.to_netcdf("probability.nc", engine="scipy")
