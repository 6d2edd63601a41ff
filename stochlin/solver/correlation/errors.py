"""Standard deviation of ``u_1 - u_2`` in tables of pairs, and its error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.correlation.errors import error_of_difference, std_of_difference
from stochlin.models.grounds import CloughPenzien, Ground, KanaiTajimi, WhiteNoise
from stochlin.solver.linearization.bias import EXPECTED, OFF, caution_of
from stochlin.solver.tables.cellwise import Cells, cellwise

# Mean errors of rho by strength, as in `kernels.correlation.errors`: of 89 pairs on white noise, 555 on
# Kanai-Tajimi and 556 on Clough-Penzien ground.
ERRORS = {
    WhiteNoise: np.array([0.02, 0.02, 0.04, 0.06]),
    KanaiTajimi: np.array([0.02, 0.03, 0.02, 0.03]),
    CloughPenzien: np.array([0.02, 0.03, 0.03, 0.04]),
}
DIFFERENCE = "relative_displacement"  # start of the names of variables


def errors_on(ground: Ground) -> Array:
    """Mean errors of ``rho`` on this kind of ground; NaN where no pairs were simulated."""
    return ERRORS.get(type(ground), np.full(4, np.nan))


@np.errstate(all="ignore")  # equal structures give 0/0, failed cells are NaN
def difference(table: Mapping[Any, Cells]) -> dict[str, Cells]:
    """Standard deviation of ``u_1 - u_2`` of a table of pairs, with its bias and its caution.

    Bias and caution follow from the standard errors of simulations; without these they are unknown.
    Nothing is added to a table that has them.
    """
    if f"{DIFFERENCE}_caution" in table:
        return {}
    values = [table[name] for name in ("displacement_std_1", "displacement_std_2", "rho")]
    (std,) = cellwise(std_of_difference, *values)
    bias, off, most = std * np.nan, std * np.nan, OFF
    if "rho_standard_error" in table:
        shares = [table[f"displacement_std_standard_error_{n}"] / values[n - 1] for n in (1, 2)]
        rest = table["rho_standard_error"] / (1 - table["rho"])
        of_sides = values[0], shares[0], values[1], shares[1]
        kinds = float, float
        off, bias = cellwise(error_of_difference, *of_sides, values[2], rest, 0.0, kinds=kinds)
        most = EXPECTED
    (flag,) = cellwise(caution_of, off, kinds=(np.int8,), most=most)
    std = table.get(f"{DIFFERENCE}_std", std)  # a building with storeys has it already
    return {f"{DIFFERENCE}_std": std, f"{DIFFERENCE}_bias": bias, f"{DIFFERENCE}_caution": flag}
