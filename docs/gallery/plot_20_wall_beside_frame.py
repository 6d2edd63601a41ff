"""
A wall beside a frame
=====================

The gap that a building on walls needs beside a frame, at each floor, and what a regular chain of
storeys with the same first period needs, whose first mode is straight. The walls bend as one
uniform cantilever, whose modes are known in closed form. Left: walls of ten storeys beside a frame
of five. Right: walls of five storeys beside a frame of ten.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import stochlin as sl
from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
HEIGHT, MASS, XI = 3.2, 4e5, 0.05  # of a storey [m], of a floor [kg]


def walls(storeys, period):
    """Five modes of a cantilever, with cos(b) cosh(b) = -1."""
    near = np.pi * (np.arange(5) + 0.5)
    b = np.array([brentq(lambda x: np.cos(x) + 1 / np.cosh(x), n - 0.6, n + 0.6) for n in near])
    share = (np.cosh(b) + np.cos(b)) / (np.sinh(b) + np.sin(b))
    x = b[:, None] * np.arange(1, storeys + 1) / storeys
    shapes = np.cosh(x) - np.cos(x) - share[:, None] * (np.sinh(x) - np.sin(x))
    factors = 2 * share / b
    return sl.ModalBuilding(
        period * (b[0] / b) ** 2,
        shapes,
        *([MASS] * storeys, [HEIGHT] * storeys, XI),
        participation=factors,
        modal_masses=storeys * MASS * factors**2,
    )


def models(storeys, period):
    """The walls and the chain with their first period."""
    return {
        "walls": walls(storeys, period),
        "regular chain": sl.ShearBuilding.regular(
            period=period, storeys=storeys, storey_height=HEIGHT, mass=MASS, damping=XI
        ),
    }


def frame(storeys, period):
    return sl.ShearBuilding.regular(
        period=period,
        storeys=storeys,
        storey_height=HEIGHT,
        mass=MASS,
        damping=XI,
        hardening=0.05,
        base_shear_coefficient=0.15,
    )


ground = sl.named_ground("firm", intensity=0.012)
motion = {"duration": 20.0, "envelope": sl.AminAng(4.0, 15.0, 0.35), "paths": 256}
pairs = {
    "10 storeys, 0.9 s, beside a frame of 5, 0.5 s": (10, 0.9, frame(5, 0.5)),
    "5 storeys, 0.45 s, beside a frame of 10, 1 s": (5, 0.45, frame(10, 1.0)),
}
figure, panels = plt.subplots(
    1, 2, figsize=(7.2, 3.0), sharex=True, sharey=True, layout="constrained"
)
for axes, (title, (storeys, period, beside)) in zip(panels, pairs.items(), strict=True):
    for (name, building), (color, dash) in zip(
        models(storeys, period).items(), CURVES, strict=False
    ):
        table = sl.separation(building, beside, ground, **motion)
        gap = 100 * table.gap_at_height.sel(rule="simulation")
        axes.plot(gap, gap.height, color=color, linestyle=dash, marker="o", ms=3, label=name)
    axes.set(xlabel="gap [cm]")
    axes.set_title(title, size=9)
panels[0].set(ylabel="height [m]", xlim=(0, 12), ylim=(0, 17))
figure.suptitle("gap for no pounding in 90 % of the motions; damping 0.05, firm ground", size=9)
figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
