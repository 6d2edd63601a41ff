"""Answers computed again and again: the gap of a case, and its correlation, by few motions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np
import xarray as xr

from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.rows import gap_of, pair_of
from stochlin.applications.cases.separation import CaseAnswer, answer_case
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.models.grounds import Ground, WhiteNoise
from stochlin.models.plausible import unquestioned
from stochlin.solver.correlation.correlation import Method, correlate
from stochlin.solver.simulation.statistics import keeping_apart
from stochlin.solver.tables import labels

RATIOS_OF_LINES = np.geomspace(0.25, 4.0, 81)
SIMULATED_RATIOS = np.geomspace(0.25, 4.0, 9)
PATHS_OF_ANSWER = 256  # motions


def gap_by_few_motions(case: Case, progress: Progress | None = None) -> CaseAnswer:
    """The answer of `answer_case` with few motions, without what would make an existing gap enough.

    The search for that takes longer than all else.
    """
    paths = min(case.simulated.motions, PATHS_OF_ANSWER)
    few = replace(case, simulated=replace(case.simulated, paths=paths))
    alone = replace(few, wanted=replace(case.wanted, existing=[]))
    answer = answer_case(alone, progress)
    if not (gap := gap_of(case)):
        return answer
    existing = xr.Dataset(keeping_apart(answer.separation.separation_samples, gap))
    return replace(answer, case=few, existing=existing.assign_attrs(gap_m=gap))


class OnGround(NamedTuple):
    """Correlation on a ground over ``period_ratio``: linearized, and simulated at a few ratios."""

    ground: str
    linearized: xr.DataArray
    simulated: xr.Dataset


def correlations(case: Case, progress: Progress | None = None) -> Iterator[OnGround]:
    """Datasets of `correlate` for both buildings, where the period of the second one changes.

    The white noise is as strong as the ground at the period of the first building. Raises a
    ValueError for buildings with storeys.
    """
    if any(building.has_storeys for building in pair_of(case)):
        raise ValueError("the correlation over the ratio of the periods is that of two oscillators")
    white = WhiteNoise(float(case.site.ground.psd(2 * np.pi / pair_of(case)[0].period)))
    grounds = {"the ground of the case": case.site.ground, "white noise": white}
    for number, (name, ground) in enumerate(grounds.items()):
        share = part_of(progress, number / 2, (number + 1) / 2)
        options: dict[str, Any] = {"seed": case.simulated.seed, "progress": share}
        simulated = _correlation(
            case, SIMULATED_RATIOS, ground, "simulation", paths=PATHS_OF_ANSWER, **options
        )
        linearized = _correlation(case, RATIOS_OF_LINES, ground, "linearization", bias=False)
        yield OnGround(name, linearized.rho, simulated[["rho", "rho_standard_error"]])


@unquestioned()
def _correlation(
    case: Case, ratios: Array, ground: Ground, method: Method, **options: Any
) -> xr.Dataset:
    """Dataset of `correlate` at these ratios of the periods, and at that of the case."""
    left, right = pair_of(case)
    first = cast(Any, left.structure)
    second = cast(Any, right.structure)
    ratios = np.union1d(ratios, right.period / left.period)
    ratio = labels.axis("period_ratio", "ratio of the periods, T2/T1", ratios)
    other = replace(second, period=left.period * ratio)
    return correlate(first, other, ground, method, **options)
