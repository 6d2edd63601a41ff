"""Variables of the charts, with unit and long name."""

from stochlin.analyses.records.variables import VARIABLES as RECORDS
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **RECORDS,
    "force_per_mass": ("m/s^2", "restoring force per unit mass"),
    "hysteretic_work_per_mass": ("m^2/s^2", "work of the hysteretic force per unit mass"),
    "rho": ("1", "correlation coefficient ρ"),
    "amplification": ("1", "amplification D, inelastic / elastic"),
    "amplification_drift": ("1", "amplification of the standard deviation by the drift closure"),
    "amplification_simulated": ("1", "D of standard deviations, simulated"),
    "amplification_simulated_standard_error": ("1", "standard error of the simulated amplification"),
    "amplification_of_peaks": ("1", "D of mean maxima, simulated"),
    "amplification_of_peaks_standard_error": (
        "1",
        "standard error of the amplification of the mean peak",
    ),
    "rho_elastic": ("1", "correlation coefficient of elastic structures on this ground"),
    "rho_white_noise": ("1", "correlation coefficient of elastic structures by eq. (4)"),
    "rho_drift": ("1", "correlation coefficient of the displacements by the drift closure"),
    "rho_effective": ("1", "correlation coefficient by eq. (4) with effective properties"),
    "rho_simulated": ("1", "ρ, simulated"),
    "rho_difference": ("1", "ρ, linearized minus simulated"),
    "velocity_over_frequency": ("m", "velocity over circular frequency"),
    **{
        f"{kind}_energy_radius{end}": ("m", f"radius of the {kind} energy{when}")
        for kind in ("input", "viscous", "hysteretic")
        for end, when in (("", " so far"), ("_at_end", " at the end"))
    },
    "significant_begin": ("s", "time of 5 % of the energy of the record"),
    "significant_end": ("s", "time of 95 % of the energy of the record"),
    "restitution": ("1", "coefficient of restitution"),
    "restitution_hertz_damp": ("1", "coefficient of restitution of the Hertz-damp contact"),
    "contact_damping": ("1", "damping parameter of the contact element"),
    "scaled_contact_time": ("1", "contact time over τ"),
    "scaled_time": ("1", "time t/τ"),
    "scaled_deformation": ("1", "deformation d/(v0 τ)"),
    "scaled_velocity": ("1", "rate of deformation over the approach velocity v0"),
    "scaled_force": ("1", "contact force f/(k (v0 τ)^n)"),
}
