r"""
Error of a gap by every method
==============================

The error of the standard deviation of :math:`u_1 - u_2`, to which a gap is proportional, by every
method of `stochlin.correlate` against simulation. It covers 276 pairs of 24 yielding buildings
(:math:`\xi` = 0.05, :math:`\alpha` = 0.05 and 0.1, R = 2 and 4, T from 0.6 to 3.4 s) on each of
three grounds. The formulas use the *simulated* standard deviations and supply only the correlation.
Linearization uses its own standard deviations, with the Gaussian closure and with the drift
closure. The dot is the median, the thick line covers half of the pairs, and the thin line nine in
ten. Errors to the left of zero are unsafe.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.charts import STYLE

plt.rcParams.update(STYLE)
grounds = {
    "broad band, Kanai-Tajimi": sl.KanaiTajimi(2 * np.pi / 15, 0.6),
    "firm, Clough-Penzien": sl.named_ground("firm"),
    "lake bed, Kanai-Tajimi": sl.KanaiTajimi(2.0, 0.05),
}
buildings = [
    (T, alpha, R) for T in (0.6, 0.85, 1.2, 1.7, 2.4, 3.4) for alpha in (0.05, 0.1) for R in (2, 4)
]
first, second = np.triu_indices(len(buildings), 1)
ways = {
    "eq. (4)": {"method": "white_noise"},
    "effective (Iwan)": {"method": "effective"},
    "linearization": {},
    "drift closure": {"closure": "drift"},
}


def side(numbers):
    """The chosen buildings, one a pair."""
    T, alpha, R = (xr.DataArray(np.array(buildings)[numbers, n], dims="pair") for n in range(3))
    return sl.Bilinear(T, 0.05, alpha, reduction_factor=R)


def apart(one, two, rho):
    """Standard deviation of the difference."""
    return np.sqrt(one**2 + two**2 - 2 * rho * one * two)


errors = {}  # [%] by ground and method
figure, panels = plt.subplots(1, 3, figsize=(7.2, 2.8), sharey=True, layout="constrained")
for axes, (title, ground) in zip(panels, grounds.items(), strict=True):
    each = [sl.Bilinear(T, 0.05, alpha, reduction_factor=R) for T, alpha, R in buildings]
    simulated = sl.simulate(each, ground, paths=32)
    sigma, rho = simulated.displacement_std.values, simulated.rho.values[first, second]
    reference = apart(sigma[first], sigma[second], rho)
    for row, (name, options) in enumerate(ways.items()):
        table = sl.correlate(side(first), side(second), ground, **options)
        alone = "method" not in options
        one = table.displacement_std_1 if alone else sigma[first]
        two = table.displacement_std_2 if alone else sigma[second]
        error = errors[title, name] = 100 * (apart(one, two, table.rho).values / reference - 1)
        low, quarter, middle, most, high = np.percentile(error, [5, 25, 50, 75, 95])
        axes.plot([low, high], [row, row], "k", lw=1)
        axes.plot([quarter, most], [row, row], color="0.4", lw=5, solid_capstyle="butt")
        axes.plot(middle, row, "ko", mfc="w")
    axes.axvline(0, color="k", lw=1)
    axes.set_title(title, size=9)
    axes.set(xlim=(-105, 105), xticks=(-80, -40, 0, 40, 80), xlabel="error of a gap [%]")
panels[0].set_yticks(range(len(ways)), ways)
panels[0].invert_yaxis()
