"""Variables of the results on risk, with unit and long name."""

import numpy as np
import xarray as xr

from stochlin.analyses.separation.variables import VARIABLES as SEPARATION
from stochlin.analyses.tables.labels import Variables

FRAGILITY_STATUS = {
    "long_name": "whether a lognormal fragility was fitted, or why not",
    "flag_values": np.arange(5, dtype=np.int8),
    "flag_meanings": "fitted fewer_than_two_motions_pound all_pound_at_the_lowest_intensity "
    "fewer_than_two_intensities not_simulated",
}
FRAGILITY: Variables = {
    "fragility_dispersion": (
        "1",
        "standard deviation of ln of the intensity at which they pound",
    ),
    "fragility_dispersion_standard_error": ("1", "standard error of fragility_dispersion"),
}
VARIABLES: Variables = {
    **SEPARATION,
    **FRAGILITY,
    "annual_rate": ("1/yr", "mean annual frequency of pounding"),
    "annual_rate_standard_error": ("1/yr", "standard error of annual_rate"),
    "annual_rate_lognormal": ("1/yr", "the same by a lognormal fragility"),
    "annual_rate_unseen": ("1/yr", "most that stronger shaking than was simulated could add"),
    "probability_in_years": ("1", "probability of pounding at least once in so many years"),
    "annual_rate_by_intensity": ("1/yr", "part of annual_rate from shaking of this intensity"),
    "pounding_probability": ("1", "share of the simulated motions of this intensity with pounding"),
    "exceedance_frequency": ("1/yr", "annual frequency with which this intensity is exceeded"),
    "required_gap": ("m", "gap with which the mean annual frequency of pounding is target_rate"),
    "target_rate": ("1/yr", "mean annual frequency of pounding that is allowed"),
}


def labelled_fragility(table: xr.Dataset, units: str) -> xr.Dataset:
    """The table with attributes of the fragility, whose median has the unit of the intensity."""
    for name in ("fragility_median", "fragility_median_standard_error"):
        if name in table:
            error = "standard error of " if name.endswith("error") else ""
            about = f"{error}median intensity at which they pound"
            table[name].attrs = {"units": units, "long_name": about}
    if "fragility_status" in table:
        table["fragility_status"] = table["fragility_status"].astype(np.int8)
        table["fragility_status"].attrs = FRAGILITY_STATUS
    return table
