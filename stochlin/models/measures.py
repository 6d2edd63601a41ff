"""Mitigation measures against pounding: links, bumpers, added damping, stiffening and strengthening."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace

import xarray as xr

from stochlin.messages import brief
from stochlin.models.contacts import Contact
from stochlin.models.descriptions import stated
from stochlin.models.links import Link
from stochlin.models.parameters import NOT_NEGATIVE, Model, Range, expect, parameter

BETWEEN = (1, 2)  # the structures that a link ties if it does not name them
FACTOR = Range(1e-3, 1e3, include_lower=True, include_upper=True)


@dataclass(frozen=True)
class Measure(Model):
    """A mitigation measure, which reduces the pounding of two buildings or its effects.

    One measure may combine links, bumpers, added damping, stiffening and strengthening.

    Parameters
    ----------
    added_damping_1, added_damping_2 : float
        Damping ratio [-] that dampers add to structures 1 and 2, not negative. As for the structure's
        own damping ratio, its mass and elastic stiffness are the reference.
    link : Link or list of Link, optional
        Springs and dashpots between the two structures, or damping devices inside one of them. For a
        device, ``structures`` of the link names the same structure twice.
    contact : Contact, optional
        Contact between the structures with the measure, for instance that of bumpers with another
        stiffness or coefficient of restitution.
    bumper_thickness : float
        Thickness of the bumpers of both structures together [m], not negative. It reduces the gap.
    stiffening_1, stiffening_2 : float
        Elastic stiffness of all storeys of structures 1 and 2 over that as built [-], between 0.001 and
        1000. Masses and damping ratios do not change; periods are divided by the square root of this
        factor.
    strengthening_1, strengthening_2 : float
        Yield force of all storeys of structures 1 and 2 over that as built [-], between 0.001 and 1000.
        Yield displacements are multiplied by the ratio of strengthening to stiffening.

    Raises
    ------
    ValueError, TypeError
        If a value is not a number, is an array or is out of range, or if ``link`` or ``contact`` is of
        the wrong kind.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), for links, bumpers and supplemental damping.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Measure(added_damping_1=0.1, link=sl.Link(damping_constant=1e6)).describe()
    'added damping of building 1: 0.1, Link (damping constant 1 MN s/m)'
    >>> braces = [
    ...     sl.Link(5e7, hardening=0.02, yield_displacement=0.003, structures=(2, 2), floors=(n, n - 1))
    ...     for n in (1, 2, 3)
    ... ]
    >>> sl.Measure(link=braces, strengthening_2=1.3).describe().partition(" at ")[2]
    'floors 1 and ground, floors 2 and 1, floors 3 and 2'
    """

    added_damping_1: float = parameter("1", "damping added to structure 1", NOT_NEGATIVE, 0.0)
    added_damping_2: float = parameter("1", "damping added to structure 2", NOT_NEGATIVE, 0.0)
    link: Link | Sequence[Link] | None = None
    contact: Contact | None = None
    _: KW_ONLY
    bumper_thickness: float = parameter("m", "thickness of the bumpers", NOT_NEGATIVE, 0.0)
    stiffening_1: float = parameter("1", "stiffness of structure 1, over that as built", FACTOR, 1.0)
    stiffening_2: float = parameter("1", "stiffness of structure 2, over that as built", FACTOR, 1.0)
    strengthening_1: float = parameter("1", "strength of structure 1, over that as built", FACTOR, 1.0)
    strengthening_2: float = parameter("1", "strength of structure 2, over that as built", FACTOR, 1.0)

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
        """All links of the measure, each with the numbers of the two structures that it ties."""
        links = (self.link,) if isinstance(self.link, Link) else self.link or ()
        return tuple(replace(each, structures=each.structures or BETWEEN) for each in links)

    @property
    def has_bumpers(self) -> bool:
        """Whether the measure changes what is between both structures where they meet."""
        return self.contact is not None or self.bumper_thickness > 0

    def describe(self) -> str:
        """The measure in one line; links that differ only in their floors are listed together."""
        return ", ".join([*self.stated(), *self.further()])

    def stated(self) -> list[str]:
        """The parameters that are not as built."""
        as_built = {field.name: field.default for field in self._declared()}
        changed = (pair for pair in self.cells().items() if pair[1] != as_built[pair[0]])
        return [stated(name, value, self.units(name)) for name, value in changed]

    def further(self) -> list[str]:
        """The links, and the contact."""
        alike: dict[str, list[Link]] = {}
        for link in (self.link,) if isinstance(self.link, Link) else self.link or ():
            kind = link.describe().replace(f", {link.ends}", "") if link.ends else link.describe()
            alike.setdefault(kind, []).append(link)
        parts = [
            f"{len(those)} times {kind} at {', '.join(link.ends or 'level floors' for link in those)}"
            if those[1:]
            else those[0].describe()
            for kind, those in alike.items()
        ]
        return parts + ([] if self.contact is None else [f"contact {self.contact.describe()}"])
