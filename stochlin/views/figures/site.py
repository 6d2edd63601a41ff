"""Charts of a record alone: the ground fitted to it, and the gap over added damping."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.analyses.records.spectra import fit_spectra
from stochlin.analyses.separation.added_damping import CURVES as DAMPED_CURVES
from stochlin.analyses.separation.added_damping import damped_gaps, damping_for_gap
from stochlin.analyses.separation.energy_gap import RhoEstimate
from stochlin.analyses.separation.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.models.arguments import checked
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import Structure
from stochlin.views.figures.charts import (
    HEIGHT,
    PICTURES,
    RECORD,
    ChartInputs,
    ground_caption,
    register_chart,
)
from stochlin.views.figures.fig1 import source_of, structure_period
from stochlin.views.figures.kinds import SQUARE
from stochlin.views.figures.panels import CENTIMETRES, in_a_row, in_cm
from stochlin.views.shared.style import CURVES, quantity
from stochlin.views.shared.symbols import typeset

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SECOND_PERIOD = 0.7  # default period of the second structure, over that of the first


@register_chart("site_spectrum", RECORD, place=10)
def _site_spectrum(inputs: ChartInputs) -> xr.Dataset:
    site = inputs.site
    return fit_spectra(inputs.motion, site).assign_attrs(
        chart="spectra",
        title=f"Ground fitted to {source_of(inputs.motion)}",
        caption=f"{ground_caption([site])}\n{site.source}",
    )


@PICTURES.register("spectra")
def draw_spectra(figure: Figure, dataset: xr.Dataset) -> None:
    """Spectral density of the record and of the ground fitted to it."""
    [axes] = in_a_row(figure, 1, HEIGHT - 1.2)
    frequency = dataset.frequency.values
    drawn = (
        ("psd_record", "0.75", "-", 0.6, "record, periodogram"),
        ("psd_smoothed", "0.35", "-", 1.2, "record, smoothed"),
        ("psd_ground", "#8c2d04", (0, (6, 1.5)), 1.8, "fitted ground"),
    )
    highest = max(float(dataset[name].max()) for name in ("psd_smoothed", "psd_ground"))
    for name, color, dash, width, label in drawn:
        axes.plot(frequency, dataset[name], color=color, linestyle=dash, lw=width, label=label)
    peak = frequency[int(dataset.psd_ground.values.argmax())]
    axes.set(xlim=(0, min(5 * peak, frequency[-1])), ylim=(0, 1.1 * highest))
    axes.ticklabel_format(axis="y", scilimits=(-1, 2), useMathText=True)
    axes.set(xlabel=quantity(dataset.frequency), ylabel=quantity(dataset.psd_ground))


@register_chart("added_damping", RECORD, place=15)
def _added_damping(inputs: ChartInputs) -> xr.Dataset:
    settings, period = inputs.settings, structure_period(inputs)
    other = settings.second_period or SECOND_PERIOD * period
    first, second = (Bilinear(T, settings.damping) for T in (period, other))
    return added_damping_chart(inputs.motion, first, second, settings.gap)


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
        chart = labels.label(damped_gaps(first, second, record, RhoEstimate()), VARIABLES)
        chart = chart[[*DAMPED_CURVES, "status"]]
    else:
        chart = damping_for_gap(record, first, second, gap)
    pair = [structure.arrays() for structure in (first, second)]
    entries = [f"T{n} = {float(own['period']):.3g} s" for n, own in enumerate(pair, start=1)]
    entries += [f"ξ{n} = {float(own['damping']):.3g}" for n, own in enumerate(pair, start=1)]
    kind = "Structures" if first.yields or second.yields else "Elastic structures"
    return chart.assign_attrs(
        chart="added_damping",
        title=f"Gap over added damping in {source_of(record)}",
        caption=f"{kind}: {', '.join(entries)} before damping is added"
        + ("" if gap is None else "\nMarks: the least damping with which the gap is enough"),
    )


@PICTURES.register("added_damping")
def draw_added_damping(figure: Figure, dataset: xr.Dataset) -> None:
    """Gap over added damping, with panels for damping in both structures and in each of them."""
    shown = (
        ("separation", "largest u1 - u2 in the record", "least_added_damping_recorded", "o"),
        ("critical_gap", "eqs. (3) and (4), energy radii", "least_added_damping", "s"),
    )
    gap = dataset.attrs.get("gap_m")
    highest = max(float(dataset[name].max()) for name, *_ in shown)
    every = in_a_row(figure, dataset.sizes["damped"], SQUARE, shared=True)
    added = dataset.added_damping
    for axes, where in zip(every, dataset.damped.values, strict=True):
        curves = dataset.sel(damped=where)
        for (name, label, least, marker), (color, dash) in zip(shown, CURVES, strict=False):
            axes.plot(added, in_cm(curves[name]), color=color, linestyle=dash, label=typeset(label))
            if gap is not None and np.isfinite(curves[least]):
                place = float(curves[least]), CENTIMETRES * gap
                axes.plot(*place, marker=marker, ms=6, mfc="w", color=color, zorder=4)
        if gap is not None:
            axes.axhline(CENTIMETRES * gap, color="0.5", lw=1, label="existing gap")
        axes.set_title(f"added to {where}", loc="left")
        axes.set(xlim=(0, float(added[-1])), ylim=(0, 1.05 * CENTIMETRES * max(highest, gap or 0)))
        axes.set(xlabel=quantity(added), ylabel=quantity(in_cm(curves.critical_gap)))
        axes.label_outer()
