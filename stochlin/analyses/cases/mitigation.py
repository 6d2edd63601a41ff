"""Comparison of mitigation measures for the two buildings of a case."""

from __future__ import annotations

import re

import numpy as np
import xarray as xr

from stochlin.analyses.cases.case import Case
from stochlin.analyses.cases.sites.shaking import LEVELS, MOST_RECORDS, shaking_of, share_apart
from stochlin.analyses.cases.variables import RECORDED
from stochlin.analyses.mitigation.mitigation import mitigate
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import brief
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.systems import LEVEL


def mitigate_case(case: Case, progress: Progress | None = None) -> xr.Dataset:
    """The measures of a case compared, and the least sufficient ones, by `stochlin.mitigate`.

    The case needs two buildings and an existing gap; errors name the file and the cure. Pounding is
    computed in the records if the case has records, a contact and all masses. ``progress`` is called
    with the share of the rows that is done.
    """
    first, second = case.pair
    if case.gap is None:
        raise ValueError(
            f'{case.file}: measures are compared for the existing gap; write existing = "5 cm" in '
            '[separation], "0 cm" for buildings that touch'
        )
    weighed = first.weighed and second.weighed
    for name, measure in case.measures.items():
        between = [link for link in measure.links if not link.within_one]
        if between and not weighed:
            raise ValueError(
                f"{case.file}: {name} links the buildings, which takes their masses; write "
                'mass = "1500 t" in [building_1] and [building_2]'
            )
        for number in {n for link in measure.links for n in link.structures or ()}:
            if not case.pair[number - 1].weighed:
                raise ValueError(
                    f"{case.file}: {name} has dampers in {case.pair[number - 1].name}, which takes its "
                    f'mass; write mass = "1500 t" in [building_{number}]'
                )
        if any(link.floors is None for link in between):
            _check_level(case, name)
        _check_fits(case, name)
    pounding = bool(case.records) and case.contact is not None and weighed
    table = mitigate(
        first.sampled,
        second.sampled,
        case.sampled_ground,
        gap=case.gap,
        measures=case.measures,
        **case.motion,
        contact=case.contact,
        records=dict(case.records) if pounding else None,
        amplification_limit=case.amplification_limit if pounding else None,
        progress=progress,
    )
    table = table.assign(shaking_of(case).data_vars)
    table = table.assign_coords(measure=table.measure.copy(data=_of_buildings(case, table)))
    if pounding and len(case.records) > MOST_RECORDS:
        table = table.assign(_over_records(case, table))
    return table.assign_attrs(title=f"{case.title}: {table.attrs['title']}", case=case.title)


def _of_buildings(case: Case, table: xr.Dataset) -> list[str]:
    """The names of the measures; those that are sought name the buildings as the file does."""
    own = {f"structure {number}": building.name for number, building in enumerate(case.pair, start=1)}
    return [
        re.sub("|".join(own), lambda found: own[found[0]], name) if kind == "least" else name
        for name, kind in zip(table.measure.values.tolist(), table.kind.values, strict=True)
    ]


def _over_records(case: Case, table: xr.Dataset) -> xr.Dataset:
    """Quantiles over many records, and the share of records without an impact, for each measure."""
    known = table.amplification_1.notnull()
    quiet = table.largest_force.where(table.impacts > 0, 0.0)  # without an impact the force is 0
    columns = {name: table[name] for name in ("amplification_1", "amplification_2", "impacts")}
    of_records = xr.Dataset({**columns, "largest_force": quiet}).where(known)
    quantiles = of_records.quantile(LEVELS, "record", skipna=False)
    quantiles = quantiles.rename({name: f"record_{name}" for name in quantiles.data_vars})
    apart = share_apart(case, table.impacts, 0.5)
    of_all = known.all("record")
    quantiles = quantiles.assign({name: share.where(of_all) for name, share in apart.items()})
    level = labels.axis("quantile", "quantile", quantiles["quantile"].to_numpy())
    return labels.label(quantiles.assign_coords(quantile=level), RECORDED)


def _check_fits(case: Case, name: str) -> None:
    """Raise a ValueError for bumpers that fill the gap, or for strengthening an elastic building."""
    measure, gap = case.measures[name], case.gap or 0.0
    where = f"in its table of [measures], {brief(name)}"
    if measure.bumper_thickness >= gap:
        raise ValueError(
            f"{case.file}: bumper_thickness = {measure.bumper_thickness:g} m {where}, fills the "
            "existing gap; allowed: less than existing in [separation]"
        )
    for number, building in enumerate(case.pair, start=1):
        if getattr(measure, f"strengthening_{number}") != 1 and not building.structure.yields:
            raise ValueError(
                f"{case.file}: strengthening_{number} {where}, is of {building.name}, which never "
                f"yields; give [building_{number}] a strength in place of elastic, or write "
                f"stiffening_{number}"
            )


def _check_level(case: Case, name: str) -> None:
    """Raise a ValueError if a link without given floors has no floors at the same level."""
    pair = [building.structure for building in case.pair]
    levels = [structure.levels() for structure in pair if isinstance(structure, MultistoreyBuilding)]
    if len(levels) < len(pair) or (np.abs(levels[0][:, None] - levels[1]) < LEVEL).any():
        return
    roof = min(own[-1] for own in levels)
    nearest = [int(np.abs(own - roof).argmin()) + 1 for own in levels]
    raise ValueError(
        f"{case.file}: {brief(name)} links the buildings, and no two of their floors are at one level; "
        f"write which floors it ties, as link_floors = {nearest}, in its table of [measures]"
    )
