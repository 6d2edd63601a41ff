"""Peak factors: the largest value of a stationary Gaussian response over its standard deviation.

``N`` is the mean number of zero crossings during the motion, up and down. ``delta =
sqrt(1 - l1^2/(l0 l2))`` is the spectral bandwidth, with the spectral moments ``l0``, ``l1`` and ``l2``;
it is 0 for a sine wave. A two-sided peak is the largest ``|u|``, a one-sided peak the largest ``u``. For
one-sided peaks only the up-crossings count, which are half of all.

The models are defined for at least one counted crossing, ``N >= 1`` (``N >= 2`` for one-sided peaks). A
shorter motion may have no peak at all, and the formulas are for peaks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.arguments import checked
from stochlin.models.parameters import POSITIVE, Model, Parameter, parameter
from stochlin.models.rules.published import Published, look_up
from stochlin.registry import Registry

PEAK_FACTORS: Registry[PeakFactor] = Registry("peak factor", "stochlin.models.rules.peak_factors")


@dataclass(frozen=True, kw_only=True)
class PeakFactor(Published):
    """A peak factor: mean and standard deviation of the peak over that of the response.

    ``formula(N, delta)`` gives both, ``p`` and ``q``, of two-sided peaks for 1-D arrays of cells.
    """

    formula: Callable[[Array, Array], tuple[Array, Array]] = field(compare=False)
    # For one-sided peaks only half of the crossings count, and a clump has half as many of them. The
    # formula takes this into account by a bandwidth that is larger by this factor.
    spread: float = 1.0
    fewest: float = 1.0  # counted crossings from which the formula is defined
    needs: str = ""  # besides the crossings, for messages

    def mean(self, crossings: Array, bandwidth: Array, sides: int = 2) -> Array:
        """Mean peak factor ``p`` [-] for ``N`` crossings and the bandwidth ``delta``.

        ``sides`` is 2 for two-sided and 1 for one-sided peaks. Cells outside the domain are NaN.
        """
        return self._both(crossings, bandwidth, sides)[0]

    def std(self, crossings: Array, bandwidth: Array, sides: int = 2) -> Array:
        """Standard deviation ``q`` of the peak factor [-]; arguments as in `mean`."""
        return self._both(crossings, bandwidth, sides)[1]

    def domain(self, sides: int = 2) -> str:
        """The domain of the model in words, for messages."""
        crossings = f"at least {self.fewest * (3 - sides):.3g} zero crossings (both ways)"
        return f"{crossings} in the duration{self.needs}"

    def _both(self, crossings: Array, bandwidth: Array, sides: int) -> tuple[Array, Array]:
        if sides not in {1, 2}:
            raise ValueError(
                f"sides = {brief(sides)}; allowed: 2 (largest absolute value), 1 (one direction)"
            )
        n, delta = np.broadcast_arrays(np.asarray(crossings, float), np.asarray(bandwidth, float))
        widest = 1.0
        if sides == 1:
            n, delta, widest = n / 2, delta * self.spread, self.spread
        inside = (n >= 1) & (n < np.inf) & (delta >= 0) & (delta <= widest)
        values = np.full((2, n.size), np.nan)
        values[:, inside.ravel()] = self.formula(n[inside], delta[inside])
        mean, std = values.reshape(2, *n.shape)
        return mean, std


def peak_factor_names() -> tuple[str, ...]:
    """Names of the peak factor models.

    Returns
    -------
    tuple of str
        Names for `peak_factor_model`.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.rules.peak_factor_names()
    ('Davenport1964', 'DerKiureghian1980', 'Vanmarcke1975')
    """
    return tuple(PEAK_FACTORS)


@checked
def peak_factor_model(name: str) -> PeakFactor:
    """Peak factor model by its name, with or without the year.

    Parameters
    ----------
    name : str
        One of `peak_factor_names`, or for instance ``"davenport"`` or ``"vanmarcke"``, in upper or lower
        case.

    Returns
    -------
    PeakFactor
        The model. Its methods ``mean`` and ``std`` give the mean and the standard deviation of the peak
        over the standard deviation of the response [-].

    Raises
    ------
    ValueError
        If the name is unknown; the message lists the known names.

    Examples
    --------
    >>> import stochlin as sl
    >>> model = sl.rules.peak_factor_model("vanmarcke")
    >>> round(float(model.mean(40, 0.2463)), 2), round(float(model.mean(40, 0.2463, sides=1)), 2)
    (2.63, 2.53)
    """
    return look_up(PEAK_FACTORS, name, "model")


@dataclass(frozen=True)
class StationaryMotion(Model):
    """A stationary motion of finite length: ``duration`` [s], positive."""

    of_arguments = True

    duration: Parameter = parameter("s", "duration of the motion", POSITIVE)
