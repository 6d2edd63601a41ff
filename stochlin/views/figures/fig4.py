"""Fig. 4: rho of two bilinear structures over their period ratio, beside other methods.

The text of the paper does not state the damping, the hardening and the period of the ground of Figs. 4
and 5. They are settings, and stated in each dataset. Only ratios of periods matter, so that the period
of the ground is arbitrary.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.tables import labels
from stochlin.models.arguments import checked
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT, Structure
from stochlin.views.figures.charts import GROUND, ChartInputs, ground_caption, register_chart
from stochlin.views.figures.fig3 import along_rules, ratio_axis
from stochlin.views.figures.settings import ChartSettings, chosen_rules

USUAL_RULES = ("penzien_1997", "iwan_1980")  # derived, and fitted to records
SIMULATED_POINTS = 21  # along a curve
VARIABLES = {
    "rho": ("1", "correlation coefficient ρ"),
    "rho_drift": ("1", "correlation coefficient of the displacements by the drift closure"),
    "rho_elastic": ("1", "correlation coefficient of elastic structures on this ground"),
    "rho_white_noise": ("1", "correlation coefficient of elastic structures by eq. (4)"),
    "rho_effective": ("1", "correlation coefficient by eq. (4) with effective properties"),
    "rho_simulated": ("1", "ρ, simulated"),
    "rho_difference": ("1", "ρ, linearized minus simulated"),
}
Grounds = Ground | Mapping[str, Ground]
Pair = tuple[Structure, Structure]
Place = dict[str, slice]  # cells of a chart


for _letter, _ratio in (("a", 0.5), ("b", 1.0), ("c", 2.0)):

    def _fig4(inputs: ChartInputs, frequency_ratio: float = _ratio) -> xr.Dataset:
        return period_ratio_chart(inputs.settings, inputs.grounds, frequency_ratio)

    register_chart(f"fig4{_letter}", GROUND, place=40)(_fig4)


@checked
def period_ratio_chart(settings: ChartSettings, ground: Grounds, frequency_ratio: float) -> xr.Dataset:
    """Fig. 4: rho over ``T1/T2`` for a fixed frequency ``w2 = frequency_ratio wg`` of structure 2.

    Parameters
    ----------
    settings : ChartSettings
        Parameters of the charts.
    ground : KanaiTajimi or CloughPenzien, or mapping of them
        The ground, with scalar parameters; or several of one period, by the titles of their panels.
    frequency_ratio : float
        Frequency of structure 2 over that of the ground [-].

    Returns
    -------
    xarray.Dataset
        ``rho`` and ``status`` over (``reduction_factor``, ``period_ratio``), and over ``ground`` for
        several; ``rho_elastic``, on the same ground, and ``rho_white_noise``, eq. (4), over
        ``period_ratio``. It also has ``rho_drift`` by the drift closure; ``rho_effective`` over
        ``rule``, eq. (4) with effective properties for the peak ductilities ``ductility_peak_1`` and
        ``_2`` of the same reduction factor; and ``rho_simulated`` with ``rho_standard_error`` and
        ``rho_difference`` (linearized minus simulated), NaN between the simulated points.

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
    grounds = by_title(ground)
    second_period = ground_period(grounds) / frequency_ratio
    chart = on_grounds(partial(_on_ground, settings, second_period), grounds)
    times = "" if frequency_ratio == 1 else f"{frequency_ratio:g} "
    title = f"Stationary correlation of bilinear structures, ω2 = {times}ωg"
    chart.attrs |= words(settings, grounds, title, f"; T2 = {second_period:.3g} s")
    chart.attrs["comparison_caption"] = (
        "Effective properties: eq. (4) at the peak ductilities of the same R, 3 σu/uy by drift closure, "
        "as far as a rule was fitted"
    )
    return with_errors(chart.assign_attrs(chart="curves", comparison="compared_curves"), settings)


def _on_ground(settings: ChartSettings, second_period: float, ground: Ground) -> xr.Dataset:
    """The chart of one ground, without its words."""
    ratio, factors = ratio_axis(settings.fine_points), reduction_factors(settings)
    periods = (ratio * second_period, second_period)
    first, second = (bilinear(settings, period, factors) for period in periods)
    elastic_1, elastic_2 = (Bilinear(period, settings.damping) for period in periods)
    chart = correlate(first, second, ground, closure=settings.closure, bias=False)[["rho", "status"]]
    chart = chart.transpose("reduction_factor", "period_ratio")
    chart["rho_elastic"] = correlate(elastic_1, elastic_2, ground, bias=False).rho
    chart["rho_white_noise"] = correlate(elastic_1, elastic_2, ground, "white_noise").rho
    chart = _with_rules(chart, (first, second), ground, settings.curves or USUAL_RULES)
    size, places = ratio.size, []
    if count := number_of_points(settings, SIMULATED_POINTS):
        # The longest memory of a group determines the duration of its simulation, and the shortest
        # period its time step: each reduction factor and each half of a curve is a group.
        step = max(1, round((size - 1) / (count - 1)))
        middle = step * -(-size // (2 * step))
        halves = slice(0, middle, step), slice(middle, None, step)
        rows = [slice(n, n + 1) for n in range(factors.size)]
        places = [{"reduction_factor": row, "period_ratio": half} for row in rows for half in halves]
    return with_truth(chart, (first, second), ground, settings, places)


def _with_rules(chart: xr.Dataset, pair: Pair, ground: Ground, names: Iterable[str]) -> xr.Dataset:
    """A chart of ``rho`` with ``rho_effective`` over ``rule``, and with its peak ductilities.

    The peak ductilities are those for the reduction factor of the chart: the peak factor times the
    standard deviation of the ductility by the drift closure, whose bias is small.
    """
    rules = [rule for rule in chosen_rules("curves", names) if rule.name != "elastic"]  # eq. (4)
    tables = []
    for rule in rules:
        table = correlate(*pair, ground, "effective", closure=DRIFT, rule=rule)
        ductilities = [table[f"ductility_peak_{n}"] for n in (1, 2)]
        fitted = [ductility <= rule.largest_ductility for ductility in ductilities]
        tables.append(table[["rho"]].where(fitted[0] & fitted[1]).rename(rho="rho_effective"))
    if not rules:
        return chart
    effective = along_rules(tables, rules).rho_effective.transpose("rule", *chart.rho.dims)
    sources = "; ".join([chart.attrs["references"], *(rule.reference for rule in rules)])
    chart = chart.assign({str(ductility.name): ductility for ductility in ductilities})
    return chart.assign(rho_effective=effective).assign_attrs(references=sources)


def with_truth(
    chart: xr.Dataset, pair: Pair, ground: Ground, settings: ChartSettings, places: Iterable[Place]
) -> xr.Dataset:
    """A chart of ``rho`` with the drift closure and, at some places, nonlinear simulation.

    ``rho_simulated``, ``rho_standard_error`` and ``rho_difference`` are NaN elsewhere.
    """
    if settings.closure != DRIFT:
        drift = correlate(*pair, ground, closure=DRIFT, bias=False).rho
        chart["rho_drift"] = drift.transpose(*chart.rho.dims)
    options: Any = {"paths": settings.paths, "seed": settings.seed}
    for place in places:
        first, second = (structure.isel(place) for structure in pair)
        table = correlate(first, second, ground, "simulation", **options)
        for name, source in (("rho_simulated", "rho"), ("rho_standard_error", "rho_standard_error")):
            if name not in chart:
                chart[name] = xr.full_like(chart.rho, np.nan).assign_attrs(table[source].attrs)
            chart[name][place] = table[source].transpose(*chart.rho.dims).values
    if "rho_simulated" in chart:
        chart["rho_difference"] = chart.rho - chart.rho_simulated
    chart = labels.label(chart, VARIABLES)
    chart.rho.attrs["curve_label"] = "ρ, linearized"
    return chart


def with_errors(chart: xr.Dataset, settings: ChartSettings) -> xr.Dataset:
    """A chart of ``rho`` that states its errors against simulation, or else the caution."""
    chart.attrs["shows"] = "rho"
    if "rho_simulated" not in chart:
        return chart.assign_attrs(comment=labels.CAUTION_RHO)
    chart.rho_simulated.attrs["ancillary_variables"] = "rho_standard_error"
    named = {"rho": "linearized", "rho_drift": "drift closure"}

    def errors(part: xr.Dataset) -> str:
        off = {text: np.abs(part[n] - part.rho_simulated) for n, text in named.items() if n in part}
        texts = [
            f"{text} {float(each.mean()):.2g} ({float(each.max()):.2g})" for text, each in off.items()
        ]
        return (
            f"Simulated on {settings.paths} paths; standard error at most "
            f"{float(part.rho_standard_error.max()):.2g}. Mean (largest) error: {'; '.join(texts)}."
        )

    return chart.assign_attrs(points="rho_simulated", comment=for_each_ground(chart, errors))


def for_each_ground(chart: xr.Dataset, text: Callable[[xr.Dataset], str]) -> str:
    """A text on each ground of a chart, after its name if there are several."""
    if "ground" not in chart.dims:
        return text(chart)
    names = chart.ground.values.tolist()
    begun = [name if name[0] == "ξ" else f"{name[0].upper()}{name[1:]}" for name in names]
    return "\n".join(
        f"{head}: {text(chart.sel(ground=name))}" for head, name in zip(begun, names, strict=True)
    )


def on_grounds(compute: Callable[[Ground], xr.Dataset], grounds: Mapping[str, Ground]) -> xr.Dataset:
    """A chart of one ground, or those of several joined over ``ground``."""
    first, *others = tables = [compute(ground) for ground in grounds.values()]
    if not others:
        return first
    axis = xr.DataArray(list(grounds), dims="ground", name="ground", attrs={"long_name": "ground"})
    how: Any = {"data_vars": "all", "coords": "minimal", "compat": "override", "join": "exact"}
    return xr.concat(tables, axis, combine_attrs="drop_conflicts", **how)


def by_title(ground: Grounds) -> Mapping[str, Ground]:
    """Grounds by the titles of their panels; a single one needs no title."""
    return ground if isinstance(ground, Mapping) else {"": ground}


def ground_period(grounds: Mapping[str, Ground]) -> float:
    """Period ``Tg`` [s] of grounds."""
    return float(next(iter(grounds.values())).arrays()["period"])


def reduction_factors(settings: ChartSettings) -> xr.DataArray:
    """Reduction factors of the curves."""
    return labels.axis("reduction_factor", "reduction factor", list(settings.reduction_factors))


def bilinear(settings: ChartSettings, period: Any, reduction_factor: Any) -> Bilinear:
    """Structures of the settings."""
    return Bilinear(period, settings.damping, settings.hardening, reduction_factor=reduction_factor)


def number_of_points(settings: ChartSettings, usual: int) -> int:
    """Number of simulated points along a curve or an axis."""
    return usual if settings.simulated_points is None else settings.simulated_points


def words(
    settings: ChartSettings, grounds: Mapping[str, Ground], title: str, where: str = ""
) -> dict[str, str]:
    """Title and caption of a chart of linearized structures."""
    closure = settings.closure.replace("gaussian", "Gaussian").replace("_", " ")
    caption = (
        f"{ground_caption(list(grounds.values()))}{where}\nBilinear structures: ξ = "
        f"{settings.damping:g}, α = {settings.hardening:g}, R = 3 σel/uy; linearized, {closure} closure"
    )
    return {"title": title, "caption": caption}
