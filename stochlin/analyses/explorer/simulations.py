"""Results of a case by simulation, and one dataset with all results of a case."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.cases.case import Case
from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.explorer.formulas import models_of, swept
from stochlin.analyses.explorer.pair import (
    for_codes,
    gap_of,
    has_storeys,
    motion_of,
    ratio_of,
    structures_of,
)
from stochlin.analyses.explorer.storeys import simulated_correlation
from stochlin.analyses.probability.confidence_errors import measured_cautions
from stochlin.analyses.probability.probability import with_samples
from stochlin.analyses.probability.simulated import SAMPLES
from stochlin.analyses.separation.separation import separation
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.models.buildings import OF_STOREYS, MultistoreyBuilding

SIMULATED_RATIOS = np.geomspace(0.25, 4.0, 13)
RATIO_PATHS = 256  # correlations need fewer motions than quantiles
FEW_PATHS = 512  # motions of a simulation that is repeated while a slider moves


def simulations(case: Case, progress: Progress | None = None) -> dict[str, xr.Dataset]:
    """Results of a case by nonlinear simulation.

    ``correlation`` is the dataset of `correlate` over the ratio of periods, with storeys only for the
    ratio of the case and at the lower roof; ``gaps`` that of `separation`; ``probability`` what
    `pounding_probability` simulates. ``progress`` is called with the share that is done, and may stop
    the simulation by an exception. Raises a ValueError if the work would take too much memory or time.
    """

    def part(number: int) -> Progress:
        return part_of(progress, number / 3, (number + 1) / 3)

    first, second = structures_of(case)
    ground = case.ground
    motions = motion_of(case) | {"paths": case.paths, "seed": case.seed}
    rules = for_codes(case) | {"unverified": case.unverified}
    gaps = separation(first, second, ground, **motions, **rules, progress=part(0))
    chances = _probability(case, case.paths, part(1))
    return {
        **_correlation(case, part(2)),
        "gaps": gaps.drop_dims("path").assign_attrs(peaks="simulated", gap_m=gap_of(case)),
        "probability": chances,
    }


def few_motions(case: Case, progress: Progress | None = None) -> xr.Dataset:
    """What `pounding_probability` simulates, with few motions."""
    return _probability(case, min(FEW_PATHS, case.paths), progress)


def _probability(case: Case, paths: int, progress: Progress | None) -> xr.Dataset:
    first, second = structures_of(case)
    motions = motion_of(case) | {"paths": paths, "seed": case.seed, "progress": progress}
    table = with_samples(first, second, case.ground, gap_of(case), **motions, solve=None)
    return table.drop_vars(SAMPLES)


def with_motions(formula: xr.Dataset | None, motions: xr.Dataset | None) -> xr.Dataset | None:
    """One dataset of the probability by formula and of simulated motions, of which one may be absent."""
    if formula is None or motions is None:
        return motions if formula is None else formula
    drawn = {name: motions.attrs[name] for name in ("paths", "seed")}
    both = formula.assign(motions.data_vars).assign_attrs(drawn)
    return both.assign(measured_cautions(both))


def _correlation(case: Case, progress: Progress) -> dict[str, xr.Dataset]:
    """Simulated correlation; empty if a yielding storey has no stationary response."""
    if has_storeys(case):
        try:
            return {"correlation": simulated_correlation(case, progress)}
        except (ArithmeticError, ValueError):
            return {}
    first: Any = structures_of(case)[0]
    ratio = ratio_of(case)
    other = swept(case, np.union1d(SIMULATED_RATIOS, ratio))
    shared: Any = {"paths": RATIO_PATHS, "seed": case.seed, "progress": progress}
    rho = correlate(first, other, case.ground, "simulation", **shared)
    return {"correlation": rho.assign_attrs(period_ratio=ratio)}


def merge_tables(case: Case, tables: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """One dataset for a file, from all datasets of a case by name.

    The names of variables, coordinates and dimensions start with that of their table. The parameters of
    storeys start with ``building_1`` or ``building_2``.
    """
    whole = xr.Dataset()
    storeys = {
        f"building_{number}": storeys_table(structure)
        for number, structure in enumerate(structures_of(case), start=1)
        if isinstance(structure, MultistoreyBuilding)
    }
    for name, table in (storeys | dict(tables)).items():
        flat = table.reset_coords(set(table.coords) - set(table.dims))
        flat = flat.rename({part: f"{name}_{part}" for part in {*flat.variables, *flat.dims}})
        whole = whole.merge(flat)
        whole.attrs |= {f"{name}_{key}": value for key, value in table.attrs.items()}
    return labels.with_run_information(
        whole, f"Explored: {case.title}", "explore", models_of(case)
    ).assign_attrs(confidence=case.confidence, duration_s=case.duration, gap_m=gap_of(case))


def storeys_table(building: MultistoreyBuilding) -> xr.Dataset:
    """Dataset with the parameters of the storeys of a building, or of its modes and floors."""
    arrays, table = building.arrays(), xr.Dataset()
    for name, array in arrays.items():
        of_storeys = name in OF_STOREYS and name != "heights"
        if array.ndim or of_storeys:
            about = building.__dataclass_fields__[name].metadata
            attrs = {key: about[key] for key in ("units", "long_name")}
            wide = array.broadcast_like(arrays["masses"]) if of_storeys else array
            table[name] = wide.assign_attrs(attrs)
    return table
