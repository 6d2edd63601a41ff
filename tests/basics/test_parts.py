"""Parts of compiled code, and named tuples that they hand on by address."""

from typing import NamedTuple

import numpy as np
import pytest

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import UNCOMPILED, compiled, entry, not_kept
from stochlin.kernels.basics.lending import borrow

pytestmark = pytest.mark.invariant


class Sums(NamedTuple):
    values: Array
    total: Array
    factor: float
    number: int


class Alike(NamedTuple):
    one: Array
    two: Array


@compiled
def add(sums, alike, n):
    """Writes where it reads, so that nothing may be read too early."""
    for i in range(sums.values.size):
        sums.total[n] += sums.factor * sums.values[i]
        alike.two[n] += alike.one[i]
        alike.one[i] += sums.number


@entry
def add_all(sums_, alike_):
    sums, alike = borrow(sums_), borrow(alike_)
    for n in range(sums.total.size):
        add(sums, alike, n)


def test_a_part_reads_and_writes_what_was_lent_to_it():
    values = np.arange(5.0)
    sums, alike = Sums(values, np.zeros(3), 2.0, 7), Alike(values, np.zeros(3))
    add_all(sums, alike)
    first = 10.0 + 35.0 * np.arange(3)
    assert (alike.two == first).all()
    assert (sums.total == 2 * first).all()
    assert (values == np.arange(5.0) + 21).all()


@compiled
def nth(values, n):
    return values[n]


@not_kept
def first_and_last(values):
    return nth(values, 0) + nth(values, -1) + nth(values, values.size - 1)


def test_a_part_has_one_form_for_all_whole_numbers():
    assert first_and_last(np.arange(5.0)) == 8.0
    if not UNCOMPILED:
        assert len(nth.signatures) == 1


@compiled
def first(values):
    return values[0]


def test_from_python_a_part_is_plain_python():
    assert first(["one", "two"]) == "one"
    if not UNCOMPILED:
        assert not first.signatures
