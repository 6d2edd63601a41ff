"""What linearization finds of systems."""

from stochlin.analyses.linearization.variables import VARIABLES as LINEARIZATION
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **LINEARIZATION,
    "drift_std": ("m", "standard deviation of the drift of the storey, or of the link's extension"),
    "ductility_std": ("1", "standard deviation of the drift over the drift at yield"),
    "yield_drift": ("m", "drift at yield"),
    "rho": ("1", "correlation coefficient of the displacements"),
    "relative_displacement_std": ("m", "standard deviation of the displacement of floor less floor_2"),
    "link_force_std": ("N", "standard deviation of the force in the link"),
    "equivalent_damping_constant": ("N s/m", "damping constant of the dashpot linearized"),
    "covariance_change": ("1", "largest change of a covariance over the standard deviations"),
    "coefficient_change": ("1", "largest change of c_eq, and of k_eq over its sum with the frequency"),
}
