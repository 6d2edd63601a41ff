"""Settings of the charts, most of which the text of the paper does not state."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated

from stochlin.messages import Named, brief
from stochlin.models.arguments import (
    DampingRatio,
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
from stochlin.models.rules.effective_properties import EffectiveRule, effective_rule
from stochlin.models.structures import STATIONARY_HARDENING

NARROW_BAND_DAMPING = 0.05  # that of the paper for Figs. 4 and 5
BROAD_BAND_DAMPING = 0.6  # firm ground, Der Kiureghian & Neuenhofer 1992
FACTOR = Number(Bilinear.allowed("reduction_factor"))
GROUND_DAMPING = Number(KanaiTajimi.allowed("damping"))


def each(check: Number) -> Callable[[str, Sequence[float]], None]:
    """A check of all values of a list, which must not be empty."""

    def check_all(name: str, values: Sequence[float]) -> None:
        if not values:
            raise ValueError(f"{name} is empty; allowed: at least one value")
        for value in values:
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
        Reduction factors [-] of the curves in Figs. 4 and 5b.
    plane_reduction_factor : float
        Reduction factor [-] in Fig. 5a; that of the paper is 4.
    ductility : float
        Peak ductility [-] of both structures in Fig. 3b.
    ground_period : float
        Period ``Tg`` [s] of the model grounds.
    ground_dampings : tuple of float
        Damping ratios [-] of the model grounds; Figs. 4 and 5 have a panel for each.
    structure_period : float, optional
        Period [s] of the structure of Fig. 1. The default is that of the ground.
    closure : str
        Closure of the linearization, as in `stochlin.linearize`.
    points : int
        Number of periods along an axis.
    paths, seed : int
        Number and seed of simulated motions, as in `stochlin.simulate`.
    simulated_points : int, optional
        Number of periods at which each curve of Fig. 4, and Fig. 5a along each axis, are also simulated;
        0 for none. The default is 21 for a curve and 41 for an axis.
    curves : tuple of str, optional
        Effective rules in Fig. 3b and in the comparison of Fig. 4: names of
        `stochlin.rules.effective_rule_names` or of unverified rules. The default is all verified rules
        and that of the paper in Fig. 3b, and the rules of Penzien and of Iwan in Fig. 4.

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
    reduction_factors: Annotated[tuple[float, ...], each(FACTOR)] = (1.0, 2.0, 4.0, 6.0)
    plane_reduction_factor: Annotated[float, FACTOR] = 4.0
    ductility: Annotated[float, FACTOR] = 4.0
    ground_period: Seconds = 2.0
    ground_dampings: Annotated[tuple[float, ...], each(GROUND_DAMPING)] = (
        NARROW_BAND_DAMPING,
        BROAD_BAND_DAMPING,
    )
    structure_period: Seconds | None = None
    closure: str = "gaussian"
    points: Points = 161
    paths: Paths = 256
    seed: Seed = 0
    simulated_points: Annotated[int, Whole(0)] | None = None
    curves: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        check_fields(self)
        if self.simulated_points == 1:
            raise ValueError("simulated_points = 1; allowed: at least 2, or 0 for none")
        chosen_rules("curves", self.curves or ())

    @property
    def fine_points(self) -> int:
        """Number of points of a curve that is quickly computed, about twice ``points``."""
        return 2 * self.points - 1


def chosen_rules(name: str, rules: Iterable[str | EffectiveRule]) -> list[EffectiveRule]:
    """The effective rules of these names; ``name`` is that of the argument in messages."""
    if isinstance(rules, str):
        raise TypeError(f"{name} = {brief(rules)}; allowed: a list of names of effective rules")
    return [effective_rule(rule) for rule in rules]
