"""Fig. 5: rho over both periods, and the amplification of the displacement by yielding."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.figures.charts import (
    DRIFT_MEMORY,
    LONGEST_MEMORY,
    USUAL_SETTINGS,
    ChartSettings,
    design_motion,
    register_chart,
)
from stochlin.applications.figures.fig4 import (
    RHO_SIMULATED,
    bilinear,
    ground_period,
    reduction_factors,
    simulated_step,
    with_errors,
    with_points,
    with_truth,
    words,
)
from stochlin.models.arguments import checked
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT
from stochlin.solver.correlation.amplification import amplification
from stochlin.solver.correlation.correlation import correlate
from stochlin.solver.tables import labels

GROUND_RATIOS = (0.1, 4.0)  # first and last period of an axis, over that of the ground
SIMULATED_ON_AXIS = 41  # along an axis of Fig. 5a
# intervals between simulated periods of Fig. 5b
STD_INTERVALS = 8
PEAK_INTERVALS = 32
# smallest reduction factor whose standard deviation is simulated within minutes
SLOWEST_DRIFT = 2.0
AMPLIFICATION_OF_MAXIMA = "amplification_of_peaks"
AMPLIFICATION_OF_STD = "amplification_simulated"
VALUE_AND_ERROR = "", "_standard_error"
AMPLIFICATION_VARIABLES = {
    "amplification": ("1", "amplification D, inelastic / elastic"),
    "amplification_drift": ("1", "D of standard deviations, drift closure"),
    AMPLIFICATION_OF_STD: ("1", "D of standard deviations, simulated"),
    AMPLIFICATION_OF_MAXIMA: ("1", "D of mean maxima, simulated"),
    f"{AMPLIFICATION_OF_MAXIMA}_standard_error": (
        "1",
        "standard error of the amplification of the mean peak",
    ),
    DRIFT_MEMORY: ("s", "relaxation time of the plastic drift"),
}


@register_chart("fig5a", place=50)
@checked
def period_plane_chart(
    settings: ChartSettings = USUAL_SETTINGS, ground: Ground | None = None
) -> xr.Dataset:
    """Fig. 5a: rho over ``T1/Tg`` and ``T2/Tg``.

    Parameters
    ----------
    settings : ChartSettings, optional
        Parameters of the charts.
    ground : KanaiTajimi or CloughPenzien, optional
        The ground, of one period; parameters over ``ground`` are several, with a panel for each.
        The default is that of the settings.

    Returns
    -------
    xarray.Dataset
        ``rho`` and ``status`` over (``period_ratio_1``, ``period_ratio_2``), and over ``ground``
        for several. It also has ``rho_drift``, ``rho_simulated``, ``rho_standard_error`` and
        ``drift_memory``, as in Fig. 4.

    Examples
    --------
    >>> import stochlin as sl
    >>> from stochlin.charts import ChartSettings, period_plane_chart
    >>> settings = ChartSettings(points=5, simulated_points=0)
    >>> chart = period_plane_chart(settings, sl.KanaiTajimi(2.0, 0.05))
    >>> chart.rho.dims
    ('period_ratio_1', 'period_ratio_2')
    """
    ground = settings.ground if ground is None else ground
    axes = [
        labels.axis(f"period_ratio_{n}", f"T{n}/Tg", np.geomspace(*GROUND_RATIOS, settings.points))
        for n in (1, 2)
    ]
    period = ground_period(ground)
    factor = settings.plane_reduction_factor
    first = bilinear(settings, axes[0] * period, factor)
    second = bilinear(settings, axes[1] * period, factor)
    chart = correlate(first, second, ground, bias=False)[["rho", "status"]]
    chart = chart.transpose(..., "period_ratio_1", "period_ratio_2")
    step = simulated_step(settings, settings.points, SIMULATED_ON_AXIS)
    places = [{f"period_ratio_{n}": slice(None, None, step) for n in (1, 2)}] if step else []
    chart = with_truth(chart, (first, second), ground, settings, places)
    title = f"Stationary correlation of bilinear structures, R = {factor:g}"
    picture = "plane_and_simulation" if RHO_SIMULATED in chart else "plane"
    chart.attrs |= words(settings, ground, title, chart=picture, comparison="compared_planes")
    return with_errors(chart, "rho", [RHO_SIMULATED], settings)


@register_chart("fig5b", place=50)
@checked
def amplification_chart(
    settings: ChartSettings = USUAL_SETTINGS, ground: Ground | None = None
) -> xr.Dataset:
    """Fig. 5b: amplification ``D`` over ``T/Tg``, for several reduction factors.

    Parameters
    ----------
    settings : ChartSettings, optional
        Parameters of the charts.
    ground : KanaiTajimi or CloughPenzien, optional
        The ground, of one period; parameters over ``ground`` are several, with a panel for each.
        The default is that of the settings.

    Returns
    -------
    xarray.Dataset
        ``amplification``, the ratio of the standard deviations, and ``status`` over
        (``reduction_factor``, ``period_ratio``), and over ``ground`` for several. It also has
        ``amplification_drift`` by the drift closure, and by simulation, NaN between the simulated
        points, ``amplification_simulated`` of the standard deviations and
        ``amplification_of_peaks`` of the peaks in a finite motion, which the text of the paper
        means, both with ``_standard_error``; and ``drift_memory`` [s], as in Fig. 4.

    Examples
    --------
    >>> import stochlin as sl
    >>> from stochlin.charts import ChartSettings, amplification_chart
    >>> settings = ChartSettings(points=3, paths=32, reduction_factors=(1.0,))
    >>> chart = amplification_chart(settings, sl.KanaiTajimi(2.0, 0.05))
    >>> chart.amplification_of_peaks.shape
    (1, 3)
    """
    ground = settings.ground if ground is None else ground
    period = ground_period(ground)
    ratio = labels.axis("period_ratio", "T/Tg", np.geomspace(*GROUND_RATIOS, settings.points))
    structure = bilinear(settings, ratio * period, reduction_factors(settings))
    table = amplification(structure, ground, closure="gaussian")
    chart = table[["amplification", "status"]].transpose(..., "reduction_factor", "period_ratio")
    drift = amplification(structure, ground, closure=DRIFT).amplification
    chart["amplification_drift"] = drift.transpose(*chart.amplification.dims)
    duration, envelope = design_motion(period)
    paths: dict[str, Any] = {"paths": settings.paths, "seed": settings.seed}
    motion = paths | {"of": "peak", "duration": duration, "envelope": envelope}
    elastic = table.displacement_std / table.amplification
    last = settings.points - 1
    seldom = slice(None, None, max(1, last // STD_INTERVALS))
    often = slice(None, None, max(1, last // PEAK_INTERVALS))
    peaks = amplification(structure.isel({"period_ratio": often}), ground, **motion)
    names = {f"amplification{end}": f"{AMPLIFICATION_OF_MAXIMA}{end}" for end in VALUE_AND_ERROR}
    tables = [peaks[[*names]].rename(names)]
    names = {f"displacement_std{end}_1": f"{AMPLIFICATION_OF_STD}{end}" for end in VALUE_AND_ERROR}
    for n, factor in enumerate(settings.reduction_factors):
        if factor >= SLOWEST_DRIFT:
            place = {"reduction_factor": slice(n, n + 1), "period_ratio": seldom}
            here = structure.isel(place)
            single = here.isel(dict.fromkeys(place, 0))
            simulated = correlate(here, single, ground, "simulation", **paths)
            stds = simulated[[*names]].rename(names) / elastic
            tables.append(stds.assign({DRIFT_MEMORY: simulated[f"{DRIFT_MEMORY}_1"]}))
    chart = labels.label(with_points(chart, tables), AMPLIFICATION_VARIABLES)
    for name, beside in ((AMPLIFICATION_OF_MAXIMA, ""), (AMPLIFICATION_OF_STD, f" {DRIFT_MEMORY}")):
        if name in chart:
            chart[name].attrs["ancillary_variables"] = f"{name}_standard_error{beside}"
    chart.amplification.attrs["curve_label"] = "D of standard deviations, linearized"
    title = (
        "Amplification by yielding: of stationary standard deviations, and of maxima in a motion"
    )
    pictures = {"chart": "curves", "comparison": "compared_curves", "beside": "amplification_drift"}
    chart.attrs |= words(settings, ground, title, **pictures)
    chart.attrs["caption"] += f"\nMaxima: {duration:.3g} s of motion, {envelope.describe()}"
    chart.attrs["longest_memory_s"] = LONGEST_MEMORY * period
    return with_errors(chart, "amplification", [AMPLIFICATION_OF_MAXIMA], settings)
