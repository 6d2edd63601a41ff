"""The same buildings in OpenSees: Steel01 in every storey, elastic gaps, Newmark's rule."""

import numpy as np
from answers.opensees_frames import PROGRAM, SAMPLES, Frame, answers

__all__ = ["ANSWERS", "NUMBERS", "PROGRAM"]

MASS, xi, alpha, GAP, SPRING, STEP = 2e5, 0.05, 0.05, 0.01, 2e8, 2e-5
tower = Frame([MASS] * 3, [8e7, 7e7, 5e7], [0.012] * 3, alpha)
annex = Frame([MASS] * 2, [1.5e8, 1.2e8], [0.006] * 2, alpha)
ANSWERS = answers([tower, annex], xi, GAP, SPRING, STEP)
NUMBERS = {
    **{"gap": 100 * GAP, "spring": SPRING / 1e6, "mass": MASS / 1000, "xi": xi, "alpha": alpha},
    **{"tower": np.array(tower.springs) / 1e6, "annex": np.array(annex.springs) / 1e6},
    **{"yields": [100 * frame.yields[0] for frame in (tower, annex)]},
    **{"end": SAMPLES[-1], "step": 1e6 * STEP},
}
