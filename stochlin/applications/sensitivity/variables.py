"""Variables of the results on sensitivity, with unit and long name."""

from stochlin.applications.separation.variables import VARIABLES as SEPARATION
from stochlin.solver.tables.labels import Variables

VARIABLES: Variables = {
    **SEPARATION,
    "gap_change": ("m", "change of the gap with the input at the end of its range"),
    "gap_change_standard_error": (
        "m",
        "standard error of the change of the gap with the input at the end of its range",
    ),
    "gap_of_medians": ("m", "gap with all inputs at their medians"),
    "gap_of_medians_standard_error": (
        "m",
        "standard error of the gap less the gap with all inputs at their medians",
    ),
    "input_factor_at": ("1", "input over its median at the end of its range"),
}
