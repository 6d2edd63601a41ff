"""Contact elements with a dashpot, which is given by its damping or by a coefficient of restitution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stochlin.models.contacts.base import DAMPING, RESTITUTION, Element, checked_value, elementwise
from stochlin.models.contacts.restitution import Relation
from stochlin.models.parameters import Parameter, parameter


@dataclass(frozen=True)
class Damped(Element):
    """A contact element with a dashpot.

    Each subclass has its own relation between damping and coefficient of restitution.
    """

    damping: Parameter = parameter("1", "damping of the contact", DAMPING)

    damping_name: ClassVar[str]  # name of the argument that gives the damping
    relation: ClassVar[Relation]

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-] of two free masses."""
        return self.restitution(self.damping)

    @classmethod
    def restitution(cls, damping: Any) -> Any:
        """Coefficient of restitution ``e`` [-] of this element between two free masses.

        ``damping`` is its damping ratio or damping factor [-], not negative, of any shape. The result
        has the same shape and is NaN in cells out of range. A scalar out of range raises a ValueError, a
        value that is not a number a TypeError.
        """
        return elementwise(cls.__name__, cls.damping_name, damping, DAMPING, cls.relation.restitution)

    @classmethod
    def _damping_for(cls, restitution: Any) -> Any:
        return elementwise(cls.__name__, "restitution", restitution, RESTITUTION, cls.relation.damping)

    @classmethod
    def _settle(cls, damping: Any, restitution: Any) -> Any:
        """The damping from the one of damping and restitution that was given."""
        name = cls.__name__
        if (damping is None) == (restitution is None):
            text = "neither is given" if damping is None else "both are given"
            raise ValueError(
                f"{name}: of {cls.damping_name} and restitution {text}; allowed: exactly one of them, "
                "since each defines the dashpot"
            )
        if damping is not None:
            return checked_value(name, cls.damping_name, damping, "1", DAMPING)
        return cls._damping_for(checked_value(name, "restitution", restitution, "1", RESTITUTION))


@dataclass(frozen=True, init=False)
class WithRatio(Damped):
    """An element with the damping ratio ``xi = c/(2 sqrt(k m))``, ``m`` being the reduced mass."""

    damping: Parameter = parameter("1", "damping ratio of the contact", DAMPING)
    damping_name: ClassVar[str] = "damping_ratio"

    def __init__(
        self,
        stiffness: Parameter,
        *,
        damping_ratio: Parameter | None = None,
        restitution: Parameter | None = None,
    ) -> None:
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "damping", self._settle(damping_ratio, restitution))
        self.__post_init__()

    @classmethod
    def damping_ratio(cls, restitution: Any) -> Any:
        """Damping ratio ``xi`` [-] of this element for a coefficient of restitution, exactly.

        ``restitution`` is ``e`` [-], in (0, 1], of any shape. Shape, NaN cells and errors are as in
        `restitution`.
        """
        return cls._damping_for(restitution)

    def damping_coefficient(self, reduced_mass: Any) -> Any:
        """Constant ``c = 2 xi sqrt(k m)`` for a reduced mass [kg]; in N s/m if the element is linear."""
        k: Any = self.stiffness
        xi: Any = self.damping
        with np.errstate(invalid="ignore"):  # NaN in cells out of range
            return 2 * xi * np.sqrt(k * reduced_mass)
