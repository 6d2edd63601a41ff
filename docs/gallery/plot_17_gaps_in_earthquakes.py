r"""
Predicted gaps in earthquakes
=============================

The share of recorded motions in which a gap was sufficient, against its nominal share. Each curve
covers all pairs and strengths, with 95 % intervals at 50, 84, 90 and 95 %. On the diagonal a gap is
sufficient as often as predicted, below it less often (``benchmarks/reality.py``).
"""

import matplotlib.pyplot as plt
import xarray as xr

from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
table = xr.load_dataset("reality.nc", engine="scipy")  # beside this file
groups = table.group.values.tolist()
figure, panels = plt.subplots(
    2, 4, figsize=(7.2, 4.2), sharex=True, sharey=True, layout="constrained"
)
for axes, group in zip(panels.flat, groups, strict=True):
    axes.plot([0, 1], [0, 1], color="0.6", lw=0.8)
    for scatter, (color, dash), shift in zip(
        table.scatter.values, CURVES, (-0.006, 0.006), strict=False
    ):
        one = table.sel(group=group, scatter=scatter)
        axes.plot(one.nominal, one.held, color=color, linestyle=dash, label=f"scatter {scatter:g}")
        four = one.sel(nominal=[0.5, 0.84, 0.9, 0.95])
        ends = four.held - four.held_lower, four.held_upper - four.held
        axes.errorbar(
            four.nominal + shift, four.held, ends, fmt="none", ecolor=color, elinewidth=0.8
        )
    axes.set_title("\n".join(group.split(", ")), size=8)
    axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal")
figure.supxlabel("nominal share", size=9)
figure.supylabel("share that held", size=9)
figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower right", ncols=2)
