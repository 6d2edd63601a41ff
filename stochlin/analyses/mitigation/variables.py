"""Variables of the results on mitigation, with unit and long name."""

from stochlin.analyses.pounding.variables import VARIABLES as POUNDING
from stochlin.analyses.separation.variables import VARIABLES as SEPARATION
from stochlin.analyses.tables.labels import Variables


def _of_devices(name: str, units: str, what: str) -> Variables:
    return {
        f"device_{name}_mean": (units, f"mean over the motions: {what}"),
        f"device_{name}_mean_standard_error": (
            units,
            f"standard error of the mean over the motions: {what}",
        ),
        f"device_{name}_quantile": (units, f"95 % quantile over the motions: {what}"),
    }


VARIABLES: Variables = {
    **POUNDING,
    **SEPARATION,
    "relative_displacement_std": ("m", "standard deviation of the relative displacement"),
    "added_damping": ("1", "added damping ratio"),
    "bumper_thickness": ("m", "thickness of the bumpers"),
    "stiffening": ("1", "elastic stiffness over that as built"),
    "strengthening": ("1", "yield force over that as built"),
    "link_stiffness": ("N/m", "stiffness of all links between both structures"),
    "link_damping_constant": ("N (s/m)^a", "damping constant of all links between both structures"),
    "link_damping_exponent": ("1", "exponent a of the dashpots of all links between both structures"),
    "devices": ("1", "number of devices"),
    **_of_devices("force", "N", "largest force of the device"),
    **_of_devices("stroke", "m", "largest extension or compression of the device"),
    **_of_devices("energy", "J", "energy that the device dissipates"),
    "largest_link_force": ("N", "largest force of any link or device"),
    "amplification": ("1", "peak displacement over that of the building as built without pounding"),
}
