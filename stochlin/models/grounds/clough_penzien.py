"""The ground of Clough and Penzien."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stochlin.kernels.linearization.filters import Filter
from stochlin.models.grounds.ground import (
    DAMPING_OF_GROUND,
    GROUNDS,
    POSITIVE_DAMPING,
    Calibration,
    Fit,
    Ground,
)
from stochlin.models.grounds.kanai_tajimi import KanaiTajimi
from stochlin.models.parameters import (
    PERIODS,
    POSITIVE,
    Parameter,
    parameter,
)
from stochlin.models.plausible import PLAUSIBLE, Plausible


@GROUNDS.register("clough_penzien", 2)
@dataclass(frozen=True)
class CloughPenzien(Ground):
    """Clough-Penzien ground: a Kanai-Tajimi ground with a high-pass filter.

    The high-pass filter is an oscillator. The PSD is that of `KanaiTajimi` times
    ``(w/wf)^4 / [(1 - (w/wf)^2)^2 + 4 xif^2 (w/wf)^2]``, so that it is zero at zero frequency.

    Parameters
    ----------
    period, damping : float or array
        Period ``2 pi / wg`` [s] and damping ratio ``xig`` [-] of the soil oscillator, positive.
    high_pass_period, high_pass_damping : float or array
        Period ``2 pi / wf`` [s] and damping ratio ``xif`` [-] of the high-pass oscillator,
        positive.
    intensity, source, scatter, fitted_for
        As in `KanaiTajimi`.

    Raises
    ------
    ValueError, TypeError
        As in `KanaiTajimi`.

    References
    ----------
    Clough, R. W. and Penzien, J. (1975), Dynamics of structures.

    Examples
    --------
    >>> import stochlin as sl
    >>> ground = sl.CloughPenzien(0.42, 0.6, high_pass_period=4.2, high_pass_damping=0.6)
    >>> float(ground.psd(0.0))
    0.0
    """

    name: ClassVar[str] = "Clough-Penzien"
    other_limits: ClassVar[Mapping[str, Plausible]] = {
        **Ground.other_limits,
        "high_pass_damping": DAMPING_OF_GROUND,
        "high_pass_period": PLAUSIBLE["period"],
    }
    fit: ClassVar[Fit] = Fit(
        {
            **KanaiTajimi.fit.bounds,
            "high_pass_period": (1.0, 100.0),
            "high_pass_damping": (0.1, 3.0),
        },
        [(*soil, *layer) for soil in KanaiTajimi.fit.starts for layer in ((1.5, 0.3), (6.0, 0.6))],
    )
    # Structures are corrected as on the ground without the high-pass filter.
    calibration: ClassVar[Calibration] = Calibration(
        (0.02, 0.03, 0.03, 0.04),  # of 556 pairs
        soil=("period", "damping"),
        ranges={"high_pass_period": (2.0, 25.0), "high_pass_damping": (0.2, 1.3)},
        high_pass="high_pass_period",
        error=0.03,
    )
    period: Parameter = parameter("s", "ground period", PERIODS)
    damping: Parameter = parameter("1", "ground damping ratio", POSITIVE_DAMPING)
    high_pass_period: Parameter = parameter("s", "high-pass period", PERIODS)
    high_pass_damping: Parameter = parameter("1", "high-pass damping ratio", POSITIVE)
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    def doubts(self) -> Iterator[str]:
        """Text on a high-pass filter that takes away the motion of the ground."""
        high_pass = self.high_pass_period
        period = self.period
        ratio = (
            high_pass / period
            if isinstance(high_pass, float) and isinstance(period, float)
            else 0.0
        )
        if text := PLAUSIBLE["high pass over ground"].doubt(ratio):
            times = f"{ratio:.2g} times the period of the ground"
            yield f"high_pass_period = {high_pass:g} is {times}; {text}"

    @staticmethod
    def filter(values: Mapping[str, Any]) -> Filter:
        """The soil oscillator, followed by the high-pass oscillator."""
        frequency = 2 * np.pi / values["high_pass_period"]
        return KanaiTajimi.filter(values).clough_penzien(frequency, values["high_pass_damping"])
