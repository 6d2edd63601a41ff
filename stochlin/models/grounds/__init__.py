"""Grounds: models of stationary random ground acceleration as filtered white noise."""

from stochlin.kernels.linearization.filters import Filter
from stochlin.models.grounds.clough_penzien import CloughPenzien
from stochlin.models.grounds.ground import (
    GROUNDS,
    MOST_FILTERS,
    OTHER_COMPONENT,
    SCATTER_OF_SPECTRUM,
    Calibration,
    Fit,
    Ground,
    UsualScatter,
    rms_acceleration,
    scatter_of,
)
from stochlin.models.grounds.kanai_tajimi import KanaiTajimi
from stochlin.models.grounds.named import ground_names, named_ground
from stochlin.models.grounds.parallel import ParallelGround
from stochlin.models.grounds.white_noise import WhiteNoise

__all__ = [
    "GROUNDS",
    "MOST_FILTERS",
    "OTHER_COMPONENT",
    "SCATTER_OF_SPECTRUM",
    "Calibration",
    "CloughPenzien",
    "Filter",
    "Fit",
    "Ground",
    "KanaiTajimi",
    "ParallelGround",
    "UsualScatter",
    "WhiteNoise",
    "ground_names",
    "named_ground",
    "rms_acceleration",
    "scatter_of",
]
