"""Separations that building codes ask for, side by side."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from stochlin.analyses.separation.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_truth
from stochlin.models.parameters import Parameter
from stochlin.models.rules.codes import BuildingPeaks, check_zone, code_rule, code_rule_names

TEXTS: Mapping[str, str] = {
    "reference": "source of the rule",
    "mark": "how the rule was checked",
    "assumptions": "what the peaks must be",
    "missing": "what the rule needs and was not given",
}


def code_gaps(
    peak_1: Parameter,
    peak_2: Parameter,
    *,
    height_1: Parameter | None = None,
    height_2: Parameter | None = None,
    floors_align: bool = False,
    zone: str | None = None,
) -> xr.Dataset:
    """Separation of two buildings by every known rule of a building code.

    Parameters
    ----------
    peak_1, peak_2 : float or array
        Peak displacements [m], not negative, at the level where the buildings could meet. Every code
        means another displacement by this: see ``assumptions``.
    height_1, height_2 : float or array, optional
        Heights of the buildings [m].
    floors_align : bool
        Whether the floors are at the same levels; some rules then ask for less.
    zone : str, optional
        Zone of Mexico City: ``"I"``, ``"II"`` or ``"III"``.

    Returns
    -------
    xarray.Dataset
        Over ``rule`` and the dimensions of the arguments: ``gap`` [m], NaN for rules that need what
        is not given, and ``status``; along ``rule`` the coordinates ``reference``, ``mark`` (S: seen in
        a copy of the source; P: printed in the paper; M: from memory, unverified), ``assumptions``
        and ``missing``: what was needed and not given.

    Raises
    ------
    ValueError, TypeError
        If the zone is unknown, a scalar is out of range, a value is not a number, or dimensions do
        not fit.

    Notes
    -----
    A summary of one clause each, for comparison: no substitute for the code.

    References
    ----------
    The coordinate ``reference``.

    Examples
    --------
    >>> import stochlin as sl
    >>> table = sl.code_gaps(0.03, 0.04, floors_align=True)
    >>> round(float(table.gap.sel(rule="eurocode_8")), 6)
    0.035
    >>> table.missing.sel(rule="peru_e030").item()
    'height_1, height_2'
    """
    check_zone(zone)
    check_truth("floors_align", floors_align)
    pair = BuildingPeaks(peak_1, peak_2, height_1, height_2)
    valid = pair.valid()
    values = {name: array.where(valid) for name, array in pair.arrays().items()}
    given = {*values, *(() if zone is None else ("zone",))}
    rules = [code_rule(name) for name in code_rule_names()]
    missing = [", ".join(n for n in rule.needs if n not in given) for rule in rules]
    nothing = xr.full_like(valid, np.nan, float)
    gaps = [
        nothing if lacks else rule.gap(**values, floors_align=bool(floors_align), zone=zone)
        for rule, lacks in zip(rules, missing, strict=True)
    ]
    dimension = xr.DataArray([rule.name for rule in rules], dims="rule", name="rule")
    dimension.attrs["long_name"] = "rule"
    gap = xr.concat(
        [xr.broadcast(g, valid)[0] for g in gaps], dim=dimension, coords="minimal", compat="override"
    )
    usable = valid & xr.DataArray([not lacks for lacks in missing], dims="rule")
    table = xr.Dataset({"gap": gap, "status": labels.status_where(usable).transpose(*gap.dims)})
    for name, text in TEXTS.items():
        told = missing if name == "missing" else [getattr(rule, name) for rule in rules]
        table = table.assign_coords({name: ("rule", told, {"long_name": text})})
    table = labels.label(table, VARIABLES)
    table.attrs["comment"] = "Rules whose mark has an M are from memory, not compared with the source."
    return labels.with_run_information(
        table,
        "Separation by the rules of building codes",
        f"code_gaps(floors_align={bool(floors_align)}, zone={zone!r})",
        {"pair": pair},
        "; ".join(dict.fromkeys(rule.reference for rule in rules)),
    )
