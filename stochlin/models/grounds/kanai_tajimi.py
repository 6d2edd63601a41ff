"""The ground of Kanai and Tajimi: one soil oscillator (eqs. 11 and 12)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stochlin.kernels.linearization.filters import KanaiTajimiFilter
from stochlin.models.grounds.base import GROUNDS, POSITIVE_DAMPING, Fit, Ground
from stochlin.models.parameters import POSITIVE, Parameter, parameter


@GROUNDS.register("kanai_tajimi", 1)
@dataclass(frozen=True)
class KanaiTajimi(Ground):
    """White noise through one soil oscillator: eqs. (11) and (12) of the paper.

    ``f = wg^2 xg + 2 xig wg xg'`` with ``xg'' + 2 xig wg xg' + wg^2 xg = n``, so that the PSD is
    ``S0 (1 + 4 xig^2 (w/wg)^2) / [(1 - (w/wg)^2)^2 + 4 xig^2 (w/wg)^2]``.

    Parameters
    ----------
    period : float or array
        Ground period ``2 pi / wg`` [s], positive.
    damping : float or array
        Bandwidth ``xig``, a damping ratio [-], positive: 0.05 is a lake bed, 0.6 firm ground.
    intensity : float or array
        Two-sided PSD ``S0`` of the white noise per rad/s [m^2/s^3], positive.
    source : str
        Where the numbers come from.

    Raises
    ------
    ValueError, TypeError
        If a parameter is out of range, not a number or wrongly shaped.

    Notes
    -----
    The PSD at zero frequency is ``S0``: displacements of long-period structures are too large.
    `CloughPenzien` removes it.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (11) and (12); Kanai, K. (1957), Bull. Earthquake Res. Inst.
    35; Tajimi, H. (1960), 2nd World Conference on Earthquake Engineering.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.KanaiTajimi(period=2.0, damping=0.05).describe()
    'KanaiTajimi(period=2, damping=0.05, intensity=1)'
    """

    name: ClassVar[str] = "Kanai-Tajimi"
    fit: ClassVar[Fit] = Fit({"damping": (2e-3, 3.0)}, ((0.02,), (0.06,), (0.2,), (0.6,)))
    period: Parameter = parameter("s", "ground period", POSITIVE)
    damping: Parameter = parameter("1", "ground damping ratio", POSITIVE_DAMPING)
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def filter(values: Mapping[str, Any]) -> KanaiTajimiFilter:
        """The soil oscillator."""
        frequency = 2 * np.pi / values["period"]
        return KanaiTajimiFilter.of(values["intensity"], frequency, values["damping"])
