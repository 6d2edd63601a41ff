"""The ground of Kanai and Tajimi."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stochlin.kernels.linearization.filters import Filter
from stochlin.models.grounds.ground import GROUNDS, POSITIVE_DAMPING, Calibration, Fit, Ground
from stochlin.models.parameters import (
    PERIODS,
    POSITIVE,
    Parameter,
    parameter,
)


@GROUNDS.register("kanai_tajimi", 1)
@dataclass(frozen=True)
class KanaiTajimi(Ground):
    """Kanai-Tajimi ground: white noise filtered by one soil oscillator, eqs. (11) and (12).

    ``f = wg^2 xg + 2 xig wg xg'`` with ``xg'' + 2 xig wg xg' + wg^2 xg = n``, so that the PSD is
    ``S0 (1 + 4 xig^2 (w/wg)^2) / [(1 - (w/wg)^2)^2 + 4 xig^2 (w/wg)^2]``.

    Parameters
    ----------
    period : float or array
        Ground period ``2 pi / wg`` [s], positive.
    damping : float or array
        Damping ratio ``xig`` of the soil oscillator [-], positive, which sets the bandwidth of the
        motion: about 0.05 for a lake bed, 0.6 for firm ground.
    intensity : float or array
        Two-sided PSD ``S0`` of the white noise per rad/s [m^2/s^3], positive.
    source : str
        Reference for the parameter values.
    scatter : float
        Default of the argument ``scatter`` of functions that simulate motions of finite duration
        [-], as in `simulate`. That of a ground that is fitted to a spectrum or a record is not 0.
    fitted_for : tuple, optional
        Duration [s] and envelope of the motions for which `fit_ground` fitted the ground to a
        spectrum, and the longest period [s] of that; other motions are then asked about.

    Raises
    ------
    ValueError, TypeError
        If a parameter is out of range, is not a number or has a wrong shape.

    Notes
    -----
    The PSD at zero frequency is ``S0``, which makes the displacements of structures with long
    periods too large. `CloughPenzien` has no PSD at zero frequency.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (11) and (12); Kanai, K. (1957), Bull. Earthquake Res.
    Inst. 35; Tajimi, H. (1960), 2nd World Conference on Earthquake Engineering.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.KanaiTajimi(period=2.0, damping=0.05).describe()
    'Kanai-Tajimi (period 2 s, damping 0.05, intensity 1 m²/s³)'
    """

    name: ClassVar[str] = "Kanai-Tajimi"
    fit: ClassVar[Fit] = Fit({"damping": (2e-3, 3.0)}, ((0.02,), (0.06,), (0.2,), (0.6,)))
    # errors of the correlation, from 555 pairs
    calibration: ClassVar[Calibration] = Calibration(
        (0.02, 0.03, 0.02, 0.03), soil=("period", "damping")
    )
    period: Parameter = parameter("s", "ground period", PERIODS)
    damping: Parameter = parameter("1", "ground damping ratio", POSITIVE_DAMPING)
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def filter(values: Mapping[str, Any]) -> Filter:
        """The soil oscillator as a filter of the white noise."""
        frequency = 2 * np.pi / values["period"]
        return Filter.kanai_tajimi(values["intensity"], frequency, values["damping"])
