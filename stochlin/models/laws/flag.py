"""The flag-shaped law of self-centring structures, which come back to where they stood."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stochlin.models.parameters import Parameter, Range, parameter
from stochlin.models.structures import LAWS, Structure

COMES_BACK = Range(0.0, 1.0, True, True, "above 1 it does not come back, below 0 it makes energy")


@LAWS.register("flag", place=6)
@dataclass(frozen=True)
class Flag(Structure):
    """Self-centring oscillator, whose loops have the shape of a flag.

    The hysteretic displacement ``uy z`` follows the displacement until ``z`` is 1 and then stays
    there. In unloading ``z`` falls elastically to ``1 - beta``, stays there, and then falls to zero
    together with the displacement. The same holds on the other side.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`.
    beta : float or array
        Height ``beta`` of the flag [-], over ``1 - hardening`` times the yield force, from 0 to 1.
        At 0 there is no hysteresis; at 1 the flag dissipates as much as it can and still comes
        back.
    mass : float, optional
        As in `Bilinear`.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`. What linearizes raises an ArithmeticError: the law has no closure.

    References
    ----------
    Christopoulos, C., Filiatrault, A. and Folz, B. (2002), Earthquake Eng. Struct. Dyn. 31,
    1131-1150.

    Examples
    --------
    >>> import stochlin as sl
    >>> rocking = sl.Flag(0.6, 0.05, hardening=0.05, yield_displacement=0.02, beta=0.8)
    >>> ground = sl.KanaiTajimi(0.4, 0.6, 0.02)
    >>> sl.simulate([rocking], ground, paths=32, duration=10.0).sizes["path"]
    32
    """

    beta: Parameter = parameter("1", "height beta of the flag", COMES_BACK, 1.0)

    def step(self) -> Any:
        """The law in time steps."""
        from stochlin.kernels.simulation.paths import FLAG

        return FLAG
