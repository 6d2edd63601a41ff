"""What sites deliver: spectra of simulated motions."""

from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    "pseudo_acceleration": ("m/s^2", "mean pseudo-acceleration of simulated motions"),
    "peak_ground_acceleration": ("m/s^2", "mean peak ground acceleration of simulated motions"),
    "target": ("m/s^2", "pseudo-acceleration wanted"),
    "ratio": ("1", "mean pseudo-acceleration over that wanted"),
    "energy_ratio": ("1", "energy of the motions over that of the record, mean"),
    "record_arias_intensity": ("m/s", "Arias intensity of the record"),
    "significant_duration": ("s", "from 5 to 95 % of the energy, mean of the motions"),
    "record_significant_duration": ("s", "from 5 to 95 % of the energy of the record"),
}
