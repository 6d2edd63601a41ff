"""White noise."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from stochlin.kernels.linearization.filters import Filter
from stochlin.models.grounds.ground import GROUNDS, Calibration, Ground
from stochlin.models.parameters import (
    POSITIVE,
    Parameter,
    parameter,
)


@GROUNDS.register("white_noise", 3)
@dataclass(frozen=True)
class WhiteNoise(Ground):
    """White noise ground acceleration, with the constant PSD ``S0``.

    Parameters
    ----------
    intensity, source, scatter, fitted_for
        As in `KanaiTajimi`.

    Raises
    ------
    ValueError, TypeError
        As in `KanaiTajimi`.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.WhiteNoise(intensity=0.01).describe()
    'white noise (intensity 0.01 m²/s³)'
    """

    name: ClassVar[str] = "white noise"
    calibration: ClassVar[Calibration] = Calibration((0.02, 0.02, 0.04, 0.06))  # of 89 pairs
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def filter(values: Mapping[str, Any]) -> Filter:
        """A filter without states, whose output is the white noise itself."""
        return Filter(values["intensity"])
