"""What is found of pairs."""

from stochlin.analyses.linearization.systems.variables import VARIABLES as SYSTEMS
from stochlin.analyses.simulation.variables import VARIABLES as SIMULATION
from stochlin.analyses.tables.labels import Variables

UNITS, OF_ONE = SIMULATION["bias"]
VARIABLES: Variables = {
    **SIMULATION,
    "rho_error": ("1", "mean absolute error of rho over simulated pairs of this region"),
    "amplification": ("1", "inelastic over elastic standard deviation of the displacement"),
    "amplification_standard_error": ("1", "standard error of the amplification"),
    "drift_amplification": ("1", "mean largest inelastic over mean largest elastic drift"),
    "drift_amplification_standard_error": ("1", "standard error of drift_amplification"),
    "elastic_peak_mean": ("m", "mean of the largest displacement of the elastic structure"),
    "elastic_peak_mean_standard_error": ("m", "standard error of elastic_peak_mean"),
    "relative_displacement_std": ("m", "standard deviation of u_1 - u_2"),
    "relative_displacement_bias": ("1", "relative error of relative_displacement_std"),
    "relative_displacement_error": ("1", "expected relative error of relative_displacement_std"),
    "relative_displacement_caution": ("1", "whether relative_displacement_std can be trusted here"),
    "link_force_std": ("N", "standard deviation of the force in the link"),
    "equivalent_damping_constant": SYSTEMS["equivalent_damping_constant"],
    "bias": ("1", "linearized rho less the simulated one"),
    **{f"bias_{n}": (UNITS, f"{OF_ONE}, structure {n}") for n in (1, 2)},
}
