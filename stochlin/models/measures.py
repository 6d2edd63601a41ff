"""A measure against pounding: links, devices, bumpers, added damping, strength or stiffness at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace

import xarray as xr

from stochlin.messages import brief
from stochlin.models.contacts import Contact
from stochlin.models.links import Link
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Model, expect, parameter

BETWEEN = (1, 2)  # the structures that a link ties which says nothing of them
ALWAYS = ("added_damping_1", "added_damping_2")  # told even where they are what is usual


@dataclass(frozen=True)
class Measure(Model):
    """A measure that reduces the pounding of two buildings or its effect.

    Parameters
    ----------
    added_damping_1, added_damping_2 : float
        Damping ratio [-] that dampers add to structure 1 and 2, referred to its mass and elastic
        stiffness as its own is; not negative.
    link : Link or list of Link, optional
        Springs and dashpots: between both, or as devices inside one of them, with its number twice in
        ``structures``.
    contact : Contact, optional
        What they meet at, for instance bumpers of another stiffness or restitution.
    bumper_thickness : float
        What bumpers take from the gap [m], of both sides together; not negative. Buildings whose
        bumpers touch, touch.
    stiffening_1, stiffening_2 : float
        Elastic stiffness of structure 1 and 2, of all its storeys, over that as built [-], positive.
        Masses and damping ratios stay: periods are divided by the root of it.
    strengthening_1, strengthening_2 : float
        Yield force of structure 1 and 2, of all its storeys, over that as built [-], positive. Yield
        displacements are multiplied by strengthening over stiffening.

    Raises
    ------
    ValueError, TypeError
        If a number is out of range or none, is an array, or links or contact are of the wrong kind.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), on links, bumpers and supplemental damping.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Measure(added_damping_1=0.1, link=sl.Link(damping_constant=1e6)).describe()
    'Measure(added_damping_1=0.1, added_damping_2=0, link=Link(stiffness=0, damping_constant=1e+06))'
    >>> braces = [
    ...     sl.Link(5e7, hardening=0.02, yield_displacement=0.003, structures=(2, 2), floors=(n, n - 1))
    ...     for n in (1, 2, 3)
    ... ]
    >>> sl.Measure(link=braces, strengthening_2=1.3).describe().partition(" at ")[2]
    'floors (1, 0), (2, 1), (3, 2))'
    """

    added_damping_1: float = parameter("1", "damping added to structure 1", NOT_NEGATIVE, 0.0)
    added_damping_2: float = parameter("1", "damping added to structure 2", NOT_NEGATIVE, 0.0)
    link: Link | Sequence[Link] | None = None
    contact: Contact | None = None
    _: KW_ONLY
    bumper_thickness: float = parameter("m", "thickness of the bumpers", NOT_NEGATIVE, 0.0)
    stiffening_1: float = parameter("1", "stiffness of structure 1, over that as built", POSITIVE, 1.0)
    stiffening_2: float = parameter("1", "stiffness of structure 2, over that as built", POSITIVE, 1.0)
    strengthening_1: float = parameter("1", "strength of structure 1, over that as built", POSITIVE, 1.0)
    strengthening_2: float = parameter("1", "strength of structure 2, over that as built", POSITIVE, 1.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in self.parameter_names():
            if isinstance(getattr(self, name), xr.DataArray):
                raise ValueError(f"Measure: {name} is an array; allowed: a number")
        if self.contact is not None:
            expect(self.contact, Contact, "Measure: contact")
        if isinstance(self.link, (list, tuple)):
            object.__setattr__(self, "link", tuple(self.link))
            for number, each in enumerate(self.link, start=1):
                expect(each, Link, f"Measure: link, number {number}")
        elif not isinstance(self.link, Link | None):
            raise TypeError(f"Measure: link = {brief(self.link)}; allowed: a Link, or a list of them")

    @property
    def links(self) -> tuple[Link, ...]:
        """All of them, each with the structures that it ties."""
        given = (self.link,) if isinstance(self.link, Link) else self.link or ()
        return tuple(replace(each, structures=each.structures or BETWEEN) for each in given)

    def describe(self) -> str:
        """One line with what it does; links that differ in their floors alone stand together."""
        told = [
            f"{field.name}={getattr(self, field.name):.6g}"
            for field in self._declared()
            if field.name in ALWAYS or getattr(self, field.name) != field.default
        ]
        alike: dict[str, list[Link]] = {}
        given = (self.link,) if isinstance(self.link, Link) else self.link or ()
        for each in given:
            alike.setdefault(each.describe().replace(f", floors={each.floors}", ""), []).append(each)
        links = [
            f"{len(those)} of {kind} at floors {', '.join(str(one.floors or 'level') for one in those)}"
            if those[1:]
            else those[0].describe()
            for kind, those in alike.items()
        ]
        told += [f"link={' + '.join(links)}"] if links else []
        told += [] if self.contact is None else [f"contact={self.contact.describe()}"]
        return f"Measure({', '.join(told)})"
