"""What compiled functions borrow: columns by name of their own block alone, and never counted."""

import sys
from typing import Any, NamedTuple

import numba as nb
import numpy as np
import pytest

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.borrowed import Columns, borrowed
from stochlin.kernels.basics.compiled import UNCOMPILED
from stochlin.kernels.simulation import state

pytestmark = pytest.mark.invariant


class Masses(Columns):
    q: Array
    v: Array


class Springs(Columns):
    force: Array


@borrowed
class Model(NamedTuple):
    masses: Masses
    springs: Springs
    weight: Array
    dt: float
    steps: int


def model(weight: Array) -> Model:
    masses, springs = Masses.zeros(3, 4), Springs.zeros(4)
    masses.q[:] = np.arange(12).reshape(3, 4)
    springs.force[:] = 2.0, 3.0, 5.0, 7.0
    return Model(masses, springs, weight, 0.5, 2)


def step(m: Any) -> None:
    for _ in range(m.steps):
        for i in range(m.weight.size):
            for lane in range(m.springs.force.size):
                m.masses.v[i, lane] += (
                    m.dt * m.weight[i] * m.springs.force[lane] * m.masses.q[i, lane]
                )


def test_compiled_functions_read_and_write_what_python_does() -> None:
    compiled, plain = model(np.array([1.0, 10.0, 100.0])), model(np.array([1.0, 10.0, 100.0]))
    arrays = compiled.masses.block, compiled.springs.block, compiled.weight
    counts = [sys.getrefcount(array) for array in arrays]
    nb.njit(step)(compiled)
    assert [sys.getrefcount(array) for array in arrays] == counts
    step(plain)
    np.testing.assert_array_equal(compiled.masses.block, plain.masses.block)
    assert plain.masses.v[2, 3] == 2 * 0.5 * 100 * 7 * 11
    np.testing.assert_array_equal(plain.masses.of_lane(3).q, [3.0, 7.0, 11.0])


@pytest.mark.skipif(UNCOMPILED, reason="nothing is compiled")
def test_a_column_of_another_block_is_refused() -> None:
    with pytest.raises(nb.TypingError, match="Unknown attribute 'force'"):
        nb.njit(lambda m: m.masses.force[0, 0])(model(np.ones(3)))
    with pytest.raises(AttributeError, match="force"):
        _ = model(np.ones(3)).masses.force  # type: ignore[attr-defined]


@pytest.mark.skipif(UNCOMPILED, reason="nothing is compiled")
def test_an_array_with_gaps_is_refused() -> None:
    with pytest.raises(TypeError, match=r"Model\.weight is not contiguous"):
        nb.njit(step)(model(np.ones(6)[::2]))
    with pytest.raises(TypeError, match="the block of Masses is not contiguous"):
        nb.njit(lambda masses: masses.q)(Masses(np.zeros((2, 3, 8))[..., ::2]))


def test_no_column_of_the_state_is_another_one() -> None:
    """Numbers written to every column by name are all found again."""
    one = state.Coordinates.zeros(2, 1)
    for number, name in enumerate(one._fields):
        getattr(one, name)[:] = number
    for number, name in enumerate(one._fields):
        assert (getattr(one, name) == number).all()
