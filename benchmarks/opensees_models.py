"""OpenSeesPy and what is modelled in it, for the benchmarks and the tests that compare with it."""

import ctypes
import importlib
import importlib.util
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stochlin import ShearBuilding


def load_opensees() -> Any:
    """The module, or an ImportError that says why not.

    Its Linux wheels carry libraries that the linker does not always find by itself.
    """
    bundle = importlib.util.find_spec("openseespylinux")
    for folder in (bundle.submodule_search_locations or []) if bundle else []:
        for pattern in ("libquadmath*", "libgfortran*", "libblas*", "liblapack*"):
            for library in sorted(Path(folder, "lib").glob(pattern)):
                try:
                    ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
                except OSError:
                    continue  # then the import below tells
    try:
        return importlib.import_module("openseespy.opensees")
    except (ImportError, RuntimeError, OSError) as error:
        raise ImportError(f"OpenSeesPy does not load: {error}") from error


def opensees_or_none() -> Any:
    """The module, or None: a benchmark then leaves it out."""
    try:
        return load_opensees()
    except ImportError:
        return None


def new_model(ops: Any) -> None:
    """An empty model of one dimension."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)


def add_oscillators(
    ops: Any,
    periods: Sequence[float],
    masses: Sequence[float],
    strengths: Sequence[float],
    damping: float,
    hardening: float,
) -> list[int]:
    """Springs of Steel01, yielding at ``strengths`` [m], beside dashpots; the nodes of the masses."""
    tops = []
    for n, (period, mass, uy) in enumerate(zip(periods, masses, strengths, strict=True), start=1):
        w = 2 * np.pi / period
        base, top, spring, dashpot = 10 * n, 10 * n + 1, 2 * n, 2 * n + 1
        ops.node(base, 0.0)
        ops.node(top, 0.0)
        ops.fix(base, 1)
        ops.mass(top, mass)
        ops.uniaxialMaterial("Steel01", spring, mass * w**2 * uy, mass * w**2, hardening)
        ops.uniaxialMaterial("Viscous", dashpot, 2 * damping * w * mass, 1.0)
        ops.element("zeroLength", n, base, top, "-mat", spring, dashpot, "-dir", 1, 1)
        tops.append(top)
    return tops


def add_shear_building(ops: Any, base: int, building: ShearBuilding) -> list[int]:
    """Storeys of Steel01, or elastic, with the damping matrix as dashpots; the nodes of the floors.

    Its tags are from ``base`` to ``base + storeys``, and from ``1000 base`` on.
    """
    values, damping = building.arrays(), building.damping_matrix()
    n = building.storeys
    yields = np.broadcast_to(values.get("yield_drifts", np.inf), n)
    ops.node(base, 0.0)
    ops.fix(base, 1)
    for i in range(n):
        k, tag = float(values["stiffnesses"][i]), base + i + 1
        ops.node(tag, 0.0)
        ops.mass(tag, float(values["masses"][i]))
        if building.yields:
            ops.uniaxialMaterial("Steel01", tag, k * yields[i], k, float(values["hardening"]))
        else:
            ops.uniaxialMaterial("Elastic", tag, k)
        ops.element("zeroLength", tag, tag - 1, tag, "-mat", tag, "-dir", 1)
    for i in range(n):
        for j in range(-1, i):  # to the ground, and between floors
            c = damping[i].sum() if j < 0 else -damping[i, j]
            tag = 1000 * base + 100 * (i + 1) + j + 1
            ops.uniaxialMaterial("Viscous", tag, c, 1.0)
            ops.element("zeroLength", tag, base + j + 1, base + i + 1, "-mat", tag, "-dir", 1)
    return [base + i + 1 for i in range(n)]


def shake(
    ops: Any,
    acceleration: Iterable[float],
    dt: float,
    test: tuple[str, float, int],
    numberer: str = "Plain",
    system: str = "FullGeneral",
    constraints: str = "Plain",
) -> None:
    """Make ready for Newmark's steps of average acceleration under a motion of the ground."""
    ops.timeSeries("Path", 1, "-dt", dt, "-values", *acceleration, 0.0)  # a sample beyond the end
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.constraints(constraints)
    ops.numberer(numberer)
    ops.system(system)
    ops.test(*test)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
