"""Response to two records: spectra, radii, histories, gaps and the damping for one."""

import numpy as np
import xarray as xr

import stochlin as sl

wave = sl.read_record("wave.txt", dt=0.02, units="g")
time = wave.time.values
sweep = xr.DataArray(
    np.sin(time * (3 + time)), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
)
records = {"wave": wave, "sweep": sweep}
period = xr.DataArray([0.2, 0.5, 1.0, 2.0], dims="period", coords={"period": [0.2, 0.5, 1.0, 2.0]})
sl.response_spectrum(records, period, 0.05).to_netcdf("elastic.nc")
sl.response_spectrum(records, period, 0.05, hardening=0.05, yield_displacement=0.01).to_netcdf(
    "yielding.nc"
)
sl.pseudo_energy_radius(wave, period, 0.02).to_netcdf("radius.nc")
left = sl.Bilinear(period, 0.05, 0.1, yield_displacement=0.02)
sl.recorded_gap(left, sl.Bilinear(0.7, 0.05), records).to_netcdf("gaps.nc")
right = sl.Bilinear(0.7, 0.05, 0.1, yield_displacement=0.02)
sl.energy_gap(left, right, records).to_netcdf("energy.nc")
left = sl.Bilinear(1.0, 0.05, 0.1, yield_displacement=0.02)
least = sl.damping_for_gap(wave, left, right, gap=0.1)
least.isel(added_damping=slice(None, None, 20)).to_netcdf("damping.nc")
history = sl.respond(sl.Bilinear(0.7, 0.05, 0.05, yield_displacement=0.01), wave, refine=2)
history.isel(time=slice(None, None, 50)).to_netcdf("history.nc")
