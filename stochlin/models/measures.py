"""Mitigation measures against pounding: links, damping devices and added damping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from stochlin.messages import brief
from stochlin.models.links import Link
from stochlin.models.parameters import NOT_NEGATIVE, Model, expect, parameter

TIED_STRUCTURES = (1, 2)  # the structures that a link ties if it does not name them


@dataclass(frozen=True)
class Measure(Model):
    """A mitigation measure, which reduces the gap that two buildings need.

    One measure may combine links, damping devices and added damping. Buildings that are stiffer or
    stronger are structures of their own, and bumpers contacts of `pound`.

    Parameters
    ----------
    added_damping_1, added_damping_2 : float
        Damping ratio [-] that dampers add to structures 1 and 2, not negative. As for the
        structure's own damping ratio, its mass and elastic stiffness are the reference.
    link : Link or list of Link, optional
        Springs and dashpots between the two structures, or damping devices inside one of them. For
        a device, ``structures`` of the link names the same structure twice.

    Raises
    ------
    ValueError, TypeError
        If a value, also of a link, is an array or is out of range, or if ``link`` is of the wrong
        kind.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), for links and supplemental damping.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Measure(added_damping_1=0.1, link=sl.Link(damping_constant=1e6)).describe()
    'added damping of building 1: 0.1, Link (damping constant 1 MN s/m)'
    >>> braces = [
    ...     sl.Link(
    ...         5e7, hardening=0.02, yield_displacement=0.003, structures=(2, 2), floors=(n, n - 1)
    ...     )
    ...     for n in (1, 2, 3)
    ... ]
    >>> sl.Measure(link=braces).describe().partition(" at ")[2]
    'floors 1 and ground, floors 2 and 1, floors 3 and 2'
    """

    added_damping_1: float = parameter(
        "1", "damping added to structure 1", NOT_NEGATIVE, 0.0, scalar=True
    )
    added_damping_2: float = parameter(
        "1", "damping added to structure 2", NOT_NEGATIVE, 0.0, scalar=True
    )
    link: Link | Sequence[Link] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        listed = (self.link,) if isinstance(self.link, Link) else self.link
        if not isinstance(listed, (list, tuple)):
            raise TypeError(
                f"Measure: link = {brief(self.link)}; allowed: a Link, or a list of them"
            )
        for number, link in enumerate(listed, start=1):
            expect(link, Link, f"Measure: link, number {number}")
            _ = link.numbers  # raises an error for an array
        object.__setattr__(self, "link", tuple(listed))

    @property
    def links(self) -> tuple[Link, ...]:
        """All links of the measure, each with the numbers of the two structures that it ties."""
        return tuple(
            replace(link, structures=link.structures or TIED_STRUCTURES) for link in self._listed()
        )

    def _listed(self) -> Sequence[Link]:
        assert isinstance(self.link, tuple)
        return self.link

    def describe(self) -> str:
        """The measure in one line; links that differ only in their floors are listed together."""
        return ", ".join([*self.stated(), *self.further()])

    def further(self) -> list[str]:
        """The links."""
        alike: dict[str, list[Link]] = {}
        for link in self._listed():
            kind = link.describe().replace(f", {link.ends}", "") if link.ends else link.describe()
            alike.setdefault(kind, []).append(link)
        return [
            f"{len(those)} times {kind} at "
            f"{', '.join(link.ends or 'level floors' for link in those)}"
            if those[1:]
            else those[0].describe()
            for kind, those in alike.items()
        ]
