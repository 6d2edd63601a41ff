"""The same oscillators in OpenSees: materials along given turns, and a motion by Newmark's rule."""

from itertools import pairwise

import numpy as np
import openseespy.opensees as ops
from answers.opensees_frames import DT, PROGRAM, new_model, times_of_steps

__all__ = ["ANSWERS", "NUMBERS", "PROGRAM"]

T, xi, alpha, uy = 0.8, 0.05, 0.05, 0.02
TURNS, PIECES, STEP = [1.5, -1.5, 3, -3, 1, -4, 4], 20000, 0.0001
samples = DT * np.arange(251)
shaking = 3.0 * np.sin(2 * np.pi * samples * (0.7 + 0.1 * samples)) * np.sin(np.pi * samples / 5)
k = (2 * np.pi / T) ** 2
ALMOST = 1e-6  # materials want some slope where the law has none


def backbone(*points):
    """Forces and displacements of an envelope, given over those of yielding, on both sides."""
    upwards = [value for force, mu in points for value in (force * k * uy, mu * uy)]
    return [*upwards, *(-value for value in upwards)]


beta, gamma, n, shape = 0.6, 0.4, 1.5, [1.0, 0.15, 0.9]  # the last are A, q and zeta_s
decay, p, psi, d_psi, lam = [0.02, 0.05], 1.0, 0.2, 0.01, 0.4
# OpenSees measures energies with the factor (1 - alpha) of the force, and in units of force and
# length
energy, worn = (1 - alpha) * k * uy**2, uy**-n
YIELD, CAP, LEFT = (1.0, 1.0), (1 + ALMOST, 2.5), (0.4, 4.5)
MATERIALS = {
    "flag": ["SelfCentering", k, alpha * k, k * uy, 0.7, 0, 0, 0],
    "decay": [
        "BoucWen",
        alpha,
        k,
        n,
        gamma * worn,
        beta * worn,
        1.0,
        0.0,
        *(d / energy for d in decay),
    ],
    "pinching": [
        *("BWBN", alpha, k, n, gamma * worn, beta * worn, *shape),
        *(p / energy, psi * uy, d_psi * uy / energy, lam, 1e-10, 100),
    ],
    "unloading": ["Hysteretic", *backbone(YIELD, CAP, LEFT), 1, 1, 0, 0, 0.4],
    "cap": [
        *("IMKPeakOriented", k, *(2 * [1.5 * uy, uy / 0.3, 1e3, k * uy, 1 + ALMOST, 0.4])),
        *(0, 0, 0, 0, 1, 1, 1, 1, 1, 1),
    ],
}


def forces(material):
    """Force at the turns."""
    new_model()
    ops.uniaxialMaterial(material[0], 1, *material[1:])
    ops.testUniaxialMaterial(1)
    reached = []
    for begin, end in pairwise([0, *TURNS]):
        for mu in np.linspace(begin, end, PIECES + 1)[1:]:
            ops.setStrain(float(mu * uy))
        reached.append(ops.getStress())
    return reached


def peak(material):
    """Largest displacement in the motion."""
    new_model()
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    ops.mass(2, 1.0)
    ops.uniaxialMaterial(material[0], 1, *material[1:])
    ops.uniaxialMaterial("Viscous", 2, 2 * xi * np.sqrt(k), 1.0)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, 2, "-dir", 1, 1)
    return max(abs(ops.nodeDisp(2, 1)) for _ in times_of_steps(shaking, STEP))


ANSWERS = {
    "force": [forces(material) for material in MATERIALS.values()],
    "peak": [peak(material) for material in MATERIALS.values()],
}
NUMBERS = {
    **{"T": T, "xi": xi, "alpha": alpha, "uy": 100 * uy, "turns": TURNS, "end": samples[-1]},
    **{"step": 1000 * STEP, "pieces": float(PIECES), "almost": ALMOST},
}
