"""Measures against pounding, side by side."""

from stochlin.analyses.pounding.variables import VARIABLES as POUNDING
from stochlin.analyses.separation.variables import VARIABLES as SEPARATION
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **POUNDING,
    **SEPARATION,
    "relative_displacement_std": ("m", "standard deviation of u_1 - u_2"),
    "added_damping": ("1", "added damping ratio"),
    "link_stiffness": ("N/m", "stiffness of the link"),
    "link_damping_constant": ("N s/m", "damping constant of the link"),
    "amplification": ("1", "peak over that as built and standing alone"),
}
