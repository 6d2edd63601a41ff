r"""
Error of linearization over period and bandwidth
================================================

The error of linearization from the map of :doc:`plot_03_error_by_strength`, over the period of the
structure (for a pair, the longer one) relative to that of the ground, and over the damping ratio
:math:`\xi_g` of the ground. Hardening ratios from 0.02 to 0.2 and all strengths and dampings count
alike. The darkest part is the stiff structure on a lake bed, whose standard deviation can be thirty
times too small.
"""

import matplotlib.pyplot as plt
import numpy as np

from stochlin.charts import STYLE, bias_map

plt.rcParams.update(STYLE)
table = bias_map().sel(hardening=slice(0, 0.2))
figure, panels = plt.subplots(2, 2, figsize=(7.2, 5.4), layout="constrained")
for column, name, period, title in zip(
    panels.T,
    ("displacement_std_bias", "rho_bias"),
    ("period", "longer_period"),
    (r"standard deviation $\sigma_u$", r"correlation coefficient $\rho$"),
    strict=True,
):
    bias = table[name].transpose("ground_damping", period, ...)
    others = bias.dims[2:]
    unit = "10 %" if period == "period" else "0.1"
    shares = np.linspace(0, 1, 11)
    medians = np.linspace(0, 0.8 if period == "period" else 0.16, 9)
    for axes, values, text, levels in (
        (column[0], (abs(bias) > 0.1).mean(others), f"share off by more than {unit}", shares),
        (column[1], abs(bias).median(others), "median size of the error", medians),
    ):
        x, y = values[period], values.ground_damping
        filled = axes.contourf(x, y, values, levels=levels, cmap="Greys")
        axes.contour(x, y, values, levels=levels, colors="0.4", linewidths=0.4)
        figure.colorbar(filled, ax=axes, format="%.2f")
        axes.set_title(f"{title}\n{text}", size=9)
        axes.set(xscale="log", yscale="log", ylabel=r"ground damping $\xi_g$")
        axes.set_xlabel("$T/T_g$" if period == "period" else "longer $T/T_g$")
        ticks = [tick for tick in (0.1, 0.3, 1, 3, 10) if tick >= 0.99 * float(x[0])]
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.set_yticks([0.03, 0.1, 0.3, 1], ["0.03", "0.1", "0.3", "1"])
        axes.minorticks_off()
        axes.grid(visible=False)
