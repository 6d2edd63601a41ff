"""Charts by name: what each computes, its dataset as a file has it, and its picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Annotated, NamedTuple, TypeVar

import numpy as np
import xarray as xr

from stochlin.models.arguments import OneOf, checked
from stochlin.models.envelopes import AminAng
from stochlin.models.grounds import Ground, KanaiTajimi
from stochlin.registry import LAST, Registry
from stochlin.solver.simulation.ground_motions import simulated_motions
from stochlin.views.figures.panels import PRINT_STYLE, SCREEN_STYLE, arrange, width_in_print
from stochlin.views.figures.settings import (
    BROAD_BAND_DAMPING,
    NARROW_BAND_DAMPING,
    ChartSettings,
)
from stochlin.views.shared.style import styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMULA, GROUND, MOTION, RECORD = SUBJECTS = ("formula", "ground", "motion", "record")
Subject = Annotated[str, OneOf(SUBJECTS)]
# Motions of Figs. 1, 2 and 5b, in periods of the ground, so that an amplification does not depend on it:
# the duration, the ends of the rise and of the strong part, and the decay. For 2 s it lasts 30 s.
DURATION, RISE_END, STRONG_END, DECAY = 15.0, 2.0, 7.5, 0.7
LONGEST_MEMORY = 2 * DURATION
SIMULATED_INTENSITY, SIMULATED_STEP = 0.004, 0.02  # m^2/s^3, s
BANDS = {NARROW_BAND_DAMPING: "narrow band, ", BROAD_BAND_DAMPING: "broad band, "}
HEIGHT = 4.6  # inches
MEMORY = "drift_memory"  # variable with the memory of plastic drifts [s]


@dataclass(frozen=True)
class ChartInputs:
    """What charts are made of: the settings, and the record with its ground or what stands for them."""

    settings: ChartSettings
    record: xr.DataArray | None = None
    fitted: Ground | None = None

    @property
    def ground(self) -> Ground:
        """The fitted ground, or the model grounds over ``ground``, the titles of their panels."""
        dampings = self.settings.ground_dampings
        if self.fitted is not None or len(dampings) == 1:
            return self.site
        titles = [f"{BANDS.get(damping, '')}ξg = {damping:g}" for damping in dampings]
        axis = xr.DataArray(titles, dims="ground", attrs={"long_name": "ground"})
        damping = xr.DataArray(list(dampings), dims="ground", coords={"ground": axis})
        return KanaiTajimi(self.settings.ground_period, damping)

    @property
    def site(self) -> Ground:
        """The ground fitted to the record, or the first model ground."""
        settings = self.settings
        return self.fitted or KanaiTajimi(settings.ground_period, settings.ground_dampings[0])

    @cached_property
    def motion(self) -> xr.DataArray:
        """The record, or a simulated motion as strong as one on the lake bed of Mexico City in 1985."""
        if self.record is not None:
            return self.record
        period, seed = float(self.site.arrays()["period"]), self.settings.seed
        duration, envelope = design_motion(period)
        ground = KanaiTajimi(period, float(self.site.arrays()["damping"]), intensity=SIMULATED_INTENSITY)
        motion = simulated_motions(ground, duration, envelope, paths=2, seed=seed, step=SIMULATED_STEP)
        about = (
            f"Motion simulated with seed {seed}: {ground_caption(ground)}, S0 = "
            f"{SIMULATED_INTENSITY:g} m²/s³; {envelope_caption(duration, envelope)}"
        )
        return motion[0].assign_attrs(source="a simulated motion", about=about)


Compute = TypeVar("Compute", bound=Callable[[ChartInputs], xr.Dataset])


class Chart(NamedTuple):
    """A chart by the function that computes its dataset, and what it is of."""

    compute: Callable[[ChartInputs], xr.Dataset]
    of: str


CHARTS: Registry[Chart] = Registry("chart", "stochlin.views.figures")
# Functions that draw the axes of a dataset into a figure, by its attribute ``chart`` or ``comparison``.
PICTURES: Registry[Callable[[Figure, xr.Dataset], None]] = Registry("chart", "stochlin.views.figures")


@checked
def register_chart(name: str, of: Subject = FORMULA, place: int = LAST) -> Callable[[Compute], Compute]:
    """A decorator that makes a chart of the function that computes its dataset.

    Parameters
    ----------
    name : str
        Name of the chart and of its files.
    of : {"formula", "ground", "motion", "record"}
        What it is of. Charts of a formula are not drawn for a record. Those of a ground are drawn for
        the model grounds or for the ground fitted to a record, those of a motion for a simulated one or
        for the record, and those of a record only if there is one.
    place : int
        Charts with a lower number are drawn first.
    """

    def register(compute: Compute) -> Compute:
        CHARTS.register(name, place)(Chart(compute, of))
        return compute

    return register


@checked
def chart_functions(
    settings: ChartSettings, record: xr.DataArray | None = None, site: Ground | None = None
) -> Mapping[str, Callable[[], xr.Dataset]]:
    """Charts by name, each as a function without arguments that computes its dataset.

    Parameters
    ----------
    settings : ChartSettings
        Parameters of the charts.
    record : xarray.DataArray, optional
        Record [m/s^2] for the charts of a site. The default is a simulated motion on the first of the
        model grounds.
    site : Ground, optional
        Ground fitted to the record. With both, the charts are those of the site.

    Returns
    -------
    mapping
        Functions by the name of the chart, which is the name of its file without suffix. The datasets
        have six significant digits, so that the same inputs give the same file.

    Examples
    --------
    >>> from stochlin.charts import ChartSettings, chart_functions
    >>> functions = chart_functions(ChartSettings(points=5))
    >>> functions["fig3a"]().rho.dims
    ('damping', 'period_ratio')
    """
    of_site = record is not None and site is not None
    inputs = ChartInputs(settings, record, site) if of_site else ChartInputs(settings)
    drawn = (GROUND, MOTION, RECORD if of_site else FORMULA)
    ending = "_site" if of_site else ""
    return {
        f"{name}{ending if chart.of == GROUND else ''}": partial(_for_file, chart, inputs)
        for name, chart in CHARTS.items()
        if chart.of in drawn
    }


def _for_file(chart: Chart, inputs: ChartInputs) -> xr.Dataset:
    return for_file(chart.compute(inputs))


def for_file(chart: xr.Dataset) -> xr.Dataset:
    """A chart as its file and its picture have it: six significant digits, and no version.

    The rounding errors of another processor or number of threads do not show in six digits, so that
    the same inputs give the same file; what is below 1e-9 of a variable's largest value is zero.
    """
    chart = chart.copy()
    for name, array in chart.variables.items():
        if array.dtype.kind == "f":
            chart[name] = array.dims, rounded(array.values), array.attrs
    for key in ("stochlin_version", "history"):
        chart.attrs.pop(key, None)
    for key, value in chart.attrs.items():
        if isinstance(value, float):
            chart.attrs[key] = float(f"{value:.5e}")
    return chart


def rounded(values: np.ndarray) -> np.ndarray:
    """Values to six significant digits, or to 1e-9 of the largest one."""
    largest = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    if largest > 0:
        decade = np.floor(np.log10(float(f"{largest:.5e}")))
        values = np.round(values, int(9 - decade))
    return np.char.mod("%.5e", values).astype(float) + 0.0  # no -0


def design_motion(period: float) -> tuple[float, AminAng]:
    """Duration [s] and envelope of the finite motions on a ground of this period."""
    return DURATION * period, AminAng(RISE_END * period, STRONG_END * period, DECAY / period)


def envelope_caption(duration: float, envelope: AminAng) -> str:
    """Duration and envelope, for the caption of a picture."""
    return (
        f"{duration:.3g} s of motion, Amin-Ang envelope: rise to {envelope.rise_end:.3g} s, strong to "
        f"{envelope.strong_end:.3g} s, decay {envelope.decay:.3g} 1/s"
    )


def ground_caption(ground: Ground) -> str:
    """Name and parameters of a ground, for the caption of a picture."""
    symbols = {"period": "Tg = {} s", "damping": "ξg = {}"}
    symbols |= {f"high_pass_{name}": text.replace("g", "f") for name, text in symbols.items()}
    texts = [
        text.format(" and ".join(f"{value:.3g}" for value in ground.arrays()[name].values.ravel()))
        for name, text in symbols.items()
        if name in ground.arrays()
    ]
    return f"{ground.name} ground, {', '.join(texts)}"


def longest_memory(ground: Ground) -> float:
    """Memory of a plastic drift [s] above which a stationary response is hardly ever reached."""
    return LONGEST_MEMORY * float(ground.arrays()["period"])


def is_slow(chart: xr.Dataset) -> xr.DataArray:
    """Where the plastic drift has a longer memory than any real motion: these points are open."""
    return chart[MEMORY] > chart.attrs["longest_memory_s"]


@styled(SCREEN_STYLE)
def draw(dataset: xr.Dataset, *, comparison: bool = False, print_width: float | None = None) -> Figure:
    """Draw one chart dataset.

    Parameters
    ----------
    dataset : xarray.Dataset
        A result of the functions of ``stochlin.charts``, from memory or from file. Its attribute
        ``chart`` gives the kind of picture, and ``comparison`` that of its second picture.
    comparison : bool
        Whether to draw the second picture of the chart, with all methods beside one another.
    print_width : float, optional
        Width [m] of the picture in print, such as 0.084 for one column and 0.174 for two. It then has no
        title and no notes, and no text below 7 points. The default is a picture for the screen.

    Returns
    -------
    matplotlib.figure.Figure
        Figure with title and legend above the panels and the parameters below them.

    Raises
    ------
    ValueError
        If the dataset is no chart, has no finite numbers or no comparison, or the width is out of range.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    if "chart" not in dataset.attrs:
        dimensions, allowed = tuple(dataset.dims), ", ".join(PICTURES)
        raise ValueError(f"dataset over {dimensions} has no attribute chart; allowed: {allowed}")
    if comparison and "comparison" not in dataset.attrs:
        raise ValueError("comparison = True; allowed: False, since this chart has no second picture")
    kind = dataset.attrs["comparison" if comparison else "chart"]
    draw_axes = PICTURES.named(kind, "attribute chart")
    numbers = [array for array in dataset.data_vars.values() if array.dtype.kind == "f"]
    if numbers and not any(bool(np.isfinite(array).any()) for array in numbers):
        raise ValueError(
            "the chart has no finite number to draw; allowed: parameters in their ranges; its status "
            "names the cause"
        )
    notes = ["caption", *["comparison_caption"][: int(comparison)], "comment"]
    words = [dataset.attrs.get(key, "") for key in ("title", *notes)]
    with mpl.rc_context({} if print_width is None else PRINT_STYLE):
        figure = Figure(figsize=(width_in_print(print_width), HEIGHT), layout="constrained")
        draw_axes(figure, dataset)
        arrange(figure, *(words if print_width is None else [""]))
    return figure
