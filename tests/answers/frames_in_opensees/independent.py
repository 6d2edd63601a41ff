"""The same buildings in OpenSees: Steel01 in every storey, elastic gaps, Newmark's rule."""

import numpy as np
from answers.opensees_frames import PROGRAM, SAMPLES, Frame, answers

__all__ = ["ANSWERS", "NUMBERS", "PROGRAM"]

xi, GAP, SPRING, STEP = 0.05, 0.01, 5e8, 5e-5
five = Frame(
    [2.5e5, 2.5e5, 2.2e5, 2.2e5, 1.8e5],
    [4e8, 3.6e8, 3e8, 2.4e8, 1.6e8],
    [0.009, 0.008, 0.008, 0.007, 0.006],
    0.05,
)
eight = Frame(
    [3e5] * 7 + [2.4e5],
    [3.6e8, 3.4e8, 3.1e8, 2.8e8, 2.4e8, 2e8, 1.6e8, 1.1e8],
    [0.012, 0.011, 0.011, 0.01, 0.01, 0.009, 0.009, 0.008],
    0.03,
)
ANSWERS = answers([five, eight], xi, GAP, SPRING, STEP)
NUMBERS = {
    **{"gap": 100 * GAP, "spring": SPRING / 1e6, "xi": xi, "alpha": [five.alpha, eight.alpha]},
    **{"masses_five": np.array(five.masses) / 1000, "masses_eight": np.array(eight.masses) / 1000},
    **{"five": np.array(five.springs) / 1e6, "eight": np.array(eight.springs) / 1e6},
    **{"yields_five": 100 * np.array(five.yields), "yields_eight": 100 * np.array(eight.yields)},
    **{"end": SAMPLES[-1], "step": 1e6 * STEP},
}
