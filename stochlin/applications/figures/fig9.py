"""Fig. 9: the required gap over the period ratio, in motions of finite length."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.applications.figures.charts import (
    SIMULATED_INTENSITY,
    USUAL_SETTINGS,
    ChartSettings,
    design_motion,
    register_chart,
)
from stochlin.applications.figures.fig4 import (
    bands,
    bilinear,
    ground_period,
    reduction_factors,
    simulated_step,
    with_points,
    words,
)
from stochlin.applications.separation.passage_gap import passage_gap
from stochlin.applications.separation.separation import separation
from stochlin.models.arguments import checked
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.solver.linearization.linearization import linearize
from stochlin.solver.tables import labels

if TYPE_CHECKING:
    pass

# first and last period of the stiffer structure, over that of the other
STIFFER_RATIOS = (0.1, 0.95)
SIMULATED_GAPS = 11  # along a curve
REPEATED = 32  # times the motions of other charts, since a quantile needs more of them than a mean
CONFIDENCE = 0.9
GAP = "required_gap"
SOURCES = (
    "The drift closure simulates nothing; eq. (3) and SRSS combine simulated peaks of both "
    "structures"
)
PEAK_RULES = {  # of `separation`, which combine simulated peaks, each with its name in the picture
    "eq_3_drift": "eq. (3), ρ with drift",
    "eq_3_linearized": "eq. (3), ρ linearized",
    "srss": "SRSS",
}
GAP_VARIABLES = {
    GAP: ("1", "required gap over σel of structure 2"),
    f"{GAP}_simulated": ("1", "simulated gap over σel"),
    f"{GAP}_simulated_lower": ("1", "lower end of the 95 % interval of the simulated gap over σel"),
    f"{GAP}_simulated_upper": ("1", "upper end of the 95 % interval of the simulated gap over σel"),
    **{f"{GAP}_{rule}": ("1", f"gap over σel by {name}") for rule, name in PEAK_RULES.items()},
}
GAP_METHODS = {
    GAP: "drift closure in time",
    **{f"{GAP}_{rule}": name for rule, name in PEAK_RULES.items()},
}


@register_chart("fig9", place=70)
@checked
def required_gap_chart(
    settings: ChartSettings = USUAL_SETTINGS,
    ground: Ground | None = None,
    frequency_ratio: float = 2.0,
) -> xr.Dataset:
    """Fig. 9: gap for 90 % over ``T1/T2`` for a fixed frequency ``w2 = frequency_ratio wg``.

    The gap is that of `stochlin.passage_gap` in motions of finite length, with the stiffer
    structure on the left, beside simulation and rules that combine simulated peaks. It is divided
    by the standard deviation of structure 2 as elastic, so that it is the same for any intensity.

    Parameters
    ----------
    settings : ChartSettings, optional
        Parameters of the charts. There are 32 times as many motions as their ``paths``.
    ground : KanaiTajimi or CloughPenzien, optional
        The ground, of one period; parameters over ``ground`` are several, with panels for each. The
        default is that of the settings.
    frequency_ratio : float
        Frequency of structure 2 over that of the ground [-].

    Returns
    -------
    xarray.Dataset
        ``required_gap`` [-] with ``caution`` and ``status`` over (``reduction_factor``,
        ``period_ratio``), and over ``ground`` for several. NaN between the simulated points:
        ``required_gap_simulated`` with its 95 % interval, ``_lower`` and ``_upper``; and with the
        simulated peaks ``required_gap_srss``, and ``required_gap_eq_3_drift`` and
        ``_eq_3_linearized``, eq. (3) with ``rho`` of these closures.

    Examples
    --------
    >>> import stochlin as sl
    >>> from stochlin.charts import ChartSettings, required_gap_chart
    >>> settings = ChartSettings(points=5, simulated_points=0)
    >>> chart = required_gap_chart(settings, sl.KanaiTajimi(2.0, 0.6))
    >>> chart.required_gap.dims
    ('reduction_factor', 'period_ratio')
    """
    ground = settings.ground if ground is None else ground
    period = ground_period(ground)
    second_period = period / frequency_ratio
    ratio = labels.axis(
        "period_ratio", "period ratio T1/T2", np.linspace(*STIFFER_RATIOS, settings.points)
    )
    factors = reduction_factors(settings)
    strong: dict[str, Any] = {"intensity": SIMULATED_INTENSITY}
    first = bilinear(settings, ratio * second_period, factors)
    second = bilinear(settings, second_period, factors)
    soil = replace(ground, **strong)
    duration, envelope = design_motion(period)
    motion: Any = {"duration": duration, "envelope": envelope, "confidence": CONFIDENCE}
    unit = linearize(Bilinear(second_period, settings.damping), soil).displacement_std
    chart = passage_gap(first, second, soil, **motion)[[GAP, "caution", "status"]]
    chart = chart.assign({GAP: chart[GAP] / unit})
    chart = chart.transpose("ground", "reduction_factor", "period_ratio", missing_dims="ignore")
    step = simulated_step(settings, settings.points, SIMULATED_GAPS)
    if step:
        motion |= {"paths": REPEATED * settings.paths, "seed": settings.seed}
        some = first.isel({"period_ratio": slice(None, None, step)})
        rules = separation(some, second, soil, **motion)
        chart = with_points(chart, [_by_rule(rules) / unit])
        chart.attrs["comment"] = _errors(chart, motion["paths"])
    times = "" if frequency_ratio == 1 else f"{frequency_ratio:g} "
    title = f"Required gap of bilinear structures in motions of {duration:.3g} s, ω2 = {times}ωg"
    where = f"; T2 = {second_period:.3g} s"
    about = "structure 1 is on the left"
    chart.attrs |= words(settings, ground, title, where, about, chart="required_gaps")
    of_motions = f"Motions of finite length from rest, {envelope.describe()}"
    chart.attrs["caption"] += (
        f"\n{of_motions}, for a confidence of {100 * CONFIDENCE:g} %\n{SOURCES}"
    )
    return labels.label(chart, GAP_VARIABLES)


def _by_rule(table: xr.Dataset) -> xr.Dataset:
    """The simulated gap with its interval, and the gaps by the rules [m]."""
    gaps = {f"{GAP}_{rule}": table.gap.sel(rule=rule) for rule in PEAK_RULES}
    for end in ("", "_lower", "_upper"):
        gaps[f"{GAP}_simulated{end}"] = table[f"gap{end}"].sel(rule="simulation")
    return xr.Dataset({name: gap.reset_coords(drop=True) for name, gap in gaps.items()})


def _errors(chart: xr.Dataset, paths: int) -> str:
    """The range of the errors of each method on each ground, and how often one has a caution."""
    simulated = chart[f"{GAP}_simulated"]
    texts = []
    for name, text in GAP_METHODS.items():
        off = 100 * (chart[name] / simulated - 1)
        ends = (np.atleast_1d(of(simulated.dims[-2:])) for of in (off.min, off.max))
        shown = (f"{low:+.0f} to {high:+.0f}" for low, high in zip(*ends, strict=True))
        texts.append(f"{text} {' and '.join(shown)}")
    of_grounds = " and ".join(map(str.strip, bands(chart)))
    on = of_grounds and f" on {of_grounds}"
    compared = simulated.notnull()
    flagged = int((compared & (chart.caution > 0)).sum())
    return (
        f"Errors in % against {paths} simulated motions{on}: {'; '.join(texts)}. The drift closure "
        f"has its caution at {flagged} of {int(compared.sum())} points. Bars: 95 % intervals."
    )
