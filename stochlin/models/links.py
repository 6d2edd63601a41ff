"""Links between two floors: of two buildings, or as a damping device inside one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass
from typing import Any

import numpy as np

from stochlin.messages import brief
from stochlin.models.arguments import Whole
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Model, Parameter, Range, parameter

NUMBER_OF_GROUND = 0  # number of the ground among the floors of a link within one structure
DASHPOT_EXPONENT = Range(0.0, 2.0, include_upper=True)
LINK_HARDENING = Range(0.0, 1.0, True, True)


@dataclass(frozen=True)
class Link(Model):
    """Spring and dashpot between two floors: ``F = k (u1 - u2) + c (u1' - u2')``.

    The force ``F`` [N] acts on structure 2 in the direction of positive displacement and on
    structure 1 against it, in tension and in compression. The spring may yield, by the bilinear
    law. The dashpot may be that of a fluid damper, ``c |v|^a sign(v)`` with ``v = u1' - u2'``.

    A link between two floors of one structure, or between a floor and the ground, is a damping
    device of this structure: a hysteretic device if it has a yielding spring, a viscous device if
    it has a dashpot only, and a viscoelastic device if it has an elastic spring and a dashpot.

    Parameters
    ----------
    stiffness : float or array
        Stiffness ``k`` of the spring [N/m], not negative.
    damping_constant : float or array
        Damping constant ``c`` of the dashpot [N s/m], not negative; its unit is N (s/m)^a if an
        exponent ``a`` is given.
    damping_exponent : float or array, optional
        Exponent ``a`` of the dashpot [-], in (0, 2]; 1, a linear dashpot, by default.
    hardening : float or array, optional
        Hardening ratio of the spring, post-yield over elastic stiffness [-], from 0 to 1. It is
        given together with ``yield_displacement``.
    yield_displacement : float or array, optional
        Relative displacement ``u1 - u2`` at which the spring yields [m], positive.
    floors : (int, int), optional
        Numbers of the floors that the link ties, counted from 1 above the first storey. By default
        they are the highest floors of both structures at the same level. An oscillator has one
        floor. Within one structure both numbers are required, the upper floor first; 0 is the
        ground.
    structures : (int, int), optional
        Numbers of the structures that the link ties, counted from 1. By default the n-th link of a
        list ties structure n to the next one. ``(2, 2)`` is a device in structure 2.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range or a value is not a number; if the spring has only one of
        hardening and yield displacement; if ``floors`` or ``structures`` are not two whole numbers
        from 1; or if a link within one structure lacks its two floors.

    References
    ----------
    Westermo, B. D. (1989), Earthquake Eng. Struct. Dyn. 18, for links between buildings; Soong, T.
    T. and Dargush, G. F. (1997), Passive energy dissipation systems in structural engineering, for
    devices.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Link(stiffness=2e7, damping_constant=1e6).describe()
    'Link (stiffness 20 MN/m, damping constant 1 MN s/m)'
    >>> sl.Link(5e7, hardening=0.02, yield_displacement=0.01, floors=(5, 5)).describe()
    'Link (stiffness 50 MN/m, hardening 0.02, yield displacement 1 cm, floors 5 and 5)'

    A fluid damper in the first storey of structure 1:

    >>> sl.Link(0, 2e6, damping_exponent=0.3, structures=(1, 1), floors=(1, 0)).describe()
    'Link (damping constant 2 MN s/m, damping exponent 0.3, floors 1 and ground, inside building 1)'
    """

    stiffness: Parameter = parameter("N/m", "stiffness of the link", NOT_NEGATIVE, 0.0)
    damping_constant: Parameter = parameter(
        "N s/m", "damping constant of the link", NOT_NEGATIVE, 0.0
    )
    _: KW_ONLY
    damping_exponent: Parameter | None = parameter(
        "1", "exponent of the dashpot", DASHPOT_EXPONENT, None
    )
    hardening: Parameter | None = parameter(
        "1", "hardening ratio of the link", LINK_HARDENING, None
    )
    yield_displacement: Parameter | None = parameter("m", "extension at yield", POSITIVE, None)
    floors: tuple[int, int] | None = None
    structures: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.yield_displacement is None) != (self.hardening is None):
            alone = "hardening" if self.yield_displacement is None else "yield_displacement"
            raise ValueError(f"Link: {alone} is given alone; allowed: both for a link that yields")
        for name in ("structures", "floors"):
            lowest = NUMBER_OF_GROUND if name == "floors" and self.within_one else 1
            if (numbers := getattr(self, name)) is not None:
                object.__setattr__(self, name, _two_numbers(name, numbers, lowest))
        if self.within_one and (self.floors is None or self.floors[0] <= self.floors[1]):
            what = f"Link: floors = {self.floors} inside structure {self.structures}"
            raise ValueError(
                f"{what}; allowed: (upper, lower), of which the lower is 0 for the ground"
            )

    def doubts(self) -> Iterator[str]:
        """Text on a spring that yields and has no stiffness."""
        if self.yields and not self.arrays()["stiffness"].any():
            yield "its spring yields and has no stiffness; usual are both, or a dashpot alone"

    @property
    def within_one(self) -> bool:
        """Whether the link is a device inside one structure."""
        return self.structures is not None and self.structures[0] == self.structures[1]

    @property
    def exponent(self) -> float:
        """Exponent of the dashpot [-], 1 by default; an error if a parameter is an array."""
        return self.numbers[-1]

    @property
    def is_power_law(self) -> bool:
        """Whether the link has a nonlinear dashpot; an error if a parameter is an array."""
        *_, constant, exponent = self.numbers
        return exponent != 1 and constant > 0

    @property
    def yields(self) -> bool:
        """Whether a yield displacement is given."""
        return self.yield_displacement is not None

    def further(self) -> list[str]:
        """The floors that the link ties, and where it is."""
        low, high = self.structures or (0, 0)
        where = f"inside building {low}" if low == high else f"between buildings {low} and {high}"
        return [*([self.ends] if self.floors else []), *([where] if self.structures else [])]

    @property
    def ends(self) -> str:
        """The floors that the link ties, in words; empty if they are not named."""
        if not self.floors:
            return ""
        low = self.floors[0] or "ground"
        high = self.floors[1] or "ground"
        return f"floors {low} and {high}"

    @property
    def parts(self) -> tuple[Any, ...]:
        """``post``, ``couple`` [N/m], strength [m] of a spring; constant, exponent of a dashpot.

        The force of the spring is ``post x + couple z``, where ``x`` is ``u1 - u2`` and ``z`` its
        elastic part. They are numbers, or arrays where the parameters are.
        """
        values = self.cells()
        k = values["stiffness"]
        hardening = values.get("hardening", 1.0)
        spring = hardening * k, (1 - hardening) * k, values.get("yield_displacement", np.inf)
        return *spring, values["damping_constant"], values.get("damping_exponent", 1.0)

    @property
    def numbers(self) -> tuple[float, ...]:
        """The `parts` as numbers; an error if a parameter is an array."""
        for name, value in self.cells().items():
            if np.ndim(value):
                raise ValueError(f"Link: {name} is an array; allowed here: a scalar")
        return tuple(map(float, self.parts))


def _two_numbers(name: str, numbers: object, lowest: int) -> tuple[int, int]:
    pair = tuple(numbers) if isinstance(numbers, (tuple, list)) else ()
    if len(pair) != 2 or not all(map(Whole(lowest).contains, pair)):
        ground = "; 0, the ground, inside one structure" if name == "floors" and lowest else ""
        allowed = f"two whole numbers from {lowest}{ground}"
        raise ValueError(f"Link: {name} = {brief(numbers)}; allowed: {allowed}")
    return int(pair[0]), int(pair[1])
