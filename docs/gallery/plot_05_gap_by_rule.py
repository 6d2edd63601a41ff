"""
Required gap by every rule
==========================

The gap by each rule, and by simulation (vertical line; the band is its 95 % interval). All rules
use the simulated peaks of the same two buildings, except linearization, which uses its own. A gap
to the left of the band does not provide the required confidence.
"""

import matplotlib.pyplot as plt

import stochlin as sl
from stochlin.charts import STYLE, rule_label

plt.rcParams.update(STYLE)
first, second = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.6, 1.0))
ground = sl.named_ground("firm", intensity=0.01)
motion = sl.AminAng(rise_end=4, strong_end=15, decay=0.35)
table = sl.separation(first, second, ground, duration=30, envelope=motion, confidence=0.9)

known = table.where(table.gap.notnull(), drop=True).sortby("gap")
answer = known.sel(rule="simulation")
figure, axes = plt.subplots(figsize=(6.4, 4.8), layout="constrained")
axes.axvspan(float(answer.gap_lower), float(answer.gap_upper), color="0.85")
axes.axvline(float(answer.gap), color="k")
for row, rule in enumerate(known.rule.values):
    unsafe = float(known.gap.sel(rule=rule)) < float(answer.gap_lower)
    axes.plot(known.gap.sel(rule=rule), row, "kx" if unsafe else "ko", mfc="w")
axes.set_yticks(range(known.rule.size), [rule_label(rule) for rule in known.rule.values])
axes.set(xlim=(0, None), xlabel="gap [m] for a confidence of 0.9 (x: too small)")
axes.set_title(
    "periods 0.6 and 1 s, damping and hardening 0.05, reduction factor 4;\n"
    "firm ground of intensity 0.01 m²/s³, motions of 30 s",
    size=9,
)
