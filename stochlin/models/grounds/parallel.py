"""The sum of several grounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.parallel_filters import in_parallel
from stochlin.messages import brief
from stochlin.models.grounds.ground import Ground
from stochlin.models.parameters import (
    POSITIVE,
    Parameter,
    expect,
    parameter,
)


@dataclass(frozen=True)
class ParallelGround(Ground):
    """Sum of the accelerations of several independent grounds; its PSD is the sum of their PSDs.

    The PSD of a single filter has one peak. Two grounds in parallel fit a design spectrum within a
    few per cent.

    Parameters
    ----------
    grounds : sequence of KanaiTajimi, CloughPenzien or an extension
        Two or more filtered grounds, whose parameters are all numbers. The ratios of their
        intensities are kept.
    intensity : float or array, optional
        Sum of the two-sided PSDs ``S0`` of their white noises [m^2/s^3], positive. If given, all
        grounds are scaled by one factor to this sum; by default the intensities are those of the
        grounds.
    source, scatter, fitted_for
        As in `KanaiTajimi`; the scatter of the grounds is not used.

    Raises
    ------
    ValueError, TypeError
        If fewer than two grounds are given, or if a ground is of another kind, has arrays or has no
        filter, as `WhiteNoise`.

    Notes
    -----
    The PSD defines a stationary Gaussian motion. The sum is therefore modelled by one white noise
    and one filter, the spectral factor of the sum of the PSDs, from which state space,
    linearization and time steps follow.

    References
    ----------
    Papoulis, A. (1991), Probability, random variables, and stochastic processes, for spectral
    factorization.

    Examples
    --------
    >>> import stochlin as sl
    >>> slow = sl.CloughPenzien(1.0, 0.4, 5.0, 0.6, intensity=0.01)
    >>> fast = sl.CloughPenzien(0.2, 0.5, 1.0, 0.6, intensity=0.02)
    >>> both = sl.ParallelGround([slow, fast])
    >>> both.intensity, round(float(both.psd(6.0) / (slow.psd(6.0) + fast.psd(6.0))), 9)
    (0.03, 1.0)
    """

    name: ClassVar[str] = "parallel-filter"
    grounds: Sequence[Ground]
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noises", POSITIVE, None)

    def __post_init__(self) -> None:
        if isinstance(self.grounds, Ground) or not isinstance(self.grounds, Sequence):
            raise TypeError(
                f"ParallelGround: grounds = {brief(self.grounds)}; allowed: a list of them"
            )
        object.__setattr__(self, "grounds", tuple(self.grounds))
        if len(self.grounds) < 2:
            raise ValueError(f"ParallelGround: {len(self.grounds)} grounds; allowed: two or more")
        for number, ground in enumerate(self.grounds, 1):
            role = f"ParallelGround: grounds, number {number}"
            expect(ground, Ground, role)
            if any(array.ndim for array in ground.arrays().values()):
                raise ValueError(f"{role}: {ground.describe()} has an array; allowed: numbers")
        if self.intensity is None:
            object.__setattr__(self, "intensity", self._own_intensity)
        super().__post_init__()
        _ = self._filter  # raises for grounds that cannot be combined

    @cached_property
    def _own_intensity(self) -> float:
        return float(sum(ground.arrays()["intensity"] for ground in self.grounds))

    @cached_property
    def _filter(self) -> Filter:
        """The filter of the sum for a total intensity of 1."""
        filters = [ground.lone_filter() for ground in self.grounds]
        return in_parallel(
            [replace(f, intensity=f.intensity / self._own_intensity) for f in filters]
        )

    def filter(self, values: Mapping[str, Any]) -> Filter:  # type: ignore[override]
        """The filter of the sum at the total intensity in ``values``."""
        return replace(self._filter, intensity=values["intensity"])

    @property
    def parts(self) -> tuple[Ground, ...]:
        """The grounds."""
        return tuple(self.grounds)

    def further(self) -> list[str]:
        """The grounds."""
        return [" + ".join(ground.describe() for ground in self.grounds)]
