"""Envelopes of finite motions: how the strength of shaking rises and falls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.parameters import Model
from stochlin.registry import Registry

_STEPS = 2000  # in which the integral is taken
ENVELOPES: Registry[type[Envelope]] = Registry("envelope", "stochlin.models.envelopes")


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


def envelope_at(envelope: Envelope | None, time: Array) -> Array:
    """Values at times [s] from 0 on; 1 throughout where there is no envelope."""
    return np.ones_like(time) if envelope is None else envelope.at(time)


def strong_seconds(duration: float, envelope: Envelope | None) -> float:
    """Length [s] of the stationary motion that an envelope stands for: the integral of its square."""
    if envelope is None:
        return duration
    middle = (np.arange(_STEPS) + 0.5) * duration / _STEPS
    return duration * float(np.mean(envelope.at(middle) ** 2))
