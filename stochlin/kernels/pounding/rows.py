"""A row of buildings as arrays, and the branches of its storeys, contacts and links."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often

LAWS = ELASTIC, BILINEAR, BOUC_WEN = range(3)  # laws of a storey
SLACK = 3  # a law of links, besides ELASTIC and BILINEAR
POST, DASHPOT, COUPLE, LIMIT, EXPONENT, EASY = range(6)  # columns of `Row.tie`
CREEP, FASTEST_CREEP = 1e-3, 10.0  # bounds of `creep_of`, over `Row.slow`


class Row(NamedTuple):
    """Buildings in a row, with ``n`` floors of ``s`` buildings, ``c`` contacts and ``l`` links."""

    first: Array  # (s + 1,): number of the first floor of each building, and n
    below: Array  # (n,): number of the floor below, -1 for the ground
    mass: Array  # (n,) [kg]
    per_mass: Array  # (n,) [1/kg]
    post: Array  # (n,) [N/m]: alpha k of the storey below the floor, less its P-Delta stiffness
    couple: Array  # (n,) [N/m]: (1 - alpha) k
    strength: Array  # (n,) [m]: yield drift, or uy of the Bouc-Wen law
    law: Array  # (n,): one of LAWS
    shape: Array  # (n, 3): beta, gamma and exponent of the Bouc-Wen law
    damping: Array  # (n, n) [N s/m]: zero between buildings
    left: Array  # (c,): number of the floor on the left; contacts of one level follow one another
    right: Array  # (c,): number of the floor on the right
    lower: Array  # (c,): number of the floor below a column that is hit; without use at weight 0
    weight: Array  # (c, 3): weights of these three floors in the penetration; 1, -1, 0 slab to slab
    meeting: Array  # (c,) [kg]: reduced mass of both sides
    gap: Array  # (c,) [m]
    element: Array  # (c,): laws of the contacts, a `contact.law_table`
    jumps: bool  # impacts are stereomechanical: velocities jump, and ``element`` has no use
    restitution: float  # coefficient of restitution of stereomechanical impacts [-]
    slow: float  # [m/s]: a slower approach counts as 0 in a force law over the approach velocity
    tied: Array  # (l, 2): numbers of the two floors of a link, the second -1 for the ground
    # (l, 6): post-yield stiffness [N/m]; coefficient c of the dashpot force c |v|^a [N (s/m)^a]; elastic
    # less post-yield stiffness [N/m]; stretch at yield, or slack [m]; exponent a; and for a < 1 the rate
    # [m/s] below which the dashpot would stop its masses faster than time steps can follow
    tie: Array
    tie_law: Array  # (l,): ELASTIC, BILINEAR or SLACK


class Branches(NamedTuple):
    """The present branch of each storey, contact and link."""

    storey: Array  # (n,): bilinear: 0, or the direction of yielding; Bouc-Wen: sign of the drift rate
    side: Array  # (n,): Bouc-Wen: sign of the strain y
    contact: Array  # (c,): OPEN, CLOSED, OPENING, PARTED or TOGETHER of `contact`
    approach: Array  # (c,) [m/s]: approach velocity at the beginning of the present contact
    entry: Array  # (c,): line of the present impact in the table of impacts, or -1
    tie: Array  # (l,): direction of yielding of a link; 1 if a link with slack is taut; otherwise 0
    pace: Array  # (l,): sign of the rate of a dashpot with an exponent; 0 below `creep_of`

    @classmethod
    def of(cls, row: Row) -> Branches:
        """The branches at rest: all springs elastic, all contacts open."""
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
    """Index of the slip of link ``j`` [m] in the state.

    The slips of links are last. They change with the displacements of the floors, and the error control
    of the time steps leaves them out.
    """
    n, s, c, _ = sizes(row)
    return 3 * n + 3 * s + c + len(row.tied) + j


@called_often
def creep_of(row: Any, j: int) -> Any:
    """Rate [m/s] below which the dashpot of link ``j`` with an exponent is linear.

    With an exponent below 1 the slope of the force is infinite at rest, and time steps would become
    arbitrarily small. The slope is therefore limited to that at the rate in the column EASY.
    """
    return min(max(CREEP * row.slow, row.tie[j, EASY]), FASTEST_CREEP * row.slow)
