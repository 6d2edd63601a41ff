r"""
Error of linearization over strength and hardening
==================================================

The error of linearization from the map of simulated structures that comes with the package. Top: the
share of the cases in which the error exceeds 10 % (standard deviation) or 0.1 (:math:`\rho`). Bottom:
the median error; negative values are too small. Each square covers all other parameters of the map,
and each point of the map counts alike: dampings of 0.02, 0.05 and 0.1, grounds from :math:`\xi_g` =
0.03 to 1, and periods from a tenth of the ground period to ten times it (for the longer period of a
pair, from a third). Structures with a hardening ratio of 1 are linear, and linearization is exact.
"""

import matplotlib.pyplot as plt
import numpy as np

from stochlin.charts import STYLE, bias_map

plt.rcParams.update(STYLE)
table = bias_map().sel(hardening=slice(0, 0.9))
shown = ("hardening", "elastic_ductility_std")
figure, panels = plt.subplots(2, 2, figsize=(7.2, 5.4), layout="constrained")
for column, name, title in zip(
    panels.T,
    ("displacement_std_bias", "rho_bias"),
    (r"standard deviation $\sigma_u$", r"correlation coefficient $\rho$"),
    strict=True,
):
    bias = table[name]
    others = [dim for dim in bias.dims if dim not in shown]
    share = (abs(bias) > 0.1).mean(others).transpose(*shown)
    median = bias.median(others).transpose(*shown)
    units = "%" if name.startswith("displacement") else ""
    factor = 100 if units else 1
    for axes, values, text, scale in (
        (column[0], 100 * share, "share off by more than " + ("10 %" if units else "0.1") + " [%]", 100),
        (column[1], factor * median, f"median error{' [%]' if units else ''}", factor * 0.5),
    ):
        axes.imshow(abs(values), vmin=0, vmax=scale, cmap="Greys", origin="lower", aspect="auto")
        for (row, place), value in np.ndenumerate(values.values):
            dark = abs(value) >= 0.59 * scale
            number = f"{value:+.2f}" if scale == 0.5 else f"{value:.0f}"
            axes.text(place, row, number, ha="center", va="center", color="w" if dark else "k", size=8)
        axes.set_title(f"{title}\n{text}", size=9)
        axes.set_xticks(range(6), [f"{3 * ratio:.2g}" for ratio in table.elastic_ductility_std.values])
        axes.set_yticks(range(5), [f"{alpha:g}" for alpha in table.hardening.values])
        axes.set(xlabel="R, with peak factor 3", ylabel=r"hardening $\alpha$")
        axes.grid(visible=False)
