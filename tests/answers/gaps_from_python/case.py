"""The gap between two buildings, the set-back of one of them, and what 8 cm would allow."""

import stochlin as sl

one, two = (sl.Bilinear(T, 0.05, 0.1, reduction_factor=3) for T in (0.6, 1.0))
ground = sl.KanaiTajimi(0.5, 0.5, intensity=0.01)
options = {"paths": 256, "seed": 2, "confidence": 0.8}
codes = {"height_1": 12.0, "height_2": 20.0, "zone": "III"}
table = sl.separation(one, two, ground, 15.0, codes=codes, **options)
table.drop_vars("separation_samples").to_netcdf("gap.nc")
alone = sl.separation(two, None, ground, 15.0, codes={"height_1": 20.0, "zone": "III"}, **options)
alone[["gap", "gap_lower", "gap_upper"]].reset_coords(drop=True).to_netcdf(
    "alone.nc", engine="scipy"
)
sl.existing_gap(
    one, two, ground, 0.08, duration=15.0, envelope=sl.GammaEnvelope(2.0, 0.4), **options
).to_netcdf("allows.nc")
