r"""
Error of linearization over strength, hardening, period and bandwidth
=====================================================================

The error of linearization against the drift closure, which simulations calibrate. First picture,
over strength and hardening: the share of the cases in which the error exceeds 10 % (standard
deviation) or 0.1 (:math:`\rho`), and the median error; negative values are too small. Second
picture, over the period of the structure (for a pair, the longer one) relative to that of the
ground, and over the damping ratio :math:`\xi_g` of the ground, for hardening ratios from 0.02 to
0.2. All other parameters count alike:
dampings of 0.02, 0.05 and 0.1, grounds from :math:`\xi_g` = 0.03 to 1, periods from a tenth of the
ground period to ten times it (for the longer one of a pair from a third), and pairs whose periods
differ by a factor of 3.2 at most. The darkest part of the second picture is the stiff structure on
a lake bed.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.charts import STYLE

plt.rcParams.update(STYLE)
axes = {
    "strength": [1, 1.5, 2.4, 3.75, 6, 9.6],
    "hardening": [0.02, 0.05, 0.1, 0.2, 0.5],
    "damping": [0.02, 0.05, 0.1],
    "ground_damping": [0.03, 0.07, 0.17, 0.4, 1.0],
    "period": 10 ** (0.05 * np.arange(-20, 21)),
    "ratio": 10 ** (0.05 * np.array([-10, -7, -4, -2, -1])),
}
R, alpha, xi, xi_g, period, ratio = (xr.DataArray(v, [(name, v)]) for name, v in axes.items())
ground = sl.KanaiTajimi(1.0, xi_g)
soft = sl.Bilinear(period, xi, alpha, reduction_factor=R)
long = sl.Bilinear(period[10:], xi, alpha, reduction_factor=R)
stiff = sl.Bilinear(ratio * period[10:], xi, alpha, reduction_factor=R)
errors = {
    r"standard deviation $\sigma_u$": sl.linearize(soft, ground).bias,
    r"correlation coefficient $\rho$": sl.correlate(stiff, long, ground).bias,
}


def share_and_median(error, shown):
    """The share of the cases beyond 0.1 and the median, over two parameters."""
    others = [dim for dim in error.dims if dim not in shown]
    return (abs(error) > 0.1).mean(others).transpose(*shown), error.median(others).transpose(*shown)


figure, panels = plt.subplots(2, 2, figsize=(7.2, 5.4), layout="constrained")
for column, (title, error) in zip(panels.T, errors.items(), strict=True):
    share, median = share_and_median(error, ("hardening", "strength"))
    units, factor = (" [%]", 100) if "sigma" in title else ("", 1)
    for panel, values, text, scale in (
        (column[0], 100 * share, f"share off by more than {'10 %' if units else '0.1'} [%]", 100),
        (column[1], factor * median, f"median error{units}", factor * 0.5),
    ):
        panel.imshow(abs(values), vmin=0, vmax=scale, cmap="Greys", origin="lower", aspect="auto")
        for (row, place), value in np.ndenumerate(values.values):
            dark = abs(value) >= 0.59 * scale
            number = f"{value:+.2f}" if scale == 0.5 else f"{value:.0f}"
            panel.text(
                place, row, number, ha="center", va="center", color="w" if dark else "k", size=8
            )
        panel.set_title(f"{title}\n{text}", size=9)
        panel.set_xticks(range(R.size), [f"{factor:g}" for factor in R.values])
        panel.set_yticks(range(alpha.size), [f"{value:g}" for value in alpha.values])
        panel.set(xlabel="R, with peak factor 3", ylabel=r"hardening $\alpha$")
        panel.grid(visible=False)

figure, panels = plt.subplots(2, 2, figsize=(7.2, 5.4), layout="constrained")
for column, (title, error) in zip(panels.T, errors.items(), strict=True):
    shown = abs(error.sel(hardening=slice(0, 0.2)))
    share, median = share_and_median(shown, ("ground_damping", "period"))
    of_std = "sigma" in title
    for panel, values, text, levels in (
        (
            column[0],
            share,
            f"share off by more than {'10 %' if of_std else '0.1'}",
            np.linspace(0, 1, 11),
        ),
        (column[1], median, "median size of the error", np.linspace(0, 1 if of_std else 0.5, 11)),
    ):
        x, y = values.period, values.ground_damping
        filled = panel.contourf(x, y, values, levels=levels, cmap="Greys")
        panel.contour(x, y, values, levels=levels, colors="0.4", linewidths=0.4)
        figure.colorbar(filled, ax=panel, format="%.2f")
        panel.set_title(f"{title}\n{text}", size=9)
        panel.set(xscale="log", yscale="log", ylabel=r"ground damping $\xi_g$")
        panel.set_xlabel("$T/T_g$" if of_std else "longer $T/T_g$")
        ticks = [tick for tick in (0.1, 0.3, 1, 3, 10) if tick >= 0.99 * float(x[0])]
        panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        panel.set_yticks([0.03, 0.1, 0.3, 1], ["0.03", "0.1", "0.3", "1"])
        panel.minorticks_off()
        panel.grid(visible=False)
