"""Variables of the results on probability, with unit and long name."""

from stochlin.analyses.linearization.variables import VARIABLES as LINEARIZATION
from stochlin.analyses.risk.variables import FRAGILITY
from stochlin.analyses.tables.labels import Variables

CORRECTED = "bias corrected"
VARIABLES: Variables = {
    **LINEARIZATION,
    **FRAGILITY,
    "separation_samples": ("m", "peak relative displacement u_1 - u_2 in the simulated motion"),
    "rho": ("1", "correlation coefficient of the displacements"),
    "input_factor": ("1", "sample of the uncertain parameter over its median"),
    "radius": ("m", "energy radius"),
    "recorded_difference": ("m", "u_1 - u_2 in the record"),
    "required_gap": ("m", "required gap for the confidence"),
    "required_gap_corrected": ("m", f"required gap for the confidence, {CORRECTED}"),
    "required_gap_simulated": ("m", "required gap for the confidence, simulated"),
    "instantaneous_probability": ("1", "instantaneous probability of exceeding the gap"),
    "instantaneous_probability_corrected": (
        "1",
        f"instantaneous probability of exceeding the gap, {CORRECTED}",
    ),
    "instantaneous_probability_simulated": ("1", "share of simulated motions that exceed the gap"),
    "confidence_of_no_pounding": ("1", "probability of no pounding so far, crossings in clumps"),
    "confidence_of_no_pounding_poisson": ("1", "probability of no pounding so far, Poisson crossings"),
    "confidence_of_no_pounding_corrected": ("1", f"probability of no pounding so far, {CORRECTED}"),
    "confidence_of_no_pounding_simulated": (
        "1",
        "share of simulated motions without pounding so far",
    ),
    "confidence_of_no_pounding_fresh_phase": (
        "1",
        "probability of no pounding so far, a new phase in every cycle",
    ),
    "pounding_probability": ("1", "probability of pounding in the motion, crossings in clumps"),
    "pounding_probability_poisson": ("1", "probability of pounding in the motion, Poisson crossings"),
    "pounding_probability_corrected": ("1", f"probability of pounding in the motion, {CORRECTED}"),
    "pounding_probability_simulated": ("1", "share of simulated motions with pounding"),
    "displacement_std_corrected": ("m", f"standard deviation of the displacement, {CORRECTED}"),
    "displacement_std_simulated": ("m", "standard deviation of the displacement, simulated"),
    "difference_std": ("m", "standard deviation of the relative displacement"),
    "difference_std_corrected": ("m", f"standard deviation of the relative displacement, {CORRECTED}"),
    "difference_std_simulated": ("m", "standard deviation of the relative displacement, simulated"),
    "difference_std_simulated_standard_error": (
        "m",
        "standard error of the simulated standard deviation of the relative displacement",
    ),
    "separation": ("m", "peak relative displacement u_1 - u_2 in the record"),
    "governing_height": ("m", "height that governs the gap by formula"),
    "confidence_of_no_pounding_at_least": (
        "1",
        "lower bound of the probability of no pounding so far, all heights",
    ),
    "pounding_probability_at_most": (
        "1",
        "upper bound of the probability of pounding in the motion, all heights",
    ),
    "confidence_of_no_pounding_at_height": ("1", "probability of no pounding so far at the height"),
    "instantaneous_probability_at_height": (
        "1",
        "instantaneous probability of exceeding the gap at the height",
    ),
    "difference_std_at_height": ("m", "standard deviation of the relative displacement at the height"),
    "difference_std_simulated_at_height": (
        "m",
        "standard deviation of the relative displacement at the height, simulated",
    ),
    "difference_std_simulated_standard_error_at_height": (
        "m",
        "standard error of the simulated standard deviation of the relative displacement at the height",
    ),
    "required_gap_at_height": ("m", "required gap for the confidence at the height"),
    "required_gap_simulated_at_height": (
        "m",
        "required gap for the confidence at the height, simulated",
    ),
    "rho_at_height": ("1", "correlation coefficient of the displacements at the height"),
    "pounding_probability_at_height": ("1", "probability of pounding in the motion at the height"),
}
