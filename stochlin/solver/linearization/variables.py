"""Variables of the results on linearization, with unit and long name."""

from stochlin.solver.tables.labels import Variables

VARIABLES: Variables = {
    "displacement_std": ("m", "standard deviation of the displacement"),
    "velocity_std": ("m/s", "standard deviation of the velocity"),
    "ductility_std": ("1", "standard deviation of the ductility"),
    "z_std": ("1", "standard deviation of the hysteretic displacement"),
    "velocity_z_corr": ("1", "correlation of velocity and hysteretic displacement"),
    "c_eq": ("1", "equivalent coefficient of the velocity in z' = -c_eq v - k_eq z"),
    "k_eq": ("1/s", "equivalent coefficient of z in z' = -c_eq v - k_eq z"),
    "yield_displacement": ("m", "yield displacement"),
    "iterations": ("1", "number of iterations"),
    "residual": ("1", "residual of the moments before the last iteration"),
    "drift_std": ("m", "standard deviation of the displacement by plastic drift"),
    "drift_time": ("s", "relaxation time of the plastic drift"),
    "bias": ("1", "bias of the linearized standard deviation of the displacement"),
    "bias_error": ("1", "expected error of the bias"),
    "displacement_error": ("1", "expected relative error of the standard deviation of the displacement"),
    "period_eq": ("s", "equivalent period"),
    "damping_eq": ("1", "equivalent damping ratio"),
    "peak_mean": ("m", "mean of the peak absolute displacement"),
    "peak_std": ("m", "standard deviation of the peak absolute displacement"),
    "peak_factor": ("1", "peak factor of the absolute displacement"),
    "crossings": ("1", "mean number of zero crossings in the duration"),
    "bandwidth": ("1", "spectral bandwidth"),
    "reduction_factor": ("1", "reduction factor"),
    "ductility_peak": ("1", "mean peak ductility"),
    "hysteretic_energy_per_mass": ("m^2/s^2", "mean work done on the hysteretic spring over the mass"),
    "state_mean": ("1", "mean of a further state of the law"),
    "envelope": ("1", "envelope of the motion"),
}
