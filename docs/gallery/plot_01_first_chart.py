r"""
Correlation on a lake bed
=========================

The correlation coefficient :math:`\rho` of the displacements of two buildings over the ratio of
their periods. Eq. (4) contains neither the ground nor yielding, and differs from both other curves.
The linearized curve of the yielding pair also has an error, which
:doc:`plot_02_linearized_and_simulated` shows.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.charts import CURVES, STYLE, ratio_ticks

plt.rcParams.update(STYLE)
lakebed = sl.KanaiTajimi(period=2.0, damping=0.05)
ratios = np.geomspace(0.25, 4, 161)
ratio = xr.DataArray(ratios, dims="ratio", coords={"ratio": ratios})

formula = sl.rho_white_noise(ratio, 1.0, 0.05, 0.05)
elastic = sl.correlate(sl.Bilinear(2.0 * ratio, 0.05), sl.Bilinear(2.0, 0.05), lakebed)
strength = {"hardening": 0.05, "reduction_factor": 4}
first = sl.Bilinear(2.0 * ratio, 0.05, **strength)
second = sl.Bilinear(2.0, 0.05, **strength)
yielding = sl.correlate(first, second, lakebed)

figure, axes = plt.subplots(figsize=(7.2, 3.8), layout="constrained")
curves = {
    "eq. (4)": formula,
    "elastic, this ground": elastic,
    "R = 4, linearized": yielding,
}
for (label, table), (color, dash) in zip(curves.items(), CURVES, strict=False):
    axes.plot(ratio, table.rho, color=color, linestyle=dash, label=label)
axes.set(
    xscale="log",
    xlabel="$T_1/T_2$",
    ylabel=r"correlation coefficient $\rho$",
    title=r"$T_2 = T_g$ = 2 s, $\xi_g$ = 0.05; structures: $\xi$ = 0.05, $\alpha$ = 0.05",
)
ratio_ticks(axes.xaxis, ratios)
axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1))
