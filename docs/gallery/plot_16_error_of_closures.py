r"""
Error of every closure
======================

The mean absolute error of each closure for the pairs of :doc:`plot_15_drift_closure`. The first and
the third row are over the strength and the hardening of each structure (for pairs, the geometric
means), with the strength as R for a peak factor of 3. The second and the fourth row are over the
period of the structure relative to that of the ground (for pairs, the shorter period) and the
bandwidth of the ground. Squares with fewer than five cases are empty.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from stochlin.charts import STYLE

plt.rcParams.update(STYLE)
table = xr.load_dataset("drift_pairs.nc", engine="scipy")  # beside this file
exact, white = table.sel(closure="simulation"), table.white.values.astype(bool)
closures = ("gaussian", "clipped", "drift")
strength, hardening = (0.3, 0.6, 1.2, 2.0, 4.0), (0.02, 0.06, 0.2, 0.5)
period, bandwidth = (0.2, 0.5, 0.9, 5.0), (0.03, 0.1, 0.3, 1.0)


def of_pairs(name, combine):
    """One value a pair from those of its two structures."""
    return combine(table[f"{name}_1"].values, table[f"{name}_2"].values)


def of_structures(name):
    """The values of all structures."""
    return np.concatenate([table[f"{name}_{n}"].values for n in (1, 2)])


def mean_error(error, x, y, x_edges, y_edges):
    """Mean of the error by squares; NaN where there are few cases."""
    known = np.isfinite(error)
    places = [x[known], y[known]]
    count = np.histogram2d(*places, bins=(x_edges, y_edges))[0]
    total = np.histogram2d(*places, bins=(x_edges, y_edges), weights=error[known])[0]
    return np.where(count < 5, np.nan, total / np.maximum(count, 1)).T


def middle(first, second):
    """Geometric mean."""
    return np.sqrt(first * second)


twice = [np.tile(values, 2) for values in (white, table.ground_damping.values)]
figure, panels = plt.subplots(4, 3, figsize=(5.6, 7.2), layout="constrained")
for column, closure in zip(panels.T, closures, strict=True):
    found = table.sel(closure=closure)
    sigma = np.concatenate(
        [abs(found[f"displacement_std_{n}"] / exact[f"displacement_std_{n}"] - 1) for n in (1, 2)]
    )
    rho = abs(found.rho - exact.rho).values
    soil, both_soils = ~white, ~twice[0]
    drawn = (
        (
            sigma,
            3 * of_structures("strength"),
            of_structures("hardening"),
            np.ones(sigma.size, bool),
            "R",
        ),
        (sigma, of_structures("period"), twice[1], both_soils, "T"),
        (
            rho,
            3 * of_pairs("strength", middle),
            of_pairs("hardening", middle),
            np.ones(rho.size, bool),
            "R",
        ),
        (rho, of_pairs("period", np.minimum), table.ground_damping.values, soil, "T"),
    )
    for row, (axes, (error, x, y, here, kind)) in enumerate(zip(column, drawn, strict=True)):
        edges = (3 * np.array(strength), hardening) if kind == "R" else (period, bandwidth)
        values = mean_error(error[here], x[here], y[here], *edges)
        per_cent, scale = row < 2, (0.5 if row < 2 else 0.25)
        axes.imshow(values, vmin=0, vmax=scale, cmap="Greys", origin="lower", aspect="auto")
        for (j, i), value in np.ndenumerate(values):
            text = "" if np.isnan(value) else f"{100 * value:.0f}" if per_cent else f"{value:.2f}"
            shade = "w" if value > 0.6 * scale else "k"
            axes.text(i, j, text, ha="center", va="center", color=shade, size=7)
        for axis, ends in zip((axes.xaxis, axes.yaxis), edges, strict=True):
            axis.set_ticks(np.arange(len(ends)) - 0.5, [f"{end:g}" for end in ends], fontsize=7)
        axes.set_xlabel("R" if kind == "R" else "$T/T_g$", labelpad=1)
        axes.grid(visible=False)
    name = "Gaussian" if closure == "gaussian" else closure
    column[0].set_title(f"{name} closure", size=9)
for axes, quantity, across in zip(
    panels[:, 0],
    (r"$\sigma_u$ [%]", r"$\sigma_u$ [%]", r"$\rho$", r"$\rho$"),
    (r"hardening $\alpha$", r"$\xi_g$", r"hardening $\alpha$", r"$\xi_g$"),
    strict=True,
):
    axes.set_ylabel(f"error of {quantity}\n{across}", size=8)
