"""Stop rule of the iterations of statistical linearization."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from stochlin.models.arguments import Number, Whole, check_fields
from stochlin.models.parameters import Range

EPSILON = float(np.finfo(float).eps)
AT_LEAST = Range(EPSILON, include_lower=True)


@dataclass(frozen=True)
class Tolerance:
    """Stop rule of an iteration, checked; `linearize` describes its parameters."""

    rtol: Annotated[float, Number(AT_LEAST, f"a finite number of at least {EPSILON:.2g}")]
    max_iterations: Annotated[int, Whole(1)]

    def __post_init__(self) -> None:
        check_fields(self)


USUAL = Tolerance(1e-10, 200)  # the defaults of `linearize`
