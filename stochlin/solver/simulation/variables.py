"""Variables of the results on simulation, with unit and long name."""

from stochlin.solver.linearization.variables import VARIABLES as LINEARIZATION
from stochlin.solver.tables.labels import Variables

OF_LINKS: Variables = {
    "peak_link_force": ("N", "peak link force"),
    "peak_link_stroke": ("m", "peak absolute extension of the link"),
    "link_energy": ("J", "energy dissipated by the link"),
}
VARIABLES: Variables = {
    **LINEARIZATION,
    "rho": ("1", "correlation coefficient of the displacements"),
    "displacement_std_standard_error": (
        "m",
        "standard error of the standard deviation of the displacement",
    ),
    "rho_standard_error": ("1", "standard error of rho"),
    "drift": ("1", "change of the variance during the run, in standard errors"),
    "drift_memory": ("s", "relaxation time of the plastic drift"),
    "peak": ("m", "peak absolute displacement"),
    "peak_positive": ("m", "peak displacement in the positive direction"),
    "peak_negative": ("m", "peak displacement in the negative direction"),
    "input_factor": ("1", "sample of the uncertain parameter over its median"),
    "drift_std": ("m", "standard deviation of the storey drift"),
    "drift_std_standard_error": ("m", "standard error of the standard deviation of the storey drift"),
    "peak_drift": ("m", "peak absolute storey drift"),
    "peak_drift_mean": ("m", "mean of the peak storey drift"),
    "peak_drift_mean_standard_error": ("m", "standard error of the mean peak storey drift"),
    "peak_at_height": ("m", "peak absolute displacement at the height"),
    "ductility": ("1", "mean peak storey drift over yield drift"),
    "separation_at_height": ("m", "peak displacement towards structure_2 at the height"),
    "separation": ("m", "peak relative displacement towards structure_2"),
    "peak_positive_mean": ("m", "mean of the peak displacement in the positive direction"),
    "peak_mean_standard_error": ("m", "standard error of the mean peak absolute displacement"),
    "peak_positive_mean_standard_error": (
        "m",
        "standard error of the mean peak_positive",
    ),
    **OF_LINKS,
    **{
        f"{name}_mean{end}": (units, f"{what} of the {text}")
        for name, (units, text) in OF_LINKS.items()
        for end, what in (("", "mean"), ("_standard_error", "standard error of the mean"))
    },
    "separation_mean": ("m", "mean of the separation"),
    "separation_mean_standard_error": ("m", "standard error of the mean separation"),
    "separation_quantile": ("m", "quantile of the separation"),
    "collapse_probability": ("1", "probability that the structure falls"),
    "probability": ("1", "probability of exceeding the gap"),
}
