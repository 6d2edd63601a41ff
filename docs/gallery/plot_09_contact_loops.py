"""
Contact elements
================

Force over deformation of the contact elements, eqs. (14) and (16) and the Hertz types. Each damped
element has a coefficient of restitution of 0.65. The area of a loop is the energy that the impact
dissipates. The Kelvin element pulls before the masses separate. Force and deformation are scaled by
those of two free masses that collide, so that all elements can be compared.
"""

import matplotlib.pyplot as plt

from stochlin.charts import CURVES, STYLE, contact_loop_chart

plt.rcParams.update(STYLE)
chart = contact_loop_chart()
figure, panels = plt.subplots(1, 2, figsize=(7.2, 3.6), sharey=True, layout="constrained")
linear = {
    "LinearSpring": "linear spring",
    "Kelvin": "Kelvin",
    "NoTensionKelvin": "Kelvin, no tension",
    "ImpactKelvin": "impact Kelvin",
}
others = {"Hertz": "Hertz", "HertzDamp": "Hertz-damp", "Jankowski": "Jankowski"}
groups = (
    ("linear springs; damped: restitution 0.65", linear),
    ("Hertz types; damped: restitution 0.65", others),
)
for axes, (title, names) in zip(panels, groups, strict=True):
    for (name, label), (color, dash) in zip(names.items(), CURVES, strict=False):
        loop = chart.sel(element=name)
        axes.plot(
            loop.scaled_deformation, loop.scaled_force, color=color, linestyle=dash, label=label
        )
    axes.set_title(title, size=9)
    axes.set(xlabel="deformation, scaled")
    axes.legend(loc="upper left")
panels[0].set(ylabel="force, scaled", ylim=(None, 1.9))
