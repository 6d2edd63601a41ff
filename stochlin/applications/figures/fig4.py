"""Fig. 4: rho of two bilinear structures over their period ratio, beside other methods.

The text of the paper does not state the damping, the hardening and the period of the ground of
Figs. 4 and 5. They are settings, and stated in each dataset. Only ratios of periods matter, so that
the period of the ground is arbitrary.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial, reduce
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.figures.charts import (
    DRIFT_MEMORY,
    LONGEST_MEMORY,
    SIMULATED_INTENSITY,
    USUAL_SETTINGS,
    ChartSettings,
    design_motion,
    is_slow,
    register_chart,
)
from stochlin.applications.figures.fig3 import ratio_axis
from stochlin.applications.records.gaps import recorded_gap
from stochlin.models.arguments import checked
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT
from stochlin.solver.correlation.correlation import correlate
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.simulation.ground_motions import simulated_motions
from stochlin.solver.tables import labels

SIMULATED_ON_CURVE = 21  # along a curve
STEPS_PER_GROUND_PERIOD = 100  # in a period of the ground, of the finite motions
RHO_SIMULATED = "rho_simulated"
IN_MOTIONS = "rho_in_motions"
ERROR = "rho_standard_error"
YIELDING_RHO_VARIABLES = {
    "rho": ("1", "correlation coefficient ρ"),
    "rho_drift": ("1", "ρ by the drift closure"),
    "rho_elastic": ("1", "ρ of elastic structures, this ground"),
    "rho_white_noise": ("1", "ρ of elastic structures, eq. (4)"),
    RHO_SIMULATED: ("1", "ρ, simulated"),
    IN_MOTIONS: ("1", "ρ in motions"),
    f"{IN_MOTIONS}_standard_error": ("1", "standard error of the mean ρ in motions"),
    DRIFT_MEMORY: ("s", "relaxation time of the slower plastic drift of the pair"),
}
Pair = tuple[Bilinear, Bilinear]
Place = dict[str, slice]  # cells of a chart


@checked
def period_ratio_chart(
    settings: ChartSettings = USUAL_SETTINGS,
    ground: Ground | None = None,
    frequency_ratio: float = 1.0,
) -> xr.Dataset:
    """Fig. 4: rho over ``T1/T2`` for a fixed frequency ``w2 = frequency_ratio wg`` of structure 2.

    Parameters
    ----------
    settings : ChartSettings, optional
        Parameters of the charts.
    ground : KanaiTajimi or CloughPenzien, optional
        The ground, of one period; parameters over ``ground`` are several, with a panel for each.
        The default is that of the settings.
    frequency_ratio : float
        Frequency of structure 2 over that of the ground [-].

    Returns
    -------
    xarray.Dataset
        ``rho`` and ``status`` over (``reduction_factor``, ``period_ratio``), and over ``ground``
        for several; ``rho_elastic``, on the same ground, and ``rho_white_noise``, eq. (4), over
        ``period_ratio``; and ``rho_drift`` by the drift closure. NaN between the simulated points:
        the stationary ``rho_simulated`` with ``rho_standard_error``; ``drift_memory`` [s], the
        relaxation time of the slower plastic drift; and where it is above the attribute
        ``longest_memory_s``, ``rho_in_motions`` with its standard error, the mean of the
        correlation coefficients in single motions from rest.

    Raises
    ------
    ValueError
        If simulations would take too long, as for structures that hardly ever yield.

    Examples
    --------
    >>> import stochlin as sl
    >>> from stochlin.charts import ChartSettings, period_ratio_chart
    >>> settings = ChartSettings(points=5, simulated_points=0)
    >>> chart = period_ratio_chart(settings, sl.KanaiTajimi(2.0, 0.05), frequency_ratio=1.0)
    >>> chart.rho.dims
    ('reduction_factor', 'period_ratio')
    """
    ground = settings.ground if ground is None else ground
    second_period = ground_period(ground) / frequency_ratio
    ratio = ratio_axis(settings.fine_points)
    factors = reduction_factors(settings)
    first_period = ratio * second_period
    damping = settings.damping
    elastic: Pair = Bilinear(first_period, damping), Bilinear(second_period, damping)
    first = bilinear(settings, first_period, factors)
    second = bilinear(settings, second_period, factors)
    chart = correlate(first, second, ground, bias=False)[["rho", "status"]]
    chart = chart.transpose(..., "reduction_factor", "period_ratio")
    chart["rho_elastic"] = correlate(*elastic, ground, bias=False).rho
    chart["rho_white_noise"] = correlate(*elastic, ground, "white_noise").rho
    chart = with_truth(chart, (first, second), ground, settings, _groups(settings, ratio.size))
    if RHO_SIMULATED in chart:
        chart = _with_motions(chart, (first, second), ground, settings)
    chart = chart.transpose("ground", "reduction_factor", "period_ratio", missing_dims="ignore")
    times = "" if frequency_ratio == 1 else f"{frequency_ratio:g} "
    title = f"Stationary correlation of bilinear structures, ω2 = {times}ωg"
    where = f"; T2 = {second_period:.3g} s"
    pictures = {"chart": "curves", "comparison": "compared_curves", "beside": "rho_drift"}
    chart.attrs |= words(settings, ground, title, where, **pictures)
    return with_errors(chart, "rho", [RHO_SIMULATED, IN_MOTIONS], settings)


for _letter, _ratio in (("a", 0.5), ("b", 1.0), ("c", 2.0)):
    register_chart(f"fig4{_letter}", place=40)(partial(period_ratio_chart, frequency_ratio=_ratio))


def _groups(settings: ChartSettings, size: int) -> list[Place]:
    """The simulated points of Fig. 4, those that are simulated together in a group.

    The longest memory of a group determines the duration of its simulation, and the shortest period
    its time step: each reduction factor and each half of a curve is a group.
    """
    step = simulated_step(settings, size, SIMULATED_ON_CURVE)
    if not step:
        return []
    middle = step * -(-size // (2 * step))
    halves = slice(0, middle, step), slice(middle, None, step)
    rows = [slice(n, n + 1) for n in range(len(settings.reduction_factors))]
    return [{"reduction_factor": row, "period_ratio": half} for row in rows for half in halves]


def with_truth(
    chart: xr.Dataset, pair: Pair, ground: Ground, settings: ChartSettings, places: Iterable[Place]
) -> xr.Dataset:
    """A chart of ``rho`` with the drift closure and, at some places, nonlinear simulation."""
    drift = correlate(*pair, ground, closure=DRIFT, bias=False).rho
    chart["rho_drift"] = drift.transpose(*chart.rho.dims)
    options: Any = {"paths": settings.paths, "seed": settings.seed}
    tables = []
    for place in places:
        first, second = pair
        table = correlate(first.isel(place), second.isel(place), ground, "simulation", **options)
        table[DRIFT_MEMORY] = np.maximum(table[f"{DRIFT_MEMORY}_1"], table[f"{DRIFT_MEMORY}_2"])
        tables.append(table[["rho", ERROR, DRIFT_MEMORY]].rename(rho=RHO_SIMULATED))
    chart = labels.label(with_points(chart, tables), YIELDING_RHO_VARIABLES)
    if tables:
        chart[RHO_SIMULATED].attrs["ancillary_variables"] = f"{ERROR} {DRIFT_MEMORY}"
    chart.rho.attrs["curve_label"] = "ρ, linearized"
    return chart.assign_attrs(longest_memory_s=LONGEST_MEMORY * ground_period(ground))


def with_points(chart: xr.Dataset, tables: Sequence[xr.Dataset]) -> xr.Dataset:
    """A chart with the variables of these tables of some of its cells, NaN in all others."""
    if not tables:
        return chart
    points = reduce(xr.Dataset.combine_first, tables).reindex_like(chart)
    return chart.merge(points.transpose(*chart.status.dims))


def _with_motions(
    chart: xr.Dataset, pair: Pair, ground: Ground, settings: ChartSettings
) -> xr.Dataset:
    """A chart with the mean correlation in finite motions where the drift has a long memory."""
    period = ground_period(ground)
    error = f"{IN_MOTIONS}_standard_error"
    duration, envelope = design_motion(period)
    motion: Any = {
        "paths": max(2, settings.paths),
        "seed": settings.seed,
        "step": period / STEPS_PER_GROUND_PERIOD,
    }
    strong: dict[str, Any] = {"intensity": SIMULATED_INTENSITY}
    step = simulated_step(settings, chart.sizes["period_ratio"], SIMULATED_ON_CURVE)
    columns = {"period_ratio": slice(None, None, step)}
    tables = []
    for number in range(chart.sizes.get("ground", 1)):
        soil = replace(ground, **strong).isel({"ground": number})
        first = strength_in_metres(pair[0].isel(columns), soil)
        second = strength_in_metres(pair[1].isel(columns), soil)
        motions = simulated_motions(soil, duration, envelope, **motion)
        rho = recorded_gap(first, second, list(motions)).rho
        spread = rho.std("record", ddof=1) / np.sqrt(rho.sizes["record"])
        tables.append(xr.Dataset({IN_MOTIONS: rho.mean("record"), error: spread}))
    table = xr.concat(tables, chart.ground) if "ground" in chart.dims else tables[0]
    chart = labels.label(with_points(chart, [table.where(is_slow(chart))]), YIELDING_RHO_VARIABLES)
    name = f"ρ in motions of {duration:.3g} s"
    chart[IN_MOTIONS].attrs |= {"ancillary_variables": error, "long_name": name}
    return chart


def with_errors(
    chart: xr.Dataset, name: str, points: Sequence[str], settings: ChartSettings
) -> xr.Dataset:
    """A chart of this variable that states its errors against simulation, or else the caution.

    They are without those points whose drift is slow, which are not those of motions of finite
    length.
    """
    chart.attrs |= {"shows": name, "points": " ".join(point for point in points if point in chart)}
    of_rho = name == "rho"
    if f"{name}_simulated" not in chart:
        return chart.assign_attrs(comment=labels.CAUTION_RHO if of_rho else labels.CAUTION_SIGMA)
    simulated = chart[f"{name}_simulated"].where(~is_slow(chart))
    texts = []
    for method, values in (("linearized", chart[name]), ("drift closure", chart[f"{name}_drift"])):
        off = abs(values - simulated) / (1.0 if of_rho else simulated)
        means_and_largest = (np.atleast_1d(of(simulated.dims[-2:])) for of in (off.mean, off.max))
        of_grounds = zip(bands(chart), *means_and_largest, strict=True)
        shown = (f"{band}{mean:.2g} ({most:.2g})" for band, mean, most in of_grounds)
        texts.append(f"{method} {', '.join(shown)}")
    comment = (
        f"Mean (largest) {'' if of_rho else 'relative '}error against simulation on "
        f"{settings.paths} paths, where plastic drifts relax within "
        f"{chart.longest_memory_s:.3g} s: {'; '.join(texts)}. "
        f"{'Bars: 95 % intervals' if 'reduction_factor' in chart.dims else 'White: slower ones'}."
    )
    return chart.assign_attrs(comment=comment)


def bands(chart: xr.Dataset) -> list[str]:
    """The grounds of a chart in a word each, before a number; nothing for one ground."""
    if "ground" not in chart.dims:
        return [""]
    return [f"{str(name).partition(',')[0]} " for name in chart.ground.values]


def ground_period(ground: Ground) -> float:
    """Period ``Tg`` [s] of a ground."""
    return float(ground.arrays()["period"])


def reduction_factors(settings: ChartSettings) -> xr.DataArray:
    """Reduction factors of the curves."""
    return labels.axis("reduction_factor", "reduction factor", list(settings.reduction_factors))


def bilinear(settings: ChartSettings, period: Any, reduction_factor: Any) -> Bilinear:
    """Structures of the settings."""
    return Bilinear(period, settings.damping, settings.hardening, reduction_factor=reduction_factor)


def simulated_step(settings: ChartSettings, size: int, usual: int) -> int:
    """The step from a simulated point to the next along a curve or an axis; 0 for none."""
    count = usual if settings.simulated_points is None else settings.simulated_points
    return max(1, round((size - 1) / (count - 1))) if count else 0


def words(
    settings: ChartSettings,
    ground: Ground,
    title: str,
    where: str = "",
    about: str = "linearized, Gaussian closure",
    **pictures: str,
) -> dict[str, str]:
    """Words and pictures of a chart of bilinear structures, which is the same for any intensity."""
    values = {
        name: np.unique(array) for name, array in ground.cells().items() if name != "intensity"
    }
    stated = ", ".join(
        f"{name.replace('_', ' ')} {' and '.join(f'{value:.3g}' for value in several)}"
        f"{' s' * (ground.units(name) == 's')}"
        for name, several in values.items()
    )
    caption = (
        f"{ground.name} ground, {stated}{where}\nBilinear structures: ξ = {settings.damping:g}, "
        f"α = {settings.hardening:g}, R = 3 σel/uy; {about}"
    )
    return {"title": title, "caption": caption, **pictures}
