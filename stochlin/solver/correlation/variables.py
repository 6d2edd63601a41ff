"""Variables of the results on pairs of structures, with unit and long name."""

from stochlin.solver.simulation.variables import VARIABLES as SIMULATION
from stochlin.solver.tables.labels import Variables

UNITS, OF_ONE = SIMULATION["bias"]
VARIABLES: Variables = {
    **SIMULATION,
    "rho_error": ("1", "mean absolute error of rho over simulated pairs of the region"),
    "amplification": ("1", "ratio of inelastic to elastic standard deviation of the displacement"),
    "amplification_standard_error": ("1", "standard error of the amplification"),
    "drift_amplification": ("1", "ratio of inelastic to elastic mean peak drift"),
    "drift_amplification_standard_error": ("1", "standard error of the drift amplification"),
    "elastic_peak_mean": ("m", "mean peak displacement of the elastic structure"),
    "elastic_peak_mean_standard_error": ("m", "standard error of the mean elastic peak displacement"),
    "relative_displacement_std": ("m", "standard deviation of the relative displacement"),
    "relative_displacement_bias": ("1", "bias of the relative displacement"),
    "relative_displacement_error": ("1", "expected error of the relative displacement"),
    "relative_displacement_caution": ("1", "caution flag of the relative displacement"),
    "bias": ("1", "bias of rho: linearized minus simulated"),
    **{f"bias_{n}": (UNITS, f"{OF_ONE}, structure {n}") for n in (1, 2)},
    **{f"bias_error_{n}": ("1", f"expected error of the bias, structure {n}") for n in (1, 2)},
}
