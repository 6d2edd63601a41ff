r"""
Restitution of contact elements
===============================

Fig. 8 of the paper: the velocity after the impact over the approach velocity, against the damping
ratio of the element. Eq. (15) holds only for the Kelvin element, which may pull.
"""

import matplotlib.pyplot as plt

from stochlin.charts import CURVES, STYLE, restitution_chart

plt.rcParams.update(STYLE)
chart = restitution_chart()
figure, axes = plt.subplots(figsize=(7.2, 3.8), layout="constrained")
names = {
    "Kelvin": "Kelvin",
    "NoTensionKelvin": "Kelvin, no tension",
    "ImpactKelvin": "impact Kelvin",
    "Jankowski": "Jankowski",
}
for (name, label), (color, dash) in zip(names.items(), CURVES, strict=False):
    row = chart.restitution.sel(element=name)
    axes.plot(chart.damping_ratio, row, color=color, linestyle=dash, label=label)
axes.set(xlabel=r"damping ratio $\xi$", ylabel="coefficient of restitution $e$")
axes.set(xlim=(0, 1), ylim=(0, 1))
axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1))
