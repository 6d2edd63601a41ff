"""What the envelopes have in common."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.parameters import Model
from stochlin.registry import Registry, expect_class

SHORTEST_STRONG_SHAKING = 2.0  # s, strong shaking
LEAST_STRONG_SHARE = 0.2  # of strong shaking in a motion
_STEPS = 2000  # steps of the midpoint rule for the integral of the squared envelope
ENVELOPES: Registry[type[Envelope]] = Registry(
    "envelope", "stochlin.models.envelopes", check=lambda kind: expect_class(kind, Envelope, "at")
)


@dataclass(frozen=True)
class Envelope(Model, base=True):
    """Base of envelopes: functions of time [s], from 0 to 1, that multiply a stationary motion."""

    def at(self, time: Array) -> Array:
        """Values of the envelope [-] at times [s] from 0 on, in the same shape."""
        raise NotImplementedError

    def kinks(self) -> tuple[float, ...]:
        """Times [s] at which the slope jumps, increasing; time integration restarts there."""
        return ()

    def doubt(self, duration: float) -> str:
        """Text of a warning if a motion of this duration [s] ends before or in its strong part."""
        now, later = self.at(duration * np.array([1.0, 1.01]))
        if now < min(0.99, later):
            return "the motion ends before its strong part; usual are longer ones"
        if later > 0.99:
            return "the motion ends in its strong part; usual are longer ones"
        strong = strong_seconds(duration, self)
        what = f"its strong shaking has {strong:.2g} s of it; usual are 5 to 60 s"
        brief = strong < min(SHORTEST_STRONG_SHAKING, LEAST_STRONG_SHARE * duration)
        return f"{what}; are the parameters of the envelope in order?" if brief else ""


def envelope_at(envelope: Envelope | None, time: Array) -> Array:
    """Values of an envelope [-] at times [s] from 0 on; 1 at all times without an envelope."""
    return np.ones_like(time) if envelope is None else envelope.at(time)


def strong_seconds(duration: float, envelope: Envelope | None) -> float:
    """Duration [s] of the stationary motion of equal energy: integral of the squared envelope."""
    middle = (np.arange(_STEPS) + 0.5) * duration / _STEPS
    return duration * float(np.mean(envelope_at(envelope, middle) ** 2))
