"""The charts by name: each registers the function that computes its data from what it asks for."""

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

# A chart asks by the names of its parameters for the settings, for a ground (there is then one for each
# ground, with its own ending), or for a record and the ground fitted to it, its site.
CHARTS: Registry[Callable[..., xr.Dataset]] = Registry("chart", "stochlin.analyses.charts")
GIVEN = {"settings", "ground", "record", "site"}
NARROW_BAND_DAMPING = 0.05  # the paper's, for Figs. 4 and 5
BROAD_BAND_DAMPING = 0.6  # firm ground, Der Kiureghian & Neuenhofer 1992


@dataclass(frozen=True)
class ChartSettings:
    """What the charts take as given where the paper is silent.

    Parameters
    ----------
    damping, hardening : float
        Of all structures [-].
    reduction_factors : tuple of float
        One curve each in Figs. 4 and 5b.
    plane_reduction_factor : float
        ``R`` of Fig. 5a; the paper's is 4.
    ductility : float
        Peak ductility of both structures in Fig. 3b [-].
    ground_period : float
        ``Tg`` [s] of the two model grounds.
    structure_period : float, optional
        Period [s] of the structure of Fig. 1, and of the first of two on which damping is added; without
        it that of the ground fitted to the record.
    second_period : float, optional
        Period [s] of the second of two on which damping is added; without it 0.7 of the first.
    gap : float, optional
        Existing gap [m] between them.
    closure : str
        As in `stochlin.linearize`.
    points : int
        Periods along an axis.
    method : str
        ``"linearization"`` or ``"simulation"``.
    paths, seed : int
        As in `stochlin.simulate`.
    simulated_points : int, optional
        Periods at which each curve of Fig. 4, and Fig. 5a along each axis, are simulated besides; 0 for
        none. Without it 21 of a curve and 41 along each axis of Fig. 5a.
    rules : tuple of str, optional
        Names of `stochlin.effective_rule_names`, the unverified among them, for Figs. 3b and 4. Without
        them Fig. 3b shows the verified, Fig. 4 that of the paper (Jeng et al., unverified) and Iwan's.
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
        """Keywords of `stochlin.correlate` and `stochlin.amplification`."""
        names = ("method", "closure", "paths", "seed")
        return {name: getattr(self, name) for name in names}

    @property
    def fine_points(self) -> int:
        """Points of a single curve, which costs little: twice as close."""
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
    """Raise if they are too few for a curve."""
    if points < 2:
        raise ValueError(f"points = {points}; allowed: at least 2")


def chosen_rules(
    rules: Iterable[str | EffectiveRule] | None, usual: Sequence[str]
) -> list[EffectiveRule]:
    """The effective rules that are given, each once; if none are, the usual ones."""
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
    """The charts by name, each a call that computes its dataset.

    Parameters
    ----------
    settings : ChartSettings
    record, site : optional
        A record and the ground fitted to it: the charts are then those of the site.

    Returns
    -------
    mapping
        File name without ending -> function without arguments.
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
    """What a chart asks for: its parameters without a default."""
    parameters = signature(CHARTS[name]).parameters.values()
    asked = {parameter.name for parameter in parameters if parameter.default is parameter.empty}
    if not asked <= GIVEN:
        wrong, allowed = ", ".join(sorted(asked - GIVEN)), ", ".join(sorted(GIVEN))
        raise TypeError(f"chart {brief(name)} needs {wrong}; allowed: {allowed}")
    return asked


def _of_record(name: str) -> bool:
    return not _asked(name).isdisjoint({"record", "site"})
