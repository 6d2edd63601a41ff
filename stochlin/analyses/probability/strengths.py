"""Strengths of the motion over which the formulas are averaged, where motions scatter."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.models.grounds import Ground

STRENGTH = "strength of the motion"  # a dimension that no result has
ALONE = np.ones(1)  # the weight of one strength
# Probabilities over ln of the strength are as smooth as the peaks of one strength scatter, by 0.15 or
# more: steps of 0.25 to 3.2 standard deviations on either side leave an error of a thousandth.
REACH, STEP, FEWEST = 3.2, 0.25, 4


def strengths(scatter: float) -> tuple[Array, Array]:
    """Factors on the motion, and weights of them that add up to 1."""
    each = max(FEWEST, int(np.ceil(REACH * scatter / STEP)))
    normal = np.linspace(-REACH, REACH, 2 * each + 1)
    weights = np.exp(-0.5 * normal**2)
    return np.exp(scatter * normal), weights / weights.sum()


def at_strengths(ground: Ground, factors: Array) -> Ground:
    """The ground with each of these factors on its motion, over `STRENGTH`."""
    intensity = ground.arrays()["intensity"] * xr.DataArray(factors**2, dims=STRENGTH)
    changed: dict[str, Any] = {"intensity": intensity}
    return replace(ground, **changed)
