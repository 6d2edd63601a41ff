r"""
Predicted pounding in earthquakes
=================================

The predicted probability of pounding, and the share of recorded motions in which the structures
would have hit each other, with 95 % intervals. There are five gaps for each pair and strength
(``benchmarks/reality.py``).
"""

import matplotlib.pyplot as plt
import xarray as xr

from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
table = xr.load_dataset("reality.nc", engine="scipy")  # beside this file
groups = [
    name for name in table.group.values.tolist() if "(a)" in name or "other component" in name
]
figure, panels = plt.subplots(
    1, 4, figsize=(7.2, 2.5), sharex=True, sharey=True, layout="constrained"
)
for axes, group in zip(panels, groups, strict=True):
    axes.plot([0, 1], [0, 1], color="0.6", lw=0.8)
    for scatter, (color, _), marker in zip(table.scatter.values, CURVES, "os", strict=False):
        one = table.sel(group=group, scatter=scatter)
        ends = one.hit - one.hit_lower, one.hit_upper - one.hit
        axes.errorbar(
            one.probability,
            one.hit,
            ends,
            fmt=marker,
            ms=3,
            color=color,
            lw=0.8,
            label=f"scatter {scatter:g}",
        )
    axes.set_title("\n".join(group.split(", ")), size=8)
    axes.set(xlim=(-0.02, 1.02), ylim=(-0.02, 1.02), aspect="equal")
figure.supxlabel("predicted probability of pounding", size=9)
figure.supylabel("share that hit", size=9)
figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower right", ncols=2)
