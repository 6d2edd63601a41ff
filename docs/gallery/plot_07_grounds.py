"""
Grounds by name
===============

Power spectral densities of some of the grounds of `stochlin.named_ground`, each divided by its
maximum. That of the lake bed of Mexico City, which was fitted to a record, is much narrower than
the others.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
frequency = xr.DataArray(np.linspace(0.05, 40, 4000), dims="frequency")
figure, axes = plt.subplots(figsize=(7.2, 3.8), layout="constrained")
names = {
    "firm": "firm",
    "medium": "medium",
    "soft": "soft",
    "sct_1985_ns": "lake bed, Mexico City 1985",
}
for (name, label), (color, dash) in zip(names.items(), CURVES, strict=False):
    psd = sl.named_ground(name).psd(frequency)
    axes.plot(frequency, psd / psd.max(), color=color, linestyle=dash, label=label)
axes.set(xlabel="circular frequency [rad/s]", ylabel="PSD over its maximum")
axes.set(xlim=(0, 40), ylim=(0, 1.05))
axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1))
