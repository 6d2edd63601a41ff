"""The data of charts of recorded motions: Figs. 1 and 2 of the paper, and the spectrum of the PER.

The paper states neither the damping of these figures nor the periods of Fig. 1: they are chosen by
the caller and stated in the dataset.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses.charts.charts import CHARTS, ChartSettings, check_points
from stochlin.analyses.charts.design import ground_caption, ground_period
from stochlin.analyses.charts.variables import VARIABLES
from stochlin.analyses.correlation.correlation import rho_white_noise
from stochlin.analyses.records.cells import Records
from stochlin.analyses.records.gaps import recorded_gap
from stochlin.analyses.records.response import pseudo_energy_radius, respond
from stochlin.analyses.records.spectra import fit_spectra
from stochlin.analyses.separation.critical_gap import double_difference
from stochlin.analyses.tables import labels
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear

POINTS_PER_PERIOD = 32  # of a portrait, for a smooth curve
CIRCLE = 181  # points
PERIODS = (0.1, 5.0)  # s
GAP_POINTS = 61  # at most, of Fig. 2: each cell follows the whole record


@CHARTS.register("site_spectrum", place=10)
def _site_spectrum(record: xr.DataArray, site: Ground) -> xr.Dataset:
    title, caption = f"Ground fitted to {_source(record)}", f"{ground_caption(site)}\n{site.source}"
    return fit_spectra(record, site).assign_attrs(chart="spectra", title=title, caption=caption)


@CHARTS.register("fig1", place=11)
def _fig1(settings: ChartSettings, record: xr.DataArray, site: Ground) -> xr.Dataset:
    return portrait_chart(record, ground_period(site), settings.damping)


@CHARTS.register("per_spectrum", place=12)
def _per_spectrum(settings: ChartSettings, record: xr.DataArray) -> xr.Dataset:
    title = f"Spectrum of the pseudo energy radius, {_source(record)}"
    return per_spectrum_chart(record, settings.damping, settings.points).assign_attrs(title=title)


@CHARTS.register("fig2", place=13)
def _fig2(settings: ChartSettings, record: xr.DataArray) -> xr.Dataset:
    return recorded_gap_chart(record, settings.damping, min(settings.points, GAP_POINTS))


def portrait_chart(record: xr.DataArray, period: float, damping: float) -> xr.Dataset:
    """Fig. 1a: the trace of ``u`` against ``u'/w``, and the circle of the pseudo energy radius.

    Parameters
    ----------
    record : xarray.DataArray
        As `stochlin.read_record` gives it.
    period, damping : float
        Of the elastic structure, [s] and [-].

    Returns
    -------
    xarray.Dataset
        ``displacement``, ``velocity_over_frequency`` and ``radius`` [m] over ``time``;
        ``pseudo_energy_radius`` [m]; ``circle_displacement`` and ``circle_velocity_over_frequency`` [m]
        over ``angle`` [rad].
    """
    peak = pseudo_energy_radius(record, period, damping).pseudo_energy_radius
    step = float(record["time"][1] - record["time"][0])
    refine = max(1, int(np.ceil(POINTS_PER_PERIOD * step / period)))
    motion = respond(Bilinear(period, damping), record, refine=refine)
    angle = np.linspace(0, 2 * np.pi, CIRCLE)
    chart = motion[["displacement", "radius"]].assign(
        velocity_over_frequency=motion.velocity * period / (2 * np.pi),
        pseudo_energy_radius=peak,
        circle_displacement=("angle", float(peak) * np.cos(angle)),
        circle_velocity_over_frequency=("angle", float(peak) * np.sin(angle)),
    )
    for name in ("displacement", "velocity_over_frequency"):
        chart[f"circle_{name}"].attrs.update(
            units="m", long_name=f"{name.replace('_', ' ')} on the circle of r_PER"
        )
    chart = chart.assign_coords(angle=("angle", angle, {"units": "rad", "long_name": "angle"}))
    return labels.label(chart, VARIABLES).assign_attrs(
        chart="portrait",
        title=f"Pseudo energy radius of {_source(record)}",
        caption=f"Elastic structure: T = {period:.3g} s, ξ = {damping:.3g}; r_PER = {float(peak):.3g} m",
    )


def per_spectrum_chart(records: Records, damping: float, points: int = 161) -> xr.Dataset:
    """Pseudo energy radius and largest displacement of elastic structures over their period.

    Parameters
    ----------
    records : xarray.DataArray, or list or mapping of them
        As `stochlin.read_record` gives them.
    damping : float
        Damping ratio [-].
    points : int
        Periods, from .1 to 5 s.

    Returns
    -------
    xarray.Dataset
        ``pseudo_energy_radius`` and ``displacement_max`` [m] and ``status`` over ``period`` [s] and, for
        several records, ``record``.
    """
    chart = pseudo_energy_radius(records, _periods("period", "period", points), damping)
    return chart.assign_attrs(
        chart="per_spectrum",
        title="Spectrum of the pseudo energy radius",
        caption=f"Elastic structures: ξ = {damping:.3g}",
    )


def recorded_gap_chart(record: xr.DataArray, damping: float, points: int = 61) -> xr.Dataset:
    """Fig. 2: the critical gap over the periods of two elastic structures; the paper's is for Taft.

    Parameters
    ----------
    record : xarray.DataArray
        As `stochlin.read_record` gives it.
    damping : float
        Damping ratio of both structures [-].
    points : int
        Periods along each axis, from .1 to 5 s.

    Returns
    -------
    xarray.Dataset
        Over ``period_1`` and ``period_2`` [s]: ``separation`` [m], the gap that the record takes;
        ``critical_gap`` [m], eq. (3) with the pseudo energy radii and ``rho_white_noise``, eq. (4);
        ``srss`` [m]; ``rho`` of the record; ``status``.
    """
    periods = (_periods(f"period_{n}", f"period, structure {n}", points) for n in (1, 2))
    first, second = (Bilinear(period, damping) for period in periods)
    table = recorded_gap(first, second, record)
    rho = rho_white_noise(first.period, second.period, damping, damping).rho
    radii = (table.pseudo_energy_radius_1, table.pseudo_energy_radius_2)
    chart = table[["separation", "srss", "rho", "status"]].assign(
        critical_gap=xr.apply_ufunc(double_difference, *radii, np.minimum(rho, 1)), rho_white_noise=rho
    )
    chart.rho.attrs["long_name"] = "correlation over the recorded motion"
    chart.rho_white_noise.attrs["long_name"] = "rho under white noise, eq. (4)"
    chart.critical_gap.attrs.update(units="m", long_name="critical gap, eqs. (3) and (4)")
    return chart.assign_attrs(
        chart="critical_gap",
        title=f"Critical gap in {_source(record)}",
        caption=f"Elastic structures: ξ = {damping:.3g}; the largest u1 - u2, and eqs. (3) and (4)",
    )


def _periods(name: str, long_name: str, points: int) -> xr.DataArray:
    check_points(points)
    return labels.axis(name, long_name, np.geomspace(*PERIODS, points), "s")


def _source(record: xr.DataArray) -> str:
    return str(record.attrs.get("source", "a record"))
