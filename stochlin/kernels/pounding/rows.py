"""What a row of buildings is to compiled code, and which branches its storeys and contacts are on."""

from __future__ import annotations

from typing import NamedTuple

import numba as nb

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding.borrowing import borrow

ELASTIC, BILINEAR, BOUC_WEN = range(3)  # laws of a storey
OPEN, CLOSED, OPENING, PARTED, TOGETHER = range(5)  # branches of a contact

lean = nb.njit(nogil=True, error_model="numpy")
# Called so often that handing over a row takes longer than the work.
tight = nb.njit(nogil=True, error_model="numpy", forceinline=True)
# What is called in one place only: the compiler then goes over it once, not once a level.
once = nb.njit(nogil=True, error_model="numpy", inline="always")


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


@lean
def sizes(row):  # type: ignore[no-untyped-def]
    """Numbers of floors, buildings and contacts, and the length of the state."""
    n, s, c = row.mass.size, row.first.size - 1, row.gap.size
    return n, s, c, 3 * n + 3 * s + c + len(row.tied)


@lean
def borrow_row(row):  # type: ignore[no-untyped-def]
    """The row, its arrays borrowed."""
    return Row(
        borrow(row.first),
        borrow(row.below),
        borrow(row.mass),
        borrow(row.per_mass),
        borrow(row.post),
        borrow(row.couple),
        borrow(row.strength),
        borrow(row.law),
        borrow(row.shape),
        borrow(row.damping),
        borrow(row.left),
        borrow(row.right),
        borrow(row.gap),
        borrow(row.element),
        row.jumps,
        row.restitution,
        row.slow,
        borrow(row.tied),
        borrow(row.tie),
    )


@lean
def borrow_branches(branch):  # type: ignore[no-untyped-def]
    """The branches, their arrays borrowed."""
    return Branches(
        borrow(branch.storey),
        borrow(branch.side),
        borrow(branch.contact),
        borrow(branch.approach),
        borrow(branch.entry),
    )
