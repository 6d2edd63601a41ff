"""Impacts, peaks and energies with each contact element."""

import numpy as np
import xarray as xr

import stochlin as sl

time = 0.02 * np.arange(250)
shaking = 3.0 * np.sin(6 * time) * time / 2 * np.exp(1 - time / 2)
motion = xr.DataArray(shaking, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
pair = [
    sl.Bilinear(1.2, 0.05, 0.05, yield_displacement=0.05, mass=2e5),
    sl.BoucWen(0.6, 0.05, 0.1, yield_displacement=0.02, mass=3e5, exponent=2),
]
elements = {
    "linear_spring": sl.LinearSpring(1e8),
    "kelvin": sl.Kelvin(1e8, restitution=0.65),
    "no_tension_kelvin": sl.NoTensionKelvin(1e8, restitution=0.65),
    "impact_kelvin": sl.ImpactKelvin(1e8, damping_ratio=0.3),
    "hertz": sl.Hertz(1e9),
    "hertz_damp": sl.HertzDamp(1e9, restitution=0.65),
    "jankowski": sl.Jankowski(1e9, restitution=0.65),
    "stereomechanical": sl.Stereomechanical(0.65),
}
for name, element in elements.items():
    table = sl.pound(pair, 0.03, element, motion).isel(time=slice(None, None, 50))
    table.to_netcdf(f"{name}.nc")
