"""A law given by symbolic form and parameters: in tables, in crowds, and refused with a reason."""

from dataclasses import dataclass

import pytest
import sympy

import stochlin as sl
from stochlin.models.parameters import Parameter, Range, parameter
from stochlin.models.structures import Structure

pytestmark = pytest.mark.oracle

V, Z, LIMIT, SHARE = sympy.symbols("v z limit share")
GROUND = sl.KanaiTajimi(period=0.8, damping=0.3)
SOFTENING = V * (1 - SHARE * sympy.Abs(Z)) - sympy.Abs(V) * sympy.sign(Z) * sympy.Max(
    abs(Z) - LIMIT, 0
)


@dataclass(frozen=True)
class Softening(Structure):
    """The slope falls with z, and once more beyond a limit."""

    limit: Parameter = parameter("1", "limit", Range(), 1.0)
    share: Parameter = parameter("1", "share", Range(), 0.5)

    def symbolic(self):
        return SOFTENING


def the_same(period, limit, share):
    law = SOFTENING.subs({LIMIT: limit, SHARE: share})
    return sl.Hysteretic(period, 0.05, 0.1, reduction_factor=4, law=law)


def test_a_table_has_the_law_of_each_cell_and_bad_cells_keep_to_themselves():
    limits, shares, periods = [0.3, 0.8, -1.0, 2.0], [0.2, 0.5, 0.5, 0.9], [0.4, 0.8, 1.0, 2.0]
    table = sl.linearize(
        Softening(periods, 0.05, 0.1, reduction_factor=4, limit=limits, share=shares), GROUND
    )
    assert table.status.values.tolist() == [0, 0, 3, 0]
    for n in (0, 1, 3):
        alone = sl.linearize(the_same(periods[n], limits[n], shares[n]), GROUND)
        for name in ("displacement_std", "z_std", "c_eq", "k_eq"):
            # the same quadrature; terms of the expression may stand in another order
            assert float(table[name][n]) == pytest.approx(float(alone[name]), rel=1e-11)


def test_a_law_without_a_drift_closure_says_what_it_has():
    structure = Softening(1.0, 0.05, 0.1, reduction_factor=4)
    with pytest.raises(
        ValueError, match="'drift' is not available for Softening; allowed: gaussian"
    ):
        sl.linearize(structure, GROUND, "drift")


@pytest.mark.parametrize("gamma", [-0.5, -0.6, -50.0])
def test_bouc_wen_without_a_bound_is_refused(gamma):
    """In loading ``z' = v (1 - (beta + gamma) |z|^n)``, which only a positive sum ends."""
    message = (
        rf"BoucWen: gamma = {gamma:g} .*allowed: -beta < value, where z is bounded; beta is 0\.5"
    )
    with pytest.raises(ValueError, match=message):
        sl.BoucWen(1.0, 0.05, 0.1, reduction_factor=4, beta=0.5, gamma=gamma)
