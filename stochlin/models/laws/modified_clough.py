"""The modified Clough law: reloading aims at the largest excursion so far, as in reinforced concrete."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from stochlin.models.parameters import Parameter, Range, parameter
from stochlin.models.structures import LAWS, Structure

BELOW_1 = Range(upper=1.0, include_lower=True)


@LAWS.register("modified_clough", place=5)
@dataclass(frozen=True)
class ModifiedClough(Structure):
    """Peak-oriented oscillator, whose stiffness degrades with the largest excursions.

    The hysteretic displacement ``uy z`` is elastic-plastic at first. It unloads with the elastic
    stiffness times ``(d_max/uy)^-a``, where ``d_max`` is the largest displacement so far on the side it
    unloads from, or ``uy`` if that is larger. From ``z = 0`` it reloads along a straight line to the
    point of the largest displacement so far on the other side. If it unloads and reloads before that, it
    first returns to this line along the way on which it came.

    The largest displacement of a stationary motion grows for ever, so that there is no stationary
    response. The law is followed in motions of finite length: by `simulate` with a duration,
    `separation`, `respond`, `recorded_gap` and `pound`.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`; period and strength are those before any damage. Beside the hysteretic spring
        stands the linear one of the hardening, so that both aim at the same point.
    unloading_exponent : float or array
        Exponent ``a`` of the unloading stiffness [-], at least 0 and below 1. At 0 the stiffness in
        unloading is the elastic one, as in Clough's law; 0.4 is Takeda's.
    mass : float, optional
        As in `Bilinear`.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`. What needs a stationary response refuses the law: by an ArithmeticError what
        linearizes, by a ValueError what simulates.

    References
    ----------
    Clough, R. W. and Johnston, S. B. (1966), Proc. 2nd Japan Earthquake Eng. Symp.; Mahin, S. A. and
    Lin, J. (1983), UCB/EERC-83/17, for reloading after partial unloading; Takeda, T., Sozen, M. A. and
    Nielsen, N. N. (1970), J. Struct. Div. ASCE 96, for the stiffness in unloading.

    Examples
    --------
    >>> import stochlin as sl
    >>> frame = sl.ModifiedClough(0.6, 0.05, hardening=0.05, yield_displacement=0.02)
    >>> ground = sl.KanaiTajimi(0.4, 0.6, 0.02)
    >>> sl.simulate([frame], ground, paths=32, duration=10.0).sizes["path"]
    32
    """

    linearizes: ClassVar[bool] = False

    unloading_exponent: Parameter = parameter("1", "exponent of the unloading stiffness", BELOW_1, 0.4)

    def check_stationary(self, role: str) -> None:
        """Raise a ValueError if the structure yields: its largest displacement then grows for ever."""
        if self.yields:
            raise ValueError(
                f"{role}: ModifiedClough has no stationary response: it depends on the largest "
                "displacement so far, which grows for ever; follow it in motions of finite length, by "
                "simulate with a duration, or separation"
            )

    def step(self) -> Any:
        """The law in time steps."""
        from stochlin.kernels.simulation.paths import MODIFIED_CLOUGH

        return MODIFIED_CLOUGH
