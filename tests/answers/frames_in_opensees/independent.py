"""The same buildings in OpenSees: Steel01 in every storey, elastic gaps, Newmark's rule."""

from importlib.metadata import version

import numpy as np
import openseespy.opensees as ops
from scipy.linalg import eigh

PROGRAM = f"OpenSeesPy {version('openseespy')}"

xi, GAP, SPRING = 0.05, 0.01, 5e8
BUILDINGS = [
    (
        [2.5e5, 2.5e5, 2.2e5, 2.2e5, 1.8e5],
        [4e8, 3.6e8, 3e8, 2.4e8, 1.6e8],
        [0.009, 0.008, 0.008, 0.007, 0.006],
        0.05,
    ),
    (
        [3e5] * 7 + [2.4e5],
        [3.6e8, 3.4e8, 3.1e8, 2.8e8, 2.4e8, 2e8, 1.6e8, 1.1e8],
        [0.012, 0.011, 0.011, 0.01, 0.01, 0.009, 0.009, 0.008],
        0.03,
    ),
]
DT, STEP = 0.02, 5e-5
samples = DT * np.arange(401)
shaking = 4.0 * np.sin(2 * np.pi * samples * (0.6 + 0.1 * samples)) * np.sin(np.pi * samples / 8)


def modal_damping(masses, springs):
    """The same ratio in every mode."""
    k = np.diag(springs) + np.diag([*springs[1:], 0.0])
    k -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
    squares, modes = eigh(k, np.diag(masses))
    modes = masses[:, None] * modes
    return sum(2 * xi * np.sqrt(s) * np.outer(m, m) for s, m in zip(squares, modes.T, strict=True))


def shaken(meet):
    """Peaks of the floors, and the times at which some gap closes."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    for b, (masses, springs, yields, alpha) in enumerate(BUILDINGS, 1):
        base, damping = 100 * b, modal_damping(np.array(masses), springs)
        ops.node(base, 0.0)
        ops.fix(base, 1)
        for i, (mass, k, uy) in enumerate(zip(masses, springs, yields, strict=True), 1):
            ops.node(base + i, 0.0)
            ops.mass(base + i, mass)
            ops.uniaxialMaterial("Steel01", base + i, k * uy, k, alpha)
            ops.element("zeroLength", base + i, base + i - 1, base + i, "-mat", base + i, "-dir", 1)
        for i in range(len(springs)):  # dashpots to the ground and between all floors
            for j in range(-1, i):
                tag = 1000 * b + 10 * i + j + 1
                c = damping[i].sum() if j < 0 else -damping[i, j]
                ops.uniaxialMaterial("Viscous", tag, c, 1.0)
                ops.element("zeroLength", tag, base + j + 1, base + i + 1, "-mat", tag, "-dir", 1)
    if meet:
        ops.uniaxialMaterial("ElasticPPGap", 1, SPRING, -1e15, -GAP, 0.0)
        for i in range(1, 6):
            ops.element("zeroLength", 5000 + i, 100 + i, 200 + i, "-mat", 1, "-dir", 1)
    ops.timeSeries("Path", 1, "-dt", DT, "-values", *shaking, 0.0)
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-12, 50)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    floors = [101, 102, 103, 104, 105, *range(201, 209)]
    peaks, times, closed = np.zeros(13), [], [False] * 5
    for n in range(round(samples[-1] / STEP)):
        assert ops.analyze(1, STEP) == 0
        u = np.array([ops.nodeDisp(floor, 1) for floor in floors])
        peaks = np.maximum(peaks, abs(u))
        now = [bool(u[i] - u[5 + i] > GAP) for i in range(5)]
        times += [(n + 1) * STEP for i in range(5) if now[i] and not closed[i]]
        closed = now
    # Over buildings and floors; the lower one has no more than five.
    return [[*peaks[:5].tolist(), *[np.nan] * 3], peaks[5:].tolist()], times


peak, times = shaken(meet=True)
alone, _ = shaken(meet=False)
ANSWERS = {"impact_time": times, "peak": peak, "peak_alone": alone}
five, eight = BUILDINGS
NUMBERS = {
    **{"gap": 100 * GAP, "spring": SPRING / 1e6, "xi": xi, "alpha": [five[3], eight[3]]},
    **{"masses_five": np.array(five[0]) / 1000, "masses_eight": np.array(eight[0]) / 1000},
    **{"five": np.array(five[1]) / 1e6, "eight": np.array(eight[1]) / 1e6},
    **{"yields_five": 100 * np.array(five[2]), "yields_eight": 100 * np.array(eight[2])},
    **{"end": samples[-1], "step": 1e6 * STEP},
}
