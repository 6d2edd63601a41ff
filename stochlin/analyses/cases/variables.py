"""What records, impacts and energies of a case add up to."""

from stochlin.analyses.pounding.variables import VARIABLES as POUNDING
from stochlin.analyses.tables.labels import Variables

RECORDED: Variables = {
    "peak_ground_acceleration": ("m/s^2", "peak ground acceleration of the record"),
    "rms_acceleration": ("m/s^2", "root mean square of its strong part"),
    "spectral_acceleration": ("m/s^2", "pseudo-acceleration at the period, damping .05"),
    "record_amplification": ("1", "amplification that so large a share of the records stays below"),
    "record_impacts": ("1", "impacts, likewise"),
    "record_largest_force": ("N", "largest force of the contact, likewise"),
    "record_gap_quantile": ("m", "gap that so large a share of the records would have taken at most"),
    "record_no_pounding_probability": ("1", "share of the records in which the gap would have held"),
}
VARIABLES: Variables = {
    **POUNDING,
    **RECORDED,
    "yield_displacement": ("m", "yield displacement"),
    "least_clearance": ("m", "least distance between the floors, negative where they press"),
    "energy_share": ("1", "share of the input energy, at the end"),
    "peak_ductility": ("1", "largest displacement over yield displacement"),
}
