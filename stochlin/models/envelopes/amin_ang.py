"""The envelope of Amin and Ang."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.envelopes.envelope import ENVELOPES, Envelope
from stochlin.models.parameters import POSITIVE, parameter


@ENVELOPES.register("amin_ang", 1)
@dataclass(frozen=True)
class AminAng(Envelope):
    """Envelope of Amin and Ang: ``(t/t1)^2`` to ``t1``, 1 to ``t2``, then ``exp(-c (t - t2))``.

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
    Amin, M. and Ang, A. H.-S. (1968), J. Eng. Mech. Div. ASCE 94; Jennings, Housner and Tsai
    (1968).

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
