"""The chart of a record alone: the ground fitted to it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import xarray as xr

from stochlin.applications.records.spectra import fit_spectra
from stochlin.views.figures.charts import (
    HEIGHT,
    PICTURES,
    RECORD,
    ChartInputs,
    ground_caption,
    register_chart,
)
from stochlin.views.figures.fig1 import source_of
from stochlin.views.figures.panels import in_a_row
from stochlin.views.shared.style import quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@register_chart("site_spectrum", RECORD, place=10)
def _site_spectrum(inputs: ChartInputs) -> xr.Dataset:
    site = inputs.site
    return fit_spectra(inputs.motion, site).assign_attrs(
        chart="spectra",
        title=f"Ground fitted to {source_of(inputs.motion)}",
        caption=f"{ground_caption(site)}\n{site.source}",
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
