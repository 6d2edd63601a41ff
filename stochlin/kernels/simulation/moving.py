"""All that moves in time steps, in any number of independent motions, and what is known of it.

Each motion is a lane: the last axis of all arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, zeros_on_a_line
from stochlin.kernels.basics.compiled import called_often, compiled, of_lane
from stochlin.kernels.basics.systems import System
from stochlin.kernels.simulation.laws import VISCOUS

CLOSE = 1e-8  # change of a slip, over the strength of the element, at which the passes of a step end
CLOSE_BY_LAW = 1e-5  # the same for laws with rates; extensions change by less than 1e-7 of theirs
# Columns of the arrays of `Moving`, see there.
Q, V, ENTERING, VISCOUS_LOSS, DQ, GAIN, WAY = range(7)
Z, SLIP, SPENT, EXTENSION, LEAST = range(5)
BEGIN, APPROACH, LARGEST, END, LOST, HANDED, DEEPEST, LAST, RISE, SPAN = range(10)
FORCE, SPEED, HELD, DISSIPATED, DEPTH, RATE = range(10, 16)
HIGHEST, LOWEST, ACCELERATION, SHEAR = range(4)
PULL, DRAINED = range(2)
F, SLOW, MEETS, GOES, FAILED, MISSING, MOST, IMBALANCE = range(8)
CHANGE, MORE, WIDEST, MOVING, STILL, FIRST, SECOND, THIRD = range(8, 16)
OF_Q, OF_DQ, OF_V, OF_Z = range(4)


class Elements(NamedTuple):
    """The masses and springs of a system, and the laws of the springs.

    A dashpot with an exponent (VISCOUS) has zeros in ``post`` and ``couple``, and as parameters ``own``
    its constant ``c`` [N (s/m)^a] and its exponent ``a``.
    """

    system: System  # its strength is infinite for a linear element
    kind: Array  # (e,): one of `laws.KINDS`, or a larger number
    states: Array  # (e,): number of states of the law, of which the first is z
    own: Array  # (e, k): parameters of the law


class Moving(NamedTuple):
    """What is known of every motion: one block of memory, ``state``, of which most arrays are parts.

    Each thing has its columns in the second axis:

    ===========  ==============================================================================
    coordinates  ``Q`` [m], its rate ``V`` [m/s], and its increment ``DQ`` in the step; energies so
                 far, ``ENTERING`` from the ground and ``VISCOUS_LOSS`` in dashpots of the structure
                 [J]; of a stereomechanical blow, the acceleration without it ``GAIN`` and the way
                 ``WAY``
    elements     ``Z``, the elastic part of the extension [m]; the ``SLIP`` in the step [m]; the
                 energy ``SPENT`` by slips so far [J]; the ``EXTENSION`` at the beginning of the
                 step [m]; ``LEAST``, the change of a slip at which the passes end [m]
    contacts     mean ``FORCE`` in the step [N]; rate of penetration ``SPEED`` at the beginning of
                 the contact [m/s]; ``HELD``, 1 if both sides move together after a blow, else 0;
                 energy ``DISSIPATED`` so far [J]; penetration ``DEPTH`` [m] and its ``RATE`` [m/s] at
                 the beginning of the step; and the present impact, whose ``BEGIN`` is NaN if there
                 is none, see `pounding.impacts`
    watched      displacements of floors, then extensions of elements: the ``HIGHEST`` and ``LOWEST``
                 [m]; of floors the largest absolute ``ACCELERATION`` [m/s^2], as means of steps, and
                 the largest ``SHEAR`` of the storey below [N]
    links        largest force ``PULL`` [N], as means of steps; energy ``DRAINED`` so far [J]
    motions      (rows, lanes): mean forcing ``F`` of the step [m/s^2]; rate of approach ``SLOW``
                 below which a contact is elastic [m/s]; ``MEETS``, 1 if contacts act, else 0;
                 ``GOES``, 1 until the motion ends; the time ``FAILED`` at which it was ended before
                 its end [s], else infinite; energy ``MISSING`` in the balance [J], the ``MOST``
                 energy put in so far [J], and ``IMBALANCE``, the largest ratio of both; for one
                 element at a time, the ``CHANGE`` of its extension and ``MORE`` slip [m]; the
                 ``WIDEST`` change [m]; ``MOVING``, 1 if the passes go on, else 0, and ``STILL``, the
                 same for the next pass; and three for one thing at a time
    ===========  ==============================================================================
    """

    state: Array  # (rows, lanes)
    coordinates: Array  # (n, columns, lanes)
    elements: Array  # (e, columns, lanes)
    contacts: Array  # (c, columns, lanes)
    watched: Array  # (f + e, columns, lanes)
    links: Array  # (l, columns, lanes)
    motions: Array
    memory: Array  # (e, k - 1, lanes): further states of the laws, with k states at most
    # What is of one step only:
    remembered: Array  # memory at its end
    known: Array  # (n + e, 1, lanes): velocities and element forces at the beginning
    products: Array  # (rows, 4, lanes): by `products`, of Q, DQ, V and Z
    states: Array  # (3, k, lanes): the pace of an extension, and states before and after, of one law
    own: Array  # (e, parameters, lanes): parameters of the laws

    @classmethod
    def at_rest(
        cls,
        elements: Sequence[Elements],
        lanes: int,
        contacts: int = 0,
        watched: int = 0,
        links: int = 0,
    ) -> Moving:
        """Motions from rest; the ``elements`` are those of each lane, or one set of all lanes."""
        like = elements[0]
        n, e, k = like.system.mass.size, like.kind.size, int(like.states.max(initial=1))
        things = (n, WAY + 1), (e, LEAST + 1), (contacts, RATE + 1), (watched, SHEAR + 1)
        sizes_of_state = *things, (links, DRAINED + 1), (1, THIRD + 1), (e, k - 1)
        ends = [*accumulate(many * columns for many, columns in sizes_of_state)]
        state = zeros_on_a_line(ends[-1], lanes)
        parts = [
            state[end - many * columns : end].reshape(many, columns, lanes)
            for end, (many, columns) in zip(ends, sizes_of_state, strict=True)
        ]
        sizes = (e, k - 1), (n + e, 1), (max(n, e, contacts, watched), OF_Z + 1), (3, k)
        scratch = [zeros_on_a_line(*size, lanes) for size in sizes]
        own = zeros_on_a_line(*like.own.shape, lanes)
        own[:] = np.stack([each.own for each in elements], axis=-1)
        *things_known, [motions], memory = parts
        moving = cls(*[state, *things_known, motions, memory, *scratch, own])
        strength = np.stack([each.system.strength for each in elements], axis=-1)
        close = np.where(like.kind <= VISCOUS, CLOSE, CLOSE_BY_LAW)
        moving.elements[:, LEAST] = close[:, None] * strength
        moving.contacts[:, BEGIN], moving.motions[FAILED] = np.nan, np.inf
        return moving

    @property
    def largest(self) -> Array:
        """Largest absolute displacements of floors, then extensions of elements [m]."""
        return np.maximum(self.watched[:, HIGHEST], -self.watched[:, LOWEST])


def rows_of(matrix: Array) -> Array:
    """A matrix (m, n) by the entries (m, w) in each row that are not zero; zeros fill shorter rows."""
    width = max(1, int((matrix != 0).sum(axis=1).max(initial=1)))
    rows = np.empty((len(matrix), width), [("column", np.int64), ("weight", float)])
    rows["column"] = np.argsort(matrix == 0, axis=1, kind="stable")[:, :width]
    rows["weight"] = np.take_along_axis(matrix, rows["column"], axis=1)
    return rows


@compiled
def copy(source, of, target, to, count):
    """Copy states (rows, lanes) from the lanes ``of`` to the lanes ``to``."""
    for row in range(source.shape[0]):
        for k in range(count):
            target[row, to[k]] = source[row, of[k]]


# The functions below take arrays one by one: of a tuple of arrays that is passed on, numba would count
# the references in every call and loop, which takes most of the time of a step.


@called_often
def times_row(rows, i, values, of, out, to, lanes):
    """Write row ``i`` of `rows_of` times the column ``of`` of the values to a row of ``out``."""
    first, row = rows[i, 0]["weight"], rows[i, 0]["column"]
    for lane in range(lanes):
        out[to, lane] = first * values[row, of, lane]
    for place in range(1, rows.shape[1]):
        more, row = rows[i, place]["weight"], rows[i, place]["column"]
        for lane in range(lanes):
            out[to, lane] += more * values[row, of, lane]


@compiled
def products(rows, values, of, out, to, lanes):
    """Write `times_row` of each row to a column of ``out`` (rows, columns, lanes)."""
    for i in range(rows.shape[0]):
        times_row(rows, i, values, of, out[i], to, lanes)


@called_often
def row_product(rows, i, values, of, lane):
    """`times_row` in one lane."""
    total = 0.0
    for place in range(rows.shape[1]):
        total += rows[i, place]["weight"] * values[rows[i, place]["column"], of, lane]
    return total


@compiled
def multiply(matrix, values, of, out, to, lanes):
    """Add a matrix times the column ``of`` of the values to a column of ``out``, by fours."""
    for i in range(matrix.shape[0]):
        row = matrix[i]
        for j in range(0, row.shape[0] - 3, 4):
            a, b, c, d = row[j], row[j + 1], row[j + 2], row[j + 3]
            for lane in range(lanes):
                first = (
                    of_lane(a, lane) * values[j, of, lane] + of_lane(b, lane) * values[j + 1, of, lane]
                )
                out[i, to, lane] += first + (
                    of_lane(c, lane) * values[j + 2, of, lane]
                    + of_lane(d, lane) * values[j + 3, of, lane]
                )
        for k in range(row.shape[0] // 4 * 4, row.shape[0]):
            a = row[k]
            for lane in range(lanes):
                out[i, to, lane] += of_lane(a, lane) * values[k, of, lane]


@called_often
def fill(values, row, value, lanes):
    """Set a row to a number in all lanes."""
    for lane in range(lanes):
        values[row, lane] = value


@called_often
def any_of(values, row, lanes):
    """Whether a number of the row is not zero."""
    for lane in range(lanes):  # noqa: SIM110 - compiled
        if values[row, lane] != 0.0:
            return True
    return False
