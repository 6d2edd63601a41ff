"""The envelope of Shinozuka and Sato."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.envelopes.envelope import ENVELOPES, Envelope
from stochlin.models.parameters import POSITIVE, parameter


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
            raise ValueError(
                f"ShinozukaSato: fast = {self.fast:g}; allowed: above slow, {self.slow:g}"
            )

    def at(self, time: Array) -> Array:
        """Values of the envelope [-] at times [s] from 0 on."""

        def shape(t: Array) -> Array:
            return np.exp(-self.slow * t) - np.exp(-self.fast * t)

        peak = np.log(self.fast / self.slow) / (self.fast - self.slow)
        return shape(np.asarray(time, float)) / shape(peak)
