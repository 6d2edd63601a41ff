"""Registry of the charts by name, each with the function that computes its dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from inspect import signature
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.charts.settings import (
    BROAD_BAND_DAMPING,
    NARROW_BAND_DAMPING,
    ChartSettings,
)
from stochlin.analyses.simulation.ground_motions import simulated_motions
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.messages import brief
from stochlin.models.arguments import checked
from stochlin.models.envelopes import AminAng
from stochlin.models.grounds import Ground, KanaiTajimi
from stochlin.registry import Registry

# The names of the parameters of a chart function select its arguments: the settings; a ground, for
# which the chart has a panel for each; a record; a motion, which is the record or else a simulated one;
# its site, the ground fitted to the record or else the first model ground.
CHARTS: Registry[Callable[..., xr.Dataset]] = Registry("chart", "stochlin.analyses.charts")
GIVEN = {"settings", "ground", "record", "motion", "site"}
GROUND = "ground"
# Motions of Figs. 1, 2 and 5b, in periods of the ground, so that an amplification does not depend on it:
# the duration, the ends of the rise and of the strong part, and the decay. For 2 s it lasts 30 s.
DURATION, RISE_END, STRONG_END, DECAY = 15.0, 2.0, 7.5, 0.7
SIMULATED_INTENSITY, SIMULATED_STEP = 0.004, 0.02  # m^2/s^3, s


@dataclass(frozen=True)
class ChartFunction:
    """A chart that is still to be computed: with several grounds, on each, joined over ``ground``.

    Parameters
    ----------
    compute : callable
        Function of the registry that computes the dataset.
    given : dict
        What the function asks for, except a ground.
    grounds : dict
        Grounds by the titles of their panels; empty for a chart that asks for none.
    """

    compute: Callable[..., xr.Dataset]
    arguments: Mapping[str, Any]
    grounds: Mapping[str, Ground]

    def __call__(self, progress: Progress | None = None) -> xr.Dataset:
        """The dataset as in its file; ``progress`` is called with the share that is done."""
        reports = "progress" in signature(self.compute).parameters
        tables: dict[str, xr.Dataset] = {}
        runs = [{"ground": ground} for ground in self.grounds.values()] or [{}]
        for number, own in enumerate(runs):
            part = part_of(progress, number / len(runs), (number + 1) / len(runs))
            options = {"progress": part} if reports else {}
            tables[[*self.grounds, ""][number]] = self.compute(**self.arguments, **own, **options)
        return for_file(_joined(tables))


def _joined(tables: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Tables of several grounds over ``ground``; captions and comments keep all that they say."""
    first, *others = tables.values()
    if not others:
        return first
    axis = xr.DataArray(list(tables), dims=GROUND, name=GROUND, attrs={"long_name": "ground"})
    how: Any = {"data_vars": "all", "coords": "minimal", "compat": "override", "join": "exact"}
    chart = xr.concat(list(tables.values()), axis, combine_attrs="drop_conflicts", **how)
    for key in ("caption", "plain_caption"):
        if texts := [table.attrs[key].splitlines() for table in tables.values() if key in table.attrs]:
            chart.attrs[key] = "\n".join(map(_one_line, zip(*texts, strict=False)))
    for key in ("comment", "plain_comment"):
        comments = {name: table.attrs[key] for name, table in tables.items() if key in table.attrs}
        if comments and key not in chart.attrs:
            begun = (name if name[0] == "ξ" else name[0].upper() + name[1:] for name in comments)
            chart.attrs[key] = " ".join(map(": ".join, zip(begun, comments.values(), strict=True)))
    return chart


def _one_line(lines: Iterable[str]) -> str:
    """Lines of several grounds as one, with all words where they differ: ``ξg = 0.05 and 0.6``."""
    several = [[*dict.fromkeys(words)] for words in zip(*map(str.split, lines), strict=True)]
    return " ".join(" and ".join([*(w.rstrip(";") for w in words[:-1]), words[-1]]) for words in several)


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


@checked
def chart_functions(
    settings: ChartSettings, record: xr.DataArray | None = None, site: Ground | None = None
) -> Mapping[str, ChartFunction]:
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
        Functions by the name of the chart, which is the name of its file without suffix. They may be
        given ``progress``, which is called with the share of the work that is done.

    Examples
    --------
    >>> from stochlin.charts import ChartSettings, chart_functions
    >>> functions = chart_functions(ChartSettings(points=5))
    >>> functions["fig3a"]().rho.dims
    ('damping', 'period_ratio')
    """
    grounds, ending = _model_grounds(settings), ""
    arguments: dict[str, Any] = {"settings": settings}
    if record is not None and site is not None:
        arguments |= {"record": record, "motion": record, "site": site}
        grounds, ending = {"": site}, "_site"
    else:
        site = next(iter(grounds.values()))
        arguments |= {"motion": _simulated_motion(site, settings.seed), "site": site}
    functions: dict[str, ChartFunction] = {}
    for name, compute in CHARTS.items():
        required = _required_parameters(name)
        on_ground, own = GROUND in required, required - {GROUND}
        of_site = on_ground or not required.isdisjoint({"record", "motion"})
        if own <= set(arguments) and (of_site or not ending):
            ending_of = ending if on_ground else ""
            chosen = {key: arguments[key] for key in own}
            functions[f"{name}{ending_of}"] = ChartFunction(
                compute, chosen, grounds if on_ground else {}
            )
    return functions


def _model_grounds(settings: ChartSettings) -> dict[str, Ground]:
    """The model grounds by the titles of their panels."""
    words = {NARROW_BAND_DAMPING: "narrow band, ", BROAD_BAND_DAMPING: "broad band, "}
    return {
        f"{words.get(damping, '')}ξg = {damping:g}": KanaiTajimi(settings.ground_period, damping)
        for damping in settings.ground_dampings
    }


def _simulated_motion(ground: Ground, seed: int) -> xr.DataArray:
    """A motion in place of a record, as strong as one on the lake bed of Mexico City in 1985."""
    period, damping = (float(ground.arrays()[name]) for name in ("period", "damping"))
    duration, envelope = design_motion(period)
    strong = KanaiTajimi(period, damping, intensity=SIMULATED_INTENSITY)
    motion = simulated_motions(strong, duration, envelope, paths=2, seed=seed, step=SIMULATED_STEP)[0]
    about = (
        f"Motion simulated with seed {seed}: Kanai-Tajimi ground, Tg = {period:.3g} s, "
        f"ξg = {damping:.3g}, S0 = {SIMULATED_INTENSITY:g} m²/s³; {envelope_caption(duration, envelope)}"
    )
    return motion.assign_attrs(source="a simulated motion", about=about)


def design_motion(period: float) -> tuple[float, AminAng]:
    """Duration [s] and envelope of the finite motions on a ground of this period."""
    return DURATION * period, AminAng(RISE_END * period, STRONG_END * period, DECAY / period)


def envelope_caption(duration: float, envelope: AminAng) -> str:
    """Duration and envelope, for the caption of a picture."""
    return (
        f"{duration:.3g} s of motion, Amin-Ang envelope: rise to {envelope.rise_end:.3g} s, strong to "
        f"{envelope.strong_end:.3g} s, decay {envelope.decay:.3g} 1/s"
    )


def _required_parameters(name: str) -> set[str]:
    """Names of the required parameters of a chart function."""
    parameters = signature(CHARTS[name]).parameters.values()
    required = {parameter.name for parameter in parameters if parameter.default is parameter.empty}
    if not required <= GIVEN:
        wrong, allowed = ", ".join(sorted(required - GIVEN)), ", ".join(sorted(GIVEN))
        raise TypeError(f"chart {brief(name)} needs {wrong}; allowed: {allowed}")
    return required
