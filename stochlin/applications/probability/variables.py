"""Variables of the results on probability, with unit and long name."""

from stochlin.solver.linearization.variables import VARIABLES as LINEARIZATION
from stochlin.solver.tables.labels import Variables

_QUANTITIES: Variables = {
    "rho": ("1", "correlation coefficient of the displacements"),
    "displacement_std": ("m", "standard deviation of the displacement"),
    "difference_std": ("m", "standard deviation of the relative displacement"),
    "required_gap": ("m", "required gap for the confidence"),
    "instantaneous_probability": ("1", "instantaneous probability of exceeding the gap"),
    "confidence_of_no_pounding": ("1", "probability of no pounding so far"),
    "pounding_probability": ("1", "probability of pounding in the motion"),
}
_VERSIONS = {  # endings of names, and of long names
    "": "",
    "_poisson": ", Poisson crossings",
    "_corrected": ", bias corrected",
    "_simulated": ", simulated",
    "_at_height": " at the height",
    "_simulated_at_height": " at the height, simulated",
}
_OF_SPREAD = "standard error of the simulated standard deviation of the relative displacement"
VARIABLES: Variables = {
    **LINEARIZATION,
    "fragility_median": ("m^2/s^3", "median intensity of pounding"),
    "fragility_median_standard_error": ("m^2/s^3", "standard error of median intensity of pounding"),
    "fragility_dispersion": ("1", "logarithmic standard deviation of the intensity of pounding"),
    "fragility_dispersion_standard_error": ("1", "standard error of the logarithmic standard deviation"),
    **{
        f"{name}{ending}": (units, f"{about}{version}")
        for name, (units, about) in _QUANTITIES.items()
        for ending, version in _VERSIONS.items()
    },
    "separation_samples": ("m", "peak relative displacement u_1 - u_2 in the simulated motion"),
    "input_factor": ("1", "sample of the uncertain parameter over its median"),
    "radius": ("m", "energy radius"),
    "recorded_difference": ("m", "u_1 - u_2 in the record"),
    "separation": ("m", "peak relative displacement u_1 - u_2 in the record"),
    "governing_height": ("m", "height that governs the gap by formula"),
    "instantaneous_probability_simulated": ("1", "share of simulated motions that exceed the gap"),
    "confidence_of_no_pounding": ("1", "probability of no pounding so far, crossings in clumps"),
    "confidence_of_no_pounding_simulated": (
        "1",
        "share of simulated motions without pounding so far",
    ),
    "confidence_of_no_pounding_at_least": (
        "1",
        "lower bound of the probability of no pounding so far, all heights",
    ),
    "pounding_probability": ("1", "probability of pounding in the motion, crossings in clumps"),
    "pounding_probability_simulated": ("1", "share of simulated motions with pounding"),
    "pounding_probability_at_most": (
        "1",
        "upper bound of the probability of pounding in the motion, all heights",
    ),
    "difference_std_simulated_standard_error": ("m", _OF_SPREAD),
    "difference_std_simulated_standard_error_at_height": ("m", f"{_OF_SPREAD} at the height"),
}
