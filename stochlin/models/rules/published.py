"""What a published formula says of itself, and how it is found by name.

Marks: S, the formula was seen in a copy of its source; P, it is printed in Valles-Mattox and Reinhorn
(1996); C, derived and checked by us; M, not compared with the printed source (high or low: how likely it
is that the formula and its constants agree with it).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Self, TypeVar

from stochlin.messages import brief
from stochlin.registry import LAST, Registry


@dataclass(frozen=True)
class Published:
    """Base of the rules: `published` gives a subclass its name, reference, mark and title."""

    name: ClassVar[str]
    reference: ClassVar[str]
    mark: ClassVar[str] = ""
    title: ClassVar[str] = ""  # the name it is published under, of authors and year
    abbreviation: ClassVar[str] = ""
    reason: ClassVar[str] = ""  # why it is too uncertain to be offered among the others

    @classmethod
    @cache
    def usual(cls) -> Self:
        """The rule with its usual numbers, one for all."""
        return cls()

    @property
    def verified(self) -> bool:
        """Whether it is certain enough to be offered among the others."""
        return not self.reason

    @classmethod
    def published_name(cls) -> str:
        """Its title, or its name if it has none, and whether its constants are doubtful."""
        return f"{cls.title or cls.name}{', constants unverified' if cls.reason else ''}"

    def describe(self) -> str:
        """Name, reference and mark in one line, for metadata."""
        return f"{self.name}: {self.reference} [{'; '.join(filter(None, (self.mark, self.reason)))}]"


Rule = TypeVar("Rule", bound=Published)


def published(
    registry: Registry[type[Rule]],
    name: str,
    reference: str,
    mark: str = "",
    place: int = LAST,
    title: str = "",
) -> Callable[[type[Rule]], type[Rule]]:
    """A decorator: the class is known by this name, and says by itself where it comes from."""

    def add(rule: type[Rule]) -> type[Rule]:
        rule.name, rule.reference, rule.mark, rule.title = name, reference, mark, title
        return registry.register(name, place)(rule)

    return add


def look_up(registry: Registry[type[Rule]], name: object, parameter: str) -> type[Rule]:
    """The rule of this name, in any case, with or without the year; or of this abbreviation.

    A ValueError lists all there are.
    """
    known = {_plain(key).rstrip("0123456789"): rule for key, rule in registry.items()}
    for key, rule in registry.items():
        known |= {_plain(own): rule for own in (rule.abbreviation or key, rule.__name__, key)}
    if _plain(name) in known:
        return known[_plain(name)]
    allowed = ", ".join(
        f"{rule.__name__} ({rule.abbreviation})" if rule.abbreviation else key
        for key, rule in registry.items()
    )
    raise ValueError(f"{parameter} = {brief(name)} is not a known {registry.kind}; allowed: {allowed}")


def _plain(name: object) -> str:
    return re.sub(r"[\s_-]", "", str(name).lower())
