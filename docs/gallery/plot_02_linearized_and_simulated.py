r"""
Linearized and simulated
========================

The same pair by every method of `stochlin.correlate`. The bars are twice the standard error of the
simulation. On the left, where the building is much stiffer than the ground, linearization fails.
Near the ground period its error is about 0.1, and on the right it is smaller. The rule for
effective properties does not contain the ground.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.charts import CURVES, STYLE, ratio_ticks

plt.rcParams.update(STYLE)
lakebed = sl.KanaiTajimi(period=2.0, damping=0.05)


def pair(ratio):
    """Two buildings of R = 4; the second has the period of the ground."""
    common = {"damping": 0.05, "hardening": 0.05, "reduction_factor": 4}
    return sl.Bilinear(2.0 * ratio, **common), sl.Bilinear(2.0, **common)


def axis(values):
    """Period ratios that name their dimension."""
    return xr.DataArray(values, dims="ratio", coords={"ratio": values})


fine, coarse = axis(np.geomspace(0.25, 4, 81)), axis(np.geomspace(0.25, 4, 13))
simulated = sl.correlate(*pair(coarse), lakebed, method="simulation", paths=128)

figure, axes = plt.subplots(figsize=(7.2, 3.6), layout="constrained")
for (label, options), (color, dash) in zip(
    {
        "linearized": {},
        "eq. (4), effective properties by Iwan (1980)": {"method": "effective"},
        "eq. (4), elastic": {"method": "white_noise"},
    }.items(),
    CURVES,
    strict=False,
):
    rho = sl.correlate(*pair(fine), lakebed, **options).rho
    axes.plot(fine, rho, color=color, linestyle=dash, label=label)
bars = 2 * simulated.rho_standard_error
axes.errorbar(coarse, simulated.rho, bars, fmt="o", color="k", ms=4, capsize=3, label="simulated")
axes.set(
    xscale="log",
    xlabel="$T_1/T_2$",
    ylabel=r"correlation coefficient $\rho$",
    title=r"$T_2 = T_g$ = 2 s, $\xi_g$ = 0.05; $\xi$ = 0.05, $\alpha$ = 0.05, R = 4",
)
ratio_ticks(axes.xaxis, fine.values)
axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1))
