"""The same buildings in OpenSees: Steel01 in every storey, elastic gaps, Newmark's rule."""

from importlib.metadata import version

import numpy as np
import openseespy.opensees as ops
from scipy.linalg import eigh

PROGRAM = f"OpenSeesPy {version('openseespy')}"

MASS, xi, alpha, GAP, SPRING = 2e5, 0.05, 0.05, 0.01, 2e8
BUILDINGS = [([8e7, 7e7, 5e7], 0.012), ([1.5e8, 1.2e8], 0.006)]
DT, STEP = 0.02, 2e-5
samples = DT * np.arange(401)
shaking = 4.0 * np.sin(2 * np.pi * samples * (0.6 + 0.1 * samples)) * np.sin(np.pi * samples / 8)


def modal_damping(springs):
    """The same ratio in every mode."""
    k = np.diag(springs) + np.diag([*springs[1:], 0.0])
    k -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
    squares, modes = eigh(k, MASS * np.eye(len(springs)))
    return sum(
        2 * xi * np.sqrt(s) * MASS**2 * np.outer(m, m) for s, m in zip(squares, modes.T, strict=True)
    )


def shaken(meet):
    """Peaks of the floors, and the times at which some gap closes."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    for b, (springs, uy) in enumerate(BUILDINGS, 1):
        base, damping = 100 * b, modal_damping(springs)
        ops.node(base, 0.0)
        ops.fix(base, 1)
        for i, k in enumerate(springs, 1):
            ops.node(base + i, 0.0)
            ops.mass(base + i, MASS)
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
        for i in (1, 2):
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
    floors = [101, 102, 103, 201, 202]
    peaks, times, closed = np.zeros(5), [], [False, False]
    for n in range(round(samples[-1] / STEP)):
        assert ops.analyze(1, STEP) == 0
        u = np.array([ops.nodeDisp(floor, 1) for floor in floors])
        peaks = np.maximum(peaks, abs(u))
        now = [bool(u[i] - u[3 + i] > GAP) for i in (0, 1)]
        times += [(n + 1) * STEP for i in (0, 1) if now[i] and not closed[i]]
        closed = now
    # Over buildings and floors; the lower one has no third floor.
    return [peaks[:3].tolist(), [*peaks[3:].tolist(), np.nan]], times


peak, times = shaken(meet=True)
alone, _ = shaken(meet=False)
ANSWERS = {"impact_time": times, "peak": peak, "peak_alone": alone}
NUMBERS = {
    **{"gap": 100 * GAP, "spring": SPRING / 1e6, "mass": MASS / 1000, "xi": xi, "alpha": alpha},
    **{"tower": np.array(BUILDINGS[0][0]) / 1e6, "annex": np.array(BUILDINGS[1][0]) / 1e6},
    **{"yields": [100 * uy for _, uy in BUILDINGS], "end": samples[-1], "step": 1e6 * STEP},
}
