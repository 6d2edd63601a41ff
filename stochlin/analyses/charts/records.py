"""Data of charts of recorded motions: Figs. 1 and 2 of the paper, and spectra of the energy radius.

The text of the paper does not state the damping of these figures and the period of Fig. 1. They are
arguments, and stated in the dataset.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses.charts.charts import CHARTS
from stochlin.analyses.charts.design import ground_caption, ground_period
from stochlin.analyses.charts.settings import ChartSettings
from stochlin.analyses.charts.variables import VARIABLES
from stochlin.analyses.records.cells import Records
from stochlin.analyses.records.records import strong_part
from stochlin.analyses.records.response import pseudo_energy_radius, respond, response_spectrum
from stochlin.analyses.records.spectra import fit_spectra
from stochlin.analyses.separation.added_damping import CURVES as DAMPED_CURVES
from stochlin.analyses.separation.added_damping import damped_gaps, damping_for_gap
from stochlin.analyses.separation.energy_gap import RhoEstimate, energy_gap
from stochlin.analyses.separation.variables import VARIABLES as SEPARATION
from stochlin.analyses.tables import labels
from stochlin.models.arguments import Points, checked
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import Structure

POINTS_PER_PERIOD = 32  # for a smooth phase portrait
CIRCLE = 181  # points of the circle
PERIODS = (0.1, 5.0)  # first and last period of an axis [s]
ENERGIES = ("input", "viscous", "hysteretic")
SECOND_PERIOD = 0.7  # default period of the second structure, over that of the first
GAP_POINTS = 61  # most points along an axis of Fig. 2, which needs the response to the record for each


@CHARTS.register("site_spectrum", place=10)
def _site_spectrum(record: xr.DataArray, site: Ground) -> xr.Dataset:
    title, caption = f"Ground fitted to {_source(record)}", f"{ground_caption(site)}\n{site.source}"
    return fit_spectra(record, site).assign_attrs(chart="spectra", title=title, caption=caption)


@CHARTS.register("fig1", place=11)
def _fig1(settings: ChartSettings, motion: xr.DataArray, site: Ground) -> xr.Dataset:
    return portrait_chart(motion, _period(settings, site), settings.damping)


@CHARTS.register("fig1b", place=12)
def _fig1b(settings: ChartSettings, motion: xr.DataArray, site: Ground) -> xr.Dataset:
    strength = settings.hardening, settings.plane_reduction_factor
    return energy_chart(motion, _period(settings, site), settings.damping, *strength, settings.points)


@CHARTS.register("per_spectrum", place=13)
def _per_spectrum(settings: ChartSettings, record: xr.DataArray) -> xr.Dataset:
    title = f"Spectrum of the pseudo energy radius, {_source(record)}"
    return per_spectrum_chart(record, settings.damping, settings.points).assign_attrs(title=title)


@CHARTS.register("fig2", place=14)
def _fig2(settings: ChartSettings, motion: xr.DataArray) -> xr.Dataset:
    return recorded_gap_chart(motion, settings.damping, min(settings.points, GAP_POINTS))


@CHARTS.register("added_damping", place=15)
def _added_damping(settings: ChartSettings, record: xr.DataArray, site: Ground) -> xr.Dataset:
    period = _period(settings, site)
    other = settings.second_period or SECOND_PERIOD * period
    first, second = (Bilinear(T, settings.damping) for T in (period, other))
    return added_damping_chart(record, first, second, settings.gap)


@checked
def portrait_chart(record: xr.DataArray, period: float, damping: float) -> xr.Dataset:
    """Fig. 1a: phase portrait ``u'/w`` over ``u``, and the circle with the pseudo energy radius.

    Parameters
    ----------
    record : xarray.DataArray
        Record [m/s^2], such as from `stochlin.read_record`.
    period, damping : float
        Period [s] and damping ratio [-] of the elastic structure.

    Returns
    -------
    xarray.Dataset
        ``displacement``, ``velocity_over_frequency`` and ``radius`` [m] over ``time``;
        ``pseudo_energy_radius`` [m]; ``circle_displacement`` and ``circle_velocity_over_frequency`` [m]
        over ``angle`` [rad].

    Raises
    ------
    ValueError, TypeError
        If the record, a period or a damping ratio is out of range or of the wrong kind.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eq. (1) and Fig. 1.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> time = np.arange(0, 10, 0.01)
    >>> record = xr.DataArray(np.sin(2 * np.pi * time), dims="time", coords={"time": time})
    >>> from stochlin.charts import portrait_chart
    >>> chart = portrait_chart(record, period=1.0, damping=0.05)
    >>> bool(chart.displacement.max() <= chart.pseudo_energy_radius)
    True
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
        caption=f"Elastic structure: T = {period:.3g} s, ξ = {damping:.3g}; r_PER = {float(peak):.3g} m"
        f"{_about(record)}",
    )


@checked
def energy_chart(
    record: xr.DataArray,
    period: float,
    damping: float,
    hardening: float,
    reduction_factor: float,
    points: Points = 161,
) -> xr.Dataset:
    """Fig. 1b: energy radius, input energy and dissipated energies, over time and over the period.

    An energy ``E`` per unit mass is shown as ``sqrt(2 E)/w``, the energy radius of an elastic structure
    with this energy. The pseudo energy radius is equal to the peak displacement or hardly larger, while
    the energies grow during the whole motion.

    Parameters
    ----------
    record : xarray.DataArray
        Record [m/s^2], such as from `stochlin.read_record`.
    period, damping : float
        Period [s] of the structures of the histories, and damping ratio [-] of all structures.
    hardening, reduction_factor : float
        Hardening ratio [-] of the yielding structures, and ratio [-] of the peak of the elastic
        displacement in the record to their yield displacement, at every period.
    points : int
        Number of periods of the spectra, from 0.1 to 5 s.

    Returns
    -------
    xarray.Dataset
        Over ``reduction_factor`` (1 for elastic structures) and ``time`` [s]: ``radius``,
        ``input_energy_radius``, ``viscous_energy_radius`` and ``hysteretic_energy_radius`` [m]. Over
        ``reduction_factor`` and ``period`` [s]: the same energies at the end of the record, with the
        ending ``_at_end``, and ``pseudo_energy_radius`` [m]. Also ``significant_begin`` and
        ``significant_end`` [s], the times at which the record has 5 and 95 % of its energy.

    Raises
    ------
    ValueError, TypeError
        If the record, a period or a damping ratio is out of range or of the wrong kind.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> time = np.arange(0, 10, 0.01)
    >>> record = xr.DataArray(np.sin(2 * np.pi * time), dims="time", coords={"time": time})
    >>> from stochlin.charts import energy_chart
    >>> chart = energy_chart(record, 1.0, 0.05, hardening=0.05, reduction_factor=4.0, points=5)
    >>> bool((chart.hysteretic_energy_radius.sel(reduction_factor=1.0) == 0).all())
    True
    """
    periods = _periods("period", "period", points)
    elastic = response_spectrum(record, periods, damping)
    peak = float(response_spectrum(record, period, damping).displacement_max)
    step = float(record["time"][1] - record["time"][0])
    refine = max(1, int(np.ceil(POINTS_PER_PERIOD / 2 * step / period)))
    tables = []
    for factor in (1.0, reduction_factor):
        structure, spectrum = Bilinear(period, damping), elastic
        if factor > 1:
            structure = Bilinear(period, damping, hardening, yield_displacement=peak / factor)
            weak = elastic.displacement_max / factor
            spectrum = response_spectrum(
                record, periods, damping, hardening=hardening, yield_displacement=weak
            )
        motion = respond(structure, record, refine=refine)
        table = motion[["radius"]].assign(pseudo_energy_radius=spectrum.pseudo_energy_radius)
        for kind in ENERGIES:
            for end, energies, of in (("", motion, period), ("_at_end", spectrum, periods)):
                squares = 2 * energies[f"{kind}_energy_per_mass"].clip(min=0.0)
                table[f"{kind}_energy_radius{end}"] = np.sqrt(squares) * of / (2 * np.pi)
        tables.append(table)
    factors = labels.axis("reduction_factor", "reduction factor R", np.array([1.0, reduction_factor]))
    chart = xr.concat(tables, factors, combine_attrs="drop", join="exact")
    strong = strong_part(record)
    chart = chart.assign(significant_begin=strong.time[0].item(), significant_end=strong.time[-1].item())
    return labels.label(chart, VARIABLES).assign_attrs(
        chart="energies",
        title=f"Pseudo energy radius and energies of {_source(record)}",
        caption=f"ξ = {damping:.3g}; over time: T = {period:.3g} s; yielding: R = {reduction_factor:g} "
        f"and hardening ratio {hardening:.3g}. An energy E of a mass m is drawn as √(2E/m)/ω."
        f"{_about(record)}",
    )


@checked
def per_spectrum_chart(records: Records, damping: float, points: Points = 161) -> xr.Dataset:
    """Pseudo energy radius and peak displacement of elastic structures over their period.

    Parameters
    ----------
    records : xarray.DataArray, or list or mapping of them
        Records [m/s^2], such as from `stochlin.read_record`.
    damping : float
        Damping ratio [-].
    points : int
        Number of periods, from 0.1 to 5 s.

    Returns
    -------
    xarray.Dataset
        ``pseudo_energy_radius`` and ``displacement_max`` [m] and ``status`` over ``period`` [s] and, for
        several records, ``record``.

    Raises
    ------
    ValueError, TypeError
        If the record, a period or a damping ratio is out of range or of the wrong kind.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> time = np.arange(0, 10, 0.01)
    >>> record = xr.DataArray(np.sin(2 * np.pi * time), dims="time", coords={"time": time})
    >>> from stochlin.charts import per_spectrum_chart
    >>> chart = per_spectrum_chart(record, damping=0.05, points=5)
    >>> bool((chart.pseudo_energy_radius >= chart.displacement_max).all())
    True
    """
    chart = pseudo_energy_radius(records, _periods("period", "period", points), damping)
    return chart.assign_attrs(
        chart="per_spectrum",
        title="Spectrum of the pseudo energy radius",
        caption=f"Elastic structures: ξ = {damping:.3g}",
    )


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
    periods = (_periods(f"period_{n}", f"period, structure {n}", points) for n in (1, 2))
    first, second = (Bilinear(period, damping) for period in periods)
    chart = energy_gap(first, second, record).rename(rho_estimate="rho_white_noise")
    chart = chart[["separation", "srss", "rho", "status", "critical_gap", "rho_white_noise"]]
    chart.rho.attrs["long_name"] = "correlation over the recorded motion"
    chart.rho_white_noise.attrs["long_name"] = "rho under white noise, eq. (4)"
    chart.critical_gap.attrs.update(units="m", long_name="critical gap")
    return chart.assign_attrs(
        chart="critical_gap",
        title=f"Critical gap in {_source(record)}",
        caption=f"Elastic structures: ξ = {damping:.3g}; the largest u1 - u2, and eqs. (3) and (4)"
        f"{_about(record)}",
    )


@checked
def added_damping_chart(
    record: xr.DataArray, first: Structure, second: Structure, gap: float | None = None
) -> xr.Dataset:
    """Gap of a record over the damping that is added to both structures, or to one of them.

    Parameters
    ----------
    record : xarray.DataArray
        Record [m/s^2], such as from `stochlin.read_record`.
    first, second : Structure
        The structures, as in `stochlin.damping_for_gap`.
    gap : float, optional
        Existing gap [m], for which the chart then has the least added damping.

    Returns
    -------
    xarray.Dataset
        Over ``damped`` and ``added_damping`` [-]: ``critical_gap`` [m], eqs. (3) and (4) with the energy
        radii, and ``separation`` [m], the largest ``u_1 - u_2`` in the record, as for
        `stochlin.damping_for_gap`; with a gap also the other variables of that function.

    Raises
    ------
    ValueError, TypeError
        As in `stochlin.damping_for_gap`.

    Examples
    --------
    >>> import stochlin as sl
    >>> import numpy as np, xarray as xr
    >>> time = np.arange(0, 10, 0.01)
    >>> record = xr.DataArray(np.sin(2 * np.pi * time), dims="time", coords={"time": time})
    >>> from stochlin.charts import added_damping_chart
    >>> chart = added_damping_chart(record, sl.Bilinear(0.7, 0.05), sl.Bilinear(1.0, 0.05))
    >>> chart.critical_gap.dims
    ('damped', 'added_damping')
    """
    if gap is None:
        chart = labels.label(damped_gaps(first, second, record, RhoEstimate()), SEPARATION)
        chart = chart[[*DAMPED_CURVES, "status"]]
    else:
        chart = damping_for_gap(record, first, second, gap)
    pair = [structure.arrays() for structure in (first, second)]
    entries = [f"T{n} = {float(own['period']):.3g} s" for n, own in enumerate(pair, start=1)]
    entries += [f"ξ{n} = {float(own['damping']):.3g}" for n, own in enumerate(pair, start=1)]
    kind = "Structures" if first.yields or second.yields else "Elastic structures"
    return chart.assign_attrs(
        chart="added_damping",
        title=f"Gap over added damping in {_source(record)}",
        caption=f"{kind}: {', '.join(entries)} before damping is added"
        + ("" if gap is None else "\nMarks: the least damping with which the gap is enough"),
    )


def _periods(name: str, long_name: str, points: int) -> xr.DataArray:
    return labels.axis(name, long_name, np.geomspace(*PERIODS, points), "s")


def _period(settings: ChartSettings, site: Ground) -> float:
    return settings.structure_period or ground_period(site)


def _source(record: xr.DataArray) -> str:
    return str(record.attrs.get("source", "a record"))


def _about(record: xr.DataArray) -> str:
    """A line that says how a motion was simulated; empty for a record."""
    return f"\n{record.attrs['about']}" if "about" in record.attrs else ""
