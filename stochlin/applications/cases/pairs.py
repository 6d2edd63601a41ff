"""Results for the two buildings of a case and their gap: probability of pounding, and measures."""

from __future__ import annotations

import re

import xarray as xr

from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.rows import check_masses, gap_of, motion_of, pair_of
from stochlin.applications.cases.shaking import shaking_of
from stochlin.applications.mitigation.mitigation import mitigate
from stochlin.applications.probability.probability import pounding_probability
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.plausible import unquestioned


@unquestioned()
def judge_gap(case: Case, gap: float, progress: Progress | None = None) -> xr.Dataset:
    """Probability of pounding of the buildings of a case with a gap [m], and their shaking.

    ``progress`` is called with the share of the work that is done. Errors are those of
    `stochlin.pounding_probability`.
    """
    first, second = (building.sampled for building in pair_of(case))
    ground = case.site.sampled_ground
    table = pounding_probability(first, second, ground, gap, **motion_of(case), progress=progress)
    return table.assign(shaking_of(case).data_vars)


@unquestioned()
def mitigate_case(case: Case, progress: Progress | None = None) -> xr.Dataset:
    """The measures of a case compared, and the least sufficient ones, by `stochlin.mitigate`.

    The case needs two buildings and an existing gap; errors name the file and the cure.
    ``progress`` is called with the share of the rows that is done.
    """
    first, second = pair_of(case)
    gap = gap_of(case)
    if gap is None:
        what = 'measures need the existing gap; write existing = "5 cm" in [separation]'
        raise case.whole.table.error("", what)
    if any(measure.links for measure in case.measures.values()):
        check_masses(case, "a link or a damper")
    models = first.sampled, second.sampled, case.site.sampled_ground
    with case.whole.table.naming("", ""):
        table = mitigate(*models, gap, case.measures, **motion_of(case), progress=progress)
    table = table.assign(shaking_of(case).data_vars)
    table = table.assign_coords(measure=table.measure.copy(data=_of_buildings(case, table)))
    return table.assign_attrs(title=f"{case.title}: {table.attrs['title']}", case=case.title)


def _of_buildings(case: Case, table: xr.Dataset) -> list[str]:
    """The names of the measures; those that are sought name the buildings as the file does."""
    first, second = (building.name for building in pair_of(case))
    names = zip(table.measure.values.tolist(), table.kind.values, strict=True)
    named = {"structure 1": first, "structure 2": second}
    return [
        re.sub("structure [12]", lambda part: named[part[0]], name) if kind == "least" else name
        for name, kind in names
    ]
