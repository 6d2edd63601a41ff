"""
Buildings that degrade
======================

Two buildings of 1.0 and 0.6 s side by side, with the bilinear law and with laws that degrade, pinch
or come back. Stiffness before any damage and strength are the same for all laws; the base shear
coefficient is 0.15. The ground is firm or a lake bed with a period of 2 s, and the strong part of
the motion lasts 8 or 38 s. Left: the gap for no pounding in 90 % of the motions. Right: the
probability of pounding at the gap that the bilinear pair needs.
"""

import matplotlib.pyplot as plt
import numpy as np

import stochlin as sl
from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
PERIODS, COEFFICIENT, GRAVITY = (1.0, 0.6), 0.15, 9.81
DECAY = {"strength_decay": 0.02, "stiffness_decay": 0.05, "pinching": 0.9}
LAWS = {
    "bilinear": (sl.Bilinear, {}),
    "peak-oriented": (sl.ModifiedClough, {}),
    "degrading, pinching": (sl.BoucWenBaberNoori, {"exponent": 2.0, **DECAY}),
    "flag": (sl.Flag, {"beta": 0.9}),
}
GROUNDS = {
    "firm": sl.named_ground("firm", intensity=0.01),
    "lake bed": sl.KanaiTajimi(2.0, 0.1, intensity=0.006),
}
STRONG = {"short": (15.0, sl.AminAng(2.0, 10.0, 0.5)), "long": (45.0, sl.AminAng(2.0, 40.0, 0.5))}


def pair(law):
    kind, own = LAWS[law]
    strength = [COEFFICIENT * GRAVITY * (period / (2 * np.pi)) ** 2 for period in PERIODS]
    return [
        kind(period, 0.05, 0.05, yield_displacement=uy, **own)
        for period, uy in zip(PERIODS, strength, strict=True)
    ]


places, figures = [], {law: [] for law in LAWS}
for ground_name, ground in GROUNDS.items():
    for length, (duration, envelope) in STRONG.items():
        places.append(f"{ground_name},\n{length}")
        gap = None
        for law in LAWS:
            moved = sl.simulate(pair(law), ground, paths=512, duration=duration, envelope=envelope)
            apart = moved.separation.isel(structure=0, structure_2=1)
            needed = float(apart.quantile(0.9))
            gap = needed if gap is None else gap
            figures[law].append((100 * needed, 100 * float((apart > gap).mean())))

figure, panels = plt.subplots(1, 2, figsize=(7.2, 3.2), layout="constrained")
titles = ("gap for 90 % [cm]", "pounding [%]")
for column, (axes, title) in enumerate(zip(panels, titles, strict=True)):
    for n, (law, rows) in enumerate(figures.items()):
        at = np.arange(len(places)) + 0.2 * (n - 1.5)
        values = [row[column] for row in rows]
        axes.bar(
            at, values, 0.18, color=CURVES[n][0], label=law, hatch=("", "//", "..", "xx")[n], ec="w"
        )
    axes.set_xticks(range(len(places)), places, size=7)
    axes.set_title(title, size=9)
    axes.grid(axis="x", visible=False)
figure.suptitle("periods 1.0 and 0.6 s, damping and hardening 0.05, uy 3.7 and 1.3 cm", size=9)
figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
