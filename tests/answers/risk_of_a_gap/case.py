import stochlin as sl

SHAPE = sl.AminAng(2.0, 8.0, 0.5)
GROUND = sl.named_ground("firm", intensity=0.01)
ONE, TWO = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.6, 1.0))
HAZARD = sl.HazardCurve([0.5, 1.0, 2.0, 4.0, 8.0], [0.02, 5e-3, 1e-3, 1.5e-4, 1e-5])
COMMON = {"envelope": SHAPE, "paths": 64}

sl.pounding_risk(ONE, TWO, GROUND, 0.06, HAZARD, 12.0, **COMMON).to_netcdf(
    "risk.nc", engine="scipy"
)
sl.required_gap(ONE, TWO, GROUND, HAZARD, 12.0, risk="10 % in 50 years", **COMMON).to_netcdf(
    "gap.nc", engine="scipy"
)
read = sl.read_hazard("hazard.csv")
print(read.describe(), read.intensity(return_period=475))
existing = sl.Bilinear(sl.Uncertain(0.6, 0.25), 0.05, 0.05, reduction_factor=sl.Uncertain(3.0, 0.3))
unknown = sl.separation(existing, TWO, GROUND, 12.0, **COMMON)
unknown = unknown.sel(rule="simulation", drop=True)
names = ["gap", "gap_lower", "gap_upper", "input_factor"]
unknown[names].reset_coords(drop=True).to_netcdf("unknown.nc", engine="scipy")
