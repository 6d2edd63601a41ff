"""Variables of the results on separation, with unit and long name."""

from stochlin.solver.simulation.variables import VARIABLES as SIMULATION
from stochlin.solver.tables.labels import Variables

VARIABLES: Variables = {
    **SIMULATION,
    "gap": ("m", "gap between the structures"),
    "gap_at_height": ("m", "gap between the structures at the height"),
    "cqc": ("m", "gap by the CQC over the modes of both structures"),
    "governing_height": ("m", "height that governs the gap of the rule"),
    "error": ("1", "relative error of the gap of the rule against simulation"),
    "separation_samples": ("m", "peak displacement of structure 1 towards structure 2"),
    "no_pounding_probability": ("1", "share of simulated motions without pounding"),
    "collapse_probability": ("1", "probability that the structure falls"),
    "ductility": ("1", "mean peak displacement over yield displacement"),
    "required_gap": ("m", "required gap for the confidence"),
    "largest_reduction_factor": ("1", "largest reduction factor for which the gap is sufficient"),
    "least_reduction_factor": ("1", "smallest reduction factor for which the gap is sufficient"),
    "largest_intensity": ("m^2/s^3", "largest intensity S0 for which the gap is sufficient"),
    "critical_gap": ("m", "critical gap of eq. (3) with the energy radii"),
    "critical_gap_error": ("1", "relative error of the critical gap against the record"),
    "rho_estimate": ("1", "correlation coefficient in eq. (3)"),
    "least_added_damping": ("1", "least damping ratio to be added to both structures"),
}

# Variables with another long name for one structure alone, beside its property line.
ALONE: Variables = {
    "gap": ("m", "distance of the structure from the property line"),
    "gap_at_height": ("m", "distance of the structure from the property line at the height"),
    "separation_samples": ("m", "peak displacement of the structure towards the property line"),
    "separation_mean": ("m", "mean peak displacement towards the property line"),
}
