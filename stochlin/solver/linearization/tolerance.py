"""Stop rule of the iterations of statistical linearization."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from stochlin.models.arguments import Number, Whole, check_fields
from stochlin.models.parameters import NOT_NEGATIVE, Range

EPSILON = float(np.finfo(float).eps)
AT_LEAST = "a finite number of at least {:.2g}"


@dataclass(frozen=True)
class Tolerance:
    """Stop rule of an iteration, checked; `linearize` describes its parameters."""

    rtol: Annotated[float, Number(Range(EPSILON, include_lower=True), AT_LEAST.format(EPSILON))]
    atol: Annotated[float, Number(NOT_NEGATIVE, AT_LEAST.format(0.0))]
    max_iterations: Annotated[int, Whole(1)]

    def __post_init__(self) -> None:
        check_fields(self)


USUAL = Tolerance(1e-10, 1e-12, 200)  # the defaults of `linearize`
