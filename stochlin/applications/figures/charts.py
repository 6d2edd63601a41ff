"""Charts by name: their settings, what each computes, and its dataset as a file has it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any

import numpy as np
import xarray as xr

from stochlin.messages import Named
from stochlin.models.arguments import (
    DampingRatio,
    Number,
    Paths,
    Points,
    Seconds,
    Seed,
    Whole,
    check_fields,
    checked,
)
from stochlin.models.envelopes import AminAng
from stochlin.models.grounds import Ground, KanaiTajimi
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.rules.effective_properties import effective_rule
from stochlin.models.structures import STATIONARY_HARDENING
from stochlin.registry import Registry
from stochlin.solver.simulation.ground_motions import simulated_motions

NARROW_BAND_DAMPING = 0.05  # that of the paper for Figs. 4 and 5
BROAD_BAND_DAMPING = 0.6  # that of firm soil, Der Kiureghian & Neuenhofer 1992
REDUCTION_FACTOR = Number(Bilinear.allowed("reduction_factor"))
GROUND_DAMPING_RATIO = Number(KanaiTajimi.allowed("damping"))
# Motions of Figs. 1, 2, 5b and 9, in periods of the ground, so that ratios do not depend on it: the
# duration, the ends of the rise and of the strong part, and the decay. For 2 s it lasts 30 s.
MOTION_PERIODS = 15.0
RISE_END = 2.0
STRONG_END = 7.5
DECAY = 0.7
# Memory of a plastic drift above which a stationary response is hardly ever reached, in periods as
# well.
LONGEST_MEMORY = 2 * MOTION_PERIODS
SIMULATED_INTENSITY = 0.004  # m^2/s^3
SIMULATED_STEP = 0.02  # s
DRIFT_MEMORY = "drift_memory"  # variable with the memory of plastic drifts [s]
BANDS = {NARROW_BAND_DAMPING: "narrow band, ", BROAD_BAND_DAMPING: "broad band, "}


def all_of(check: Number) -> Callable[[str, Sequence[Any]], None]:
    """A check of all values of a list, which must not be empty."""

    def check_all(name: str, values: Sequence[Any]) -> None:
        for value in values or [None]:
            check(name, value)

    return check_all


@dataclass(frozen=True)
class ChartSettings(metaclass=Named):
    """Parameters of the charts, most of which the text of the paper does not state.

    Parameters
    ----------
    damping, hardening : float
        Damping ratio and hardening ratio [-] of all structures.
    reduction_factors : tuple of float
        Reduction factors [-] of the curves in Figs. 4 and 5b, and of the panels of Fig. 9.
    plane_reduction_factor : float
        Reduction factor [-] in Fig. 5a; that of the paper is 4.
    ductility : float
        Peak ductility [-] of both structures in Fig. 3b.
    ground_period : float
        Period ``Tg`` [s] of the model grounds.
    ground_dampings : tuple of float
        Damping ratios [-] of the model grounds; Figs. 4, 5 and 9 have a panel for each.
    points : int
        Number of periods along an axis.
    paths, seed : int
        Number and seed of simulated motions, as in `stochlin.simulate`.
    simulated_points : int, optional
        Number of periods at which each curve of Figs. 4 and 9, and Fig. 5a along each axis, are
        also simulated; 0 for none. The default is 21 for a curve, 11 in Fig. 9, and 41 for an axis.
    curves : tuple of str, optional
        Effective rules in Fig. 3b: names of `stochlin.rules.effective_rule_names` or of unverified
        rules. The default is all verified rules and that of the paper.
    record : DataArray, optional
        Record [m/s^2] over ``time`` [s] for Figs. 1 and 2, as from `stochlin.read_record`. The
        default is a simulated motion.

    Raises
    ------
    ValueError, TypeError
        If a value is out of range or of the wrong kind, or a rule is unknown.

    Examples
    --------
    >>> from stochlin.charts import ChartSettings
    >>> ChartSettings(points=5).fine_points
    9
    """

    damping: DampingRatio = 0.05
    hardening: Annotated[float, Number(STATIONARY_HARDENING)] = 0.05
    reduction_factors: Annotated[tuple[float, ...], all_of(REDUCTION_FACTOR)] = (1.0, 2.0, 4.0, 6.0)
    plane_reduction_factor: Annotated[float, REDUCTION_FACTOR] = 4.0
    ductility: Annotated[float, REDUCTION_FACTOR] = 4.0
    ground_period: Seconds = 2.0
    ground_dampings: Annotated[tuple[float, ...], all_of(GROUND_DAMPING_RATIO)] = (
        NARROW_BAND_DAMPING,
        BROAD_BAND_DAMPING,
    )
    points: Points = 161
    paths: Paths = 256
    seed: Seed = 0
    simulated_points: Annotated[int, Whole(0)] | None = None
    curves: tuple[str, ...] | None = None
    record: xr.DataArray | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if self.simulated_points == 1:
            raise ValueError("simulated_points = 1; allowed: at least 2, or 0 for none")
        for rule in self.curves or ():
            effective_rule(rule)

    @property
    def ground(self) -> Ground:
        """The model grounds over ``ground``, the titles of panels; a ground alone has none."""
        dampings = self.ground_dampings
        if len(dampings) == 1:
            return KanaiTajimi(self.ground_period, dampings[0])
        titles = [f"{BANDS.get(damping, '')}ξg = {damping:g}" for damping in dampings]
        axis = xr.DataArray(titles, dims="ground", attrs={"long_name": "ground"})
        damping = xr.DataArray(list(dampings), dims="ground", coords={"ground": axis})
        return KanaiTajimi(self.ground_period, damping)

    @property
    def motion(self) -> xr.DataArray:
        """The record, or a simulated one of the first ground, as strong as Mexico City in 1985."""
        if self.record is not None:
            return self.record
        duration, envelope = design_motion(self.ground_period)
        ground = KanaiTajimi(self.ground_period, self.ground_dampings[0], SIMULATED_INTENSITY)
        chosen: Any = {"paths": 2, "seed": self.seed, "step": SIMULATED_STEP}
        motion = simulated_motions(ground, duration, envelope, **chosen)[0]
        return motion.assign_attrs(source=f"a simulated motion of {duration:g} s, seed {self.seed}")

    @property
    def fine_points(self) -> int:
        """Number of points of a curve that is quickly computed, about twice ``points``."""
        return 2 * self.points - 1


USUAL_SETTINGS = ChartSettings()
CHARTS: Registry[Callable[[ChartSettings], xr.Dataset]] = Registry(
    "chart", "stochlin.applications.figures"
)
# A decorator, ``register_chart(name, place)``, of the function that computes a chart from the
# settings.
register_chart = checked(CHARTS.register)


@checked
def chart_functions(settings: ChartSettings) -> Mapping[str, Callable[[], xr.Dataset]]:
    """Charts by name, each as a function without arguments that computes its dataset.

    Parameters
    ----------
    settings : ChartSettings
        Parameters of the charts.

    Returns
    -------
    mapping
        Functions by the name of the chart, which is the name of its file without suffix. The
        datasets have six significant digits, so that the same settings give the same file.

    Examples
    --------
    >>> from stochlin.charts import ChartSettings, chart_functions
    >>> functions = chart_functions(ChartSettings(points=5))
    >>> functions["fig3a"]().rho.dims
    ('damping', 'period_ratio')
    """

    def computed(chart: Callable[[ChartSettings], xr.Dataset]) -> xr.Dataset:
        return for_file(chart(settings))

    return {name: partial(computed, chart) for name, chart in CHARTS.items()}


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
    return MOTION_PERIODS * period, AminAng(RISE_END * period, STRONG_END * period, DECAY / period)


def is_slow(chart: xr.Dataset) -> xr.DataArray:
    """Where the plastic drift has a longer memory than any real motion: these points are open."""
    return chart[DRIFT_MEMORY] > chart.attrs["longest_memory_s"]
