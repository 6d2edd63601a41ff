"""
Measures against pounding
=========================

The gap that two yielding buildings need, as built and with measures against pounding, with 95 %
intervals. All are simulated with the same motions. The rows at the bottom (open circles) are the
least measures of their kinds with which the existing gap, the dashed line, prevents pounding in 90
% of the motions; a kind that is not enough at any size has no circle.
"""

import matplotlib.pyplot as plt
import numpy as np

import stochlin as sl
from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
office, annex = (
    sl.Bilinear(period, 0.05, 0.05, reduction_factor=4, mass=mass)
    for period, mass in ((1.0, 3.2e6), (0.6, 1.5e6))
)
ground = sl.named_ground("firm", intensity=0.01)
motion = sl.AminAng(rise_end=4, strong_end=15, decay=0.35)
measures = {
    "15 % more damping in the annex": sl.Measure(added_damping_2=0.15),
    "dashpot between both, 5 MN s/m": sl.Measure(link=sl.Link(0.0, 5e6)),
}
table = sl.mitigate(
    office, annex, ground, 0.08, measures, duration=20.0, envelope=motion, paths=512
)

figure, axes = plt.subplots(figsize=(7.2, 3.4), layout="constrained")
rows, needed = np.arange(table.measure.size), 100 * table.required_gap
ends = abs(100 * table[["required_gap_lower", "required_gap_upper"]].to_array() - needed)
for kind, face in (("as built", "k"), ("given", "k"), ("least", "w")):
    here = (table.kind == kind).values
    axes.errorbar(
        needed[here], rows[here], xerr=ends[:, here], fmt="o", color="k", mfc=face, capsize=2
    )
color, dash = CURVES[2]
axes.axvline(8.0, color=color, linestyle=dash, label="existing gap")
axes.set_yticks(rows, table.measure.values.tolist())
axes.invert_yaxis()
axes.set(xlim=(0, None), xlabel="gap needed in 90 % of the motions [cm]")
axes.set_title(
    "periods 1 and 0.6 s, damping and hardening 0.05, reduction factor 4, firm ground", size=9
)
axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1))
