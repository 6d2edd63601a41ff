"""Stop rule of the iterations of statistical linearization."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.analyses.tables.checks import check_whole, is_number
from stochlin.messages import brief


@dataclass(frozen=True)
class Tolerance:
    """Stop rule of an iteration, checked; `linearize` describes its parameters."""

    rtol: float
    atol: float
    max_iterations: int

    def __post_init__(self) -> None:
        for name, lowest in (("rtol", np.finfo(float).eps), ("atol", 0.0)):
            value = getattr(self, name)
            if not is_number(value) or not lowest <= value < np.inf:
                raise ValueError(
                    f"{name} = {brief(value)}; allowed: a number of at least {lowest:.2g}, finite"
                )
        check_whole("max_iterations", self.max_iterations, 1)


USUAL = Tolerance(1e-10, 1e-12, 200)  # the defaults of `linearize`
