"""A frame of ten Bouc-Wen storeys in white noise: mean peak drifts, probabilities of large ones."""

import numpy as np
import xarray as xr

import stochlin as sl

heights = np.array([4.0, *[3.0] * 9])
columns = np.array([0.5, *[0.4] * 9])  # sides of their square sections, three in each storey
stiffnesses = 3 * 12 * 3e10 * columns**4 / 12 / heights**3
law = {"beta": 15 / 165, "gamma": 150 / 165, "exponent": 1.0}
frame = sl.ShearBuilding(
    *([2.6e5] * 10, stiffnesses, heights, 0.05),
    **{"hardening": 0.04, "yield_drifts": 1 / 165, "law": "bouc_wen", "law_parameters": law},
    damping_modes=(1, 2),
)
ground = sl.WhiteNoise(0.0072 / (2 * np.pi))
table = sl.simulate([frame], ground, paths=1024, duration=10.0, steps_per_period=256)

drifts = table.peak_drift.swap_dims(element="storey")
large = [0.034, 0.028, 0.022, 0.017, 0.013, 0.0108, 0.0085, 0.0065, 0.0047, 0.00235]
larger = [0.047, 0.039, 0.028, 0.021, 0.016, 0.0125, 0.01, 0.0075, 0.0054, 0.0027]
drift = {"storey": drifts.storey, "drift": ["large", "larger"]}
limits = xr.DataArray([large, larger], dims=("drift", "storey"), coords=drift)
exceeded = sl.exceedance(drifts, limits).probability.transpose("drift", "storey")
answer = xr.Dataset({"mean": drifts.mean("path"), "exceedance": exceeded})
answer["mean"].attrs = {"long_name": "mean peak drift", "units": "m"}
answer["exceedance"].attrs = {"long_name": "probability of exceedance", "units": "1"}
answer[["mean", "exceedance"]].to_netcdf("answer.nc")
