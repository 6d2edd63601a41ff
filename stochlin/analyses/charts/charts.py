"""Registry of the charts by name, each with the function that computes its dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from inspect import signature
from itertools import groupby
from typing import Any

import xarray as xr

from stochlin.analyses.tables.checks import check_whole, checked_gap, is_number
from stochlin.messages import brief
from stochlin.models.grounds import Ground, KanaiTajimi
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.rules.effective_properties import EffectiveRule, effective_rule
from stochlin.registry import Registry

# The names of the parameters of a chart function select its arguments: the settings; a ground, for
# which there is one chart for each ground, with an ending of its name; a record; its site, the ground
# fitted to it.
CHARTS: Registry[Callable[..., xr.Dataset]] = Registry("chart", "stochlin.analyses.charts")
GIVEN = {"settings", "ground", "record", "site"}
NARROW_BAND_DAMPING = 0.05  # that of the paper for Figs. 4 and 5
BROAD_BAND_DAMPING = 0.6  # firm ground, Der Kiureghian & Neuenhofer 1992


@dataclass(frozen=True)
class ChartSettings:
    """Parameters of the charts, most of which the paper does not state.

    Parameters
    ----------
    damping, hardening : float
        Damping ratio and hardening ratio [-] of all structures.
    reduction_factors : tuple of float
        Reduction factors [-] of the curves in Figs. 4 and 5b.
    plane_reduction_factor : float
        Reduction factor [-] in Fig. 5a; that of the paper is 4.
    ductility : float
        Peak ductility [-] of both structures in Fig. 3b.
    ground_period : float
        Period ``Tg`` [s] of the two model grounds.
    structure_period : float, optional
        Period [s] of the structure of Fig. 1, and of the first structure in the chart of added damping.
        The default is the period of the ground fitted to the record.
    second_period : float, optional
        Period [s] of the second structure in the chart of added damping. The default is 0.7 times the
        first one.
    gap : float, optional
        Existing gap [m] in the chart of added damping.
    closure : str
        Closure of the linearization, as in `stochlin.linearize`.
    points : int
        Number of periods along an axis.
    method : {"linearization", "simulation"}
        Method for the response of yielding structures.
    paths, seed : int
        Number and seed of simulated motions, as in `stochlin.simulate`.
    simulated_points : int, optional
        Number of periods at which each curve of Fig. 4, and Fig. 5a along each axis, are also simulated;
        0 for none. The default is 21 for a curve and 41 for an axis.
    rules : tuple of str, optional
        Names of `stochlin.effective_rule_names`, or of unverified rules, for Figs. 3b and 4. The default
        is all verified rules for Fig. 3b, and for Fig. 4 that of the paper (Jeng et al., unverified) and
        that of Iwan.

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

    damping: float = 0.05
    hardening: float = 0.05
    reduction_factors: tuple[float, ...] = (1.0, 2.0, 4.0, 6.0)
    plane_reduction_factor: float = 4.0
    ductility: float = 4.0
    ground_period: float = 2.0
    structure_period: float | None = None
    second_period: float | None = None
    gap: float | None = None
    closure: str = "gaussian"
    points: int = 161
    method: str = "linearization"
    paths: int = 256
    seed: int = 0
    simulated_points: int | None = None
    rules: tuple[str, ...] | None = None

    @property
    def options(self) -> dict[str, Any]:
        """Keyword arguments for `stochlin.correlate` and `stochlin.amplification`."""
        names = ("method", "closure", "paths", "seed")
        return {name: getattr(self, name) for name in names}

    @property
    def fine_points(self) -> int:
        """Number of points of a curve that is quickly computed, about twice ``points``."""
        return 2 * self.points - 1

    def __post_init__(self) -> None:
        check_points(self.points)
        check_whole("paths", self.paths, 2)
        check_whole("seed", self.seed, 0)
        if self.simulated_points is not None:
            check_whole("simulated_points", self.simulated_points, 0)
        if self.simulated_points == 1:
            raise ValueError("simulated_points = 1; allowed: at least 2, or 0 for none")
        chosen_rules(self.rules, ())
        if not self.reduction_factors:
            raise ValueError("reduction_factors is empty; allowed: at least one value")
        asked = {"damping": "damping", "hardening": "hardening", "ground_period": "period"}
        asked |= {"plane_reduction_factor": "reduction_factor", "ductility": "reduction_factor"}
        for name in ("structure_period", "second_period"):
            if getattr(self, name) is not None:
                asked[name] = "period"
        if self.gap is not None:
            checked_gap(self.gap)
        given = [(name, getattr(self, name), Bilinear.allowed(own)) for name, own in asked.items()]
        factor = Bilinear.allowed("reduction_factor")
        given += [("reduction_factors", value, factor) for value in self.reduction_factors]
        for name, value, allowed in given:
            if not is_number(value) or not allowed.contains(value):
                raise ValueError(f"{name} = {brief(value)} is out of range; allowed: {allowed}")


def check_points(points: int) -> None:
    """Raise a ValueError if there are less than two points along an axis."""
    if points < 2:
        raise ValueError(f"points = {points}; allowed: at least 2")


def chosen_rules(
    rules: Iterable[str | EffectiveRule] | None, usual: Sequence[str]
) -> list[EffectiveRule]:
    """Rules for effective properties, without repetitions; the ``usual`` ones if ``rules`` is None."""
    if isinstance(rules, str) or not isinstance(rules, Iterable | None):
        raise TypeError(f"rules = {brief(rules)}; allowed: a list of names of effective rules")
    names = usual if rules is None else list(rules)
    if rules is not None and not names:
        raise ValueError("rules is empty; allowed: at least one name, or none given")
    found = [effective_rule(name) for name in names]
    return list({rule.name: rule for rule in found}.values())


def chart_functions(
    settings: ChartSettings, record: xr.DataArray | None = None, site: Ground | None = None
) -> Mapping[str, partial[xr.Dataset]]:
    """Charts by name, each as a function without arguments that computes its dataset.

    Parameters
    ----------
    settings : ChartSettings
        Parameters of the charts.
    record : xarray.DataArray, optional
        Record [m/s^2] for the charts of a site.
    site : Ground, optional
        Ground fitted to the record. With both, the charts are those of the site.

    Returns
    -------
    mapping
        Functions by the name of the chart, which is the name of its file without suffix.

    Examples
    --------
    >>> from stochlin.charts import ChartSettings, chart_functions
    >>> functions = chart_functions(ChartSettings(points=5))
    >>> functions["fig3a"]().rho.dims
    ('damping', 'period_ratio')
    """
    given: dict[str, Any] = {"settings": settings}
    recorded = record is not None and site is not None
    if recorded:
        given |= {"record": record, "site": site}
        on_grounds = {"_site": given | {"ground": site}}
    else:
        dampings = {"": NARROW_BAND_DAMPING, "_broad_band": BROAD_BAND_DAMPING}
        on_grounds = {
            ending: given | {"ground": KanaiTajimi(settings.ground_period, damping)}
            for ending, damping in dampings.items()
        }
    functions: dict[str, partial[xr.Dataset]] = {}
    for on_ground, group in groupby(CHARTS, lambda name: "ground" in _asked(name)):
        names = [n for n in group if recorded == _of_record(n) or (recorded and on_ground)]
        for ending, things in (on_grounds if on_ground else {"": given}).items():
            for name in names:
                chosen = {key: things[key] for key in _asked(name)}
                functions[f"{name}{ending}"] = partial(CHARTS[name], **chosen)
    return functions


def _asked(name: str) -> set[str]:
    """Names of the required parameters of a chart function."""
    parameters = signature(CHARTS[name]).parameters.values()
    asked = {parameter.name for parameter in parameters if parameter.default is parameter.empty}
    if not asked <= GIVEN:
        wrong, allowed = ", ".join(sorted(asked - GIVEN)), ", ".join(sorted(GIVEN))
        raise TypeError(f"chart {brief(name)} needs {wrong}; allowed: {allowed}")
    return asked


def _of_record(name: str) -> bool:
    """Whether a chart needs a record or its site."""
    return not _asked(name).isdisjoint({"record", "site"})
