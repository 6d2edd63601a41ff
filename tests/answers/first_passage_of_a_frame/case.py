"""First passage of drifts and roof of six Bouc-Wen storeys with Rayleigh damping in white noise."""

import xarray as xr

import stochlin as sl

masses = [3e5, 3e5, 3e5, 3e5, 3e5, 2.4e5]
stiffnesses = [4.2e8, 4e8, 3.6e8, 3.1e8, 2.5e8, 1.8e8]
yield_drifts = [0.012, 0.012, 0.011, 0.01, 0.009, 0.008]
frame = sl.ShearBuilding(
    *(masses, stiffnesses, [4.0, *[3.2] * 5], 0.03),
    **{"hardening": 0.1, "yield_drifts": yield_drifts, "law": "bouc_wen"},
    damping_modes=(1, 3),
)
table = sl.simulate([frame], sl.WhiteNoise(0.02), paths=32768, duration=15.0)

largest = {"drift": table.peak_drift.max("element"), "roof": table.peak.isel(floor=-1, drop=True)}
drifts, roofs = (
    [0.023, 0.027, 0.032, 0.035, 0.0395, 0.0445],
    [0.097, 0.114, 0.133, 0.145, 0.162, 0.182],
)
parts = []
for name, limits in (("drift", drifts), ("roof", roofs)):
    passed = sl.exceedance(largest[name], xr.DataArray(limits, coords={name: limits}))
    parts.append(passed.rename({variable: f"{name}_{variable}" for variable in passed}))
xr.merge(parts).to_netcdf("answer.nc")
