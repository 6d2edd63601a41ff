"""Variables of the results on cases, with unit and long name."""

from stochlin.applications.pounding.variables import VARIABLES as POUNDING
from stochlin.solver.tables.labels import Variables

RECORDED: Variables = {
    "peak_ground_acceleration": ("m/s^2", "peak ground acceleration of the record"),
    "rms_acceleration": ("m/s^2", "root mean square of the strong part of the record"),
    "spectral_acceleration": ("m/s^2", "pseudo-acceleration at the period, damping ratio 0.05"),
    "record_gap_quantile": ("m", "quantile of the gap over the records"),
    "record_no_pounding_probability": ("1", "share of the records without pounding"),
    "record_confidence_of_no_pounding": (
        "1",
        "probability of no pounding so far in the record, hybrid method",
    ),
    "record_required_gap": ("m", "required gap for the confidence in the record, hybrid method"),
    "record_separation": ("m", "peak relative displacement u_1 - u_2 in the record"),
    "record_rho": ("1", "correlation coefficient of the displacements, hybrid method"),
    "record_radius_difference": ("m", "largest difference of the energy radii in the record"),
}
VARIABLES: Variables = {
    **POUNDING,
    **RECORDED,
    "yield_displacement": ("m", "yield displacement"),
    "least_clearance": ("m", "smallest distance between the floors, negative during contact"),
    "energy_share": ("1", "share of the input energy at the end"),
    "peak_ductility": ("1", "peak ductility"),
}
