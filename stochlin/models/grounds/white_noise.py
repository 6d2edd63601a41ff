"""White noise ground acceleration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from stochlin.kernels.linearization.filters import Filter
from stochlin.models.grounds.base import GROUNDS, Ground
from stochlin.models.parameters import POSITIVE, Parameter, parameter


@GROUNDS.register("white_noise", 3)
@dataclass(frozen=True)
class WhiteNoise(Ground):
    """White noise ground acceleration, with the constant PSD ``S0``.

    Parameters
    ----------
    intensity, source
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
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def filter(values: Mapping[str, Any]) -> Filter:
        """A filter without states, whose output is the white noise itself."""
        return Filter(values["intensity"])
