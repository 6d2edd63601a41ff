"""Variables of the results on pounding, with unit and long name."""

from stochlin.applications.records.variables import VARIABLES as RECORDS
from stochlin.solver.simulation.variables import OF_LINKS
from stochlin.solver.tables.labels import Variables

_PEAKS: Variables = {
    "peak": ("m", "peak absolute displacement"),
    "peak_acceleration": ("m/s^2", "peak absolute acceleration"),
    "peak_storey_shear": ("N", "peak storey shear"),
    "peak_base_shear": ("N", "peak base shear"),
}
_SINGLE: Variables = {
    **RECORDS,
    **_PEAKS,
    **{f"{name}_alone": (units, f"{words} without pounding") for name, (units, words) in _PEAKS.items()},
    "acceleration": ("m/s^2", "absolute acceleration"),
    "storey_shear": ("N", "shear of the storey below the floor, including the P-delta shear"),
    "base_shear": ("N", "shear of the first storey"),
    **OF_LINKS,
    "column_force": ("N", "largest force of a slab on the column that it meets"),
    "column_force_share": ("1", "force on the column over yield shear of the storey"),
    "link_force": ("N", "force of the link against structure 1, negative in tension"),
    "contact_force": ("N", "force of the contact, positive where it pushes apart"),
    "input_energy": ("J", "work of the ground since the beginning"),
    "kinetic_energy": ("J", "kinetic energy relative to the ground"),
    "elastic_energy": ("J", "energy stored in springs"),
    "viscous_energy": ("J", "energy dissipated by the damping of the structure since the beginning"),
    "hysteretic_energy": ("J", "energy dissipated by yielding since the beginning"),
    "contact_stored_energy": ("J", "energy stored in the contacts"),
    "link_stored_energy": ("J", "energy stored in the springs of the links"),
    "link_lost_energy": ("J", "energy dissipated by the links since the beginning"),
    "contact_lost_energy": ("J", "energy dissipated by the contacts since the beginning"),
    "energy_balance_error": ("1", "imbalance of the energies over the largest input energy so far"),
    "step_error": (
        "1",
        "largest relative change of a peak or largest force from time steps twice as long",
    ),
    "impact_time": ("s", "time at which the impact began"),
    "impact_contact": ("1", "contact of the impact"),
    "approach_velocity": ("m/s", "velocity of approach at the beginning of the impact"),
    "largest_force": ("N", "largest force in the impact"),
    "impact_duration": ("s", "duration of the impact"),
    "energy_lost": ("J", "energy lost in the impact"),
    "energy_transferred": ("J", "work of the impact on the structure on this side"),
    "radius_amplification": ("1", "energy radius after the impact over that before"),
    "largest_radius_amplification": ("1", "largest amplification of the energy radius by an impact"),
    "contact_displacement": ("m", "displacement at which the structures meet"),
    "velocity_before": ("m/s", "velocity before the hit"),
    "velocity_after": ("m/s", "velocity after the hit"),
    "amplification": ("1", "peak displacement in the row over that standing alone"),
    "gap": ("m", "gap between the structures"),
    "impacts": ("1", "number of impacts"),
    "hardest_force": ("N", "largest force of the contact in any impact"),
    "fastest_approach": ("m/s", "largest velocity of approach"),
    "longest_impact": ("s", "duration of the longest impact"),
    "deepest_compression": ("m", "largest compression of the contact in any impact"),
    "contact_energy": ("J", "energy lost in the contact"),
    "energy_received": ("J", "work of all impacts on the structure"),
    "impacts_between": ("1", "number of impacts between the neighbours, at all levels"),
    "hardest_force_between": ("N", "largest force between the neighbours, at any level"),
    "contact_energy_between": ("J", "energy lost in all contacts between the neighbours"),
    "pounding_probability": ("1", "share of the motions with an impact between the neighbours"),
    "no_pounding_probability": ("1", "share of the motions without an impact between the neighbours"),
}
# Variables with a mean and quantiles over several motions.
STATISTICS = (
    *("impacts_between", "hardest_force_between", "contact_energy_between"),
    *("impacts", "hardest_force", "fastest_approach", "contact_energy", "column_force"),
    *("column_force_share", "amplification", *_PEAKS, *(f"{name}_alone" for name in _PEAKS)),
    *OF_LINKS,
)


def over_motions(variables: Variables) -> Variables:
    """Means and quantiles over motions of these variables."""
    return {
        f"{name}_{what}": (units, f"{words} over the motions: {text}")
        for name, (units, text) in variables.items()
        for what, words in (
            ("mean", "mean"),
            ("mean_standard_error", "standard error of the mean"),
            ("quantile", "quantile"),
        )
    }


VARIABLES: Variables = {**_SINGLE, **over_motions({name: _SINGLE[name] for name in STATISTICS})}
