"""Variables of the results on sites, with unit and long name."""

from stochlin.analyses.tables.labels import Variables

_MEANS: Variables = {
    "pseudo_acceleration": ("m/s^2", "mean pseudo-acceleration of simulated motions"),
    "peak_ground_acceleration": ("m/s^2", "mean peak ground acceleration of simulated motions"),
    "spectral_acceleration": (
        "m/s^2",
        "mean pseudo-acceleration of simulated motions at its period, damping 0.05",
    ),
    "rms_acceleration": ("m/s^2", "root mean square of the ground acceleration in the strong part"),
    "ground_intensity": ("m^2/s^3", "two-sided PSD S0 of the white noise"),
    "target": ("m/s^2", "pseudo-acceleration wanted"),
    "ratio": ("1", "mean pseudo-acceleration over that wanted"),
    "energy_ratio": ("1", "energy of the motions over that of the record, mean"),
    "record_arias_intensity": ("m/s", "Arias intensity of the record"),
    "significant_duration": ("s", "from 5 to 95 % of the energy, mean of the motions"),
    "record_significant_duration": ("s", "from 5 to 95 % of the energy of the record"),
}
VARIABLES: Variables = {
    **_MEANS,
    **{
        f"{name}_standard_error": (units, f"{about}: its standard error")
        for name, (units, about) in _MEANS.items()
    },
}
