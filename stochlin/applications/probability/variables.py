"""Variables of the results on probability, with unit and long name."""

from stochlin.solver.linearization.variables import VARIABLES as LINEARIZATION
from stochlin.solver.tables.labels import Variables

_OF_FORMULAS: Variables = {
    "rho": ("1", "correlation coefficient of the displacements"),
    "displacement_std": ("m", "standard deviation of the displacement"),
    "difference_std": ("m", "standard deviation of the relative displacement"),
    "required_gap": ("m", "required gap for the confidence"),
    "instantaneous_probability": ("1", "instantaneous probability of exceeding the gap"),
    "confidence_of_no_pounding": ("1", "probability of no pounding so far"),
    "pounding_probability": ("1", "probability of pounding in the motion"),
}
_VERSIONS = {"": "", "_poisson": ", Poisson crossings", "_corrected": ", bias corrected"}
_SIMULATED = "_simulated", ", simulated"
VARIABLES: Variables = {
    **LINEARIZATION,
    "fragility_median": ("m^2/s^3", "median intensity of pounding"),
    "fragility_median_standard_error": ("m^2/s^3", "standard error of median intensity of pounding"),
    "fragility_dispersion_standard_error": ("1", "standard error of the logarithmic standard deviation"),
    "fragility_dispersion": ("1", "logarithmic standard deviation of the intensity of pounding"),
    **{
        f"{name}{ending}{place}": (units, f"{about}{version}{' at the height' if place else ''}")
        for name, (units, about) in _OF_FORMULAS.items()
        for ending, version in (*_VERSIONS.items(), _SIMULATED)
        for place in ("", "_at_height")
    },
    "input_factor": ("1", "sample of the uncertain parameter over its median"),
    "radius": ("m", "energy radius"),
    "recorded_difference": ("m", "u_1 - u_2 in the record"),
    "separation": ("m", "peak relative displacement u_1 - u_2 in the record"),
    "governing_height": ("m", "height that governs the gap by formula"),
    "difference_std_simulated_standard_error": (
        "m",
        "standard error of the simulated standard deviation of the relative displacement",
    ),
    "instantaneous_probability_simulated": ("1", "share of simulated motions that exceed the gap"),
    "confidence_of_no_pounding": ("1", "probability of no pounding so far, crossings in clumps"),
    "confidence_of_no_pounding_simulated": ("1", "share of simulated motions without pounding so far"),
    "confidence_of_no_pounding_at_least": ("1", "lower bound for all heights of that of no pounding"),
    "pounding_probability": ("1", "probability of pounding in the motion, crossings in clumps"),
    "pounding_probability_simulated": ("1", "share of simulated motions with pounding"),
}
