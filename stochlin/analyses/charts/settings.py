"""Settings of the charts, and the names of the curves that are drawn."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated

from stochlin.messages import Named, brief
from stochlin.models.arguments import (
    DampingRatio,
    Metres,
    Number,
    Paths,
    Points,
    Seconds,
    Seed,
    Whole,
    check_fields,
)
from stochlin.models.grounds import KanaiTajimi
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.rules.effective_properties import (
    EFFECTIVE_RULES,
    EffectiveRule,
    effective_rule,
)
from stochlin.models.structures import STATIONARY_HARDENING

NARROW_BAND_DAMPING = 0.05  # that of the paper for Figs. 4 and 5
BROAD_BAND_DAMPING = 0.6  # firm ground, Der Kiureghian & Neuenhofer 1992
LINEARIZATION, SIMULATION, DRIFT_CLOSURE, ELASTIC, EQ_4 = METHODS = (
    "linearization",
    "simulation",
    "drift",
    "elastic",
    "white_noise",
)
FACTOR = Number(Bilinear.allowed("reduction_factor"))


@dataclass(frozen=True)
class ChartSettings(metaclass=Named):
    """Parameters of the charts, most of which the text of the paper does not state.

    Parameters
    ----------
    damping, hardening : float
        Damping ratio and hardening ratio [-] of all structures.
    reduction_factors : tuple of float
        Reduction factors [-] of the curves in Figs. 4 and 5b.
    plane_reduction_factor : float
        Reduction factor [-] in Fig. 5a; that of the paper is 4.
    ductilities : tuple of float
        Peak ductilities [-] of both structures in Fig. 3b, which has a panel for each.
    ground_period : float
        Period ``Tg`` [s] of the model grounds.
    ground_dampings : tuple of float
        Damping ratios [-] of the model grounds; Figs. 4 and 5 have a panel for each.
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
    solver : {"closed_form", "lyapunov"}
        Solver of the linearized pairs of Figs. 4 and 5a, as in `stochlin.correlate`.
    points : int
        Number of periods along an axis.
    paths, seed : int
        Number and seed of simulated motions, as in `stochlin.simulate`.
    simulated_points : int, optional
        Number of periods at which each curve of Fig. 4, and Fig. 5a along each axis, are also simulated;
        0 for none. The default is 21 for a curve and 41 for an axis.
    curves : tuple of str, optional
        What is drawn: ``"linearization"``, ``"simulation"``, ``"drift"`` (the drift closure),
        ``"elastic"`` (elastic structures on the same ground), ``"white_noise"`` (the same by eq. (4)),
        and names of `stochlin.rules.effective_rule_names` or of unverified rules. Fig. 3b has the rules
        alone. The default is all of them, with all verified rules in Fig. 3b and those of Penzien and
        of Iwan in Fig. 4.

    Raises
    ------
    ValueError, TypeError
        If a value is out of range or of the wrong kind, or a curve is unknown.

    Examples
    --------
    >>> from stochlin.charts import ChartSettings
    >>> ChartSettings(points=5).fine_points
    9
    """

    damping: DampingRatio = 0.05
    hardening: Annotated[float, Number(STATIONARY_HARDENING)] = 0.05
    reduction_factors: tuple[float, ...] = (1.0, 2.0, 4.0, 6.0)
    plane_reduction_factor: Annotated[float, FACTOR] = 4.0
    ductilities: tuple[float, ...] = (4.0,)
    ground_period: Seconds = 2.0
    ground_dampings: tuple[float, ...] = (NARROW_BAND_DAMPING, BROAD_BAND_DAMPING)
    structure_period: Seconds | None = None
    second_period: Seconds | None = None
    gap: Metres | None = None
    closure: str = "gaussian"
    solver: str = "closed_form"
    points: Points = 161
    paths: Paths = 256
    seed: Seed = 0
    simulated_points: Annotated[int, Whole(0)] | None = None
    curves: tuple[str, ...] | None = None

    @property
    def fine_points(self) -> int:
        """Number of points of a curve that is quickly computed, about twice ``points``."""
        return 2 * self.points - 1

    def draws(self, method: str) -> bool:
        """Whether a method is among the curves."""
        return self.curves is None or method in self.curves

    def rules(self, usual: Sequence[str]) -> list[EffectiveRule]:
        """The rules among the curves; the usual ones if curves are not given."""
        names = usual if self.curves is None else [n for n in self.curves if n in EFFECTIVE_RULES]
        return [effective_rule(name) for name in names]

    def __post_init__(self) -> None:
        check_fields(self)
        if self.simulated_points == 1:
            raise ValueError("simulated_points = 1; allowed: at least 2, or 0 for none")
        object.__setattr__(self, "curves", _checked_curves(self.curves))
        for name, allowed in (
            ("reduction_factors", FACTOR),
            ("ductilities", FACTOR),
            ("ground_dampings", Number(KanaiTajimi.allowed("damping"))),
        ):
            if not getattr(self, name):
                raise ValueError(f"{name} is empty; allowed: at least one value")
            for value in getattr(self, name):
                allowed(name, value)


def _checked_curves(names: Iterable[str] | None) -> tuple[str, ...] | None:
    """Names of curves as the registry of rules has them, without repetitions."""
    if isinstance(names, str) or not isinstance(names, Iterable | None):
        raise TypeError(f"curves = {brief(names)}; allowed: a list of names of curves")
    if names is None:
        return None
    known: list[str] = []
    for name in names:
        plain = str(name).strip().lower().replace("-", "_")
        if plain not in METHODS:
            try:
                plain = effective_rule(name).name
            except ValueError:
                allowed = ", ".join([*METHODS, *(rule for rule in EFFECTIVE_RULES if rule != ELASTIC)])
                raise ValueError(f"curves: {brief(name)} is not known; allowed: {allowed}") from None
        known.append(plain)
    if not known:
        raise ValueError("curves is empty; allowed: at least one name, or none given")
    return tuple(dict.fromkeys(known))
