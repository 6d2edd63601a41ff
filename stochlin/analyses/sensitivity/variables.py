"""Variables of the results on sensitivity, with unit and long name."""

from stochlin.analyses.separation.variables import VARIABLES as SEPARATION
from stochlin.analyses.tables.labels import Variables

OWN: Variables = {
    "slope": ("m", "change of the gap per unit of the input"),
    "elasticity": ("1", "relative change of the gap over that of the input"),
    "gap_change": ("m", "change of the gap with the input at the end of its range"),
}
VARIABLES: Variables = {
    **SEPARATION,
    **OWN,
    **{
        f"{name}_standard_error": (units, f"standard error of the {about}")
        for name, (units, about) in OWN.items()
    },
    "gap_of_medians": ("m", "gap with all inputs at their medians"),
    "gap_of_medians_standard_error": (
        "m",
        "standard error of the gap less the gap with all inputs at their medians",
    ),
    "input_factor_at": ("1", "input over its median at the end of its range"),
}
