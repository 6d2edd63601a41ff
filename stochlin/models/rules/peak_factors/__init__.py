"""Peak factors: largest value of a stationary Gaussian response over its standard deviation.

``N`` is the mean number of zero crossings in the duration, both ways; ``delta =
sqrt(1 - l1^2/(l0 l2))`` the spectral bandwidth, 0 for a sine wave. A peak is two-sided, the largest
``|u|``, or one-sided, the largest ``u``; for the second only every other crossing counts.

A model is defined from one counted crossing on, ``N >= 1`` (``N >= 2`` for one-sided peaks): a shorter
motion need not hold a peak at all, and all formulas here are about peaks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.parameters import POSITIVE, Model, Parameter, parameter
from stochlin.models.rules.published import Published, look_up
from stochlin.registry import Registry

PEAK_FACTORS: Registry[type[PeakFactor]] = Registry("peak factor", "stochlin.models.rules.peak_factors")


@dataclass(frozen=True)
class PeakFactor(Published):
    """Base of the peak factors: mean and standard deviation of the peak over that of the response."""

    # One-sided peaks: half the crossings, one a cycle, and clumps that are half as long counted in
    # these crossings. The latter is a bandwidth larger by this factor.
    spread: ClassVar[float] = 1.0

    def mean(self, crossings: Array, bandwidth: Array, sides: int = 2) -> Array:
        """Mean peak factor ``p`` of ``N`` crossings and the bandwidth ``delta``; NaN outside the domain.

        ``sides`` is 2 for the largest absolute value, 1 for the largest value.
        """
        return self._evaluate(crossings, bandwidth, sides)[0]

    def std(self, crossings: Array, bandwidth: Array, sides: int = 2) -> Array:
        """Standard deviation ``q`` of the peak factor; arguments as in `mean`."""
        return self._evaluate(crossings, bandwidth, sides)[1]

    @staticmethod
    def domain(sides: int = 2) -> str:
        """Where the model is defined, in words."""
        return f"at least {3 - sides} zero crossings (both ways) in the duration, 0 <= bandwidth <= 1"

    def _evaluate(self, crossings: Array, bandwidth: Array, sides: int) -> tuple[Array, Array]:
        if sides not in {1, 2}:
            raise ValueError(
                f"sides = {brief(sides)}; allowed: 2 (largest absolute value), 1 (one direction)"
            )
        n, delta = np.broadcast_arrays(np.asarray(crossings, float), np.asarray(bandwidth, float))
        if sides == 1:
            n, delta = n / 2, delta * self.spread
        widest = 1.0 if sides == 2 else self.spread
        inside = (n >= 1) & (n < np.inf) & (delta >= 0) & (delta <= widest)
        values = np.full((2, n.size), np.nan)
        values[:, inside.ravel()] = self.formula(n[inside], delta[inside])
        mean, std = values.reshape(2, *n.shape)
        return mean, std

    def formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        """``(p, q)`` for two-sided peaks, cells in one row."""
        raise NotImplementedError


def peak_factor_names() -> tuple[str, ...]:
    """Names of the peak factor models.

    Returns
    -------
    tuple of str
        As `peak_factor_model` takes them.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.peak_factor_names()
    ('Davenport1964', 'DerKiureghian1980', 'Vanmarcke1975')
    """
    return tuple(model.__name__ for model in PEAK_FACTORS.values())


def peak_factor_model(name: str) -> PeakFactor:
    """Peak factor model by its name, with or without the year, or its abbreviation.

    Parameters
    ----------
    name : str
        One of `peak_factor_names`, or ``"davenport"``, ``"vanmarcke"``, ``"DK80"``..., in any case.

    Returns
    -------
    Davenport1964, DerKiureghian1980 or Vanmarcke1975
        With ``mean`` and ``std`` of the peak, over the standard deviation of the response [-].

    Raises
    ------
    ValueError
        If the name is unknown; the message lists those that are.

    Examples
    --------
    >>> import stochlin as sl
    >>> model = sl.peak_factor_model("vanmarcke")
    >>> round(float(model.mean(40, 0.2463)), 2), round(float(model.mean(40, 0.2463, sides=1)), 2)
    (2.63, 2.53)
    """
    return look_up(PEAK_FACTORS, name, "model").usual()


@dataclass(frozen=True)
class StationaryMotion(Model):
    """How long a stationary motion lasts: ``duration`` [s], positive."""

    of_arguments = True

    duration: Parameter = parameter("s", "duration of the motion", POSITIVE)
