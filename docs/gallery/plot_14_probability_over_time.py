"""
Confidence of no pounding over time
===================================

The confidence that two yielding buildings have not pounded so far, in motions of 25 s. It is
computed by the drift closure in time, from the crossings of the linearized response, and by
simulation of motions that end at each of the points, with its 95 % interval. The grey shape below
is the envelope of the motion. Linearization loses the plastic drift and is unsafe.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
warnings.filterwarnings(
    "ignore", message=".*the motion ends in its strong part"
)  # as it is to here
one, two = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.6, 1.0))
ground = sl.KanaiTajimi(period=2 * np.pi / 15, damping=0.6, intensity=0.01)
motion = sl.AminAng(rise_end=4, strong_end=15, decay=0.35)
tables = {
    label: sl.pounding_probability(
        one, two, ground, gap=0.08, closure=closure, envelope=motion, duration=25, paths=0
    )
    for label, closure in {"drift closure": "drift", "linearized": "gaussian"}.items()
}
ends = np.array([6, 9, 12, 15, 18, 21, 25])
simulated = []
for end in ends:  # the same motions, ever longer
    peaks = sl.simulate([one, two], ground, envelope=motion, duration=end, paths=1024)
    simulated.append(sl.exceedance(peaks.separation[:, 0, 1], 0.08))

figure, axes = plt.subplots(figsize=(7.2, 3.4), layout="constrained")
table = tables["linearized"]
axes.fill_between(
    table.time, 0.15 * table.envelope, color="0.9", lw=0, label="envelope of the motion"
)
shares = 1 - xr.concat(simulated, "end")
share = shares.probability
errors = [share - shares.probability_upper, shares.probability_lower - share]
look = {"fmt": "ko", "ms": 3, "capsize": 3, "label": "simulated, 95 %"}
axes.errorbar(ends, share, errors, **look)
for (label, table), (color, dash) in zip(tables.items(), CURVES, strict=False):
    axes.plot(table.time, table.confidence_of_no_pounding, color=color, linestyle=dash, label=label)
axes.set(xlabel="time [s]", ylabel="confidence of no pounding", xlim=(0, 25), ylim=(0, 1.02))
axes.set_title(
    "periods 0.6 and 1 s, damping and hardening 0.05, reduction factor 4, gap 0.08 m;\n"
    "ground period 0.42 s, ground damping 0.6",
    size=9,
)
axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1))
