"""Grounds: models of stationary random ground acceleration as filtered white noise."""

from stochlin.kernels.linearization.filters import Filter
from stochlin.models.grounds.base import GROUNDS, MOST_FILTERS, Fit, Ground, rms_acceleration
from stochlin.models.grounds.clough_penzien import CloughPenzien
from stochlin.models.grounds.kanai_tajimi import KanaiTajimi
from stochlin.models.grounds.parallel import ParallelGround
from stochlin.models.grounds.white_noise import WhiteNoise

__all__ = [
    "GROUNDS",
    "MOST_FILTERS",
    "CloughPenzien",
    "Filter",
    "Fit",
    "Ground",
    "KanaiTajimi",
    "ParallelGround",
    "WhiteNoise",
    "rms_acceleration",
]
