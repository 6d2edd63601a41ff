"""Modal pushover beside the whole frame: `python benchmarks/modal_pushover.py RECORDS`.

RECORDS is a folder of records of two columns, time [s] and acceleration [g]. A plane moment frame of
eight storeys, whose beams and columns yield anywhere along their length, is shaken by them in
OpenSeesPy, without the weight on its columns. Its modes make a `ModalBuilding`; none, one or two of them
yield, as when pushed to the median elastic displacement and made bilinear by equal energy. Printed is
the ratio of peaks and gaps by modes to those of the whole frame: its geometric mean, and the standard
deviation of its logarithm. The gap is that to a neighbour of five storeys. Takes some minutes.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from opensees_models import load_opensees, shake

import stochlin as sl
from stochlin.kernels.basics.arrays import Array

STOREYS, BAYS, BAY = 8, 2, 7.0
HEIGHTS = [4.0] + [3.2] * (STOREYS - 1)  # m
LEVELS = np.concatenate([[0.0], np.cumsum(HEIGHTS)])
MASS = 1.2e5  # kg, of each floor
COLUMNS, BEAMS, STEEL = (3.0e8, 6e9), (2.0e8, 6e9), 0.02  # EI [N m^2], EA [N], hardening
BEAM_MOMENTS = [4.2e5, 4.2e5, 4.2e5, 3.6e5, 3.6e5, 2.7e5, 2.7e5, 1.8e5]  # N m, floors from the ground up
COLUMN_STRENGTH = 1.3  # moment of a column over the mean one of the beams of its storey
DAMPING, FACTORS = 0.05, (0.5, 1.0, 2.0)
LOW = sl.ShearBuilding.regular(
    period=0.6, storeys=5, storey_height=HEIGHTS[:5], mass=2e5, damping=DAMPING, hardening=0.05,
    base_shear_coefficient=0.15,
)  # fmt: skip
FACING = LOW.storeys
MEASURES = "roof", "neighbour's roof", "gap"
STEP = 0.005  # s, or a part of the step of the record


class Modes(NamedTuple):
    """Modes of the frame: periods [s], shapes over modes and floors, and their factors."""

    periods: Array
    shapes: Array
    factors: Array
    masses: Array


def node(floor: int, line: int) -> int:
    return 10 * floor + line


def build(ops: Any) -> None:
    """The frame, with masses along the gap and modal damping; floors are rigid along it."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.geomTransf("Linear", 1)
    lines, tag = range(1, BAYS + 2), 0
    for floor, level in enumerate(LEVELS):
        for line in lines:
            ops.node(node(floor, line), BAY * line, level)
            if floor == 0:
                ops.fix(node(floor, line), 1, 1, 1)
            elif line > 1:
                ops.equalDOF(node(floor, 1), node(floor, line), 1)
        if floor:
            ops.mass(node(floor, 1), MASS, 0.0, 0.0)
    for floor, moment in enumerate(BEAM_MOMENTS, 1):
        of_column = COLUMN_STRENGTH * moment
        for number, (strength, (bending, axial)) in enumerate(
            ((of_column, COLUMNS), (moment, BEAMS)), 2 * floor
        ):
            ops.uniaxialMaterial("Steel01", 2 * number, strength, bending, STEEL)
            ops.uniaxialMaterial("Elastic", 2 * number + 1, axial)
            ops.section("Aggregator", number, 2 * number + 1, "P", 2 * number, "Mz")
            ops.beamIntegration("Lobatto", number, number, 5)
        ends = [(2 * floor, node(floor - 1, line), node(floor, line)) for line in lines]
        ends += [(2 * floor + 1, node(floor, line), node(floor, line + 1)) for line in lines[:-1]]
        for kind, start, end in ends:
            tag += 1
            ops.element("forceBeamColumn", tag, start, end, 1, kind)


def floors(ops: Any) -> Array:
    """Displacements of the floors [m]."""
    return np.array([ops.nodeDisp(node(floor, 1), 1) for floor in range(1, STOREYS + 1)])


def modes_of(ops: Any) -> Modes:
    squares = np.array(ops.eigen("-fullGenLapack", STOREYS))
    shapes = np.array(
        [
            [ops.nodeEigenvector(node(floor, 1), n, 1) for floor in range(1, STOREYS + 1)]
            for n in range(1, STOREYS + 1)
        ]
    )
    of_ground, own = MASS * shapes.sum(axis=1), MASS * (shapes**2).sum(axis=1)
    return Modes(2 * np.pi / np.sqrt(squares), shapes, of_ground / own, of_ground**2 / own)


def pushed(ops: Any, modes: Modes, n: int, target: float) -> tuple[Array, Array]:
    """The curve of mode ``n``, pushed to ``target`` [m]: displacement and force of its oscillator."""
    build(ops)
    roof, steps = modes.factors[n] * modes.shapes[n, -1], 400
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    forces = MASS * modes.shapes[n] * modes.factors[n]
    for floor, force in enumerate(forces, 1):
        ops.load(node(floor, 1), force, 0.0, 0.0)
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-9, 50)
    ops.algorithm("Newton")
    ops.integrator("DisplacementControl", node(STOREYS, 1), 1, target * roof / steps)
    ops.analysis("Static")
    curve = [(0.0, 0.0)]
    for _ in range(steps):
        if ops.analyze(1) != 0:
            raise RuntimeError("OpenSees did not converge in a pushover")
        # The base shear is the load factor times the sum of the forces, the effective mass.
        curve.append((floors(ops)[-1] / roof, ops.getLoadFactor(1)))
    displacement, force = np.array(curve).T
    return displacement, force


def bilinear(displacement: Array, force: Array, stiffness: float) -> tuple[float, float]:
    """Yield displacement and hardening ratio: the elastic slope, the same end and the same energy."""
    end, top, energy = displacement[-1], force[-1], np.trapezoid(force, displacement)
    first = (2 * energy - top * end) / (stiffness * end - top)
    return float(first), float((top - stiffness * first) / (end - first) / stiffness)


def shaken(ops: Any, record: xr.DataArray) -> Array:
    """Displacements of the floors at the samples of a record (samples, floors)."""
    build(ops)
    ops.eigen("-fullGenLapack", STOREYS)
    ops.modalDamping(DAMPING)
    dt = float(record.time[1] - record.time[0])
    cuts = int(np.ceil(dt / STEP - 1e-9))
    shake(ops, record.values, dt, ("NormDispIncr", 1e-8, 30), constraints="Transformation")
    found = np.zeros((record.size, STOREYS))
    for i in range(1, record.size):
        if ops.analyze(cuts, dt / cuts) != 0:
            raise RuntimeError(f"OpenSees did not converge at {i * dt:.2f} s")
        found[i] = floors(ops)
    return found


def by_modes(ops: Any, modes: Modes, targets: Array) -> sl.ModalBuilding:
    """All modes, the first of which yield as when pushed to ``targets`` [m]."""
    fits = [
        bilinear(*pushed(ops, modes, n, target), (2 * np.pi / modes.periods[n]) ** 2)
        for n, target in enumerate(targets)
    ]
    strength: dict[str, Any] = {}
    if fits:
        first, hardening = (list(values) for values in zip(*fits, strict=True))
        strength = {"yield_displacements": first, "hardening": hardening}
    masses = [MASS] * STOREYS
    return sl.ModalBuilding(modes.periods, modes.shapes, masses, HEIGHTS, DAMPING, **strength)


def measures(history: Array, beside: Array) -> Array:
    """Peaks of the roof and at the neighbour's roof, and the larger of the gaps on both sides."""
    peaks, apart = np.abs(history).max(axis=0), np.abs(history[:, :FACING] - beside)
    return np.array([peaks[-1], peaks[FACING - 1], apart.max()])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    files = sorted(parser.parse_args().folder.glob("*.txt"))
    records = [sl.read_record(file, time_column=0, column=1, units="g") for file in files]
    ops = load_opensees()
    build(ops)
    modes = modes_of(ops)
    shares = modes.masses / (STOREYS * MASS)
    print(
        f"{len(records)} records; periods {modes.periods[:3].round(3)} s, shares {shares[:3].round(3)}"
    )
    for factor in FACTORS:
        scaled = [factor * record for record in records]
        elastic = sl.response_spectrum(scaled, modes.periods[:2], DAMPING).displacement_max
        targets = elastic.median("record").values
        buildings = [by_modes(ops, modes, targets[:n]) for n in range(3)]
        beside = [sl.respond(LOW, record).displacement.values for record in scaled]
        whole = [measures(shaken(ops, record), low) for record, low in zip(scaled, beside, strict=True)]
        weak = buildings[2].arrays()
        print(
            f"\nrecords times {factor:g}: modes pushed to {targets.round(3)} m, yield at "
            f"{weak['yield_displacements'].values.round(4)} m, hardening "
            f"{weak['hardening'].values.round(3)}"
        )
        for yielding, building in enumerate(buildings):
            histories = [sl.respond(building, record).displacement.values for record in scaled]
            ours = [measures(*both) for both in zip(histories, beside, strict=True)]
            ratios = np.log(np.array(ours) / np.array(whole))
            told = [
                f"{measure} {np.exp(mean):.2f}, {spread:.2f}"
                for measure, mean, spread in zip(
                    MEASURES, ratios.mean(axis=0), ratios.std(axis=0, ddof=1), strict=True
                )
            ]
            print(f"{yielding} modes yield: " + "; ".join(told), flush=True)


if __name__ == "__main__":
    main()
