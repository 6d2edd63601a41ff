"""Names, units and run information that every dataset carries."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from stochlin._version import __version__
from stochlin.models.parameters import Model

PAPER = (
    "Valles-Mattox, R. E. and Reinhorn, A. M. (1996). Evaluation, prevention and mitigation of "
    "pounding effects in building structures. 11th World Conference on Earthquake Engineering."
)

CAUTION_RHO = (
    "Caution: against exact simulation, linearized ρ is off by .05 to .2 where yielding is moderate, "
    "and by up to 1.3 for structures much stiffer than a narrow-band ground; see 'stochlin verify'."
)
CAUTION_DRIFT = (
    "Against exact simulation of 500 random pairs, displacements by the drift closure are off by 1.4 % "
    "in the mean and ρ by .03; where T < Tg/2 on a narrow-band ground (ξg < .1), by 4 % and .05."
)
CAUTION_SIGMA = (
    "Caution: against exact simulation, linearized displacements are 20 to 46 % too small at α ≤ .05, "
    "and up to 30 times for structures much stiffer than a narrow-band ground; see 'stochlin verify'."
)

CONVERGED, ELASTIC_LIMIT, NOT_CONVERGED, INVALID_INPUT, NOT_PHYSICAL = range(5)
STATUS_MEANINGS = (
    "converged",
    "elastic_limit",
    "not_converged",
    "invalid_input",
    "not_a_covariance",
)
CURES = {
    NOT_CONVERGED: "raise max_iterations; in a simulation, relaxation_times",
    INVALID_INPUT: "correct the parameters that are out of range",
    NOT_PHYSICAL: "rounding has spoiled the covariance: use less extreme parameters, or another closure",
}

VARIABLES: Mapping[str, tuple[str, str]] = {
    "displacement_std": ("m", "standard deviation of the displacement"),
    "velocity_std": ("m/s", "standard deviation of the velocity"),
    "ductility_std": ("1", "standard deviation of displacement over yield displacement"),
    "z_std": ("1", "standard deviation of the hysteretic displacement"),
    "velocity_z_corr": ("1", "correlation of velocity and hysteretic displacement"),
    "c_eq": ("1", "equivalent coefficient of the velocity, z' = -c_eq v - k_eq z"),
    "k_eq": ("1/s", "equivalent coefficient of z, z' = -c_eq v - k_eq z"),
    "yield_displacement": ("m", "yield displacement"),
    "period_eq": ("s", "equivalent period"),
    "damping_eq": ("1", "equivalent damping ratio"),
    "iterations": ("1", "iterations"),
    "residual": ("1", "mismatch of log sigma and atanh correlation before the last correction"),
    "drift_std": ("m", "standard deviation of the plastic drift in the displacement, as derived"),
    "drift_time": ("s", "relaxation time of the plastic drift"),
    "bias": ("1", "relative error of the linearized standard deviation of the displacement"),
    "relative_displacement_std": ("m", "standard deviation of u_1 - u_2"),
    "link_force_std": ("N", "standard deviation of the force in the link"),
    "rho": ("1", "correlation coefficient of the displacements"),
    "displacement_std_standard_error": ("m", "standard error of the displacement's standard deviation"),
    "rho_error": ("1", "mean absolute error of rho over simulated pairs of this region"),
    "rho_standard_error": ("1", "standard error of rho"),
    "drift": ("1", "variance of the second half of the run less that of the first, in standard errors"),
    "amplification_standard_error": ("1", "standard error of the amplification"),
    "amplification": ("1", "inelastic over elastic standard deviation of the displacement"),
    "peak": ("m", "largest absolute displacement"),
    "peak_positive": ("m", "largest displacement"),
    "peak_negative": ("m", "largest displacement the other way"),
    "separation": ("m", "largest displacement of the structure towards structure_2"),
    "peak_mean": ("m", "mean of the largest absolute displacement"),
    "peak_positive_mean": ("m", "mean of the largest displacement"),
    "peak_std": ("m", "standard deviation of the largest absolute displacement"),
    "peak_factor": ("1", "mean largest absolute displacement over the standard deviation"),
    "crossings": ("1", "mean number of zero crossings, both ways, in the duration"),
    "bandwidth": ("1", "spectral bandwidth, 0 for a sine wave"),
    "gap": ("m", "gap between the structures"),
    "reduction_factor": ("1", "reduction factor, elastic over yield strength"),
    "ductility_peak": ("1", "mean peak ductility"),
    "separation_mean": ("m", "mean of the separation"),
    "peak_mean_standard_error": ("m", "standard error of peak_mean"),
    "peak_positive_mean_standard_error": ("m", "standard error of peak_positive_mean"),
    "separation_mean_standard_error": ("m", "standard error of separation_mean"),
    "separation_quantile": ("m", "separation not exceeded with this probability"),
    "separation_quantile_lower": ("m", "lower end of its 95 % interval"),
    "separation_quantile_upper": ("m", "upper end of its 95 % interval"),
    "displacement": ("m", "displacement relative to the ground"),
    "velocity": ("m/s", "velocity relative to the ground"),
    "z": ("1", "hysteretic displacement over yield displacement"),
    "radius": ("m", "root of u^2 + (u'/w)^2"),
    "velocity_over_frequency": ("m", "velocity over circular frequency"),
    "displacement_max": ("m", "largest absolute displacement relative to the ground"),
    "velocity_max": ("m/s", "largest absolute velocity relative to the ground"),
    "acceleration_max": ("m/s^2", "largest absolute acceleration, ground included"),
    "pseudo_velocity": ("m/s", "circular frequency times displacement_max"),
    "pseudo_acceleration": ("m/s^2", "circular frequency squared times displacement_max"),
    "pseudo_energy_radius": ("m", "largest root of u^2 + (u'/w)^2"),
    "permanent_set": ("m", "displacement at rest after the motion"),
    "srss": ("m", "root of the sum of squares of the peaks"),
    "separation_over_srss": ("1", "separation over SRSS of the peaks"),
    "required_gap": ("m", "gap that keeps the confidence"),
    "largest_reduction_factor": ("1", "reduction factor at which the gap just keeps the confidence"),
    "largest_intensity": ("m^2/s^3", "intensity S0 at which the gap just keeps the confidence"),
    "least_added_damping": ("1", "damping ratio to be added to both for the gap to keep the confidence"),
    "gap_lower": ("m", "lower end of the answer's 95 % interval"),
    "gap_upper": ("m", "upper end of the answer's 95 % interval"),
    "error": ("1", "gap of the rule over that of the simulation, less one"),
    "separation_samples": ("m", "largest displacement of structure 1 towards structure 2"),
    "no_pounding_probability": ("1", "share of the simulated motions that the gap survives"),
    "no_pounding_probability_lower": ("1", "lower end of its 95 % interval"),
    "no_pounding_probability_upper": ("1", "upper end of its 95 % interval"),
    "ductility": ("1", "mean peak displacement over yield displacement"),
    "probability": ("1", "probability of exceeding the gap"),
    "probability_lower": ("1", "lower end of its 95 % interval"),
    "probability_upper": ("1", "upper end of its 95 % interval"),
    "instantaneous_probability": ("1", "probability that u_1 - u_2 is beyond the gap at the instant"),
    "instantaneous_probability_corrected": ("1", "the same, linearization corrected for its known bias"),
    "instantaneous_probability_simulated": ("1", "share of the simulated motions beyond the gap"),
    "confidence_of_no_pounding": ("1", "probability of no pounding so far, crossings in clumps"),
    "confidence_of_no_pounding_poisson": ("1", "probability of no pounding so far, Poisson crossings"),
    "confidence_of_no_pounding_corrected": (
        "1",
        "probability of no pounding so far, linearization corrected for its known bias",
    ),
    "confidence_of_no_pounding_simulated": (
        "1",
        "share of the simulated motions without pounding so far",
    ),
    "confidence_of_no_pounding_simulated_lower": ("1", "lower end of its 95 % interval"),
    "confidence_of_no_pounding_simulated_upper": ("1", "upper end of its 95 % interval"),
    "confidence_of_no_pounding_fresh_phase": (
        "1",
        "probability of no pounding so far, a new phase in every cycle",
    ),
    "pounding_probability": ("1", "probability of pounding in the motion, crossings in clumps"),
    "pounding_probability_poisson": ("1", "probability of pounding in the motion, Poisson crossings"),
    "pounding_probability_corrected": (
        "1",
        "probability of pounding in the motion, linearization corrected for its known bias",
    ),
    "pounding_probability_simulated": ("1", "share of the simulated motions with pounding"),
    "pounding_probability_simulated_lower": ("1", "lower end of its 95 % interval"),
    "pounding_probability_simulated_upper": ("1", "upper end of its 95 % interval"),
    "displacement_std_corrected": ("m", "standard deviation of the displacement, bias corrected"),
    "displacement_std_simulated": ("m", "standard deviation of the displacement, simulated"),
    "difference_std": ("m", "standard deviation of u_1 - u_2"),
    "difference_std_corrected": ("m", "standard deviation of u_1 - u_2, bias corrected"),
    "difference_std_simulated": ("m", "standard deviation of u_1 - u_2, simulated"),
    "difference_std_simulated_standard_error": ("m", "its standard error"),
    "required_gap_lower": ("m", "lower end of its 95 % interval"),
    "required_gap_upper": ("m", "upper end of its 95 % interval"),
    "added_damping": ("1", "added damping ratio"),
    "link_stiffness": ("N/m", "stiffness of the link"),
    "link_damping_constant": ("N s/m", "damping constant of the link"),
    "required_gap_corrected": ("m", "gap that keeps the confidence, bias corrected"),
    "required_gap_simulated": ("m", "gap that keeps the confidence, simulated"),
    "required_gap_simulated_lower": ("m", "lower end of its 95 % interval"),
    "required_gap_simulated_upper": ("m", "upper end of its 95 % interval"),
    "envelope": ("1", "envelope of the motion"),
    "recorded_difference": ("m", "u_1 - u_2 in the record"),
    "record_energy": ("1", "share of the record's energy so far"),
    "envelope_energy": ("1", "share of the envelope's energy so far"),
    "restitution": ("1", "coefficient of restitution"),
    "restitution_hertz_damp": ("1", "coefficient of restitution of the Hertz-damp contact"),
    "contact_damping": ("1", "damping of the contact, as its element takes it"),
    "scaled_contact_time": ("1", "contact time over (m v0^(1-n)/k)^(1/(n+1))"),
    "scaled_time": ("1", "time over (m v0^(1-n)/k)^(1/(n+1))"),
    "scaled_deformation": ("1", "deformation d over (m v0^2/k)^(1/(n+1))"),
    "scaled_velocity": ("1", "rate of deformation over the approach velocity v0"),
    "link_force": ("N", "force of the link, positive in tension: against structure 1"),
    "contact_force": ("N", "force of the contact, positive where it pushes apart"),
    "input_energy": ("J", "work of the ground since the beginning"),
    "kinetic_energy": ("J", "kinetic energy relative to the ground"),
    "elastic_energy": ("J", "energy stored in springs"),
    "viscous_energy": ("J", "energy dissipated by the structure's damping since the beginning"),
    "hysteretic_energy": ("J", "energy dissipated by yielding since the beginning"),
    "contact_stored_energy": ("J", "energy stored in the contacts"),
    "link_stored_energy": ("J", "energy stored in the springs of the links"),
    "link_lost_energy": ("J", "energy dissipated by the dashpots of the links since the beginning"),
    "contact_lost_energy": ("J", "energy dissipated by the contacts since the beginning"),
    "energy_balance_error": ("1", "imbalance of the energies over the largest input energy so far"),
    "impact_time": ("s", "time at which the impact began"),
    "impact_contact": ("1", "contact of the impact"),
    "approach_velocity": ("m/s", "velocity of approach at the beginning of the impact"),
    "largest_force": ("N", "largest force in the impact"),
    "impact_duration": ("s", "time until the last force of the impact"),
    "energy_lost": ("J", "energy lost in the impact"),
    "impacts": ("1", "number of impacts"),
    "hardest_force": ("N", "largest force of the contact in any impact"),
    "fastest_approach": ("m/s", "largest velocity of approach"),
    "longest_impact": ("s", "duration of the longest impact"),
    "contact_energy": ("J", "energy that the contact has taken"),
    "least_clearance": ("m", "least distance between the floors, negative where they press"),
    "energy_share": ("1", "share of the input energy, at the end"),
    "peak_ductility": ("1", "largest displacement over yield displacement"),
    "peak_alone": ("m", "largest absolute displacement without pounding"),
    "radius_amplification": ("1", "energy radius after the hit over that before"),
    "largest_radius_amplification": ("1", "largest radius_amplification of any hit"),
    "contact_displacement": ("m", "displacement at which the structures meet"),
    "velocity_before": ("m/s", "velocity before the hit"),
    "velocity_after": ("m/s", "velocity after the hit"),
    "scaled_force": ("1", "contact force over k^(1/(n+1)) (m v0^2)^(n/(n+1))"),
}


def label(dataset: xr.Dataset) -> xr.Dataset:
    """Give every variable its units and long name; numbered ones say which structure."""
    for name in dataset.data_vars:
        stem, _, number = str(name).rpartition("_")
        if name == "status":
            dataset[name].attrs = {
                "long_name": "status of the cell",
                "flag_values": np.arange(len(STATUS_MEANINGS), dtype=np.int8),
                "flag_meanings": " ".join(STATUS_MEANINGS),
            }
        elif str(name) in VARIABLES:
            units, long_name = VARIABLES[str(name)]
            dataset[name].attrs.update(units=units, long_name=long_name)
        elif stem in VARIABLES and number.isdigit():
            units, long_name = VARIABLES[stem]
            dataset[name].attrs.update(units=units, long_name=f"{long_name}, structure {number}")
    return dataset


def with_run_information(
    dataset: xr.Dataset, title: str, call: str, models: Mapping[str, Model], references: str = PAPER
) -> xr.Dataset:
    """Add title, references, version and the parameters that made the dataset.

    The clock stays out of it: the same inputs give the same file.
    """
    dataset.attrs = {
        **dataset.attrs,
        "title": title,
        "references": references,
        "stochlin_version": __version__,
        "history": f"stochlin {__version__}: {call}",
        **{role: model.describe() for role, model in models.items()},
    }
    return dataset


def raise_if_lone_failure(dataset: xr.Dataset, what: str) -> None:
    """A single case that failed has no neighbours to go on for: say so."""
    status = dataset["status"]
    if status.ndim == 0 and int(status) >= NOT_CONVERGED:
        code = int(status)
        raise ArithmeticError(f"{what}: {STATUS_MEANINGS[code].replace('_', ' ')}; {CURES[code]}")
