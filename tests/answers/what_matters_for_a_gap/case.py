import stochlin as sl

FIRST = sl.Bilinear(sl.Uncertain(0.6, 0.25), 0.05, 0.05, reduction_factor=3.0)
SECOND = sl.Bilinear(1.0, 0.05)
GROUND = sl.KanaiTajimi(0.4, 0.6, 0.01)

table = sl.sensitivity(FIRST, SECOND, GROUND, 12.0, paths=64)
names = ["gap", "gap_of_medians", "gap_change"]
errors = [f"{name}_standard_error" for name in names[1:]]
kept = (
    table[names + errors].isel(input=[0, 3, 7]).reset_coords(drop=True).drop_vars(["input", "end"])
)
kept.attrs = {}
kept.to_netcdf("matters.nc", engine="scipy")
