"""
A hysteresis law of one's own
=============================

Any odd law ``z' = G(v, z)`` that is written in sympy can be linearized and simulated. In this
example the corner of the bilinear law is rounded, which gives the Bouc-Wen law with an exponent of
2. For both laws the linearized standard deviation is too small.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy

import stochlin as sl
from stochlin.charts import CURVES, STYLE

plt.rcParams.update(STYLE)
v, z = sympy.symbols("v z", real=True)
rounded = v - 0.5 * sympy.Abs(v) * z * sympy.Abs(z) - 0.5 * v * z**2
ground = sl.named_ground("firm")
factors = np.array([1.0, 2.0, 4.0, 6.0])

figure, axes = plt.subplots(figsize=(7.2, 3.8), layout="constrained")
common = {"period": 0.8, "damping": 0.05, "hardening": 0.1}
laws = {
    "bilinear": lambda r: sl.Bilinear(**common, reduction_factor=r),
    "own law": lambda r: sl.Hysteretic(**common, reduction_factor=r, law=rounded),
}
for (label, make), (color, dash), marker in zip(laws.items(), CURVES, "os", strict=False):
    linearized = sl.linearize(make(factors), ground).ductility_std
    axes.plot(factors, linearized, color=color, linestyle=dash, label=f"{label}, linearized")
    simulated = sl.simulate([make(factor) for factor in factors], ground, paths=64)
    values = simulated.ductility_std
    axes.plot(factors, values, marker, mfc="w", color=color, label=f"{label}, simulated")
axes.set(xlabel="reduction factor R", ylabel="standard deviation of the ductility")
axes.set_title("period 0.8 s, damping 0.05, hardening 0.1; firm ground", size=9)
axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1))
