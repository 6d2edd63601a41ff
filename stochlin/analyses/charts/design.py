"""The data of the design charts: Figs. 3, 4 and 5 of the paper, and the same for broad band; 6 to 8.

The paper leaves out damping, hardening and the periods behind its ratios: they are chosen
here, stated in every dataset, and can be set. Ratios are all that matters under a common
scale of time, so that the ground period only sets the units.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.charts.contacts import (
    contact_history_chart,
    contact_loop_chart,
    restitution_chart,
)
from stochlin.analyses.charts.records import per_spectrum_chart, portrait_chart, recorded_gap_chart
from stochlin.analyses.charts.rules import effective_rules_chart
from stochlin.analyses.correlation.amplification import amplification
from stochlin.analyses.correlation.correlation import correlate, rho_white_noise
from stochlin.analyses.records.spectra import fit_spectra
from stochlin.analyses.tables import labels
from stochlin.models.grounds import Ground, KanaiTajimi
from stochlin.models.laws.bilinear import Bilinear

NARROW_BAND_DAMPING = 0.05  # the paper's, for Figs. 4 and 5
BROAD_BAND_DAMPING = 0.6  # firm ground, Der Kiureghian & Neuenhofer 1992
GAP_POINTS = 61  # at most, of Fig. 2: each cell follows the whole record


@dataclass(frozen=True)
class ChartSettings:
    """What the charts take as given where the paper is silent.

    Parameters
    ----------
    damping, hardening : float
        Of all structures [-].
    reduction_factors : tuple of float
        One curve each in Figs. 4 and 5b.
    plane_reduction_factor : float
        ``R`` of Fig. 5a; the paper's is 4.
    ductility : float
        Peak ductility of both structures in Fig. 3b [-].
    ground_period : float
        ``Tg`` [s] of the two model grounds.
    closure : str
        As in `stochlin.linearize`.
    points : int
        Periods along an axis.
    method : str
        ``"linearization"`` or ``"simulation"``.
    paths, seed : int
        As in `stochlin.simulate`.
    """

    damping: float = 0.05
    hardening: float = 0.05
    reduction_factors: tuple[float, ...] = (1.0, 2.0, 4.0, 6.0)
    plane_reduction_factor: float = 4.0
    ductility: float = 4.0
    ground_period: float = 2.0
    closure: str = "gaussian"
    points: int = 161
    method: str = "linearization"
    paths: int = 256
    seed: int = 0

    @property
    def options(self) -> dict[str, Any]:
        """Keywords of `stochlin.correlate` and `stochlin.amplification`."""
        names = ("method", "closure", "paths", "seed")
        return {name: getattr(self, name) for name in names}

    def __post_init__(self) -> None:
        if self.points < 2:
            raise ValueError(f"points = {self.points}; allowed: at least 2")
        if not self.reduction_factors:
            raise ValueError("reduction_factors is empty; allowed: at least one value")


def _axis(name: str, long_name: str, low: float, high: float, points: int) -> xr.DataArray:
    attrs = {"units": "1", "long_name": long_name}
    values = np.geomspace(low, high, points)
    return xr.DataArray(values, dims=name, coords={name: (name, values, attrs)}, attrs=attrs)


def _reduction_factors(values: tuple[float, ...]) -> xr.DataArray:
    attrs = {"units": "1", "long_name": "reduction factor"}
    coords = {"reduction_factor": ("reduction_factor", list(values), attrs)}
    return xr.DataArray(list(values), dims="reduction_factor", coords=coords, attrs=attrs)


def white_noise_chart(settings: ChartSettings) -> xr.Dataset:
    """Fig. 3a: eq. (4) over the period ratio, for several damping ratios.

    Returns
    -------
    xarray.Dataset
        ``rho`` over (``damping``, ``period_ratio``).
    """
    ratio = _axis("period_ratio", "period ratio T1/T2", 0.25, 4, 2 * settings.points - 1)
    values = [0.01, 0.02, 0.05, 0.1, 0.2]
    attrs = {"units": "1", "long_name": "damping ratio"}
    damping = xr.DataArray(values, dims="damping", coords={"damping": ("damping", values, attrs)})
    table = rho_white_noise(ratio, 1.0, damping, damping).transpose("damping", "period_ratio")
    return table.assign_attrs(
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
        ground) and ``rho_white_noise`` (eq. 4) over ``period_ratio``.
    """
    ratio = _axis("period_ratio", "period ratio T1/T2", 0.25, 4, 2 * settings.points - 1)
    second_period = _ground_period(ground) / frequency_ratio
    factors = _reduction_factors(settings.reduction_factors)
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
    title = f"Correlation of bilinear structures, {_frequency_title(frequency_ratio)}"
    where = f"{_ground_caption(ground)}; T2 = {second_period:.3g} s"
    return _captioned(chart, title, where, settings, labels.CAUTION_RHO)


def period_plane_chart(settings: ChartSettings, ground: Ground) -> xr.Dataset:
    """Fig. 5a: rho over ``T1/Tg`` and ``T2/Tg``.

    Returns
    -------
    xarray.Dataset
        ``rho`` and ``status`` over (``period_ratio_1``, ``period_ratio_2``).
    """
    first, second = (
        Bilinear(
            _axis(f"period_ratio_{n}", f"T{n}/Tg", 0.1, 4, settings.points) * _ground_period(ground),
            settings.damping,
            settings.hardening,
            reduction_factor=settings.plane_reduction_factor,
        )
        for n in (1, 2)
    )
    table = correlate(first, second, ground, **settings.options)
    title = f"Correlation of bilinear structures, R = {settings.plane_reduction_factor:g}"
    chart = table[_shown(table)]
    return _captioned(chart, title, _ground_caption(ground), settings, labels.CAUTION_RHO)


def amplification_chart(settings: ChartSettings, ground: Ground) -> xr.Dataset:
    """Fig. 5b: amplification ``D`` over ``T/Tg``, for several reduction factors.

    Returns
    -------
    xarray.Dataset
        ``amplification`` and ``status`` over (``reduction_factor``, ``period_ratio``).
    """
    ratio = _axis("period_ratio", "T/Tg", 0.1, 4, settings.points)
    structure = Bilinear(
        ratio * _ground_period(ground),
        settings.damping,
        settings.hardening,
        reduction_factor=_reduction_factors(settings.reduction_factors),
    )
    table = amplification(structure, ground, **settings.options)
    chart = table[_shown(table)].transpose("reduction_factor", "period_ratio")
    title = "Amplification of the displacement by yielding"
    return _captioned(chart, title, _ground_caption(ground), settings, labels.CAUTION_SIGMA)


def chart_functions(
    settings: ChartSettings, record: xr.DataArray | None = None, site: Ground | None = None
) -> Mapping[str, Callable[[], xr.Dataset]]:
    """The charts by name, each a call that computes its dataset.

    Parameters
    ----------
    settings : ChartSettings
    record, site : optional
        A record and the ground fitted to it: the charts are then those of the site.

    Returns
    -------
    mapping
        File name without ending -> function without arguments.
    """
    grounds: dict[str, Ground] = {
        "": KanaiTajimi(settings.ground_period, NARROW_BAND_DAMPING),
        "_broad_band": KanaiTajimi(settings.ground_period, BROAD_BAND_DAMPING),
    }
    functions: dict[str, Callable[[], xr.Dataset]] = {}
    if record is not None and site is not None:
        grounds = {"_site": site}
        damping, period = settings.damping, _ground_period(site)
        functions["site_spectrum"] = partial(_spectrum_chart, record, site)
        functions["fig1"] = partial(portrait_chart, record, period, damping)
        functions["per_spectrum"] = partial(_per_chart, record, damping, settings.points)
        functions["fig2"] = partial(
            recorded_gap_chart, record, damping, min(settings.points, GAP_POINTS)
        )
    else:
        functions["fig3a"] = partial(white_noise_chart, settings)
        functions["fig3b"] = partial(
            effective_rules_chart,
            settings.damping,
            settings.hardening,
            settings.ductility,
            2 * settings.points - 1,
        )
    for suffix, ground in grounds.items():
        for letter, frequency_ratio in (("a", 0.5), ("b", 1.0), ("c", 2.0)):
            name = f"fig4{letter}{suffix}"
            functions[name] = partial(period_ratio_chart, settings, ground, frequency_ratio)
        functions[f"fig5a{suffix}"] = partial(period_plane_chart, settings, ground)
        functions[f"fig5b{suffix}"] = partial(amplification_chart, settings, ground)
    if site is None:
        contacts = (contact_loop_chart, contact_history_chart, restitution_chart)
        for number, chart in enumerate(contacts, start=6):
            functions[f"fig{number}"] = partial(chart, points=2 * settings.points - 1)
    return functions


def _spectrum_chart(record: xr.DataArray, site: Ground) -> xr.Dataset:
    return fit_spectra(record, site).assign_attrs(
        title=f"Ground fitted to {record.attrs.get('source', 'a record')}",
        caption=f"{_ground_caption(site)}\n{site.source}",
    )


def _per_chart(record: xr.DataArray, damping: float, points: int) -> xr.Dataset:
    title = f"Spectrum of the pseudo energy radius, {record.attrs.get('source', 'a record')}"
    return per_spectrum_chart(record, damping, points).assign_attrs(title=title)


def _shown(table: xr.Dataset) -> list[str]:
    names = ("rho", "amplification", "rho_standard_error", "amplification_standard_error", "status")
    return [name for name in names if name in table]


def _frequency_title(ratio: float) -> str:
    return "ω2 = ωg" if ratio == 1 else f"ω2 = {ratio:g} ωg"


def _ground_period(ground: Ground) -> float:
    return float(ground.arrays()["period"])


def _ground_caption(ground: Ground) -> str:
    values = ground.arrays()
    period, damping = float(values["period"]), float(values["damping"])
    text = f"{ground.name} ground: Tg = {period:.3g} s, ξg = {damping:.3g}"
    if "high_pass_period" in values:
        period, damping = float(values["high_pass_period"]), float(values["high_pass_damping"])
        text += f", Tf = {period:.3g} s, ξf = {damping:.3g}"
    return text


def _captioned(
    chart: xr.Dataset, title: str, where: str, settings: ChartSettings, caution: str
) -> xr.Dataset:
    """Add what the picture states; the caution is for linearized charts alone."""
    linearized = settings.method == "linearization"
    how = f"linearized, {settings.closure} closure" if linearized else "simulated"
    structures = (
        f"Bilinear structures: ξ = {settings.damping:g}, α = {settings.hardening:g}, R = 3 σel/uy; {how}"
    )
    chart = chart.assign_attrs(title=title, caption=f"{where}\n{structures}")
    return chart.assign_attrs(comment=caution) if linearized else chart
