r"""
The drift closure and simulation
================================

The standard deviation and the correlation by the Gaussian and the drift closure against simulation,
for 500 random pairs of unequal bilinear structures: hardening 0.02 to 0.5, R/p 0.3 to 4, damping
0.01 to 0.1, white noise or Kanai-Tajimi ground with :math:`\xi_g` = 0.03 to 1, T/Tg = 0.2 to 5.
Each dot is a structure (left) or a pair (right). Between the dashed lines the error is below 10 %
or 0.1. None of the pairs is in the map that calibrates the closure.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

from stochlin.charts import STYLE

plt.rcParams.update(STYLE)
table = xr.load_dataset("drift_pairs.nc", engine="scipy")  # beside this file
exact = table.sel(closure="simulation")
names = {"gaussian": "Gaussian closure", "drift": "drift closure"}
figure, panels = plt.subplots(2, 2, figsize=(6.6, 6.4), layout="constrained")
for row, (closure, name) in zip(panels, names.items(), strict=True):
    found = table.sel(closure=closure)
    sigma = [
        np.concatenate([side.displacement_std_1, side.displacement_std_2])
        for side in (exact, found)
    ]
    ends = np.array([min(sigma[0]), max(sigma[0])])
    row[0].plot(*sigma, "ko", ms=1.5, alpha=0.5, mew=0)
    row[0].plot(ends, ends, "k-", lw=0.8)
    for share in (0.9, 1.1):
        row[0].plot(ends, share * ends, "k--", lw=0.8)
    row[0].set(
        xscale="log", yscale="log", xlabel=r"simulated $\sigma_u$ [m]", ylabel=r"$\sigma_u$ [m]"
    )
    off = np.abs(sigma[1] / sigma[0] - 1)
    row[0].set_title(f"{name}: within 10 % in {100 * np.mean(off < 0.1):.0f} %", size=9)
    row[1].plot(exact.rho, found.rho, "ko", ms=2.5, alpha=0.5, mew=0)
    ends = np.array([-0.4, 1])
    row[1].plot(ends, ends, "k-", lw=0.8)
    for by in (-0.1, 0.1):
        row[1].plot(ends, ends + by, "k--", lw=0.8)
    off = np.abs(found.rho - exact.rho)
    row[1].set(xlim=(-0.4, 1), ylim=(-0.6, 1), xlabel=r"simulated $\rho$", ylabel=r"$\rho$")
    row[1].set_title(f"{name}: within 0.1 in {100 * float(np.mean(off < 0.1)):.0f} %", size=9)
