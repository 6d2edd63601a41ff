"""Gamma functions: that of Saragoni and Hart, and its case of a linear build-up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.envelopes.base import ENVELOPES, Envelope
from stochlin.models.parameters import POSITIVE, parameter


@ENVELOPES.register("gamma", 3)
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


@ENVELOPES.register("hsu_bernard", 4)
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
