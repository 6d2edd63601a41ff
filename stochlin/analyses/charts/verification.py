"""Linearized design charts together with the drift closure, effective rules and simulation."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.charts.rules import along_rules
from stochlin.analyses.charts.settings import (
    DRIFT_CLOSURE,
    ELASTIC,
    LINEARIZATION,
    SIMULATION,
    ChartSettings,
)
from stochlin.analyses.charts.variables import VARIABLES
from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.models.grounds import Ground
from stochlin.models.rules.effective_properties import EFFECTIVE_RULES
from stochlin.models.structures import DRIFT, Structure

USUAL_RULES = ("penzien_1997", "iwan_1980")  # derived, and fitted to records
DRIFT_SHARE = 0.02  # share of the drift closure in the time for it and for the simulations
BESIDE = ("_drift", "_simulated", "_of_peaks")  # endings of what can be drawn without linearization
Pair = tuple[Structure, Structure]
Place = dict[str, slice]  # cells of a chart


def with_rules(chart: xr.Dataset, pair: Pair, ground: Ground, settings: ChartSettings) -> xr.Dataset:
    """A chart of ``rho`` with ``rho_effective`` over ``rule``, and with its peak ductilities.

    The peak ductilities are those for the reduction factor of the chart: the peak factor times the
    standard deviation of the ductility by the drift closure, whose bias is small.
    """
    rules = [rule for rule in settings.rules(USUAL_RULES) if rule.name != ELASTIC]  # that is eq. (4)
    chart.attrs["comparison"] = "compared_curves"
    if not rules:
        return labels.label(chart, VARIABLES)
    tables = []
    for rule in rules:
        table = correlate(*pair, ground, "effective", closure=DRIFT, rule=rule)
        ductilities = [table[f"ductility_peak_{n}"] for n in (1, 2)]
        fitted = [ductility <= rule.largest_ductility for ductility in ductilities]
        tables.append(table[["rho"]].where(fitted[0] & fitted[1]).rename(rho="rho_effective"))
    effective = along_rules(tables, rules)
    chart = chart.assign(rho_effective=effective.rho_effective.transpose("rule", *chart.rho.dims))
    chart = chart.assign({str(ductility.name): ductility for ductility in ductilities})
    caption = (
        f"{chart.attrs['caption']}\nEffective properties: eq. (4) at the peak ductilities of the same "
        "R, 3 σu/uy by drift closure, as far as a rule was fitted"
    )
    sources = "; ".join([chart.attrs["references"], *(rule.reference for rule in rules)])
    attrs = {"caption": caption, "plain_caption": chart.attrs["caption"], "references": sources}
    return labels.label(chart.assign_attrs(attrs), VARIABLES)


def with_truth(
    chart: xr.Dataset,
    pair: Pair,
    ground: Ground,
    settings: ChartSettings,
    usual_points: int,
    progress: Progress,
) -> xr.Dataset:
    """A chart of ``rho`` with the drift closure and, at some points, nonlinear simulation.

    The number of simulated points along an axis is that of the settings or else ``usual_points``;
    ``rho_simulated``, ``rho_standard_error`` and ``rho_difference`` are NaN between them. Simulations
    that would take too long are left out, which the comment states. ``progress`` is called with the
    share of this work that is done.
    """
    if settings.draws(DRIFT_CLOSURE) and settings.closure != DRIFT:
        drift = correlate(*pair, ground, closure=DRIFT).rho
        chart = chart.assign(rho_drift=drift.transpose(*chart.rho.dims))
        chart.attrs["comparison"] = f"compared_{chart.attrs['chart']}"
    progress(DRIFT_SHARE)
    points = settings.simulated_points if settings.draws(SIMULATION) else 0
    if count := usual_points if points is None else points:
        runs = part_of(progress, DRIFT_SHARE, 1.0)
        simulated, refused = _simulated(chart.rho, pair, ground, settings, count, runs)
        if bool(simulated.rho.notnull().any()):
            chart = _beside(chart, simulated, settings.paths)
            comment = chart.attrs["comment"]
            chart.attrs["plain_comment"] = " ".join([comment, _errors(chart, plain=True), *refused])
            refused = [_errors(chart), *refused]
        chart = chart.assign_attrs(comment=" ".join([chart.attrs["comment"], *refused]))
    return labels.label(chart, VARIABLES)


def left_out(chart: xr.Dataset, settings: ChartSettings) -> xr.Dataset:
    """A chart without the linearized curve, if it is not wanted."""
    if settings.draws(LINEARIZATION):
        return chart
    names = [name for name in chart if name in ("rho", "rho_difference", "amplification")]
    if not any(str(name).endswith(BESIDE) for name in chart):
        raise ValueError(
            f"curves = {', '.join(settings.curves or ())} leaves nothing to draw; allowed: also "
            f"{LINEARIZATION}, {SIMULATION} or {DRIFT_CLOSURE}"
        )
    return chart.drop_vars(names)


def _beside(chart: xr.Dataset, simulated: xr.Dataset, paths: int) -> xr.Dataset:
    """A chart with the simulated ``rho``, its standard error, and the difference from it."""
    chart["rho_simulated"] = simulated.rho.assign_attrs(chart.rho.attrs)
    chart["rho_standard_error"] = simulated.rho_standard_error
    chart["rho_difference"] = chart.rho - simulated.rho
    largest = float(simulated.rho_standard_error.max())
    comment = f"Simulated on {paths} paths; standard error at most {largest:.2g}."
    kind = f"compared_{chart.attrs['chart']}"
    return labels.label(chart, VARIABLES).assign_attrs(comparison=kind, comment=comment)


def _simulated(
    rho: xr.DataArray,
    pair: Pair,
    ground: Ground,
    settings: ChartSettings,
    count: int,
    progress: Progress,
) -> tuple[xr.Dataset, list[str]]:
    """Simulated ``rho`` and its standard error at ``count`` points of an axis, and refused runs.

    The values are NaN between these points.
    """
    names = ("rho", "rho_standard_error")
    table = xr.Dataset({name: xr.full_like(rho, np.nan) for name in names})
    refused: dict[str, str] = {}
    options: Any = {"paths": settings.paths, "seed": settings.seed}
    runs = list(_runs(rho, count))
    for number, place in enumerate(runs):
        first, second = (structure.isel(place) for structure in pair)
        part = part_of(progress, number / len(runs), (number + 1) / len(runs))
        part(0.0)
        try:
            correlation = correlate(first, second, ground, "simulation", **options, progress=part)
        except ValueError as error:  # the arguments were checked before, so that it would take too long
            strength = rho.isel(place).coords.get("reduction_factor", [])
            where = "".join(f" at R = {factor:g}" for factor in np.asarray(strength))
            refused[where] = f"Not all is simulated{where}: {str(error).split(';')[0]}."
            continue
        for name in names:
            table[name][place] = correlation[name].transpose(*rho.dims).values
            table[name].attrs = correlation[name].attrs
    return table, list(refused.values())


def _runs(rho: xr.DataArray, count: int) -> Iterator[Place]:
    """Groups of cells that are simulated together.

    The longest memory of a group determines the duration of its simulation, and the shortest period its
    time step. Each reduction factor and each half of a curve is therefore a group.
    """
    axes = []
    for dim in map(str, rho.dims):
        size = rho.sizes[dim]
        if dim == "reduction_factor":
            axes.append([{dim: slice(n, n + 1)} for n in range(size)])
            continue
        step = max(1, round((size - 1) / (count - 1)))
        middle = step * -(-size // (2 * step))
        parts = [slice(0, None, step)]
        if "reduction_factor" in rho.dims and middle < size:
            parts = [slice(0, middle, step), slice(middle, None, step)]
        axes.append([{dim: part} for part in parts])
    for chosen in product(*axes):
        yield {dim: cells for place in chosen for dim, cells in place.items()}


def _errors(chart: xr.Dataset, *, plain: bool = False) -> str:
    """Text with the errors of all curves, or of those of the plain picture, compared with simulation."""
    curves = {"linearized": chart.rho}
    if "rho_drift" in chart and not plain:
        curves["drift closure"] = chart.rho_drift
    if "rho_effective" in chart and not plain:
        for name in chart.rule.values.tolist():
            known = EFFECTIVE_RULES.get(name)
            curves[known.published_name() if known else name] = chart.rho_effective.sel(rule=name)
    off = {name: np.abs(curve - chart.rho_simulated) for name, curve in curves.items()}
    errors = [
        f"{name} {float(difference.mean()):.2g} ({float(difference.max()):.2g})"
        for name, difference in off.items()
        if bool(difference.notnull().any())
    ]
    return f"Mean (largest) error: {'; '.join(errors)}."
