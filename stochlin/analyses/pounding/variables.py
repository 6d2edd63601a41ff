"""What happens to buildings that meet."""

from stochlin.analyses.records.variables import VARIABLES as RECORDS
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **RECORDS,
    "peak_alone": ("m", "largest absolute displacement without pounding"),
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
    "radius_amplification": ("1", "energy radius after the hit over that before"),
    "largest_radius_amplification": ("1", "largest radius_amplification of any hit"),
    "contact_displacement": ("m", "displacement at which the structures meet"),
    "velocity_before": ("m/s", "velocity before the hit"),
    "velocity_after": ("m/s", "velocity after the hit"),
    "amplification": ("1", "peak in the row over peak standing alone"),
}
