"""The data of the design charts: Figs. 3a, 4 and 5 of the paper, and the same for broad band.

The paper leaves out damping, hardening and the periods behind its ratios: they are chosen
here, stated in every dataset, and can be set. Ratios are all that matters under a common
scale of time, so that the ground period only sets the units.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from stochlin.analyses.charts.charts import CHARTS, ChartSettings
from stochlin.analyses.charts.verification import with_rules, with_truth
from stochlin.analyses.correlation.amplification import amplification
from stochlin.analyses.correlation.correlation import correlate, rho_white_noise
from stochlin.analyses.tables import labels
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear


def _reduction_factors(settings: ChartSettings) -> xr.DataArray:
    return labels.axis("reduction_factor", "reduction factor", list(settings.reduction_factors))


@CHARTS.register("fig3a", place=30)
def white_noise_chart(settings: ChartSettings) -> xr.Dataset:
    """Fig. 3a: eq. (4) over the period ratio, for several damping ratios.

    Returns
    -------
    xarray.Dataset
        ``rho`` over (``damping``, ``period_ratio``).
    """
    ratio = labels.axis(
        "period_ratio", "period ratio T1/T2", np.geomspace(0.25, 4, settings.fine_points)
    )
    damping = labels.axis("damping", "damping ratio", [0.01, 0.02, 0.05, 0.1, 0.2])
    table = rho_white_noise(ratio, 1.0, damping, damping).transpose("damping", "period_ratio")
    return table.assign_attrs(
        chart="curves",
        title="Correlation of linear structures under white noise, eq. (4)",
        caption="Linear structures of equal damping ratio on white noise ground.",
        comment="Exact for stationary response.",
    )


def period_ratio_chart(settings: ChartSettings, ground: Ground, frequency_ratio: float) -> xr.Dataset:
    """Fig. 4: rho over ``T1/T2`` with structure 2 fixed at ``w2 = frequency_ratio wg``.

    Returns
    -------
    xarray.Dataset
        ``rho`` and ``status`` over (``reduction_factor``, ``period_ratio``), ``rho_elastic`` (the same
        ground) and ``rho_white_noise`` (eq. 4) over ``period_ratio``. Linearized, it also has the drift
        closure's ``rho_drift``; ``rho_effective`` along ``rule``, eq. (4) at the peak ductilities
        ``ductility_peak_1`` and ``_2`` of the same reduction factor; and ``rho_simulated`` with
        ``rho_standard_error`` and ``rho_difference`` (linearized less simulated), NaN between
        the simulated points.
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
    table = correlate(first, second, ground, **settings.options)
    elastic_1, elastic_2 = (Bilinear(period, settings.damping) for period in periods)
    chart = table[_shown(table)].transpose("reduction_factor", "period_ratio")
    chart = chart.assign(
        rho_elastic=correlate(elastic_1, elastic_2, ground).rho,
        rho_white_noise=correlate(elastic_1, elastic_2, ground, "white_noise").rho,
    )
    chart.rho_elastic.attrs["long_name"] = "rho of elastic structures on this ground"
    chart.rho_white_noise.attrs["long_name"] = "rho of elastic structures under white noise, eq. (4)"
    times = "" if frequency_ratio == 1 else f"{frequency_ratio:g} "
    title = f"Correlation of bilinear structures, ω2 = {times}ωg"
    where = f"{ground_caption(ground)}; T2 = {second_period:.3g} s"
    chart = _captioned(chart, "curves", title, where, settings, labels.CAUTION_RHO)
    if settings.method == "simulation":
        return chart
    chart = with_rules(chart, (first, second), ground, settings)
    return with_truth(chart, (first, second), ground, settings, settings.simulated_points)


@CHARTS.register("fig5a", place=50)
def period_plane_chart(settings: ChartSettings, ground: Ground) -> xr.Dataset:
    """Fig. 5a: rho over ``T1/Tg`` and ``T2/Tg``.

    Returns
    -------
    xarray.Dataset
        ``rho`` and ``status`` over (``period_ratio_1``, ``period_ratio_2``). Linearized, it also has
        ``rho_drift``, ``rho_simulated``, ``rho_standard_error`` and ``rho_difference``, as Fig. 4.
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
    table = correlate(first, second, ground, **settings.options)
    title = f"Correlation of bilinear structures, R = {settings.plane_reduction_factor:g}"
    chart = table[_shown(table)]
    chart = _captioned(chart, "plane", title, ground_caption(ground), settings, labels.CAUTION_RHO)
    if settings.method == "simulation":
        return chart
    return with_truth(chart, (first, second), ground, settings, settings.simulated_points_of_plane)


@CHARTS.register("fig5b", place=50)
def amplification_chart(settings: ChartSettings, ground: Ground) -> xr.Dataset:
    """Fig. 5b: amplification ``D`` over ``T/Tg``, for several reduction factors.

    Returns
    -------
    xarray.Dataset
        ``amplification`` and ``status`` over (``reduction_factor``, ``period_ratio``).
    """
    ratio = labels.axis("period_ratio", "T/Tg", np.geomspace(0.1, 4, settings.points))
    structure = Bilinear(
        ratio * ground_period(ground),
        settings.damping,
        settings.hardening,
        reduction_factor=_reduction_factors(settings),
    )
    table = amplification(structure, ground, **settings.options)
    chart = table[_shown(table)].transpose("reduction_factor", "period_ratio")
    title = "Amplification of the displacement by yielding"
    return _captioned(chart, "curves", title, ground_caption(ground), settings, labels.CAUTION_SIGMA)


for _letter, _ratio in (("a", 0.5), ("b", 1.0), ("c", 2.0)):
    CHARTS.register(f"fig4{_letter}", place=40)(partial(period_ratio_chart, frequency_ratio=_ratio))


def _shown(table: xr.Dataset) -> list[str]:
    names = ("rho", "amplification", "rho_standard_error", "amplification_standard_error", "status")
    return [name for name in names if name in table]


def ground_period(ground: Ground) -> float:
    """``Tg`` [s]."""
    return float(ground.arrays()["period"])


def ground_caption(ground: Ground) -> str:
    """What a picture states of the ground."""
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
    """Add what the picture states; the caution is for linearized charts alone."""
    linearized = settings.method == "linearization"
    how = f"linearized, {settings.closure} closure" if linearized else "simulated"
    structures = (
        f"Bilinear structures: ξ = {settings.damping:g}, α = {settings.hardening:g}, R = 3 σel/uy; {how}"
    )
    chart = chart.assign_attrs(chart=picture, title=title, caption=f"{where}\n{structures}")
    return chart.assign_attrs(comment=caution) if linearized else chart
