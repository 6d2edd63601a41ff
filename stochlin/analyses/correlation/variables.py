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
    "relative_displacement_std": ("m", "standard deviation of u_1 - u_2"),
    "link_force_std": ("N", "standard deviation of the force in the link"),
    "equivalent_damping_constant": SYSTEMS["equivalent_damping_constant"],
    "bias": ("1", "linearized rho less the exact one"),
    **{f"bias_{n}": (UNITS, f"{OF_ONE}, structure {n}") for n in (1, 2)},
}
