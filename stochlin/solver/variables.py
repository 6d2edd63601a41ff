"""Units and long names of the variables of all tables."""

from collections.abc import Mapping

Variables = Mapping[str, tuple[str, str]]
NONE: Variables = {}
VARIABLES: Variables = {
    # Response of one structure
    "displacement": ("m", "displacement relative to the ground"),
    "velocity": ("m/s", "velocity relative to the ground"),
    "z": ("1", "hysteretic displacement over yield displacement"),
    "ductility": ("1", "peak over yield deformation, of several motions the mean"),
    "storey_drift": ("m", "storey drift"),
    "permanent_set": ("m", "permanent displacement after the motion"),
    "base_shear": ("N", "base shear"),
    "displacement_std": ("m", "standard deviation of the displacement"),
    "velocity_std": ("m/s", "standard deviation of the velocity"),
    "ductility_std": ("1", "standard deviation of the ductility"),
    "z_std": ("1", "standard deviation of the hysteretic displacement"),
    "velocity_z_corr": ("1", "correlation of velocity and hysteretic displacement"),
    "drift_std": ("m", "standard deviation of the storey drift, or of the plastic drift"),
    "drift_time": ("s", "relaxation time of the plastic drift"),
    "drift_memory": ("s", "relaxation time of the plastic drift"),
    "drift": ("1", "change of the variance during the run, in standard errors"),
    "peak": ("m", "peak absolute displacement"),
    "peak_positive": ("m", "peak displacement in the positive direction"),
    "peak_negative": ("m", "peak displacement in the negative direction"),
    "peak_drift": ("m", "peak absolute storey drift"),
    "peak_std": ("m", "standard deviation of the peak absolute displacement"),
    "peak_factor": ("1", "peak factor of the absolute displacement"),
    "peak_ductility": ("1", "peak ductility"),
    "ductility_peak": ("1", "mean peak ductility"),
    "elastic_peak": ("m", "peak absolute displacement of the elastic structure"),
    "displacement_max": ("m", "peak absolute displacement relative to the ground"),
    "velocity_max": ("m/s", "peak absolute velocity relative to the ground"),
    "acceleration_max": ("m/s^2", "peak absolute total acceleration"),
    "crossings": ("1", "mean number of zero crossings in the duration"),
    "bandwidth": ("1", "spectral bandwidth"),
    "state_mean": ("1", "mean of a further state of the law"),
    "collapse_probability": ("1", "probability that the structure falls"),
    # Structures and equivalent structures
    "period": ("s", "period of the mode"),
    "yield_displacement": ("m", "yield displacement"),
    "yield_drift": ("m", "yield drift"),
    "reduction_factor": ("1", "reduction factor"),
    "hardening": ("1", "hardening ratio that is taken"),
    "c_eq": ("1", "equivalent coefficient of the velocity in z' = -c_eq v - k_eq z"),
    "k_eq": ("1/s", "equivalent coefficient of z in z' = -c_eq v - k_eq z"),
    "period_eq": ("s", "equivalent period"),
    "damping_eq": ("1", "equivalent damping ratio"),
    "force_per_mass": ("m/s^2", "restoring force per unit mass"),
    "equivalent_damping_constant": ("N s/m", "equivalent damping constant of the link"),
    "added_damping": ("1", "added damping ratio"),
    "input_factor": ("1", "sample of the uncertain parameter over its median"),
    "input_factor_at": ("1", "input over its median at the end of its range"),
    # Errors and iterations
    "bias": ("1", "bias by linearization, relative or, of rho, a difference"),
    "bias_error": ("1", "expected error of the bias"),
    "displacement_error": ("1", "expected relative error of the standard deviation of the displacement"),
    "rho_error": ("1", "mean absolute error of rho over simulated pairs of the region"),
    "iterations": ("1", "number of iterations"),
    "residual": ("1", "relative residual of the equations of the moments"),
    "covariance_change": ("1", "largest relative change of the covariance"),
    "coefficient_change": ("1", "largest change of the equivalent coefficients"),
    "step_error": ("1", "largest relative change of a peak when the time step is halved"),
    "energy_balance_error": ("1", "imbalance of the energies over the largest input energy so far"),
    "error": ("1", "relative error of the gap of the rule against simulation"),
    # Two structures
    "rho": ("1", "correlation coefficient of the displacements"),
    "rho_estimate": ("1", "correlation coefficient in eq. (3)"),
    "amplification": ("1", "displacement over that of the elastic structure, or of the structure alone"),
    "difference_std": ("m", "standard deviation of the relative displacement"),
    "relative_displacement_std": ("m", "standard deviation of the relative displacement"),
    "relative_displacement_bias": ("1", "bias of the relative displacement"),
    "relative_displacement_error": ("1", "expected error of the relative displacement"),
    "relative_displacement_caution": ("1", "caution flag of the relative displacement"),
    "separation": ("m", "peak displacement towards structure_2 or the property line"),
    "separation_samples": ("m", "peak displacement towards structure 2 or the property line"),
    "separation_over_srss": ("1", "separation over SRSS of the peaks"),
    "srss": ("m", "root of the sum of the squares of the peaks"),
    "recorded_difference": ("m", "u_1 - u_2 in the record"),
    # Gaps
    "gap": ("m", "gap between the structures, or to the property line"),
    "cqc": ("m", "gap by the CQC over the modes of both structures"),
    "required_gap": ("m", "required gap"),
    "critical_gap": ("m", "critical gap of eq. (3) with the energy radii"),
    "critical_gap_error": ("1", "relative error of the critical gap against the record"),
    "governing_height": ("m", "height that governs the gap"),
    "gap_change": ("m", "change of the gap with the input at the end of its range"),
    "gap_of_medians": ("m", "gap with all inputs at their medians"),
    "least_clearance": ("m", "smallest distance between the floors, negative during contact"),
    "largest_reduction_factor": ("1", "largest reduction factor for which the gap is sufficient"),
    "least_reduction_factor": ("1", "smallest reduction factor for which the gap is sufficient"),
    "largest_intensity": ("m^2/s^3", "largest intensity S0 for which the gap is sufficient"),
    "least_added_damping": ("1", "least damping ratio to be added to both structures"),
    "least_added_damping_recorded": ("1", "least damping ratio to be added, by the motion itself"),
    # Probabilities
    "probability": ("1", "probability of exceeding the gap"),
    "instantaneous_probability": ("1", "instantaneous probability of exceeding the gap"),
    "confidence_of_no_pounding": ("1", "probability of no pounding so far"),
    "confidence_of_no_pounding_at_least": ("1", "lower bound for all heights of that of no pounding"),
    "no_pounding_probability": ("1", "probability of no pounding"),
    "pounding_probability": ("1", "probability of pounding"),
    "fragility_median": ("m^2/s^3", "median intensity of pounding"),
    "fragility_dispersion": ("1", "logarithmic standard deviation of the intensity of pounding"),
    "probability_in_years": ("1", "probability of pounding at least once in the given years"),
    "annual_rate": ("1/yr", "mean annual frequency of pounding"),
    "annual_rate_unseen": ("1/yr", "upper bound for intensities above the simulated ones"),
    "annual_rate_unseen_weaker": ("1/yr", "upper bound for intensities below the table of the hazard"),
    "annual_rate_by_intensity": (
        "1/yr",
        "contribution of the intensity to the annual frequency of pounding",
    ),
    "target_rate": ("1/yr", "allowed mean annual frequency of pounding"),
    # Ground motion
    "envelope": ("1", "envelope of the motion"),
    "ground_intensity": ("m^2/s^3", "two-sided PSD S0 of the white noise"),
    "peak_ground_acceleration": ("m/s^2", "peak ground acceleration"),
    "rms_acceleration": ("m/s^2", "root mean square of the ground acceleration in the strong part"),
    "spectral_acceleration": ("m/s^2", "pseudo-acceleration at the period, damping ratio 0.05"),
    "pseudo_acceleration": ("m/s^2", "pseudo-acceleration"),
    "pseudo_velocity": ("m/s", "pseudo-velocity"),
    "target": ("m/s^2", "target pseudo-acceleration"),
    "ratio": ("1", "mean pseudo-acceleration over the target"),
    # Energies
    "radius": ("m", "energy radius"),
    "pseudo_energy_radius": ("m", "pseudo energy radius"),
    "radius_amplification": ("1", "energy radius after the impact over that before"),
    "largest_radius_amplification": ("1", "largest amplification of the energy radius by an impact"),
    "input_energy_per_mass": ("m^2/s^2", "relative input energy per mass so far"),
    "viscous_energy_per_mass": ("m^2/s^2", "energy per mass dissipated by viscous damping so far"),
    "hysteretic_energy_per_mass": ("m^2/s^2", "energy per mass put into hysteretic springs so far"),
    "hysteretic_work_per_mass": ("m^2/s^2", "work of the hysteretic force per unit mass"),
    "kinetic_energy_per_mass": ("m^2/s^2", "kinetic energy per mass relative to the ground"),
    "elastic_energy_per_mass": ("m^2/s^2", "elastic energy per mass"),
    "input_energy": ("J", "work of the ground since the beginning"),
    "kinetic_energy": ("J", "kinetic energy relative to the ground"),
    "elastic_energy": ("J", "energy stored in springs"),
    "viscous_energy": ("J", "energy dissipated by the damping of the structure since the beginning"),
    "hysteretic_energy": ("J", "energy dissipated by yielding since the beginning"),
    "contact_stored_energy": ("J", "energy stored in the contacts"),
    "contact_lost_energy": ("J", "energy dissipated by the contacts since the beginning"),
    "link_stored_energy": ("J", "energy stored in the springs of the links"),
    "link_lost_energy": ("J", "energy dissipated by the links since the beginning"),
    # Pounding
    "acceleration": ("m/s^2", "absolute acceleration"),
    "peak_acceleration": ("m/s^2", "peak absolute acceleration"),
    "storey_shear": ("N", "shear of the storey below the floor, including the P-delta shear"),
    "peak_storey_shear": ("N", "peak storey shear"),
    "peak_base_shear": ("N", "peak base shear"),
    "column_force": ("N", "largest force of a slab on the column that it meets"),
    "column_force_share": ("1", "force on the column over yield shear of the storey"),
    "contact_displacement": ("m", "displacement at which the structures meet"),
    "velocity_before": ("m/s", "velocity before the hit"),
    "velocity_after": ("m/s", "velocity after the hit"),
    "impacts": ("1", "number of impacts"),
    "impact_time": ("s", "time at which the impact began"),
    "impact_contact": ("1", "contact of the impact"),
    "impact_duration": ("s", "duration of the impact"),
    "approach_velocity": ("m/s", "velocity of approach at the beginning of the impact"),
    "largest_force": ("N", "largest force in the impact"),
    "energy_lost": ("J", "energy lost in the impact"),
    "energy_transferred": ("J", "work of the impact on the structure on this side"),
    "contact_force": ("N", "force of the contact, positive where it pushes apart"),
    "contact_energy": ("J", "energy lost in the contact"),
    "hardest_force": ("N", "largest force of the contact in any impact"),
    "fastest_approach": ("m/s", "largest velocity of approach"),
    "longest_impact": ("s", "duration of the longest impact"),
    "deepest_compression": ("m", "largest compression of the contact in any impact"),
    "energy_received": ("J", "work of all impacts on the structure"),
    "impacts_between": ("1", "number of impacts between the neighbours, at all levels"),
    "hardest_force_between": ("N", "largest force between the neighbours, at any level"),
    "contact_energy_between": ("J", "energy lost in all contacts between the neighbours"),
    # Links
    "link_force": ("N", "force of the link against structure 1, negative in tension"),
    "link_force_std": ("N", "standard deviation of the link force"),
    "link_energy": ("J", "energy dissipated by the link"),
    "link_damping_constant": ("N s/m", "damping constant of all links between both structures"),
    "peak_link_force": ("N", "peak link force"),
    "peak_link_stroke": ("m", "peak absolute extension of the link"),
    # Modes and pushover curves
    "shape": ("1", "displacement of the floor in the mode, in the unit of the file"),
    "mass": ("kg", "mass of the floor"),
    "height": ("m", "height of the storey below the floor"),
    "level": ("m", "level of the floor above the ground"),
    "participation": ("1", "participation factor of the mode, in the unit of the shapes"),
    "modal_mass": ("kg", "effective modal mass along the direction"),
    "mass_share": ("1", "effective modal mass over the mass of all floors"),
    "floor_move": ("1", "displacement of the floor over that of the oscillator of the mode"),
    "yield_force": ("N", "base shear at yield"),
    "initial_stiffness": ("N/m", "base shear over displacement of the roof where the curve begins"),
    "effective_stiffness": ("N/m", "base shear over displacement of the roof, up to yield"),
    "target_displacement": ("m", "displacement of the roof up to which the curve is idealized"),
    "idealized_base_shear": ("N", "base shear of the idealization"),
    "idealized_displacement": ("m", "displacement of the roof in the idealization"),
}
# What the end or the beginning of a name adds to the long name of the rest.
ENDINGS = {
    "lower": "{}, lower end of the 95 % interval",
    "upper": "{}, upper end of the 95 % interval",
    "standard_error": "standard error of the {}",
    "mean": "mean of the {}",
    "quantile": "quantile of the {}",
    "at_height": "{}, at the height",
    "alone": "{} without pounding",
    "simulated": "{}, simulated",
    "poisson": "{}, Poisson crossings",
}
RECORD = "record_"


def unit_and_long_name(name: str, special: Variables = NONE) -> tuple[str, str] | None:
    """Unit and long name of a variable; None if it has none.

    A name that is neither ``special`` nor in `VARIABLES` may end as in `ENDINGS` or in the number of a
    structure, or begin with ``record_``, also in several ways at once.
    """
    if known := special.get(name) or VARIABLES.get(name):
        return known
    rest, text = name.removeprefix(RECORD), "{}, in the record"
    if rest == name:
        for ending, words in ENDINGS.items():
            if name.endswith(f"_{ending}"):
                rest, text = name.removesuffix(f"_{ending}"), words
        stem, _, number = name.rpartition("_")
        if number.isdigit():
            rest, text = stem, f"{{}}, structure {number}"
    if rest == name or (known := unit_and_long_name(rest, special)) is None:
        return None
    units, long_name = known
    return units, text.format(long_name)
