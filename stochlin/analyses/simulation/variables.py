"""What is simulated, beside what linearization finds."""

from stochlin.analyses.linearization.variables import VARIABLES as LINEARIZATION
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **LINEARIZATION,
    "rho": ("1", "correlation coefficient of the displacements"),
    "displacement_std_standard_error": ("m", "standard error of the displacement's standard deviation"),
    "rho_standard_error": ("1", "standard error of rho"),
    "drift": ("1", "variance of the second half of the run less that of the first, in standard errors"),
    "peak": ("m", "largest absolute displacement"),
    "peak_positive": ("m", "largest displacement"),
    "peak_negative": ("m", "largest displacement the other way"),
    "input_factor": ("1", "sample of the parameter over its median"),
    "drift_std": ("m", "standard deviation of the drift of the storey"),
    "drift_std_standard_error": ("m", "standard error of drift_std"),
    "peak_drift": ("m", "largest absolute drift of the storey"),
    "peak_drift_mean": ("m", "mean of the largest drift"),
    "peak_drift_mean_standard_error": ("m", "standard error of peak_drift_mean"),
    "peak_at_height": ("m", "largest absolute displacement of the structure at this height"),
    "ductility": ("1", "mean of the largest drift over the drift at yield"),
    "separation_at_height": ("m", "largest displacement towards structure_2 at this height"),
    "separation": ("m", "largest displacement of the structure towards structure_2"),
    "peak_positive_mean": ("m", "mean of the largest displacement"),
    "peak_mean_standard_error": ("m", "standard error of peak_mean"),
    "peak_positive_mean_standard_error": ("m", "standard error of peak_positive_mean"),
    "separation_mean": ("m", "mean of the separation"),
    "separation_mean_standard_error": ("m", "standard error of separation_mean"),
    "separation_quantile": ("m", "separation not exceeded with this probability"),
    "probability": ("1", "probability of exceeding the gap"),
}
