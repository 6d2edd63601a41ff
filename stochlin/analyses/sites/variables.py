"""What sites deliver: spectra of simulated motions."""

from stochlin.analyses.tables.labels import Variables

VARIABLES: Variables = {
    "pseudo_acceleration": ("m/s^2", "mean pseudo-acceleration of simulated motions"),
    "peak_ground_acceleration": ("m/s^2", "mean peak ground acceleration of simulated motions"),
    "target": ("m/s^2", "pseudo-acceleration wanted"),
    "ratio": ("1", "mean pseudo-acceleration over that wanted"),
}
