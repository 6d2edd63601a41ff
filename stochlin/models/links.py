"""A link between two buildings: a spring and a dashpot that keep them together or apart."""

from __future__ import annotations

from dataclasses import dataclass

from stochlin.messages import brief
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import NOT_NEGATIVE, Model, Parameter, parameter


@dataclass(frozen=True)
class Link(Model):
    """Spring and dashpot between two structures: ``F = k (u1 - u2) + c (u1' - u2')``.

    The force acts on structure 1 against, on structure 2 along this direction; both ends hold, in
    tension and compression.

    Parameters
    ----------
    stiffness : float or array
        ``k`` [N/m], not negative.
    damping_constant : float or array
        ``c`` [N s/m], not negative.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, or a value is not a number.

    References
    ----------
    Westermo, B. D. (1989), Earthquake Eng. Struct. Dyn. 18.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Link(stiffness=2e7, damping_constant=1e6).describe()
    'Link(stiffness=2e+07, damping_constant=1e+06)'
    """

    stiffness: Parameter = parameter("N/m", "stiffness of the link", NOT_NEGATIVE, 0.0)
    damping_constant: Parameter = parameter("N s/m", "damping constant of the link", NOT_NEGATIVE, 0.0)


def check_linked(first: object, second: object) -> tuple[float, float]:
    """The masses [kg] of two bilinear structures; an error says what is missing."""
    masses = []
    for role, structure in (("first", first), ("second", second)):
        if not isinstance(structure, Bilinear):
            raise TypeError(
                f"{role} = {brief(structure)} cannot be linked; allowed: Bilinear, or no link"
            )
        if structure.mass is None:
            raise ValueError(
                f"{role}: mass is not given; a link acts on masses, allowed: 0 < value, in kg"
            )
        masses.append(float(structure.mass))
    return masses[0], masses[1]
