"""
Probability of pounding over the gap
====================================

The share of simulated motions in which two buildings would have met, with its 95 % interval. The
reduction factor and the motions are the same for all curves; only the period of the stiffer
building changes.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
ground = sl.named_ground("firm", intensity=0.01)
motion = sl.AminAng(rise_end=4, strong_end=15, decay=0.35)
periods = (0.6, 0.8, 0.9, 1.0)
buildings = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in periods]
table = sl.simulate(buildings, ground, duration=30, envelope=motion, paths=1024)

gap = xr.DataArray(np.linspace(0, 0.2, 101), dims="gap")
figure, axes = plt.subplots(figsize=(7.2, 3.8), layout="constrained")
for n, (color, dash) in zip(range(3), CURVES, strict=False):
    found = sl.exceedance(table.separation[:, n, -1], gap)
    axes.fill_between(
        gap, found.probability_lower, found.probability_upper, color=color, alpha=0.2, lw=0
    )
    axes.plot(gap, found.probability, color=color, linestyle=dash, label=f"{periods[n]:g} and 1 s")
axes.set(xlabel="gap [m]", ylabel="probability of pounding in 30 s", ylim=(0, 1), xlim=(0, 0.2))
axes.set_title(
    "damping and hardening 0.05, reduction factor 4; firm ground of intensity 0.01 m²/s³", size=9
)
axes.legend(title="periods", loc="upper left", bbox_to_anchor=(1.01, 1))
