"""A measure against pounding: a link, added damping, a bumper, or several of them at once."""

from __future__ import annotations

from dataclasses import dataclass

from stochlin.models.contacts import Contact
from stochlin.models.links import Link
from stochlin.models.parameters import NOT_NEGATIVE, Model, Parameter, expect, parameter


@dataclass(frozen=True)
class Measure(Model):
    """What is done to two buildings so that they pound less, or pound softer.

    Parameters
    ----------
    added_damping_1, added_damping_2 : float
        Damping ratio [-] that dampers add to structure 1 and 2, referred to its mass and elastic
        stiffness as its own is; not negative.
    link : Link, optional
        Spring and dashpot between both.
    contact : Contact, optional
        What they meet at, for instance bumpers of another stiffness or restitution.

    Raises
    ------
    ValueError, TypeError
        If a ratio is negative or no number, or link or contact is of the wrong kind.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), on links, bumpers and supplemental damping.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Measure(added_damping_1=0.1, link=sl.Link(damping_constant=1e6)).describe()
    'Measure(added_damping_1=0.1, added_damping_2=0, link=Link(stiffness=0, damping_constant=1e+06))'
    """

    added_damping_1: Parameter = parameter("1", "damping added to structure 1", NOT_NEGATIVE, 0.0)
    added_damping_2: Parameter = parameter("1", "damping added to structure 2", NOT_NEGATIVE, 0.0)
    link: Link | None = None
    contact: Contact | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        for kind, part, role in ((Link, self.link, "link"), (Contact, self.contact, "contact")):
            if part is not None:
                expect(part, kind, f"Measure: {role}")

    def describe(self) -> str:
        """One line with the parameters."""
        own = {"link": self.link, "contact": self.contact}
        parts = [f", {name}={part.describe()}" for name, part in own.items() if part is not None]
        return f"{super().describe()[:-1]}{''.join(parts)})"
