"""Strengths of the motion, over which formulas are averaged if motions have a scatter."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.models.grounds import Ground

STRENGTH = "strength of the motion"  # dimension that the results do not have
ALONE = np.ones(1)  # weights of a single strength
# Range [standard deviations], step of the logarithm, and least number of steps on each side. The peaks
# scatter by a logarithmic standard deviation of 0.15 or more for one strength, so that probabilities are
# smooth in the strength; the error of the mean is about 0.001.
REACH, STEP, FEWEST = 3.2, 0.25, 4


def strengths(scatter: float) -> tuple[Array, Array]:
    """Factors on the motion, and their weights with the sum 1."""
    each = max(FEWEST, int(np.ceil(REACH * scatter / STEP)))
    normal = np.linspace(-REACH, REACH, 2 * each + 1)
    weights = np.exp(-0.5 * normal**2)
    return np.exp(scatter * normal), weights / weights.sum()


def at_strengths(ground: Ground, factors: Array) -> Ground:
    """The ground with its motion multiplied by each of the factors, over the dimension `STRENGTH`."""
    intensity = ground.arrays()["intensity"] * xr.DataArray(factors**2, dims=STRENGTH)
    changed: dict[str, Any] = {"intensity": intensity}
    return replace(ground, **changed)
