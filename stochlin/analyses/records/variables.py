"""Variables of the results on records, with unit and long name."""

from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    "displacement": ("m", "displacement relative to the ground"),
    "velocity": ("m/s", "velocity relative to the ground"),
    "z": ("1", "hysteretic displacement over yield displacement"),
    "radius": ("m", "root of u^2 + (u'/w)^2"),
    "displacement_max": ("m", "largest absolute displacement relative to the ground"),
    "velocity_max": ("m/s", "largest absolute velocity relative to the ground"),
    "acceleration_max": ("m/s^2", "largest absolute acceleration, ground included"),
    "pseudo_velocity": ("m/s", "circular frequency times displacement_max"),
    "pseudo_acceleration": ("m/s^2", "circular frequency squared times displacement_max"),
    "pseudo_energy_radius": ("m", "largest root of u^2 + (u'/w)^2"),
    "input_energy_per_mass": ("m^2/s^2", "energy put in by the ground so far, relative"),
    "viscous_energy_per_mass": ("m^2/s^2", "energy dissipated by viscous damping so far"),
    "hysteretic_energy_per_mass": ("m^2/s^2", "energy dissipated by yielding so far"),
    "kinetic_energy_per_mass": ("m^2/s^2", "kinetic energy relative to the ground"),
    "elastic_energy_per_mass": ("m^2/s^2", "energy that unloading would give back"),
    "permanent_set": ("m", "displacement at rest after the motion"),
    "peak": ("m", "largest absolute displacement"),
    "separation_at_height": ("m", "largest displacement towards structure_2 at this height"),
    "storey_drift": ("m", "drift of the storey"),
    "peak_drift": ("m", "largest absolute drift of the storey"),
    "ductility": ("1", "largest drift over the drift at yield"),
    "step_error": ("1", "largest change of a peak when the step was halved for the last time"),
    "separation": ("m", "largest displacement of the structure towards structure_2"),
    "separation_quantile": ("m", "gap that this share of the records keeps"),
    "srss": ("m", "root of the sum of squares of the peaks"),
    "separation_over_srss": ("1", "separation over SRSS of the peaks"),
    "rho": ("1", "correlation coefficient of the displacements"),
    "envelope": ("1", "envelope of the motion"),
    "record_energy": ("1", "share of the record's energy so far"),
    "envelope_energy": ("1", "share of the envelope's energy so far"),
}

# Variables with another long name for one structure alone, beside its property line.
ALONE: Variables = {
    "separation": ("m", "largest displacement of the structure towards its property line"),
    "separation_at_height": ("m", "largest displacement towards the property line at this height"),
}
