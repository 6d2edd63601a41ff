"""Elements with a dashpot, given by its damping or by the restitution that it is to deliver."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from stochlin.messages import brief
from stochlin.models.contacts.base import DAMPING, RESTITUTION, Element, Form, checked, elementwise
from stochlin.models.parameters import Parameter, parameter

EXACT = "exact"


@dataclass(frozen=True)
class Damped(Element):
    """An element with a dashpot.

    The relation between its damping and its coefficient of restitution is its own: nothing here is
    shared between elements but the way of asking.
    """

    damping: Parameter = parameter("1", "damping of the contact", DAMPING)

    damping_name: ClassVar[str]  # what the damping is called where it is given
    restitution_of: ClassVar[Form]  # the damping
    damping_for: ClassVar[Mapping[str, Form]]  # a restitution, by name of the formula

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-] of two free masses."""
        return self._deliver(self.damping)

    @classmethod
    def delivered_restitution(cls, restitution: Any, formula: str = EXACT) -> Any:
        """What the damping by a formula really delivers, where ``restitution`` is asked for.

        Arguments, cells of NaN and errors as in `Kelvin.damping_ratio`.
        """
        return cls._deliver(cls._invert(restitution, formula))

    @classmethod
    def _deliver(cls, damping: Any) -> Any:
        return elementwise(cls.__name__, cls.damping_name, damping, DAMPING, cls.restitution_of)

    @classmethod
    def _invert(cls, restitution: Any, formula: str = EXACT) -> Any:
        if formula not in cls.damping_for:
            known = ", ".join(cls.damping_for)
            raise ValueError(
                f"{cls.__name__}: formula = {brief(formula)} is not known; allowed: {known}"
            )
        form = cls.damping_for[formula]
        return elementwise(cls.__name__, "restitution", restitution, RESTITUTION, form)

    @classmethod
    def _settle(cls, damping: Any, restitution: Any) -> Any:
        """The damping, from what was given of the two."""
        name = cls.__name__
        if (damping is None) == (restitution is None):
            given = "neither is given" if damping is None else "both are given"
            raise ValueError(
                f"{name}: of {cls.damping_name} and restitution {given}; allowed: exactly one of them, "
                "since each defines the dashpot"
            )
        if damping is not None:
            return checked(name, cls.damping_name, damping, "1", DAMPING)
        return cls._invert(checked(name, "restitution", restitution, "1", RESTITUTION))


@dataclass(frozen=True, init=False)
class WithRatio(Damped):
    """A dashpot by its damping ratio ``xi = c/(2 sqrt(k m))``, ``m`` the reduced mass."""

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
    def restitution(cls, damping_ratio: Any) -> Any:
        """Coefficient of restitution ``e`` [-] that this element delivers between two free masses.

        ``damping_ratio`` is ``xi`` [-], not negative, of any shape; what comes back is like it, NaN in
        cells out of range. A scalar out of range is a ValueError, what is not a number a TypeError.
        """
        return cls._deliver(damping_ratio)

    @classmethod
    def damping_ratio(cls, restitution: Any, formula: str = EXACT) -> Any:
        """Damping ratio ``xi`` [-] with which this element delivers a coefficient of restitution.

        ``restitution`` is ``e`` [-], in (0, 1]; ``formula`` is ``"exact"``, the inverse of
        `restitution`, or a published approximation by its name, else a ValueError. The rest is as there.
        """
        return cls._invert(restitution, formula)

    def damping_coefficient(self, reduced_mass: Any) -> Any:
        """Dashpot constant ``c = 2 xi sqrt(k m)`` for a reduced mass [kg]: [N s/m] if linear."""
        product = (self.damping, self.stiffness, reduced_mass)
        with np.errstate(invalid="ignore"):  # NaN in cells out of range
            return xr.apply_ufunc(
                lambda xi, k, m: 2 * xi * np.sqrt(k * m), *product, join="exact", keep_attrs=False
            )
