"""What linearization finds of one structure."""

from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    "displacement_std": ("m", "standard deviation of the displacement"),
    "velocity_std": ("m/s", "standard deviation of the velocity"),
    "ductility_std": ("1", "standard deviation of displacement over yield displacement"),
    "z_std": ("1", "standard deviation of the hysteretic displacement"),
    "velocity_z_corr": ("1", "correlation of velocity and hysteretic displacement"),
    "c_eq": ("1", "equivalent coefficient of the velocity, z' = -c_eq v - k_eq z"),
    "k_eq": ("1/s", "equivalent coefficient of z, z' = -c_eq v - k_eq z"),
    "yield_displacement": ("m", "yield displacement"),
    "iterations": ("1", "iterations"),
    "residual": ("1", "mismatch of log sigma and atanh correlation before the last correction"),
    "drift_std": ("m", "standard deviation of the plastic drift in the displacement, as derived"),
    "drift_time": ("s", "relaxation time of the plastic drift"),
    "bias": ("1", "relative error of the linearized standard deviation of the displacement"),
    "displacement_error": ("1", "expected relative error of displacement_std"),
    "period_eq": ("s", "equivalent period"),
    "damping_eq": ("1", "equivalent damping ratio"),
    "peak_mean": ("m", "mean of the largest absolute displacement"),
    "peak_std": ("m", "standard deviation of the largest absolute displacement"),
    "peak_factor": ("1", "mean largest absolute displacement over the standard deviation"),
    "crossings": ("1", "mean number of zero crossings, both ways, in the duration"),
    "bandwidth": ("1", "spectral bandwidth, 0 for a sine wave"),
    "reduction_factor": ("1", "reduction factor, elastic over yield strength"),
    "ductility_peak": ("1", "mean peak ductility"),
    "envelope": ("1", "envelope of the motion"),
}
