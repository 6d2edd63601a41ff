"""Peak displacements and peak relative displacements in simulated motions of finite duration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.ensemble import Extremes, Links, finite_extremes
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.envelopes import Envelope, envelope_at
from stochlin.models.systems import Assembly
from stochlin.solver.simulation.checks import check_finite, check_response
from stochlin.solver.simulation.ensembles import SimulationRun
from stochlin.solver.simulation.results import RESULTS, EndedMotions, columns_of
from stochlin.solver.simulation.statistics import (
    ABOVE_GROUND,
    Columns,
    mean_columns,
    quantile_columns,
    share_columns,
)
from stochlin.solver.simulation.structures_in_motion import (
    HEIGHT,
    STRUCTURE,
    StructuresInMotion,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.labels import ELEMENT, link_coordinates

STEPS_AT_ONCE = 256  # time steps that are computed at once


def simulate_finite(
    moving: StructuresInMotion,
    duration: float,
    envelope: Envelope | None,
    quantiles: Sequence[float],
    progress: Progress | None,
) -> xr.Dataset:
    """Dataset of `simulate` for motions of finite duration, without labels."""
    levels = np.asarray(quantiles, float)
    run = moving.run
    system = moving.system
    functions = moving.functions
    motion = duration, envelope
    extremes = extremes_of(run, [*functions.values()], motion, progress, links_of(system))
    motions = _ended(moving, functions, extremes)
    check_response(system, ~np.isnan(motions.largest["floors"][0]))
    samples = columns_of(motions)
    names = [f"{number}" for number in range(1, len(system.sticks) + 1)]
    coords = moving.coords | {STRUCTURE: names, f"{STRUCTURE}_2": names}
    if moving.places:
        coords[HEIGHT] = labels.axis(HEIGHT, ABOVE_GROUND, moving.heights, "m").height
    if system.placed_links:
        coords |= link_coordinates([placed.number for placed in system.placed_links])
    means = _means(samples)
    if moving.system.has_storeys:
        means["ductility"] = [ELEMENT], means["peak_drift_mean"][1] / system.watched_strength
    (_, *over_pairs), separations = samples["separation"]
    separation_quantiles = quantile_columns("separation", over_pairs, separations, levels)
    if np.isfinite(moving.limits).any():
        means |= share_columns("collapse_probability", [STRUCTURE], motions.fallen)
    coords["quantile"] = "quantile", levels, {"units": "1", "long_name": "quantile"}
    # Made at once, because each addition to a dataset takes a millisecond.
    columns = samples | means | separation_quantiles | moving.input_factors()
    return xr.Dataset(columns, coords, finite_attributes(run, duration, envelope))


def links_of(system: Assembly) -> tuple[Array, Array]:
    """Extensions of the links, as functions (l, w) of all that is watched, and their parameters."""
    extensions = np.zeros((len(system.placed_links), len(system.watched)))
    for row, placed in zip(extensions, system.placed_links, strict=True):
        row[placed.floor] = 1.0
        if placed.other >= 0:
            row[placed.other] = -1.0
    return extensions, np.reshape([placed.link.numbers for placed in system.placed_links], (-1, 5))


def extremes_of(
    run: SimulationRun,
    functions: Sequence[Array],
    motion: tuple[float, Envelope | None],
    progress: Progress | None = None,
    links: tuple[Array, Array] | None = None,
) -> Extremes:
    """Extremes of linear functions (m, w) [m] of all that is watched, and peaks of links.

    The ``motion`` is a duration with its envelope. Raises as `check_finite`.
    """
    matrix = np.concatenate(functions)
    duration, envelope = motion
    check_finite(run, duration, len(matrix))
    extensions, parameters = links or (np.zeros((0, 1)), np.zeros((0, 5)))
    count = int(np.ceil(duration / run.plan.dt))
    middle = run.plan.dt * (np.arange(count) + 0.5)  # of the steps
    ensemble = run.with_plan(every=1, samples=STEPS_AT_ONCE).ensemble
    watched = Links(run.rows(extensions), parameters)
    return finite_extremes(
        ensemble, run.rows(matrix), envelope_at(envelope, middle), progress, watched
    )


def _ended(
    moving: StructuresInMotion, functions: Mapping[str, Array], extremes: Extremes
) -> EndedMotions:
    """All that is known of the motions; a structure that falls moves beyond any gap."""
    system = moving.system
    matrix = np.concatenate([*functions.values()])
    largest = np.stack([extremes.highest, -extremes.lowest])
    ends = np.cumsum([len(rows) for rows in functions.values()])[:-1]
    blocks = dict(zip(functions, np.split(largest, ends, axis=2), strict=True))
    drifts = blocks["drifts" if moving.system.has_storeys else "floors"].max(axis=0)
    fallen = system.fallen(drifts, moving.limits)
    members = np.arange(len(system.sticks)) == system.owners[:, None]
    lost = fallen @ (np.abs(matrix) @ members > 0).T
    largest[:, lost] = np.inf
    peaks = {"force": extremes.force, "stroke": extremes.stroke, "energy": extremes.energy}
    falls = fallen.any(axis=1, keepdims=True)
    links: dict[str, Array] = {}
    if system.placed_links:
        links = {name: np.where(falls, np.inf, peak) for name, peak in peaks.items()}
    displacement = moving.run.watched(extremes.last)
    plastic = moving.run.watched(extremes.plastic)
    return EndedMotions(moving, blocks, fallen, links, displacement, plastic)


def _means(samples: Columns) -> Columns:
    """Means over the motions, and their standard errors."""
    means: Columns = {}
    for name, ((_, *over), values) in samples.items():
        if RESULTS[name].mean:
            means |= mean_columns(name, over, values)
    return means


def finite_attributes(
    run: SimulationRun, duration: float, envelope: Envelope | None
) -> dict[str, float | int | str]:
    """Attributes of a dataset that describe its simulation of finite motions."""
    return {
        "paths": run.plan.groups * LANES,
        "seed": run.plan.seed,
        "step_s": run.plan.dt,
        "duration_s": float(duration),
        "envelope": "none" if envelope is None else envelope.describe(),
        **labels.of_scatter(run.plan.scatter),
    }
