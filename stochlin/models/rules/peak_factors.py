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
from stochlin.models.parameters import Model, Parameter, Range, parameter

EULER = float(np.euler_gamma)
RISING = float(np.exp(EULER / 2))  # below, L + .5772/L falls as the number of crossings grows


@dataclass(frozen=True)
class PeakFactor:
    """Base of the peak factors: mean and standard deviation of the peak over that of the response."""

    abbreviation: ClassVar[str]
    reference: ClassVar[str]
    # One-sided peaks: half the crossings, one a cycle, and clumps that are half as long counted in
    # these crossings. The latter is a bandwidth larger by this factor.
    spread: ClassVar[float]

    def mean(self, crossings: Array, bandwidth: Array, sides: int = 2) -> Array:
        """Mean peak factor ``p``; NaN outside the domain.

        Parameters
        ----------
        crossings, bandwidth : array
            ``N`` and ``delta`` [-]; they broadcast.
        sides : int
            2: largest absolute value; 1: largest value.
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
                f"sides = {sides!r}; allowed: 2 (largest absolute value), 1 (one direction)"
            )
        n, delta = np.broadcast_arrays(np.asarray(crossings, float), np.asarray(bandwidth, float))
        if sides == 1:
            n, delta = n / 2, delta * self.spread
        widest = 1.0 if sides == 2 else self.spread
        inside = (n >= 1) & (n < np.inf) & (delta >= 0) & (delta <= widest)
        values = np.full((2, n.size), np.nan)
        values[:, inside.ravel()] = self._formula(n[inside], delta[inside])
        mean, std = values.reshape(2, *n.shape)
        return mean, std

    def _formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        """``(p, q)`` for two-sided peaks, cells in one row."""
        raise NotImplementedError


def _extreme_value(n: Array) -> Array:
    """Mean ``L + .5772/L``, ``L = sqrt(2 ln N)``; NaN where it would fall as N grows."""
    level = np.sqrt(2 * np.log(np.maximum(n, RISING)))
    return np.where(n >= RISING, level + EULER / level, np.nan)


@dataclass(frozen=True)
class Davenport1964(PeakFactor):
    """Independent crossings: ``p = L + .5772/L``, ``q = (pi/sqrt 6)/L``, ``L = sqrt(2 ln N)``.

    Asymptotic for many crossings and a broad band; too large for a narrow one, where crossings come
    in clumps. Below ``N = exp(.5772/2) = 1.33`` p would fall as N grows: NaN; and below 6.8 q is
    above .655, the scatter of Rayleigh's law, where it cannot be. One-sided
    peaks: the same with ``N/2``, the up-crossings of one level.
    """

    abbreviation: ClassVar[str] = "D64"
    reference: ClassVar[str] = "Davenport, A. G. (1964), Proc. Inst. Civil Eng. 28, 187-196"
    spread: ClassVar[float] = 1.0

    def _formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        mean = _extreme_value(n)
        with np.errstate(divide="ignore"):
            std = np.pi / np.sqrt(12 * np.log(n))
        return mean, np.where(np.isnan(mean), np.nan, std)

    @staticmethod
    def domain(sides: int = 2) -> str:
        """Where the model is defined, in words."""
        return f"at least {RISING * (3 - sides):.3g} zero crossings (both ways) in the duration"


@dataclass(frozen=True)
class DerKiureghian1980(PeakFactor):
    """Davenport's mean with an equivalent number ``Ne`` of independent crossings, fitted.

    ``Ne = max(2.1, 2 delta N)`` for ``delta <= .1``, ``(1.63 delta^.45 - .38) N`` to .69, ``N`` above;
    ``q = 1.2/L - 5.4/(13 + L^6.4)``, and .65 for ``Ne <= 2.1``. Of the fit's three pieces only the
    first has a floor: where the others give ``Ne < 1.33``, p is NaN. At ``delta = .1`` the pieces
    do not quite meet: ``Ne`` falls by .8 %.

    One-sided peaks: ``N/2`` crossings and ``2 delta``. In the narrow band ``Ne`` then stays what it
    was, as it must: up and down the envelope has the same peak.
    """

    abbreviation: ClassVar[str] = "DK80"
    reference: ClassVar[str] = "Der Kiureghian, A. (1980), J. Eng. Mech. Div. ASCE 106, 1195-1213"
    spread: ClassVar[float] = 2.0

    def _formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        middle = (1.63 * delta**0.45 - 0.38) * n
        effective = np.where(delta <= 0.1, np.maximum(2.1, 2 * delta * n), middle)
        effective = np.where(delta > 0.69, n, effective)
        level = np.sqrt(2 * np.log(np.maximum(effective, 2.1)))
        std = np.where(effective > 2.1, 1.2 / level - 5.4 / (13 + level**6.4), 0.65)
        mean = _extreme_value(effective)
        return mean, np.where(np.isnan(mean), np.nan, std)

    @staticmethod
    def domain(sides: int = 2) -> str:
        """Where the model is defined, in words."""
        return f"{PeakFactor.domain(sides)}, and Ne >= {RISING:.3g} independent ones"


PANELS, ORDER = 28, 12  # mean and std to 1e-10 up to N = 1e8, by comparison with mpmath
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(ORDER)
CELLS = 256  # at a time: nodes times cells stay in the cache


@dataclass(frozen=True)
class Vanmarcke1975(PeakFactor):
    """First passage of an envelope that clumps, started in its stationary state.

    ``P(peak < x) = [1 - e^(-x^2/2)] exp{-N [1 - e^(-sqrt(pi/2) delta^1.2 x)] / (e^(x^2/2) - 1)}``; mean
    and standard deviation by quadrature.

    One-sided peaks: up-crossings of one level come at half the rate, ``N/2``, and each clump of the
    envelope holds half as many, so that ``sqrt(pi/2)`` turns to ``sqrt(2 pi)``; the factor for the start
    stays, for the envelope starts as before. The narrow-band limit is the same for both.
    """

    abbreviation: ClassVar[str] = "V75"
    reference: ClassVar[str] = "Vanmarcke, E. H. (1975), J. Appl. Mech. 42, 215-220"
    spread: ClassVar[float] = 2 ** (1 / 1.2)

    def _formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        moments = np.empty((2, n.size))
        for begin in range(0, n.size, CELLS):
            cells = slice(begin, begin + CELLS)
            moments[:, cells] = _survival_moments(n[cells, None], delta[cells, None])
        mean, square = moments
        return mean, np.sqrt(square - mean**2)


def _survival_moments(n: Array, delta: Array) -> tuple[Array, Array]:
    """``Int (1 - F) dx`` and ``Int 2 x (1 - F) dx`` of Vanmarcke's distribution."""
    reach = np.sqrt(2 * (np.log1p(n) + 37))  # 1 - F is below 1e-16 beyond
    # Panels that shrink towards 0, where F turns on within x ~ N delta^1.2 if that is small.
    edges = np.union1d(0.25 ** np.arange(2, 9), np.linspace(0, 1, PANELS))
    half = 0.5 * np.diff(edges)[:, None]
    unit = (edges[:-1, None] + half * (1 + _NODES)).ravel()
    x, weight = reach * unit, reach * (half * _WEIGHTS).ravel()
    rate = -n * np.expm1(-np.sqrt(np.pi / 2) * delta**1.2 * x) / np.expm1(0.5 * x * x)
    # 1 - (1 - a) e^-r without cancellation where both are small
    start = np.exp(-0.5 * x * x)
    exceeding = start * np.exp(-rate) - np.expm1(-rate)
    return (weight * exceeding).sum(axis=1), (weight * 2 * x * exceeding).sum(axis=1)


_MODELS: dict[str, PeakFactor] = {
    model.__class__.__name__: model for model in (Davenport1964(), DerKiureghian1980(), Vanmarcke1975())
}


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
    return tuple(_MODELS)


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
    wanted = str(name).strip().lower().replace("_", "").replace(" ", "")
    for key, model in _MODELS.items():
        if wanted in {key.lower(), key.lower().rstrip("0123456789"), model.abbreviation.lower()}:
            return model
    allowed = ", ".join(f"{key} ({model.abbreviation})" for key, model in _MODELS.items())
    raise ValueError(f"model = {name!r} is no known peak factor; allowed: {allowed}")


@dataclass(frozen=True)
class StationaryMotion(Model):
    """How long a stationary motion lasts: ``duration`` [s], positive."""

    duration: Parameter = parameter("s", "duration of the motion", Range())
