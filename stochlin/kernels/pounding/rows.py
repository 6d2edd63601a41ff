"""What a row of buildings is to compiled code, and which branches its storeys and contacts are on."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often

LAWS = ELASTIC, BILINEAR, BOUC_WEN = range(3)  # of a storey
SLACK = 3  # of a link, beside ELASTIC and BILINEAR
POST, DASHPOT, COUPLE, LIMIT, EXPONENT, EASY = range(6)  # columns of `Row.tie`
CREEP, FASTEST_CREEP = 1e-3, 10.0  # of `Row.slow`: the bounds of `creep_of`


class Row(NamedTuple):
    """Buildings in a row: n floors of s buildings, c contacts, l links."""

    first: Array  # (s + 1,): number of the first floor of each building, and n
    below: Array  # (n,): number of the floor below, -1 for the ground
    mass: Array  # (n,) [kg]
    per_mass: Array  # (n,) [1/kg]
    post: Array  # (n,) [N/m]: alpha k of the storey below the floor, less what the weight takes
    couple: Array  # (n,) [N/m]: (1 - alpha) k
    strength: Array  # (n,) [m]: yield drift, or uy of the Bouc-Wen law
    law: Array  # (n,)
    shape: Array  # (n, 3): beta, gamma and exponent of the Bouc-Wen law
    damping: Array  # (n, n) [N s/m]: zero between buildings
    left: Array  # (c,): number of the floor on the left; contacts along one level follow one another
    right: Array  # (c,)
    lower: Array  # (c,): number of the floor below a column that is hit; any where the weight is 0
    weight: Array  # (c, 3): of these three floors in the penetration; 1, -1, 0 where slabs meet
    meeting: Array  # (c,) [kg]: reduced mass of both sides
    gap: Array  # (c,) [m]
    element: Array  # (c,): laws of the contacts, a `contact.law_table`
    jumps: bool  # velocities jump instead: stereomechanical impacts
    restitution: float  # of these
    slow: float  # [m/s]: an approach slower than this counts as none in a law over its velocity
    tied: Array  # (l, 2): numbers of the floors that a link ties, the second -1 for the ground
    tie: Array  # (l, 6): stiffness past yield [N/m], dashpot [N (s/m)^a], the rest, limit, a, easy rate
    tie_law: Array  # (l,): the limit [m] is that of yielding, or the slack


class Branches(NamedTuple):
    """Where each storey and contact is on its law."""

    storey: Array  # (n,): bilinear: 0, or the sign of yielding; Bouc-Wen: sign of the strain rate
    side: Array  # (n,): Bouc-Wen: sign of the strain y
    contact: Array  # (c,)
    approach: Array  # (c,) [m/s]: velocity at the beginning of this contact
    entry: Array  # (c,): its line in the table of impacts, or -1
    tie: Array  # (l,): sign of yielding of a link, 1 where one with slack is taut, else 0
    pace: Array  # (l,): sign of the rate of a dashpot with an exponent, 0 where it creeps

    @classmethod
    def of(cls, row: Row) -> Branches:
        """Elastic and open."""
        n, _, c, _ = sizes_of(row)
        storey, contact, tie, pace = (
            np.zeros(size, np.int64) for size in (n, c, len(row.tied), len(row.tied))
        )
        return cls(storey, np.ones(n, np.int64), contact, np.zeros(c), np.full(c, -1), tie, pace)


def sizes_of(row: Row) -> tuple[int, int, int, int]:
    """Numbers of floors, buildings and contacts, and the length of the state."""
    n, s, c = row.mass.size, row.first.size - 1, row.gap.size
    return n, s, c, 3 * n + 3 * s + c + 2 * len(row.tied)


sizes = called_often(sizes_of)


@called_often
def slip_of(row, j):
    """Where the state has the slip of a link [m].

    It follows the floors, and so has no part of its own in the control of the steps.
    """
    n, s, c, _ = sizes(row)
    return 3 * n + 3 * s + c + len(row.tied) + j


@register_jitable
def creep_of(row: Any, j: int) -> Any:
    """Rate [m/s] below which the dashpot of a link with an exponent is linear.

    An exponent below 1 has no slope at rest, and steps no length: none is steeper than at the easy rate.
    """
    return min(max(CREEP * row.slow, row.tie[j, EASY]), FASTEST_CREEP * row.slow)
