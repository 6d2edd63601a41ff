"""Envelopes of motions of finite length: the amplitude of the shaking as a function of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.parameters import POSITIVE, Model, parameter
from stochlin.registry import Registry, expect_class

SHORTEST = 2.0  # s, strong shaking
LEAST_SHARE = 0.2  # of strong shaking in a motion
_STEPS = 2000  # steps of the midpoint rule for the integral of the squared envelope
ENVELOPES: Registry[type[Envelope]] = Registry(
    "envelope", "stochlin.models.envelopes", check=lambda kind: expect_class(kind, Envelope, "at")
)


@dataclass(frozen=True)
class Envelope(Model, base=True):
    """Base of the envelopes: functions of time [s], from 0 to 1, that multiply a stationary motion."""

    def at(self, time: Array) -> Array:
        """Values of the envelope [-] at times [s] from 0 on, in the same shape."""
        raise NotImplementedError

    def kinks(self) -> tuple[float, ...]:
        """Times [s] at which the slope jumps, in increasing order; time integration restarts there."""
        return ()

    def doubt(self, duration: float) -> str:
        """Text of a warning if a motion of this duration [s] ends before its strong part, or in it."""
        now, later = self.at(duration * np.array([1.0, 1.01]))
        if now < min(0.99, later):
            return "the motion ends before its strong part; usual are longer ones"
        if later > 0.99:
            return "the motion ends in its strong part; usual are longer ones"
        strong = strong_seconds(duration, self)
        what = f"its strong shaking has {strong:.2g} s of it; usual are 5 to 60 s"
        brief = strong < min(SHORTEST, LEAST_SHARE * duration)
        return f"{what}; are the parameters of the envelope in order?" if brief else ""


def envelope_at(envelope: Envelope | None, time: Array) -> Array:
    """Values of an envelope [-] at times [s] from 0 on; 1 at all times without an envelope."""
    return np.ones_like(time) if envelope is None else envelope.at(time)


def strong_seconds(duration: float, envelope: Envelope | None) -> float:
    """Duration [s] of the stationary motion of equal energy: the integral of the squared envelope."""
    middle = (np.arange(_STEPS) + 0.5) * duration / _STEPS
    return duration * float(np.mean(envelope_at(envelope, middle) ** 2))


@ENVELOPES.register("amin_ang", 1)
@dataclass(frozen=True)
class AminAng(Envelope):
    """Envelope of Amin and Ang: ``(t/t1)^2`` up to ``t1``, 1 up to ``t2``, then ``exp(-c (t - t2))``.

    Parameters
    ----------
    rise_end : float
        End of the build-up ``t1`` [s], positive.
    strong_end : float
        End of the strong phase ``t2`` [s], not before ``rise_end``.
    decay : float
        Decay rate ``c`` [1/s], positive.

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

    rise_end: float = parameter("s", "end of the rise", POSITIVE, scalar=True)
    strong_end: float = parameter("s", "end of strong shaking", POSITIVE, scalar=True)
    decay: float = parameter("1/s", "decay rate", POSITIVE, scalar=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.strong_end < self.rise_end:
            least = f"allowed: from rise_end, {self.rise_end:g}"
            raise ValueError(f"AminAng: strong_end = {self.strong_end:g}; {least}")

    def at(self, time: Array) -> Array:
        """Values of the envelope [-] at times [s] from 0 on."""
        rise = np.minimum(time / self.rise_end, 1) ** 2
        return rise * np.exp(-self.decay * np.maximum(time - self.strong_end, 0))

    def kinks(self) -> tuple[float, ...]:
        """Times [s] of the end of the build-up and the end of the strong phase."""
        return self.rise_end, self.strong_end


@ENVELOPES.register("shinozuka_sato", 2)
@dataclass(frozen=True)
class ShinozukaSato(Envelope):
    """Envelope of Shinozuka and Sato: ``exp(-a t) - exp(-b t)``, divided by its maximum.

    Parameters
    ----------
    slow, fast : float
        Rates ``a`` of the decay and ``b`` of the build-up [1/s], positive, with ``a < b``.

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

    slow: float = parameter("1/s", "rate of decay", POSITIVE, scalar=True)
    fast: float = parameter("1/s", "rate of rise", POSITIVE, scalar=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.fast <= self.slow:
            raise ValueError(f"ShinozukaSato: fast = {self.fast:g}; allowed: above slow, {self.slow:g}")

    def at(self, time: Array) -> Array:
        """Values of the envelope [-] at times [s] from 0 on."""

        def shape(t: Array) -> Array:
            return np.exp(-self.slow * t) - np.exp(-self.fast * t)

        peak = np.log(self.fast / self.slow) / (self.fast - self.slow)
        return shape(np.asarray(time, float)) / shape(peak)


@ENVELOPES.register("gamma", 3)
@dataclass(frozen=True)
class GammaEnvelope(Envelope):
    """Gamma envelope ``t^k exp(-c t)``, divided by its maximum.

    With ``k = 1`` it is that of Hsu and Bernard, whose build-up is linear.

    Parameters
    ----------
    power : float
        Power ``k`` [-], positive.
    decay : float
        Decay rate ``c`` [1/s], positive. The maximum is at the time ``k/c``.

    Raises
    ------
    ValueError, TypeError
        If a value is not a number or out of range.

    References
    ----------
    Saragoni, G. R. and Hart, G. C. (1974), Earthquake Eng. Struct. Dyn. 2; Hsu, T.-I. and Bernard, M. C.
    (1978), Earthquake Eng. Struct. Dyn. 6.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> float(sl.GammaEnvelope(power=2.0, decay=0.5).at(np.array(4.0)))
    1.0
    """

    power: float = parameter("1", "power of the rise", POSITIVE, scalar=True)
    decay: float = parameter("1/s", "decay rate", POSITIVE, scalar=True)

    def at(self, time: Array) -> Array:
        """Values of the envelope [-] at times [s] from 0 on."""
        share = np.asarray(time, float) * self.decay / self.power
        return share**self.power * np.exp(self.power * (1 - share))
