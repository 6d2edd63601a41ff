"""Variables of the results on risk, with unit and long name."""

import numpy as np
import xarray as xr

from stochlin.analyses.separation.variables import VARIABLES as SEPARATION
from stochlin.analyses.tables.labels import Variables

FRAGILITY_STATUS = {
    "long_name": "status of the lognormal fragility",
    "flag_values": np.arange(5, dtype=np.int8),
    "flag_meanings": "fitted fewer_than_two_motions_pound all_pound_at_the_lowest_intensity "
    "fewer_than_two_intensities not_simulated",
}
FRAGILITY: Variables = {
    "fragility_dispersion": (
        "1",
        "logarithmic standard deviation of the intensity of pounding",
    ),
    "fragility_dispersion_standard_error": ("1", "standard error of the logarithmic standard deviation"),
}
VARIABLES: Variables = {
    **SEPARATION,
    **FRAGILITY,
    "annual_rate": ("1/yr", "mean annual frequency of pounding"),
    "annual_rate_standard_error": ("1/yr", "standard error of the mean annual frequency of pounding"),
    "annual_rate_lognormal": ("1/yr", "mean annual frequency of pounding by a lognormal fragility"),
    "annual_rate_unseen": ("1/yr", "upper bound for intensities above the simulated ones"),
    "probability_in_years": ("1", "probability of pounding at least once in the given years"),
    "annual_rate_by_intensity": (
        "1/yr",
        "contribution of the intensity to the annual frequency of pounding",
    ),
    "pounding_probability": ("1", "share of simulated motions with pounding at the intensity"),
    "exceedance_frequency": ("1/yr", "annual frequency of exceedance of the intensity"),
    "required_gap": ("m", "required gap for the allowed mean annual frequency of pounding"),
    "target_rate": ("1/yr", "allowed mean annual frequency of pounding"),
}


def labelled_fragility(table: xr.Dataset, units: str) -> xr.Dataset:
    """The table with attributes of the fragility, whose median has the unit of the intensity."""
    for name in ("fragility_median", "fragility_median_standard_error"):
        if name in table:
            error = "standard error of " if name.endswith("error") else ""
            about = f"{error}median intensity of pounding"
            table[name].attrs = {"units": units, "long_name": about}
    if "fragility_status" in table:
        table["fragility_status"] = table["fragility_status"].astype(np.int8)
        table["fragility_status"].attrs = FRAGILITY_STATUS
    return table
