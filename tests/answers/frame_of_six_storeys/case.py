"""A frame of six Bouc-Wen storeys in white noise: mean peak drifts, probabilities of large ones."""

import xarray as xr

import stochlin as sl

masses = [3e5, 3e5, 3e5, 3e5, 3e5, 2.4e5]
stiffnesses = [4.2e8, 4e8, 3.6e8, 3.1e8, 2.5e8, 1.8e8]
yield_drifts = [0.012, 0.012, 0.011, 0.01, 0.009, 0.008]
frame = sl.ShearBuilding(
    *(masses, stiffnesses, [4.0, *[3.2] * 5], 0.03),
    **{"hardening": 0.1, "yield_drifts": yield_drifts, "law": "bouc_wen"},
    law_parameters={"beta": 0.5, "gamma": 0.5, "exponent": 3.0},
)
ground = sl.WhiteNoise(0.02)
table = sl.simulate([frame], ground, paths=1024, duration=15.0, steps_per_period=256)

drifts = table.peak_drift.swap_dims(element="storey")
large = [0.027, 0.021, 0.022, 0.024, 0.0231, 0.0168]
larger = [0.034, 0.026, 0.027, 0.028, 0.027, 0.0185]
drift = {"storey": drifts.storey, "drift": ["large", "larger"]}
limits = xr.DataArray([large, larger], dims=("drift", "storey"), coords=drift)
exceeded = sl.exceedance(drifts, limits).probability.transpose("drift", "storey")
answer = xr.Dataset({"mean": drifts.mean("path"), "exceedance": exceeded})
answer["mean"].attrs = {"long_name": "mean peak drift", "units": "m"}
answer["exceedance"].attrs = {"long_name": "probability of exceedance", "units": "1"}
answer[["mean", "exceedance"]].to_netcdf("answer.nc")
