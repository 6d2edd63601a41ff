"""What the impacts and energies of a case add up to."""

from stochlin.analyses.pounding.variables import VARIABLES as POUNDING
from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    **POUNDING,
    "yield_displacement": ("m", "yield displacement"),
    "least_clearance": ("m", "least distance between the floors, negative where they press"),
    "energy_share": ("1", "share of the input energy, at the end"),
    "peak_ductility": ("1", "largest displacement over yield displacement"),
}
