"""The gamma envelope."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.envelopes.envelope import ENVELOPES, Envelope
from stochlin.models.parameters import POSITIVE, parameter


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
    Saragoni, G. R. and Hart, G. C. (1974), Earthquake Eng. Struct. Dyn. 2; Hsu, T.-I. and Bernard,
    M. C. (1978), Earthquake Eng. Struct. Dyn. 6.

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
