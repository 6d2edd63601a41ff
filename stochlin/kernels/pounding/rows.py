"""What a row of buildings is to compiled code, and which branches its storeys and contacts are on."""

from __future__ import annotations

from typing import NamedTuple

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import compiled

LAWS = ELASTIC, BILINEAR, BOUC_WEN = range(3)  # of a storey


class Row(NamedTuple):
    """Buildings in a row: n floors of s buildings, c contacts, l links."""

    first: Array  # (s + 1,): number of the first floor of each building, and n
    below: Array  # (n,): number of the floor below, -1 for the ground
    mass: Array  # (n,) [kg]
    per_mass: Array  # (n,) [1/kg]
    post: Array  # (n,) [N/m]: alpha k of the storey below the floor
    couple: Array  # (n,) [N/m]: (1 - alpha) k
    strength: Array  # (n,) [m]: yield drift, or uy of the Bouc-Wen law
    law: Array  # (n,)
    shape: Array  # (n, 3): beta, gamma and exponent of the Bouc-Wen law
    damping: Array  # (n, n) [N s/m]: zero between buildings
    left: Array  # (c,): number of the floor on the left; contacts along one level follow one another
    right: Array  # (c,)
    gap: Array  # (c,) [m]
    element: Array  # (c,): laws of the contacts, a `contact.law_table`
    jumps: bool  # velocities jump instead: stereomechanical impacts
    restitution: float  # of these
    slow: float  # [m/s]: an approach slower than this counts as none in a law over its velocity
    tied: Array  # (l, 2): numbers of the floors that a link ties
    tie: Array  # (l, 2): its stiffness [N/m] and damping constant [N s/m]


class Branches(NamedTuple):
    """Where each storey and contact is on its law."""

    storey: Array  # (n,): bilinear: 0, or the sign of yielding; Bouc-Wen: sign of the strain rate
    side: Array  # (n,): Bouc-Wen: sign of the strain y
    contact: Array  # (c,)
    approach: Array  # (c,) [m/s]: velocity at the beginning of this contact
    entry: Array  # (c,): its line in the table of impacts, or -1


@compiled
def sizes(row):
    """Numbers of floors, buildings and contacts, and the length of the state."""
    n, s, c = row.mass.size, row.first.size - 1, row.gap.size
    return n, s, c, 3 * n + 3 * s + c + len(row.tied)
