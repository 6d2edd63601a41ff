"""Fig. 2: the critical gap of two elastic structures in a motion, over their periods."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.applications.separation.energy_gap import energy_gap
from stochlin.models.arguments import Points, checked
from stochlin.models.laws.bilinear import Bilinear
from stochlin.views.figures.charts import ChartSettings, register_chart
from stochlin.views.figures.fig1 import about, period_axis, source_of
from stochlin.views.figures.pictures import PICTURES, SQUARE, in_a_row, in_cm, planes
from stochlin.views.shared.symbols import typeset

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_POINTS = 61  # along an axis, which needs the response to the record for each


@register_chart("fig2", place=14)
def _fig2(settings: ChartSettings) -> xr.Dataset:
    return recorded_gap_chart(settings.motion, settings.damping, min(settings.points, MOST_POINTS))


@checked
def recorded_gap_chart(record: xr.DataArray, damping: float, points: Points = 61) -> xr.Dataset:
    """Fig. 2: critical gap over the periods of two elastic structures; in the paper for the Taft record.

    Parameters
    ----------
    record : xarray.DataArray
        Record [m/s^2], such as from `stochlin.read_record`.
    damping : float
        Damping ratio [-] of both structures.
    points : int
        Number of periods along each axis, from 0.1 to 5 s.

    Returns
    -------
    xarray.Dataset
        Over ``period_1`` and ``period_2`` [s]: ``separation`` [m], the largest ``u_1 - u_2`` in the
        record; ``critical_gap`` [m], eq. (3) with the pseudo energy radii and ``rho_white_noise`` [-] of
        eq. (4); ``srss`` [m], the root of the sum of the squares of both; ``rho`` [-], the correlation
        coefficient over the record; and ``status``.

    Raises
    ------
    ValueError, TypeError
        If the record, a period or a damping ratio is out of range or of the wrong kind.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1), (3) and (4), Fig. 2.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> time = np.arange(0, 10, 0.01)
    >>> record = xr.DataArray(np.sin(2 * np.pi * time), dims="time", coords={"time": time})
    >>> from stochlin.charts import recorded_gap_chart
    >>> chart = recorded_gap_chart(record, damping=0.05, points=5)
    >>> float(abs(chart.separation.values.diagonal()).max())
    0.0
    """
    periods = (period_axis(f"period_{n}", f"period, structure {n}", points) for n in (1, 2))
    first, second = (Bilinear(period, damping) for period in periods)
    chart = energy_gap(first, second, record).rename(rho_estimate="rho_white_noise")
    chart = chart[["separation", "srss", "rho", "status", "critical_gap", "rho_white_noise"]]
    chart.rho.attrs["long_name"] = "correlation over the recorded motion"
    chart.rho_white_noise.attrs["long_name"] = "rho under white noise, eq. (4)"
    chart.critical_gap.attrs.update(units="m", long_name="critical gap")
    return chart.assign_attrs(
        chart="critical_gap",
        title=f"Critical gap in {source_of(record)}",
        caption=f"Elastic structures: ξ = {damping:.3g}; the largest u1 - u2, and eqs. (3) and (4)"
        f"{about(record)}",
    )


@PICTURES.register("critical_gap")
def draw_critical_gap(figure: Figure, dataset: xr.Dataset) -> None:
    """Peak of ``u_1 - u_2`` in the record, and eqs. (3) and (4), over the periods."""
    shown = {"separation": "largest u1 - u2", "critical_gap": "eqs. (3) and (4)"}
    over = "period_1", "period_2"
    tables = [
        (typeset(title), in_cm(dataset[name].assign_attrs(dataset.critical_gap.attrs)).transpose(*over))
        for name, title in shown.items()
    ]
    highest = max(float(table.max()) for _, table in tables)
    planes(figure, in_a_row(figure, 2, SQUARE, shared=True), tables, _levels(highest))


def _levels(highest: float) -> np.ndarray:
    """Levels 0 and 1, 2, 3, 5, 10, ... from a thousandth of the highest value to beyond it."""
    from matplotlib.ticker import LogLocator

    lowest = highest / 1000
    series = np.asarray(LogLocator(subs=(1, 2, 3, 5), numticks=10).tick_values(lowest, 10 * highest))
    series = series[series >= lowest]
    return np.array([0.0, *series[: np.searchsorted(series, highest) + 1]])
