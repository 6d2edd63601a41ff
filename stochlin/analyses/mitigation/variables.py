"""Variables of the results on mitigation, with unit and long name."""

from stochlin.analyses.pounding.variables import VARIABLES as POUNDING
from stochlin.analyses.separation.variables import VARIABLES as SEPARATION
from stochlin.analyses.tables.labels import Variables


def _of_links(name: str, which: str) -> Variables:
    return {
        f"{name}s": ("1", f"number of {which}"),
        f"{name}_stiffness": ("N/m", f"stiffness of all {which}"),
        f"{name}_damping_constant": ("N (s/m)^a", f"damping constant of all {which}"),
        f"{name}_damping_exponent": ("1", f"exponent a of the dashpots of all {which}"),
    }


VARIABLES: Variables = {
    **POUNDING,
    **SEPARATION,
    "relative_displacement_std": ("m", "standard deviation of the relative displacement"),
    "added_damping": ("1", "added damping ratio"),
    "bumper_thickness": ("m", "thickness of the bumpers"),
    "stiffening": ("1", "elastic stiffness over that as built"),
    "strengthening": ("1", "yield force over that as built"),
    **_of_links("link", "links between both structures"),
    **_of_links("device", "devices"),
    "largest_link_force": ("N", "largest force of any link or device"),
    "amplification": ("1", "peak displacement over that of the building as built without pounding"),
}
