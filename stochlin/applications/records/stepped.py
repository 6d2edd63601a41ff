"""Response to records of buildings with storeys and structures of any law, by halved steps."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.records.cells import OUT_OF_RANGE, RecordedMotions
from stochlin.kernels.basics.arrays import Array, matrix_products
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.pounding.run import BuildingRow, GroundMotions, StepCounts, run
from stochlin.kernels.records.runs import SampledMotion
from stochlin.kernels.simulation.contacts import Contacts
from stochlin.messages import DoubtfulInput
from stochlin.models.buildings.base import FLOOR
from stochlin.models.start import Start
from stochlin.models.structures import AnyStructure
from stochlin.models.systems import Assembly, assembly_of
from stochlin.solver.simulation.checks import runs_away
from stochlin.solver.simulation.connected_structures import SteppedGroup, connected_groups, row_of
from stochlin.solver.simulation.start_values import (
    END_STATE,
    AnyStart,
    as_end_state,
    checked_end_state,
    first_block,
    start_values,
)
from stochlin.solver.simulation.structures_in_motion import apart, at_height, pairs_of
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_work
from stochlin.solver.tables.labels import ELEMENT, element_coordinates, floor_coordinates

FIRST_STEPS_PER_PERIOD = 32  # steps in the shortest period before the first halving
# displacement over the largest at which a structure falls, where it is not followed
FALLEN_STRUCTURE = 1e3
HALVING_ERROR = 1e-4  # allowed change of peaks, relatively, and of z when the step is halved
# Most halvings. States of laws, where yield displacements are small, need more than displacements
# do.
HALVINGS = 6
HALVINGS_OF_HISTORY = 10
ELEMENT_SECONDS = 4e-7  # of a step of an element [s]
NO_Z = np.zeros(0)
TOO_LARGE = "take softer structures, or a shorter record"


class SteppedResponse(NamedTuple):
    """Response of a system to a record in time steps, and what of it has to converge."""

    values: Any  # the response
    peaks: Array  # peaks of displacements [m]
    z: Array  # states z that are returned [-]; NaN where a structure has fallen
    cuts: int  # number of steps in an interval of the record
    error: float = np.inf  # largest change of a peak, relatively, and of z in the last halving

    def change(self, coarse: SteppedResponse) -> float:
        """Largest relative change of a peak, and largest change of z, from a coarser response."""
        with np.errstate(over="ignore", invalid="ignore"):  # of states that run away in long steps
            scale = np.where(self.peaks > 0, self.peaks, 1.0)
            peak_changes = np.abs(self.peaks - coarse.peaks) / scale
            z_changes = np.abs(self.z - coarse.z)
        return float(max(peak_changes.max(), np.nanmax(z_changes, initial=0.0)))


def stepped_response(
    system: Assembly, connected: Sequence[SteppedGroup], ground: SampledMotion, functions: Array
) -> SteppedResponse:
    """Functions (m, w) of all that is watched, from rest, in steps that `halved` finds.

    The values (steps + 1, m) [m] are those after every step.
    """
    cuts = _first_cuts(connected, ground)
    steps = float(cuts) * ground.acceleration.size
    what = _size(connected, ground)
    check_work(what, TOO_LARGE, numbers=len(functions) * 2.0**2 * steps)  # which are halved twice

    def followed(cuts: int) -> SteppedResponse:
        """The functions in such steps; those of a structure that falls end far beyond its limit."""
        values = _within(system.limits, _values(connected, functions, ground, cuts))
        return SteppedResponse(values, peaks_of(values), NO_Z, cuts)

    return halved(system, followed, cuts, HALVINGS)


def halved(
    system: Assembly, followed: Callable[[int], SteppedResponse], cuts: int, most: int
) -> SteppedResponse:
    """The response of a system by steps halved from ``cuts`` until it converges, or ``most`` times.

    The steps are of second order, so that the remaining error is about a third of the last change.
    Warns of a response that has not converged, and raises an ArithmeticError if it is not finite.
    """
    coarse = followed(cuts)
    for _ in range(most):
        response = followed(2 * coarse.cuts)
        response = response._replace(error=response.change(coarse))
        if response.error <= HALVING_ERROR:
            return response
        coarse = response
    if not np.isfinite(coarse.error):
        raise ArithmeticError(f"the response is no longer finite; {runs_away(system.sticks)}")
    what = (
        f"the response changes by {coarse.error:.2g} when the time step is halved for the last time"
    )
    warnings.warn(
        f"{what}, more than {HALVING_ERROR:g}: see step_error", DoubtfulInput, stacklevel=4
    )
    return coarse


def _first_cuts(connected: Sequence[SteppedGroup], ground: SampledMotion) -> int:
    """Number of steps in an interval of the record before the first halving."""
    shortest = min(group.shortest for group in connected)
    return max(1, int(np.ceil(ground.dt * FIRST_STEPS_PER_PERIOD / shortest)))


def _size(connected: Sequence[SteppedGroup], ground: SampledMotion) -> str:
    """The subject of a message on the size of a response."""
    shortest = min(group.shortest for group in connected)
    return (
        f"{ground.acceleration.size} samples, with a shortest period of {shortest:.3g} s, would "
        "take"
    )


def _within(limits: Array, values: Array) -> Array:
    """Displacements of which those of a structure that falls end far beyond its limit."""
    most = FALLEN_STRUCTURE * limits[np.isfinite(limits)].max(initial=0.0) or np.inf
    return values if most == np.inf else np.clip(np.nan_to_num(values, nan=most), -most, most)


def stepped_history(
    structure: AnyStructure, ground: SampledMotion, refine: int, start: AnyStart | None
) -> xr.Dataset:
    """The response history for `respond`, with ``refine`` points in an interval; without times."""
    system = assembly_of([structure])
    finer = _refined(ground, refine)
    row = row_of(system, Contacts.of([], system.storeys.mass.size), all_states=True)
    size = finer.acceleration.size
    intervals = np.array([size - 1])
    none = np.zeros(1)
    motion = GroundMotions(finer.acceleration[:, None], finer.dt, intervals, none, none)
    connected = connected_groups(system)
    first, cuts = _begun(row, system, start)
    cuts = cuts or _first_cuts(connected, finer)
    steps = float(cuts) * size
    numbers = 2 * len(first) * size
    # where they are halved twice
    seconds = ELEMENT_SECONDS * 2.0**3 * steps * system.storeys.mass.size
    check_work(_size(connected, finer), TOO_LARGE, numbers=numbers, seconds=seconds)
    falls = np.isfinite(system.limits).any()

    def followed(cuts: int) -> SteppedResponse:
        """The history in such steps, which is NaN after a fall."""
        [response] = run(row, motion, StepCounts(cuts, 1), keep=True, start=first)
        history = response.history
        moved = _within(system.limits, history.coordinates.q.T @ system.storeys.shapes.T)
        z = history.elements.z.T / system.storeys.strength
        if not falls and not np.isfinite(z).all():
            moved = np.full_like(moved, np.nan)  # so that the response is not taken as finite
        return SteppedResponse(history, peaks_of(moved), z, cuts)

    converged = halved(system, followed, cuts, HALVINGS_OF_HISTORY)
    last = np.append(converged.cuts, converged.values.block[:, -1])
    table = _history_table(structure, system, converged.values)
    return table.assign({"step_error": converged.error, END_STATE: as_end_state(last)})


def _history_table(structure: AnyStructure, system: Assembly, history: Any) -> xr.Dataset:
    """Displacements, drifts and energies in the history of a structure."""
    storeys = system.storeys
    q = history.coordinates.q.T
    rate = history.coordinates.v.T
    z = history.elements.z.T
    u = matrix_products(q, storeys.shapes)
    v = matrix_products(rate, storeys.shapes)
    extension = matrix_products(q, system.extensions)
    elastic = storeys.post * extension**2 + storeys.couple * z**2
    energies = {
        "input": history.coordinates.input_energy.T,
        "viscous": history.coordinates.viscous_energy.T,
        "hysteretic": history.elements.dissipated.T,
        "kinetic": 0.5 * storeys.mass * rate**2,
        "elastic": 0.5 * elastic,
    }
    mass = storeys.mass.sum()
    columns = {
        f"{name}_energy_per_mass": ("time", parts.sum(axis=1) / mass)
        for name, parts in energies.items()
    }
    lone = system.sticks[0].is_oscillator

    def over(dimension: str, values: Array) -> tuple[Any, Array]:
        return ("time", values[:, 0]) if lone else (("time", dimension), values)

    table = xr.Dataset({"displacement": over(FLOOR, u), "velocity": over(FLOOR, v), **columns})
    if lone:
        radius = np.hypot(u[:, 0], v[:, 0] * float(structure.first_period()) / (2 * np.pi))
        table["radius"] = ("time", radius)
    else:
        drifts = system.drifts @ system.displacements
        table["storey_drift"] = over(ELEMENT, matrix_products(q, drifts))
        table = table.assign_coords({**floor_coordinates(system), **element_coordinates(system)})
    if structure.yields:
        table["z"] = over(ELEMENT, system.of_elements(z / storeys.strength, 0.0, np.nan))
    return table


def _refined(ground: SampledMotion, refine: int) -> SampledMotion:
    """The same motion with ``refine`` samples in place of each interval."""
    samples = np.arange(ground.acceleration.size)
    between = np.arange(refine * samples[-1] + 1) / refine
    return SampledMotion(np.interp(between, samples, ground.acceleration), ground.dt / refine)


def _begun(row: BuildingRow, system: Assembly, start: AnyStart | None) -> tuple[Array, int]:
    """The block (rows, 1) of a motion at its start, and half its steps in an interval, if known."""
    block = row.at_rest(1).block
    if start is None:
        return block, 0
    if isinstance(start, Start):
        return first_block(row, start_values(system, start), start.ground_velocity)[:, None], 0
    cuts, *before = checked_end_state(start, 1 + len(block))
    return np.reshape(before, (-1, 1)), int(cuts) // 2


def stepped_gap(
    structures: Sequence[AnyStructure], motions: RecordedMotions, progress: Progress | None = None
) -> xr.Dataset:
    """The result of `recorded_gap` for structures with scalar parameters, without labels."""
    system = assembly_of(structures)
    floors = np.eye(len(system.floors), len(system.watched))
    if len(structures) == 1:
        highest = floors[-1:]
        moved = floors
    else:
        pairs = pairs_of(system)
        height = pairs[-1].height
        highest = np.array([at_height(system, number, height) for number in (0, 1)]) @ floors
        moved = np.array([apart(system, pair) for pair in pairs]) @ floors
    functions = np.concatenate([highest, system.drifts, moved])
    connected = connected_groups(system)
    periods = [float(s.arrays()["period"]) for s in structures if not s.has_storeys]
    tables = []
    for ground in motions.grounds:
        motion = stepped_response(system, connected, ground, functions)
        table = _in_one(system, motion)
        if len(periods) == len(structures):
            table = table.assign(_radii(motion, periods, ground.dt / motion.cuts))
        tables.append(table)
        if progress is not None:
            progress(len(tables) / len(motions.grounds))
    return motions.together(tables)


def gap_columns(separation: Any, peaks: Sequence[Any], rho: Any | None) -> dict[str, Any]:
    """The gap, the peaks and, of two structures, their correlation ``rho``, as arrays of any shape.

    Peaks are infinite where a structure falls.
    """
    stands = np.all(np.isfinite(peaks), axis=0)
    columns = {"separation": np.where(stands, separation, np.inf)}
    columns |= {f"peak_{number}": peak for number, peak in enumerate(peaks, start=1)}
    if rho is not None:
        columns |= {"rho": np.where(stands, rho, np.nan), "srss": np.hypot(*peaks)}
        with np.errstate(invalid="ignore", divide="ignore"):
            columns["separation_over_srss"] = columns["separation"] / columns["srss"]
    return columns


def _in_one(system: Assembly, motion: SteppedResponse) -> xr.Dataset:
    """Results for one record.

    The functions in ``motion`` are the displacement of each structure at the highest level where
    they can meet, all drifts, and the relative displacements at all levels.
    """
    n = len(system.watched)
    values = motion.values
    count = len(system.sticks)
    peaks, drifts = np.split(np.abs(values[:, : count + n]).max(axis=0), [count])
    at_height = np.maximum(values[:, count + n :].max(axis=0), 0.0)
    fallen = system.fallen(drifts, system.limits)
    if fallen.any():
        at_height[:] = np.inf
        peaks[fallen] = np.inf
        drifts[fallen[system.owners]] = np.inf
    strength = system.watched_strength
    status = labels.CONVERGED if (drifts > strength).any() else labels.ELASTIC_LIMIT
    rho = None
    if count == 2:
        u_1 = values[:, 0]
        u_2 = values[:, 1]
        with np.errstate(invalid="ignore", divide="ignore"):
            power = np.sqrt(np.trapezoid(u_1**2) * np.trapezoid(u_2**2))
            rho = np.trapezoid(u_1 * u_2) / power
    columns = gap_columns(at_height.max(), [*peaks], rho)
    if not fallen.any() and not np.isfinite([*columns.values()]).all():
        raise ArithmeticError(f"the response is not a number; {OUT_OF_RANGE}")
    table = xr.Dataset(columns).assign(step_error=motion.error, status=np.int8(status))
    if not system.has_storeys:
        return table
    heights = system.sticks[0].levels if count == 1 else [pair.height for pair in pairs_of(system)]
    attrs = {"units": "m", "long_name": "height above the ground"}
    table = table.assign(
        separation_at_height=("height", at_height),
        peak_drift=(ELEMENT, drifts),
        ductility=(ELEMENT, drifts / strength),
    )
    axis = "height", heights, attrs
    return table.assign_coords({"height": axis, **element_coordinates(system)})


def _radii(motion: SteppedResponse, periods: Sequence[float], dt: float) -> dict[str, float]:
    """Pseudo energy radii of oscillators [m], with velocities by central differences."""
    moved = motion.values[:, : len(periods)]
    frequencies = 2 * np.pi / np.array(periods)
    radii = np.hypot(moved, np.gradient(moved, dt, axis=0) / frequencies).max(axis=0)
    return {f"pseudo_energy_radius_{n}": float(radius) for n, radius in enumerate(radii, 1)}


def peaks_of(values: Array) -> Array:
    """Largest values and negatives of the smallest values, each at least 0 (2 m,)."""
    return np.maximum(np.concatenate([values.max(axis=0), -values.min(axis=0)]), 0.0)


def _values(
    connected: Sequence[SteppedGroup], weights: Array, ground: SampledMotion, cuts: int
) -> Array:
    share = (np.arange(cuts) + 0.5) / cuts  # of the means over each step of the acceleration
    rise = np.diff(ground.acceleration)
    f = -(ground.acceleration[:-1, None] + rise[:, None] * share).reshape(-1, 1)
    dt = ground.dt / cuts
    values = np.zeros((len(f) + 1, len(weights)))
    for group in connected:
        out = np.empty((len(f), group.watched.size, 1))
        group.part.block(dt)(f, group.part.at_rest(1), 1, out)
        values[1:] += out[..., 0] @ weights[:, group.watched].T
    return values
