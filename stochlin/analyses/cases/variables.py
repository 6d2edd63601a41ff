"""Variables of the results on cases, with unit and long name."""

from stochlin.analyses.pounding.variables import VARIABLES as POUNDING
from stochlin.analyses.tables.labels import Variables

RECORDED: Variables = {
    "peak_ground_acceleration": ("m/s^2", "peak ground acceleration of the record"),
    "rms_acceleration": ("m/s^2", "root mean square of its strong part"),
    "spectral_acceleration": ("m/s^2", "pseudo-acceleration at the period, damping 0.05"),
    "record_amplification": ("1", "quantile of the amplification over the records"),
    "record_impacts": ("1", "quantile of the number of impacts"),
    "record_largest_force": ("N", "quantile of the largest force of the contact"),
    "record_gap_quantile": ("m", "quantile of the gap that the records need"),
    "record_no_pounding_probability": ("1", "share of the records for which the gap is enough"),
    "record_confidence_of_no_pounding": (
        "1",
        "probability of no pounding so far in the record, hybrid method, one phase",
    ),
    "record_confidence_of_no_pounding_fresh_phase": (
        "1",
        "probability of no pounding so far in the record, hybrid method, a new phase in every cycle",
    ),
    "record_required_gap": ("m", "gap that keeps the confidence in the record, hybrid method"),
    "record_separation": ("m", "gap that the record itself needs"),
    "record_rho": ("1", "correlation coefficient of the displacements, hybrid method"),
    "record_radius_difference": ("m", "largest difference of the radii in the record"),
}
VARIABLES: Variables = {
    **POUNDING,
    **RECORDED,
    "yield_displacement": ("m", "yield displacement"),
    "least_clearance": ("m", "smallest distance between the floors, negative where they press"),
    "energy_share": ("1", "share of the input energy, at the end"),
    "peak_ductility": ("1", "largest displacement relative to the yield displacement"),
}
