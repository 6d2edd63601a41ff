"""Frames of Steel01 storeys and others in OpenSees, without anything of the library."""

from importlib.metadata import version
from typing import NamedTuple

import numpy as np
import openseespy.opensees as ops
from scipy.linalg import eigh

PROGRAM = f"OpenSeesPy {version('openseespy')}"
DT = 0.02
SAMPLES = DT * np.arange(401)
SHAKING = 4.0 * np.sin(2 * np.pi * SAMPLES * (0.6 + 0.1 * SAMPLES)) * np.sin(np.pi * SAMPLES / 8)


class Frame(NamedTuple):
    """A frame of storeys, from the ground up."""

    masses: list
    springs: list
    yields: list
    alpha: float

    def modal_damping(self, xi):
        """The matrix of the same ratio in every mode."""
        masses, springs = np.array(self.masses), self.springs
        k = np.diag(springs) + np.diag([*springs[1:], 0.0])
        k -= np.diag(springs[1:], 1) + np.diag(springs[1:], -1)
        squares, modes = eigh(k, np.diag(masses))
        modes = masses[:, None] * modes
        return sum(
            2 * xi * np.sqrt(s) * np.outer(m, m) for s, m in zip(squares, modes.T, strict=True)
        )


def new_model():
    """An empty model of one dimension."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)


def times_of_steps(shaking, step):
    """Those by Newmark's average acceleration under a ground motion, each after it is done."""
    ops.timeSeries("Path", 1, "-dt", DT, "-values", *shaking, 0.0)
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-12, 50)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    for n in range(1, round((len(shaking) - 1) * DT / step) + 1):
        assert ops.analyze(1, step) == 0
        yield n * step


def shaken(frames, xi, gap, spring, step, meet):
    """Peaks of the floors of two frames, and the times at which some gap between them closes.

    Floors of one number face each other. Peaks are over frames and floors, NaN where a frame has
    none.
    """
    new_model()
    for b, frame in enumerate(frames, 1):
        base, damping = 100 * b, frame.modal_damping(xi)
        ops.node(base, 0.0)
        ops.fix(base, 1)
        for i, (mass, k, uy) in enumerate(zip(*frame[:3], strict=True), 1):
            ops.node(base + i, 0.0)
            ops.mass(base + i, mass)
            ops.uniaxialMaterial("Steel01", base + i, k * uy, k, frame.alpha)
            ops.element("zeroLength", base + i, base + i - 1, base + i, "-mat", base + i, "-dir", 1)
        for i in range(len(frame.springs)):  # dashpots to the ground and between all floors
            for j in range(-1, i):
                tag = 1000 * b + 10 * i + j + 1
                c = damping[i].sum() if j < 0 else -damping[i, j]
                ops.uniaxialMaterial("Viscous", tag, c, 1.0)
                ops.element("zeroLength", tag, base + j + 1, base + i + 1, "-mat", tag, "-dir", 1)
    one, two = (len(frame.masses) for frame in frames)
    facing = range(min(one, two))
    if meet:
        ops.uniaxialMaterial("ElasticPPGap", 1, spring, -1e15, -gap, 0.0)
        for i in facing:
            ops.element("zeroLength", 5001 + i, 101 + i, 201 + i, "-mat", 1, "-dir", 1)
    floors = [*range(101, 101 + one), *range(201, 201 + two)]
    peaks, times, closed = np.zeros(one + two), [], [False for _ in facing]
    for time in times_of_steps(SHAKING, step):
        u = np.array([ops.nodeDisp(floor, 1) for floor in floors])
        peaks = np.maximum(peaks, abs(u))
        now = [bool(u[i] - u[one + i] > gap) for i in facing]
        times += [time for i in facing if now[i] and not closed[i]]
        closed = now
    tallest = max(one, two)
    sides = (peaks[:one], peaks[one:])
    return [[*side.tolist(), *[np.nan] * (tallest - side.size)] for side in sides], times


def answers(*known):
    """What both independent programs answer: with contacts, and standing alone."""
    peak, times = shaken(*known, meet=True)
    alone, _ = shaken(*known, meet=False)
    return {"impact_time": times, "peak": peak, "peak_alone": alone}
