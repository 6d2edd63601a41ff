"""Envelopes of finite motions: how the strength of shaking rises and falls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.parameters import Model, Range, parameter

POSITIVE = Range()


@dataclass(frozen=True)
class Envelope(Model):
    """Base of the envelopes: a function of time [s] with values from 0 to 1, multiplying the motion."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, value in self.arrays().items():
            if value.ndim:
                raise ValueError(f"{type(self).__name__}: {name} is an array; allowed: a number")

    def at(self, time: Array) -> Array:
        """Values at times from 0 on, the same shape."""
        raise NotImplementedError

    def kinks(self) -> tuple[float, ...]:
        """Times [s] at which the slope jumps, increasing: an integration begins anew there."""
        return ()


@dataclass(frozen=True)
class AminAng(Envelope):
    """Build-up, strong shaking, decay: ``(t/t1)^2``, 1, ``exp(-c (t - t2))``.

    Parameters
    ----------
    rise_end : float
        ``t1`` [s], positive.
    strong_end : float
        ``t2`` [s], not before ``rise_end``.
    decay : float
        ``c`` [1/s], positive.

    Raises
    ------
    ValueError, TypeError
        If a value is not a number or out of range.

    References
    ----------
    Amin, M. and Ang, A. H.-S. (1968), J. Eng. Mech. Div. ASCE 94; Jennings, Housner and Tsai (1968).

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> sl.AminAng(4.0, 15.0, 0.35).at(np.array([2.0, 10.0])).tolist()
    [0.25, 1.0]
    """

    rise_end: float = parameter("s", "end of the rise", POSITIVE)
    strong_end: float = parameter("s", "end of strong shaking", POSITIVE)
    decay: float = parameter("1/s", "decay rate", POSITIVE)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.strong_end < self.rise_end:
            raise ValueError(
                f"AminAng: strong_end = {self.strong_end:g} is before rise_end = {self.rise_end:g}; "
                "allowed: strong_end >= rise_end"
            )

    def at(self, time: Array) -> Array:
        """Values at times from 0 on."""
        rise = np.minimum(time / self.rise_end, 1) ** 2
        return rise * np.exp(-self.decay * np.maximum(time - self.strong_end, 0))

    def kinks(self) -> tuple[float, ...]:
        """End of the rise, end of strong shaking."""
        return self.rise_end, self.strong_end


@dataclass(frozen=True)
class ShinozukaSato(Envelope):
    """Difference of exponentials ``(exp(-a t) - exp(-b t))``, over its maximum.

    Parameters
    ----------
    slow, fast : float
        ``a < b`` [1/s], positive.

    Raises
    ------
    ValueError, TypeError
        If a value is not a number or out of range, or ``slow >= fast``.

    References
    ----------
    Shinozuka, M. and Sato, Y. (1967), J. Eng. Mech. Div. ASCE 93.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> round(float(sl.ShinozukaSato(0.1, 1.0).at(np.linspace(0, 20, 2001)).max()), 6)
    1.0
    """

    slow: float = parameter("1/s", "rate of decay", POSITIVE)
    fast: float = parameter("1/s", "rate of rise", POSITIVE)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.fast <= self.slow:
            raise ValueError(
                f"ShinozukaSato: fast = {self.fast:g} with slow = {self.slow:g}; allowed: fast > slow"
            )

    def at(self, time: Array) -> Array:
        """Values at times from 0 on."""

        def shape(t: Array) -> Array:
            return np.exp(-self.slow * t) - np.exp(-self.fast * t)

        peak = np.log(self.fast / self.slow) / (self.fast - self.slow)
        return shape(np.asarray(time, float)) / shape(peak)


@dataclass(frozen=True)
class GammaEnvelope(Envelope):
    """Gamma function ``t^k exp(-c t)``, over its maximum.

    Parameters
    ----------
    power : float
        ``k`` [-], positive.
    decay : float
        ``c`` [1/s], positive; the maximum is at ``k/c``. `HsuBernard` is the case ``k = 1``.

    Raises
    ------
    ValueError, TypeError
        If a value is not a number or out of range.

    References
    ----------
    Saragoni, G. R. and Hart, G. C. (1974), Earthquake Eng. Struct. Dyn. 2.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> float(sl.GammaEnvelope(power=2.0, decay=0.5).at(np.array(4.0)))
    1.0
    """

    power: float = parameter("1", "power of the rise", POSITIVE)
    decay: float = parameter("1/s", "decay rate", POSITIVE)

    def at(self, time: Array) -> Array:
        """Values at times from 0 on."""
        share = np.asarray(time, float) * self.decay / self.power
        return share**self.power * np.exp(self.power * (1 - share))


@dataclass(frozen=True)
class HsuBernard(Envelope):
    """Linear build-up and exponential decay in one: ``(t/tp) exp(1 - t/tp)``.

    Parameters
    ----------
    peak_time : float
        ``tp`` [s], positive: when it is 1.

    Raises
    ------
    ValueError, TypeError
        If the value is not a number or out of range.

    References
    ----------
    Hsu, T.-I. and Bernard, M. C. (1978), Earthquake Eng. Struct. Dyn. 6.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> float(sl.HsuBernard(peak_time=5.0).at(np.array(5.0)))
    1.0
    """

    peak_time: float = parameter("s", "time of the maximum", POSITIVE)

    def at(self, time: Array) -> Array:
        """Values at times from 0 on."""
        share = np.asarray(time, float) / self.peak_time
        return share * np.exp(1 - share)
