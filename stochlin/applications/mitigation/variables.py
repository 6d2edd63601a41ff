"""Variables of the results on mitigation, with unit and long name."""

from stochlin.applications.pounding.variables import VARIABLES as POUNDING
from stochlin.applications.separation.variables import VARIABLES as SEPARATION
from stochlin.solver.tables.labels import Variables

VARIABLES: Variables = {
    **POUNDING,
    **SEPARATION,
    "relative_displacement_std": ("m", "standard deviation of the relative displacement"),
    "added_damping": ("1", "added damping ratio"),
    "bumper_thickness": ("m", "thickness of the bumpers"),
    "link_damping_constant": ("N s/m", "damping constant of all links between both structures"),
    "largest_link_force": ("N", "largest force of any link or device"),
    "amplification": ("1", "peak displacement over that of the building as built without pounding"),
}
