"""Variables of the results on risk, with unit and long name."""

from stochlin.applications.separation.variables import VARIABLES as SEPARATION
from stochlin.solver.tables.labels import Variables

VARIABLES: Variables = {
    **SEPARATION,
    "annual_rate": ("1/yr", "mean annual frequency of pounding"),
    "annual_rate_standard_error": ("1/yr", "standard error of the mean annual frequency of pounding"),
    "annual_rate_unseen": ("1/yr", "upper bound for intensities above the simulated ones"),
    "probability_in_years": ("1", "probability of pounding at least once in the given years"),
    "annual_rate_by_intensity": (
        "1/yr",
        "contribution of the intensity to the annual frequency of pounding",
    ),
    "pounding_probability": ("1", "share of simulated motions with pounding at the intensity"),
    "required_gap": ("m", "required gap for the allowed mean annual frequency of pounding"),
    "target_rate": ("1/yr", "allowed mean annual frequency of pounding"),
}
