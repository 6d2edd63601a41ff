"""What contact elements do, and the trace of a record."""

from stochlin.analyses.records.variables import VARIABLES as RECORDS
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **RECORDS,
    "amplification_drift": ("1", "amplification of the standard deviation by the drift closure"),
    "amplification_simulated": ("1", "amplification of the standard deviation, simulated"),
    "amplification_simulated_standard_error": ("1", "standard error of amplification_simulated"),
    "amplification_of_peaks": ("1", "amplification of the maximum, simulated"),
    "amplification_of_peaks_standard_error": ("1", "standard error of amplification_of_peaks"),
    "rho_drift": ("1", "correlation coefficient of the displacements by the drift closure"),
    "rho_effective": ("1", "correlation coefficient by eq. (4) with effective properties"),
    "rho_simulated": ("1", "correlation coefficient, simulated"),
    "rho_difference": ("1", "correlation coefficient, linearized less simulated"),
    "velocity_over_frequency": ("m", "velocity over circular frequency"),
    **{
        f"{kind}_energy_radius{end}": ("m", f"radius sqrt(2 E)/w of the {kind} energy{when}")
        for kind in ("input", "viscous", "hysteretic")
        for end, when in (("", " so far"), ("_at_end", " at the end"))
    },
    "significant_begin": ("s", "when 5 % of the record's energy have come"),
    "significant_end": ("s", "when 95 % of the record's energy have come"),
    "restitution": ("1", "coefficient of restitution"),
    "restitution_hertz_damp": ("1", "coefficient of restitution of the Hertz-damp contact"),
    "contact_damping": ("1", "damping of the contact, as its element takes it"),
    "scaled_contact_time": ("1", "contact time over (m v0^(1-n)/k)^(1/(n+1))"),
    "scaled_time": ("1", "time over (m v0^(1-n)/k)^(1/(n+1))"),
    "scaled_deformation": ("1", "deformation d over (m v0^2/k)^(1/(n+1))"),
    "scaled_velocity": ("1", "rate of deformation over the approach velocity v0"),
    "scaled_force": ("1", "contact force over k^(1/(n+1)) (m v0^2)^(n/(n+1))"),
}
