r"""
Restitution of contact elements
===============================

Fig. 8 of the paper: what is left of the approach velocity, over the damping ratio of the element.
Eq. (15) holds for the Kelvin element that may pull, and for no other.
"""

import matplotlib.pyplot as plt

from stochlin.charts import CURVES, STYLE, restitution_chart

plt.rcParams.update(STYLE)
chart = restitution_chart()
figure, axes = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
for name, (color, dash) in zip(chart.element.values, CURVES, strict=False):
    row = chart.restitution.sel(element=name)
    axes.plot(chart.damping_ratio, row, color=color, linestyle=dash, label=name)
axes.set(xlabel=r"damping ratio $\xi$", ylabel="coefficient of restitution $e$")
axes.set(xlim=(0, 1), ylim=(0, 1))
axes.legend()
