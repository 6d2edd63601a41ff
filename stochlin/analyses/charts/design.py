"""Data of the design charts: Figs. 3a, 4 and 5 of the paper.

The text of the paper does not state the damping, the hardening and the period of the ground. They are
settings, and stated in each dataset. Only ratios of periods matter, so that the period of the ground is
arbitrary.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.charts.charts import CHARTS, design_motion, envelope_caption
from stochlin.analyses.charts.settings import (
    DRIFT_CLOSURE,
    ELASTIC,
    EQ_4,
    SIMULATION,
    ChartSettings,
)
from stochlin.analyses.charts.variables import VARIABLES
from stochlin.analyses.charts.verification import left_out, with_rules, with_truth
from stochlin.analyses.correlation.amplification import amplification
from stochlin.analyses.correlation.correlation import correlate, rho_white_noise
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.models.arguments import checked
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT

STD_INTERVALS, PEAK_INTERVALS = 8, 32  # intervals between simulated periods
STD_PATHS = 64  # paths for standard deviations, whose simulations are long
SLOWEST_DRIFT = 2.0  # smallest reduction factor whose standard deviation is simulated within minutes
TABLE_SHARE = 0.02  # share of a linearized table in the time for a chart with simulations
OF_PEAKS, OF_STD = "amplification_of_peaks", "amplification_simulated"


def _reduction_factors(settings: ChartSettings) -> xr.DataArray:
    return labels.axis("reduction_factor", "reduction factor", list(settings.reduction_factors))


@CHARTS.register("fig3a", place=30)
@checked
def white_noise_chart(settings: ChartSettings) -> xr.Dataset:
    """Fig. 3a: eq. (4) over the period ratio, for several damping ratios.

    Parameters
    ----------
    settings : ChartSettings
        Parameters of the charts, of which ``points`` is used.

    Returns
    -------
    xarray.Dataset
        ``rho`` [-] over (``damping``, ``period_ratio``).

    Examples
    --------
    >>> from stochlin.charts import ChartSettings, white_noise_chart
    >>> chart = white_noise_chart(ChartSettings(points=5))
    >>> bool((chart.rho.sel(period_ratio=1, method="nearest") > 0.999).all())
    True
    """
    ratio = labels.axis(
        "period_ratio", "period ratio T1/T2", np.geomspace(0.25, 4, settings.fine_points)
    )
    damping = labels.axis("damping", "damping ratio", [0.01, 0.02, 0.05, 0.1, 0.2])
    table = rho_white_noise(ratio, 1.0, damping, damping).transpose("damping", "period_ratio")
    return labels.label(table, VARIABLES).assign_attrs(
        chart="curves",
        title="Stationary correlation of linear structures under white noise, eq. (4)",
        caption="Linear structures of equal damping ratio on white noise ground.",
        comment="Exact for stationary response.",
    )


@checked
def period_ratio_chart(
    settings: ChartSettings, ground: Ground, frequency_ratio: float, progress: Progress | None = None
) -> xr.Dataset:
    """Fig. 4: rho over ``T1/T2`` for a fixed frequency ``w2 = frequency_ratio wg`` of structure 2.

    Parameters
    ----------
    settings : ChartSettings
        Parameters of the charts.
    ground : KanaiTajimi or CloughPenzien
        The ground, with scalar parameters.
    frequency_ratio : float
        Frequency of structure 2 over that of the ground [-].
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.Dataset
        ``rho`` and ``status`` over (``reduction_factor``, ``period_ratio``); ``rho_elastic``, on the
        same ground, and ``rho_white_noise``, eq. (4), over ``period_ratio``. It also has
        ``rho_drift`` by the drift closure; ``rho_effective`` over ``rule``, eq. (4) with effective
        properties for the peak ductilities ``ductility_peak_1`` and ``_2`` of the same reduction factor;
        and ``rho_simulated`` with ``rho_standard_error`` and ``rho_difference`` (linearized minus
        simulated), NaN between the simulated points.

    Examples
    --------
    >>> import stochlin as sl
    >>> from stochlin.charts import ChartSettings, period_ratio_chart
    >>> settings = ChartSettings(points=5, simulated_points=0)
    >>> chart = period_ratio_chart(settings, sl.KanaiTajimi(2.0, 0.05), frequency_ratio=1.0)
    >>> chart.rho.dims
    ('reduction_factor', 'period_ratio')
    """
    ratio = labels.axis(
        "period_ratio", "period ratio T1/T2", np.geomspace(0.25, 4, settings.fine_points)
    )
    second_period = ground_period(ground) / frequency_ratio
    factors = _reduction_factors(settings)
    periods = (ratio * second_period, second_period)
    first, second = (
        Bilinear(period, settings.damping, settings.hardening, reduction_factor=factors)
        for period in periods
    )
    table = correlate(first, second, ground, closure=settings.closure, solver=settings.solver)
    part_of(progress, 0.0, TABLE_SHARE)(1.0)
    chart = table[["rho", "status"]].transpose("reduction_factor", "period_ratio")
    elastic_1, elastic_2 = (Bilinear(period, settings.damping) for period in periods)
    if settings.draws(ELASTIC):
        chart["rho_elastic"] = correlate(elastic_1, elastic_2, ground, solver=settings.solver).rho
    if settings.draws(EQ_4):
        chart["rho_white_noise"] = correlate(elastic_1, elastic_2, ground, "white_noise").rho
    times = "" if frequency_ratio == 1 else f"{frequency_ratio:g} "
    title = f"Stationary correlation of bilinear structures, ω2 = {times}ωg"
    where = f"{ground_caption(ground)}; T2 = {second_period:.3g} s"
    chart = _captioned(chart, "curves", title, where, settings, labels.CAUTION_RHO)
    chart = with_rules(chart, (first, second), ground, settings)
    left = part_of(progress, 2 * TABLE_SHARE, 1.0)
    left(0.0)
    return left_out(with_truth(chart, (first, second), ground, settings, 21, left), settings)


@CHARTS.register("fig5a", place=50)
@checked
def period_plane_chart(
    settings: ChartSettings, ground: Ground, progress: Progress | None = None
) -> xr.Dataset:
    """Fig. 5a: rho over ``T1/Tg`` and ``T2/Tg``.

    Parameters
    ----------
    settings : ChartSettings
        Parameters of the charts.
    ground : KanaiTajimi or CloughPenzien
        The ground, with scalar parameters.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.Dataset
        ``rho`` and ``status`` over (``period_ratio_1``, ``period_ratio_2``). It also has
        ``rho_drift``, ``rho_simulated``, ``rho_standard_error`` and ``rho_difference``, as in Fig. 4.

    Examples
    --------
    >>> import stochlin as sl
    >>> from stochlin.charts import ChartSettings, period_plane_chart
    >>> settings = ChartSettings(points=5, simulated_points=0)
    >>> chart = period_plane_chart(settings, sl.KanaiTajimi(2.0, 0.05))
    >>> chart.rho.dims
    ('period_ratio_1', 'period_ratio_2')
    """
    first, second = (
        Bilinear(
            labels.axis(f"period_ratio_{n}", f"T{n}/Tg", np.geomspace(0.1, 4, settings.points))
            * ground_period(ground),
            settings.damping,
            settings.hardening,
            reduction_factor=settings.plane_reduction_factor,
        )
        for n in (1, 2)
    )
    table = correlate(first, second, ground, closure=settings.closure, solver=settings.solver)
    title = f"Stationary correlation of bilinear structures, R = {settings.plane_reduction_factor:g}"
    chart = table[["rho", "status"]]
    chart = _captioned(chart, "plane", title, ground_caption(ground), settings, labels.CAUTION_RHO)
    left = part_of(progress, TABLE_SHARE, 1.0)
    left(0.0)
    return left_out(with_truth(chart, (first, second), ground, settings, 41, left), settings)


@CHARTS.register("fig5b", place=50)
@checked
def amplification_chart(
    settings: ChartSettings, ground: Ground, progress: Progress | None = None
) -> xr.Dataset:
    """Fig. 5b: amplification ``D`` over ``T/Tg``, for several reduction factors.

    Parameters
    ----------
    settings : ChartSettings
        Parameters of the charts.
    ground : KanaiTajimi or CloughPenzien
        The ground, with scalar parameters.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.Dataset
        ``amplification``, the ratio of the standard deviations, and ``status`` over
        (``reduction_factor``, ``period_ratio``). It also has ``amplification_drift`` by
        the drift closure, and by simulation, NaN between the simulated points,
        ``amplification_simulated`` of the standard deviations and ``amplification_of_peaks`` of the
        peaks in a finite motion, which the text of the paper means, both with ``_standard_error``.

    Examples
    --------
    >>> import stochlin as sl
    >>> from stochlin.charts import ChartSettings, amplification_chart
    >>> settings = ChartSettings(points=3, paths=32, reduction_factors=(1.0,))
    >>> chart = amplification_chart(settings, sl.KanaiTajimi(2.0, 0.05))
    >>> chart.amplification_of_peaks.shape
    (1, 3)
    """
    ratio = labels.axis("period_ratio", "T/Tg", np.geomspace(0.1, 4, settings.points))
    structure = Bilinear(
        ratio * ground_period(ground),
        settings.damping,
        settings.hardening,
        reduction_factor=_reduction_factors(settings),
    )
    table = amplification(structure, ground, closure=settings.closure)
    chart = table[["amplification", "status"]].transpose("reduction_factor", "period_ratio")
    title = "Amplification by yielding: of stationary standard deviations, and of maxima in a motion"
    chart = _captioned(chart, "curves", title, ground_caption(ground), settings, labels.CAUTION_SIGMA)
    left = part_of(progress, TABLE_SHARE, 1.0)
    left(0.0)
    return left_out(_with_others(chart, structure, ground, settings, left), settings)


def _with_others(
    chart: xr.Dataset,
    structure: Bilinear,
    ground: Ground,
    settings: ChartSettings,
    progress: Progress,
) -> xr.Dataset:
    """A linearized Fig. 5b with the drift closure, and with simulated peaks and std. deviations."""
    if settings.draws(DRIFT_CLOSURE) and settings.closure != DRIFT:
        drifting = amplification(structure, ground, closure=DRIFT).amplification
        chart = chart.assign(amplification_drift=drifting.transpose(*chart.amplification.dims))
    if settings.draws(SIMULATION):
        chart = _simulated(chart, structure, ground, settings, progress)
    return labels.label(chart, VARIABLES).assign_attrs(comparison="compared_curves")


def _simulated(
    chart: xr.Dataset,
    structure: Bilinear,
    ground: Ground,
    settings: ChartSettings,
    progress: Progress,
) -> xr.Dataset:
    """Fig. 5b with simulated peaks, and std. deviations where structures do not yield too rarely."""
    duration, envelope = design_motion(ground_period(ground))
    last = chart.sizes["period_ratio"] - 1
    seldom, often = (slice(None, None, max(1, last // n)) for n in (STD_INTERVALS, PEAK_INTERVALS))
    motion: dict[str, Any] = {"of": "peak", "duration": duration, "envelope": envelope}
    runs = [(OF_PEAKS, slice(None), often, {**motion, "paths": settings.paths})]
    few = {"method": "simulation", "paths": min(settings.paths, STD_PATHS)}
    runs += [
        (OF_STD, slice(n, n + 1), seldom, few)
        for n, factor in enumerate(settings.reduction_factors)
        if factor >= SLOWEST_DRIFT
    ]
    for number, (name, rows, columns, options) in enumerate(runs):
        progress(number / len(runs))
        place = {"reduction_factor": rows, "period_ratio": columns}
        simulated = amplification(structure.isel(place), ground, seed=settings.seed, **options)
        for end in ("", "_standard_error"):
            if name + end not in chart:
                chart[name + end] = xr.full_like(chart.amplification, np.nan)
            values = simulated[f"amplification{end}"].transpose(*chart.amplification.dims).values
            chart[name + end][place] = values
    plain = f"{chart.attrs['caption']}\nMaxima: {envelope_caption(duration, envelope)}"
    return chart.assign_attrs(
        caption=f"{plain}; std. deviations simulated for R ≥ {SLOWEST_DRIFT:g}",
        plain_caption=plain,
        comment=_errors_of_amplification(chart),
        plain_comment=f"{_simulation_errors(chart, {OF_PEAKS: 'maxima'})}.",
    )


def _simulation_errors(chart: xr.Dataset, simulated: Mapping[str, str]) -> str:
    """Text with the largest standard errors of the simulated variables, by their words."""
    errors = [
        f"{text} {100 * float((chart[f'{name}_standard_error'] / chart[name]).max()):.2g} %"
        for name, text in simulated.items()
        if name in chart
    ]
    return f"Largest standard error of the simulated {', '.join(errors)}"


def _errors_of_amplification(chart: xr.Dataset) -> str:
    """Text with the standard errors of the simulations, and the errors of the curves against them."""
    text = f"{_simulation_errors(chart, {OF_PEAKS: 'maxima', OF_STD: 'std. deviations'})}."
    curves = {"amplification": "linearized", "amplification_drift": "drift closure"}
    if OF_STD not in chart:
        return text
    errors = {c: 100 * np.abs(chart[n] / chart[OF_STD] - 1) for n, c in curves.items() if n in chart}
    off = [f"{c} {float(each.mean()):.2g} % ({float(each.max()):.2g} %)" for c, each in errors.items()]
    return f"{text} Mean (largest) error of the std. deviations: {'; '.join(off)}."


for _letter, _ratio in (("a", 0.5), ("b", 1.0), ("c", 2.0)):
    CHARTS.register(f"fig4{_letter}", place=40)(partial(period_ratio_chart, frequency_ratio=_ratio))


def ground_period(ground: Ground) -> float:
    """Period ``Tg`` of the ground [s]."""
    return float(ground.arrays()["period"])


def ground_caption(ground: Ground) -> str:
    """Name and parameters of a ground, for the caption of a picture."""
    values = ground.arrays()
    period, damping = float(values["period"]), float(values["damping"])
    text = f"{ground.name} ground: Tg = {period:.3g} s, ξg = {damping:.3g}"
    if "high_pass_period" in values:
        period, damping = float(values["high_pass_period"]), float(values["high_pass_damping"])
        text += f", Tf = {period:.3g} s, ξf = {damping:.3g}"
    return text


def _captioned(
    chart: xr.Dataset, picture: str, title: str, where: str, settings: ChartSettings, caution: str
) -> xr.Dataset:
    """Chart with title and caption, and the caution as its comment."""
    closure = settings.closure.replace("gaussian", "Gaussian").replace("_", " ")
    structures = (
        f"Bilinear structures: ξ = {settings.damping:g}, α = {settings.hardening:g}, R = 3 σel/uy; "
        f"linearized, {closure} closure"
    )
    caption = f"{where}\n{structures}"
    return chart.assign_attrs(chart=picture, title=title, caption=caption, comment=caution)
