"""The same pair in OpenSees: Steel01 beside a dashpot, Newmark's average acceleration."""

import numpy as np
import openseespy.opensees as ops
from answers.opensees_frames import DT, PROGRAM, new_model, times_of_steps

__all__ = ["ANSWERS", "NUMBERS", "PROGRAM"]

T, xi, alpha, uy = (1.0, 0.6), 0.05, 0.05, (0.03, 0.012)
STEP = 0.0002
samples = DT * np.arange(501)
shaking = 3.0 * np.sin(2 * np.pi * samples * (0.5 + 0.1 * samples)) * np.sin(np.pi * samples / 10)

new_model()
for n in (1, 2):
    w = 2 * np.pi / T[n - 1]
    ops.node(10 * n, 0.0)
    ops.node(10 * n + 1, 0.0)
    ops.fix(10 * n, 1)
    ops.mass(10 * n + 1, 1.0)
    ops.uniaxialMaterial("Steel01", 2 * n, w**2 * uy[n - 1], w**2, alpha)
    ops.uniaxialMaterial("Viscous", 2 * n + 1, 2 * xi * w, 1.0)
    ops.element("zeroLength", n, 10 * n, 10 * n + 1, "-mat", 2 * n, 2 * n + 1, "-dir", 1, 1)
peak, apart = np.zeros(2), 0.0
for _ in times_of_steps(shaking, STEP):
    u = np.array([ops.nodeDisp(11, 1), ops.nodeDisp(21, 1)])
    peak, apart = np.maximum(peak, abs(u)), max(apart, u[0] - u[1])
ANSWERS = {"separation": apart, "peak_1": peak[0], "peak_2": peak[1]}
NUMBERS = {
    **{"T": T, "xi": xi, "alpha": alpha, "uy": [100 * one for one in uy], "end": samples[-1]},
    **{"dt": DT, "step": 1000 * STEP},
}
