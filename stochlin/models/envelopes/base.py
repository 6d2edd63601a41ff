"""The base of the envelopes, and their use: values at times, and the equivalent strong duration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.parameters import Model
from stochlin.registry import Registry

_STEPS = 2000  # steps of the midpoint rule for the integral of the squared envelope
ENVELOPES: Registry[type[Envelope]] = Registry("envelope", "stochlin.models.envelopes")


@dataclass(frozen=True)
class Envelope(Model):
    """Base of the envelopes: functions of time [s], from 0 to 1, that multiply a stationary motion."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, value in self.arrays().items():
            if value.ndim:
                raise ValueError(f"{type(self).__name__}: {name} is an array; allowed: a number")

    def at(self, time: Array) -> Array:
        """Values of the envelope [-] at times [s] from 0 on, in the same shape."""
        raise NotImplementedError

    def kinks(self) -> tuple[float, ...]:
        """Times [s] at which the slope jumps, in increasing order; time integration restarts there."""
        return ()

    def doubt(self, duration: float) -> str:
        """Text of a warning if a motion of this duration [s] ends while its envelope still rises."""
        now, later = self.at(duration * np.array([1.0, 1.01]))
        return "the motion ends before its strong part" if now < min(0.99, later) else ""


def envelope_at(envelope: Envelope | None, time: Array) -> Array:
    """Values of an envelope [-] at times [s] from 0 on; 1 at all times without an envelope."""
    return np.ones_like(time) if envelope is None else envelope.at(time)


def strong_seconds(duration: float, envelope: Envelope | None) -> float:
    """Duration [s] of the stationary motion of equal energy: the integral of the squared envelope."""
    middle = (np.arange(_STEPS) + 0.5) * duration / _STEPS
    return duration * float(np.mean(envelope_at(envelope, middle) ** 2))
