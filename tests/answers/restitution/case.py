"""Which damping of a contact leaves .65 of the approach velocity."""

import xarray as xr

import stochlin as sl

elements = {
    "Kelvin": sl.Kelvin,
    "NoTensionKelvin": sl.NoTensionKelvin,
    "ImpactKelvin": sl.ImpactKelvin,
}
elements |= {"Jankowski": sl.Jankowski, "HertzDamp": sl.HertzDamp}
needed = [
    kind.damping_factor(0.65) if kind is sl.HertzDamp else kind.damping_ratio(0.65)
    for kind in elements.values()
]
meaning = {"long_name": "damping for a restitution of .65", "units": "1"}
answer = xr.Dataset({"damping": ("element", needed, meaning)}, {"element": list(elements)})
answer.to_netcdf("answer.nc")
