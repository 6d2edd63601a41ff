"""Risk of pounding, and the gap that keeps it."""

from stochlin.analyses.separation.variables import VARIABLES as SEPARATION
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **SEPARATION,
    "annual_rate": ("1/yr", "mean annual frequency of pounding"),
    "annual_rate_standard_error": ("1/yr", "standard error of annual_rate"),
    "annual_rate_lognormal": ("1/yr", "the same by a lognormal fragility"),
    "annual_rate_unseen": ("1/yr", "most that stronger shaking than was simulated could add"),
    "probability_in_years": ("1", "probability of pounding at least once in so many years"),
    "annual_rate_by_intensity": ("1/yr", "part of annual_rate from shaking of this intensity"),
    "pounding_probability": ("1", "share of the simulated motions of this intensity with pounding"),
    "exceedance_frequency": ("1/yr", "annual frequency with which this intensity is exceeded"),
    "fragility_dispersion": (
        "1",
        "standard deviation of ln of the intensity at which they pound",
    ),
    "fragility_dispersion_standard_error": ("1", "standard error of fragility_dispersion"),
    "target_rate": ("1/yr", "mean annual frequency of pounding that is allowed"),
}
