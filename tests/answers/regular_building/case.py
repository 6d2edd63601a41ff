"""A building of eight equal storeys, and its first mode."""

import xarray as xr

import stochlin as sl

office = sl.ShearBuilding.regular(
    period=0.8,
    storeys=8,
    storey_height=3.2,
    mass=4e5,
    damping=0.05,
    hardening=0.05,
    base_shear_coefficient=0.15,
)
first = office.oscillator()
table = xr.Dataset(
    {
        "stiffness": ("storey", office.stiffnesses.values, office.stiffnesses.attrs),
        "yield_drift": ((), office.yield_drifts, {"units": "m", "long_name": "drift at yield"}),
        "period": ((), first.period, {"units": "s", "long_name": "period of the first mode"}),
        "mass": ((), first.mass, {"units": "kg", "long_name": "mass of the first mode"}),
        "yield_displacement": (
            (),
            first.yield_displacement,
            {"units": "m", "long_name": "displacement of the oscillator at yield"},
        ),
        "participation": office.participation(),
    },
    {"storey": range(1, 9)},
)
table.to_netcdf("answer.nc")
