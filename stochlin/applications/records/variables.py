"""Variables of the results on records, with unit and long name."""

from stochlin.solver.tables.labels import Variables

VARIABLES: Variables = {
    "displacement": ("m", "displacement relative to the ground"),
    "velocity": ("m/s", "velocity relative to the ground"),
    "z": ("1", "hysteretic displacement over yield displacement"),
    "radius": ("m", "energy radius"),
    "displacement_max": ("m", "peak absolute displacement relative to the ground"),
    "velocity_max": ("m/s", "peak absolute velocity relative to the ground"),
    "acceleration_max": ("m/s^2", "peak absolute total acceleration"),
    "pseudo_velocity": ("m/s", "pseudo-velocity"),
    "pseudo_acceleration": ("m/s^2", "pseudo-acceleration"),
    "pseudo_energy_radius": ("m", "pseudo energy radius"),
    "input_energy_per_mass": ("m^2/s^2", "relative input energy per mass so far"),
    "viscous_energy_per_mass": ("m^2/s^2", "energy per mass dissipated by viscous damping so far"),
    "hysteretic_energy_per_mass": ("m^2/s^2", "energy per mass dissipated by yielding so far"),
    "kinetic_energy_per_mass": ("m^2/s^2", "kinetic energy per mass relative to the ground"),
    "elastic_energy_per_mass": ("m^2/s^2", "elastic energy per mass"),
    "permanent_set": ("m", "permanent displacement after the motion"),
    "peak": ("m", "peak absolute displacement"),
    "separation_at_height": ("m", "peak displacement towards structure_2 at the height"),
    "storey_drift": ("m", "storey drift"),
    "peak_drift": ("m", "peak absolute storey drift"),
    "ductility": ("1", "peak storey drift over yield drift"),
    "step_error": ("1", "largest relative change of a peak by the last halving of the time step"),
    "separation": ("m", "peak relative displacement towards structure_2"),
    "separation_quantile": ("m", "quantile of the gap over the records"),
    "srss": ("m", "root of the sum of the squares of the peaks"),
    "separation_over_srss": ("1", "separation over SRSS of the peaks"),
    "rho": ("1", "correlation coefficient of the displacements"),
}

# Variables with another long name for one structure alone, beside its property line.
ALONE: Variables = {
    "separation": ("m", "peak displacement towards the property line"),
    "separation_at_height": ("m", "peak displacement towards the property line at the height"),
}
