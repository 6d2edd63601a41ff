"""Variables of the results on linearization of systems, with unit and long name."""

from stochlin.analyses.linearization.variables import VARIABLES as LINEARIZATION
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **LINEARIZATION,
    "drift_std": ("m", "standard deviation of the storey drift or link extension"),
    "ductility_std": ("1", "standard deviation of the storey ductility"),
    "yield_drift": ("m", "yield drift"),
    "rho": ("1", "correlation coefficient of the displacements"),
    "relative_displacement_std": ("m", "standard deviation of the relative displacement of two floors"),
    "link_force_std": ("N", "standard deviation of the link force"),
    "equivalent_damping_constant": ("N s/m", "equivalent damping constant of the link"),
    "residual": ("1", "relative residual of the Lyapunov equation"),
    "covariance_change": ("1", "largest relative change of the covariance"),
    "coefficient_change": ("1", "largest change of the equivalent coefficients"),
}
