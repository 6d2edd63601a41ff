"""Figs. 1 and 2, of a motion: pseudo energy radius, energies and critical gap over the periods."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.applications.figures.charts import ChartSettings, register_chart
from stochlin.applications.records.records import strong_part
from stochlin.applications.records.response import pseudo_energy_radius, respond, response_spectrum
from stochlin.applications.separation.energy_gap import energy_gap
from stochlin.models.arguments import Points, checked
from stochlin.models.descriptions import roles_in_words
from stochlin.models.laws.bilinear import Bilinear
from stochlin.solver.tables import labels

if TYPE_CHECKING:
    pass

PORTRAIT_POINTS = 32  # for a smooth phase portrait
MOST_POINTS = 61  # along an axis of Fig. 2, which needs the response to the record for each
PERIOD_ENDS = (0.1, 5.0)  # first and last period of an axis [s]
SHOWN_ENERGIES = ("input", "viscous", "hysteretic")
PORTRAIT_VARIABLES = {
    "velocity_over_frequency": ("m", "velocity over circular frequency"),
    **{
        f"{kind}_energy_radius": ("m", f"radius of the {kind} energy so far")
        for kind in SHOWN_ENERGIES
    },
    "significant_begin": ("s", "time of 5 % of the energy of the record"),
    "significant_end": ("s", "time of 95 % of the energy of the record"),
}


@register_chart("fig1", place=11)
def _fig1(settings: ChartSettings) -> xr.Dataset:
    # Away from the period of the ground the radius is more than the displacement.
    return portrait_chart(settings.motion, settings.ground_period / 2, settings.damping)


@register_chart("fig1b", place=12)
def _fig1b(settings: ChartSettings) -> xr.Dataset:
    strength = settings.hardening, settings.plane_reduction_factor
    return energy_chart(settings.motion, settings.ground_period, settings.damping, *strength)


@checked
def portrait_chart(record: xr.DataArray, period: float, damping: float) -> xr.Dataset:
    """Fig. 1a: phase portrait ``u'/w`` over ``u``, and the pseudo energy radius.

    Parameters
    ----------
    record : xarray.DataArray
        Record [m/s^2], such as from `stochlin.read_record`.
    period, damping : float
        Period [s] and damping ratio [-] of the elastic structure.

    Returns
    -------
    xarray.Dataset
        ``displacement``, ``velocity_over_frequency`` and ``radius`` [m] over ``time``, and
        ``pseudo_energy_radius`` [m].

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
    >>> record = xr.DataArray(
    ...     np.sin(2 * np.pi * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> from stochlin.charts import portrait_chart
    >>> chart = portrait_chart(record, period=1.0, damping=0.05)
    >>> bool(chart.displacement.max() <= chart.pseudo_energy_radius)
    True
    """
    peak = pseudo_energy_radius(record, period, damping).pseudo_energy_radius
    refine = _refine(record, period, PORTRAIT_POINTS)
    motion = respond(Bilinear(period, damping), record, refine=refine)
    chart = motion[["displacement", "radius"]].assign(
        velocity_over_frequency=motion.velocity * period / (2 * np.pi),
        pseudo_energy_radius=peak,
    )
    return labels.label(chart, PORTRAIT_VARIABLES).assign_attrs(
        chart="portrait",
        title=f"Pseudo energy radius of {source_of(record)}",
        caption=f"Elastic structure: T = {period:.3g} s, ξ = {damping:.3g}; "
        f"r_PER = {100 * float(peak):.3g} cm{about(record)}",
    )


@checked
def energy_chart(
    record: xr.DataArray, period: float, damping: float, hardening: float, reduction_factor: float
) -> xr.Dataset:
    """Fig. 1b: energy radius, input energy and dissipated energies over time, elastic and yielding.

    An energy ``E`` per unit mass is shown as ``sqrt(2 E)/w``, the energy radius of an elastic
    structure with this energy. The pseudo energy radius is equal to the peak displacement or hardly
    larger, while the energies grow during the whole motion.

    Parameters
    ----------
    record : xarray.DataArray
        Record [m/s^2], such as from `stochlin.read_record`.
    period, damping : float
        Period [s] and damping ratio [-] of the structures.
    hardening, reduction_factor : float
        Hardening ratio [-] of the yielding structure, and ratio [-] of the peak of the elastic
        displacement in the record to its yield displacement.

    Returns
    -------
    xarray.Dataset
        Over ``reduction_factor`` (1 for the elastic structure) and ``time`` [s]: ``radius``,
        ``input_energy_radius``, ``viscous_energy_radius`` and ``hysteretic_energy_radius`` [m].
        Also ``significant_begin`` and ``significant_end`` [s], the times at which the record has 5
        and 95 % of its energy.

    Raises
    ------
    ValueError, TypeError
        If the record, a period or a damping ratio is out of range or of the wrong kind.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> time = np.arange(0, 10, 0.01)
    >>> record = xr.DataArray(
    ...     np.sin(2 * np.pi * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> from stochlin.charts import energy_chart
    >>> chart = energy_chart(record, 1.0, 0.05, hardening=0.05, reduction_factor=4.0)
    >>> bool((chart.hysteretic_energy_radius.sel(reduction_factor=1.0) == 0).all())
    True
    """
    peak = float(response_spectrum(record, period, damping).displacement_max)
    yielding = Bilinear(period, damping, hardening, yield_displacement=peak / reduction_factor)
    refine = _refine(record, period, PORTRAIT_POINTS / 2)
    tables = []
    for structure in (Bilinear(period, damping), yielding):
        motion = respond(structure, record, refine=refine)
        table = motion[["radius"]]
        for kind in SHOWN_ENERGIES:
            squares = 2 * motion[f"{kind}_energy_per_mass"].clip(min=0.0)
            table[f"{kind}_energy_radius"] = np.sqrt(squares) * period / (2 * np.pi)
        tables.append(table)
    factors = labels.axis(
        "reduction_factor", "reduction factor R", np.array([1.0, reduction_factor])
    )
    chart = xr.concat(tables, factors, combine_attrs="drop", join="exact")
    strong = strong_part(record)
    chart = chart.assign(
        significant_begin=strong.time[0].item(), significant_end=strong.time[-1].item()
    )
    return labels.label(chart, PORTRAIT_VARIABLES).assign_attrs(
        chart="energies",
        title=f"Pseudo energy radius and energies of structures in {source_of(record)}",
        caption=f"T = {period:.3g} s, ξ = {damping:.3g}; yielding: R = {reduction_factor:g} and "
        f"hardening ratio {hardening:.3g}. An energy E of a structure of mass m is drawn as "
        f"√(2E/m)/ω.{about(record)}",
    )


@register_chart("fig2", place=14)
def _fig2(settings: ChartSettings) -> xr.Dataset:
    return recorded_gap_chart(settings.motion, settings.damping, min(settings.points, MOST_POINTS))


@checked
def recorded_gap_chart(record: xr.DataArray, damping: float, points: Points = 61) -> xr.Dataset:
    """Fig. 2: critical gap over the periods of two elastic structures.

    In the paper it is that for the Taft record.

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
        record; ``critical_gap`` [m], eq. (3) with the pseudo energy radii and ``rho_white_noise``
        [-] of eq. (4); ``srss`` [m], the root of the sum of the squares of both; ``rho`` [-], the
        correlation coefficient over the record; and ``status``.

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
    >>> record = xr.DataArray(
    ...     np.sin(2 * np.pi * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    ... )
    >>> from stochlin.charts import recorded_gap_chart
    >>> chart = recorded_gap_chart(record, damping=0.05, points=5)
    >>> float(abs(chart.separation.values.diagonal()).max())
    0.0
    """
    periods = np.geomspace(*PERIOD_ENDS, points)
    first = Bilinear(labels.axis("period_1", "period, structure 1", periods, "s"), damping)
    second = Bilinear(labels.axis("period_2", "period, structure 2", periods, "s"), damping)
    chart = energy_gap(first, second, record).rename(rho_estimate="rho_white_noise")
    chart = chart[["separation", "srss", "rho", "status", "critical_gap", "rho_white_noise"]]
    chart.rho.attrs["long_name"] = "correlation over the recorded motion"
    chart.rho_white_noise.attrs["long_name"] = "rho under white noise, eq. (4)"
    chart.critical_gap.attrs.update(units="m", long_name="critical gap")
    return chart.assign_attrs(
        chart="critical_gap",
        title=f"Critical gap in {source_of(record)}",
        caption=f"Elastic structures: ξ = {damping:.3g}; the largest u1 - u2, and eqs. (3) "
        f"and (4) over it: below 1, within thick lines, unsafe{about(record)}",
    )


def _refine(record: xr.DataArray, period: float, points: float) -> int:
    """Steps of the response in a step of the record, for so many points a period."""
    step = float(record["time"][1] - record["time"][0])
    return max(1, int(np.ceil(points * step / period)))


def source_of(record: xr.DataArray) -> str:
    """What a title calls a record."""
    return str(record.attrs.get("source", "a record"))


def about(record: xr.DataArray) -> str:
    """Lines that say how a motion was simulated; empty for a record."""
    return "".join(f"\n{line}" for line in roles_in_words(record.attrs, "ground", "envelope"))
