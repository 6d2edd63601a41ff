"""Results of a scene by simulation, and one dataset with all results of a scene."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.explorer.buildings import storeys_table
from stochlin.analyses.explorer.formulas import models_of, swept
from stochlin.analyses.explorer.scene import Scene
from stochlin.analyses.explorer.storeys import simulated_correlation
from stochlin.analyses.probability.probability import with_samples
from stochlin.analyses.probability.simulated import SAMPLES
from stochlin.analyses.separation.separation import separation
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.models.buildings import ShearBuilding

SIMULATED_RATIOS = np.geomspace(0.25, 4.0, 13)
RATIO_PATHS = 256  # correlations need fewer motions than quantiles
FEW_PATHS = 512  # motions of a simulation that is repeated while a slider moves


def simulations(scene: Scene, progress: Progress | None = None) -> dict[str, xr.Dataset]:
    """Results of a scene by nonlinear simulation.

    ``correlation`` is the dataset of `correlate` over the ratio of periods, with storeys only for the
    ratio of the scene and at the lower roof; ``gaps`` that of `separation`; ``probability`` what
    `pounding_probability` simulates. ``progress`` is called with the share that is done, and may stop
    the simulation by an exception. Raises a ValueError if the work would take too much memory or time.
    """

    def part(number: int) -> Progress:
        return part_of(progress, number / 3, (number + 1) / 3)

    first, second = scene.structures()
    ground = scene.ground()
    motions = scene.motion() | {"paths": scene.paths, "seed": scene.seed}
    rules = scene.for_codes() | {"unverified": scene.unverified}
    gaps = separation(first, second, ground, **motions, **rules, progress=part(0))
    chances = _probability(scene, scene.paths, part(1))
    return {
        **_correlation(scene, part(2)),
        "gaps": gaps.drop_dims("path").assign_attrs(peaks="simulated", gap_m=scene.gap),
        "probability": chances,
    }


def few_motions(scene: Scene, progress: Progress | None = None) -> xr.Dataset:
    """What `pounding_probability` simulates, with few motions."""
    return _probability(scene, min(FEW_PATHS, scene.paths), progress)


def _probability(scene: Scene, paths: int, progress: Progress | None) -> xr.Dataset:
    first, second = scene.structures()
    motions = scene.motion() | {"paths": paths, "seed": scene.seed, "progress": progress}
    table = with_samples(first, second, scene.ground(), scene.gap, **motions, solve=None)
    return table.drop_vars(SAMPLES)


def with_motions(formula: xr.Dataset | None, motions: xr.Dataset | None) -> xr.Dataset | None:
    """One dataset of the probability by formula and of simulated motions, of which one may be absent."""
    if formula is None or motions is None:
        return motions if formula is None else formula
    drawn = {name: motions.attrs[name] for name in ("paths", "seed")}
    return formula.assign(motions.data_vars).assign_attrs(drawn)


def _correlation(scene: Scene, progress: Progress) -> dict[str, xr.Dataset]:
    """Simulated correlation; empty if a yielding storey has no stationary response."""
    if scene.has_storeys:
        try:
            return {"correlation": simulated_correlation(scene, progress)}
        except (ArithmeticError, ValueError):
            return {}
    ratio = scene.period_2 / scene.period_1
    other = swept(scene, np.union1d(SIMULATED_RATIOS, ratio))
    shared = {"paths": RATIO_PATHS, "seed": scene.seed, "progress": progress}
    rho = correlate(scene.oscillator(1), other, scene.ground(), "simulation", **shared)  # type: ignore[arg-type]
    return {"correlation": rho.assign_attrs(period_ratio=ratio)}


def merge_tables(scene: Scene, tables: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """One dataset for a file, from all datasets of a scene by name.

    The names of variables, coordinates and dimensions start with that of their table. The parameters of
    storeys start with ``building_1`` or ``building_2``.
    """
    whole = xr.Dataset()
    storeys = {
        f"building_{number}": storeys_table(structure)
        for number, structure in enumerate(scene.structures(), start=1)
        if isinstance(structure, ShearBuilding)
    }
    for name, table in (storeys | dict(tables)).items():
        flat = table.reset_coords(set(table.coords) - set(table.dims))
        flat = flat.rename({part: f"{name}_{part}" for part in {*flat.variables, *flat.dims}})
        whole = whole.merge(flat)
        whole.attrs |= {f"{name}_{key}": value for key, value in table.attrs.items()}
    return labels.with_run_information(
        whole, f"Explored: {scene.title}", "explore", models_of(scene)
    ).assign_attrs(confidence=scene.confidence, duration_s=scene.duration, gap_m=scene.gap)
