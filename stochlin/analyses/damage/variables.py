"""Variables of the results on damage, with unit and long name."""

from stochlin.analyses.tables.labels import Variables

OF_DAMAGE: Variables = {
    "residual_drift": ("m", "residual drift"),
    "dissipated_energy": ("J", "energy dissipated by yielding of the element"),
    "peak_ductility": ("1", "peak drift over yield drift"),
    "cumulative_ductility": ("1", "1 + dissipated energy over yield force times yield drift"),
    "hysteretic_energy": ("J", "energy dissipated by yielding of all elements of the structure"),
    "park_ang": ("1", "damage index of Park and Ang"),
    "park_ang_of_structure": ("1", "damage index of Park and Ang of the structure"),
}
VARIABLES: Variables = {
    **OF_DAMAGE,
    **{
        f"{name}_{end}": (units, f"{what}: {text}")
        for name, (units, text) in OF_DAMAGE.items()
        for end, what in (
            ("mean", "mean over the motions"),
            ("mean_standard_error", "standard error of the mean over the motions"),
            ("quantile", "quantile over the motions"),
        )
    },
}
