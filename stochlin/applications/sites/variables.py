"""Variables of the results on sites, with unit and long name."""

from stochlin.solver.tables.labels import Variables

_MEANS: Variables = {
    "pseudo_acceleration": ("m/s^2", "mean pseudo-acceleration of simulated motions"),
    "peak_ground_acceleration": (
        "m/s^2",
        "mean peak ground acceleration of simulated motions, step 0.01 s",
    ),
    "spectral_acceleration": (
        "m/s^2",
        "mean pseudo-acceleration of simulated motions at the period, damping ratio 0.05",
    ),
    "rms_acceleration": ("m/s^2", "root mean square of the ground acceleration in the strong part"),
    "ground_intensity": ("m^2/s^3", "two-sided PSD S0 of the white noise"),
    "target": ("m/s^2", "target pseudo-acceleration"),
    "ratio": ("1", "mean pseudo-acceleration over the target"),
}
VARIABLES: Variables = {
    **_MEANS,
    **{
        f"{name}_standard_error": (units, f"standard error of the {about}")
        for name, (units, about) in _MEANS.items()
    },
}
