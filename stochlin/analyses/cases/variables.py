"""What the impacts and energies of a case add up to."""

from stochlin.analyses.pounding.variables import VARIABLES as POUNDING
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **POUNDING,
    "gap": ("m", "gap between the structures"),
    "yield_displacement": ("m", "yield displacement"),
    "impacts": ("1", "number of impacts"),
    "hardest_force": ("N", "largest force of the contact in any impact"),
    "fastest_approach": ("m/s", "largest velocity of approach"),
    "longest_impact": ("s", "duration of the longest impact"),
    "contact_energy": ("J", "energy that the contact has taken"),
    "least_clearance": ("m", "least distance between the floors, negative where they press"),
    "energy_received": ("J", "work of all impacts on the structure"),
    "energy_share": ("1", "share of the input energy, at the end"),
    "peak_ductility": ("1", "largest displacement over yield displacement"),
}
