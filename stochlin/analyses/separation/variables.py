"""Variables of the results on separation, with unit and long name."""

from stochlin.analyses.simulation.variables import VARIABLES as SIMULATION
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **SIMULATION,
    "gap": ("m", "gap between the structures"),
    "gap_lower": ("m", "lower end of the answer's 95 % interval"),
    "gap_upper": ("m", "upper end of the answer's 95 % interval"),
    "gap_at_height": ("m", "gap between the structures at this height"),
    "governing_height": ("m", "height at which the gap of the rule is largest"),
    "error": ("1", "gap of the rule over that of the simulation, less one"),
    "separation_samples": ("m", "largest displacement of structure 1 towards structure 2"),
    "no_pounding_probability": ("1", "share of the simulated motions that the gap survives"),
    "ductility": ("1", "mean peak displacement over yield displacement"),
    "required_gap": ("m", "gap that keeps the confidence"),
    "largest_reduction_factor": ("1", "reduction factor up to which the gap keeps the confidence"),
    "least_reduction_factor": ("1", "reduction factor from which on the gap keeps the confidence"),
    **{
        f"{which}_reduction_factor_{end}": ("1", f"{end} end of the 95 % interval of that")
        for which in ("largest", "least")
        for end in ("lower", "upper")
    },
    "largest_intensity": ("m^2/s^3", "intensity S0 at which the gap just keeps the confidence"),
    "critical_gap": ("m", "critical gap of eq. (3) with the energy radii"),
    "critical_gap_error": ("1", "critical gap over the gap that the record takes, less one"),
    "rho_estimate": ("1", "correlation coefficient that eq. (3) takes"),
    "least_added_damping": ("1", "damping ratio to be added to both for the gap to keep the confidence"),
}

# Variables with another long name for one structure alone, beside its property line.
ALONE: Variables = {
    "gap": ("m", "distance of the structure from its property line"),
    "gap_at_height": ("m", "distance of the structure from its property line at this height"),
    "separation_samples": ("m", "largest displacement of the structure towards its property line"),
    "separation_mean": ("m", "mean largest displacement towards the property line"),
}
