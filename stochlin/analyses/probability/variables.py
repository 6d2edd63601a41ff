"""How likely pounding is, over time and in a motion."""

from stochlin.analyses.linearization.variables import VARIABLES as LINEARIZATION
from stochlin.analyses.risk.variables import FRAGILITY
from stochlin.analyses.tables.labels import Variables

CORRECTED = "linearization corrected for its known bias"
VARIABLES: Variables = {
    **LINEARIZATION,
    **FRAGILITY,
    "separation_samples": ("m", "largest u_1 - u_2 of each simulated motion"),
    "rho": ("1", "correlation coefficient of the displacements"),
    "input_factor": ("1", "sample of the parameter over its median"),
    "radius": ("m", "root of u^2 + (u'/w)^2"),
    "recorded_difference": ("m", "u_1 - u_2 in the record"),
    "required_gap": ("m", "gap that keeps the confidence"),
    "required_gap_corrected": ("m", "gap that keeps the confidence, bias corrected"),
    "required_gap_simulated": ("m", "gap that keeps the confidence, simulated"),
    "instantaneous_probability": ("1", "probability that u_1 - u_2 is beyond the gap at the instant"),
    "instantaneous_probability_corrected": ("1", "the same, linearization corrected for its known bias"),
    "instantaneous_probability_simulated": ("1", "share of the simulated motions beyond the gap"),
    "confidence_of_no_pounding": ("1", "probability of no pounding so far, crossings in clumps"),
    "confidence_of_no_pounding_poisson": ("1", "probability of no pounding so far, Poisson crossings"),
    "confidence_of_no_pounding_corrected": ("1", f"probability of no pounding so far, {CORRECTED}"),
    "confidence_of_no_pounding_simulated": (
        "1",
        "share of the simulated motions without pounding so far",
    ),
    "confidence_of_no_pounding_fresh_phase": (
        "1",
        "probability of no pounding so far, a new phase in every cycle",
    ),
    "pounding_probability": ("1", "probability of pounding in the motion, crossings in clumps"),
    "pounding_probability_poisson": ("1", "probability of pounding in the motion, Poisson crossings"),
    "pounding_probability_corrected": ("1", f"probability of pounding in the motion, {CORRECTED}"),
    "pounding_probability_simulated": ("1", "share of the simulated motions with pounding"),
    "displacement_std_corrected": ("m", "standard deviation of the displacement, bias corrected"),
    "displacement_std_simulated": ("m", "standard deviation of the displacement, simulated"),
    "difference_std": ("m", "standard deviation of u_1 - u_2"),
    "difference_std_corrected": ("m", "standard deviation of u_1 - u_2, bias corrected"),
    "difference_std_simulated": ("m", "standard deviation of u_1 - u_2, simulated"),
    "difference_std_simulated_standard_error": ("m", "its standard error"),
    "separation": ("m", "gap that the record itself needs"),
    "governing_height": ("m", "height at which the gap by formula has to be the widest"),
    "confidence_of_no_pounding_at_least": (
        "1",
        "least that the formulas of all heights allow for them together (Boole)",
    ),
    "pounding_probability_at_most": (
        "1",
        "most that the formulas of all heights allow for them together (Boole)",
    ),
    "confidence_of_no_pounding_at_height": ("1", "probability of no pounding at this height so far"),
    "instantaneous_probability_at_height": ("1", "probability of being beyond the gap at this height"),
    "difference_std_at_height": ("m", "standard deviation of u_1 - u_2 at this height"),
    "difference_std_simulated_at_height": ("m", "the same, simulated"),
    "difference_std_simulated_standard_error_at_height": ("m", "its standard error"),
    "required_gap_at_height": ("m", "gap that keeps the confidence at this height"),
    "required_gap_simulated_at_height": ("m", "gap that keeps the confidence at this height, simulated"),
    "rho_at_height": ("1", "correlation coefficient of the displacements at this height"),
    "pounding_probability_at_height": ("1", "probability of pounding at this height in the motion"),
}
