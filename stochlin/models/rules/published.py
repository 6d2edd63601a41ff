"""The base of published formulas (rules), with name, reference and mark, and the search by name.

The mark says how a formula was verified: S, compared with a copy of its source; P, in the
available text of Valles-Mattox and Reinhorn (1996); C, derived and checked here; M, not compared with
its source, with a high or a low confidence that the formula and its constants agree with it.
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
    """Base of the rules; `published` sets name, reference, mark and title of a subclass."""

    name: ClassVar[str]
    reference: ClassVar[str]
    mark: ClassVar[str] = ""
    title: ClassVar[str] = ""  # published name, authors and year
    abbreviation: ClassVar[str] = ""
    reason: ClassVar[str] = ""  # why the rule is too uncertain to be listed with the others, if it is

    @classmethod
    @cache
    def usual(cls) -> Self:
        """The rule with its default numbers, as one shared instance."""
        return cls()

    @property
    def verified(self) -> bool:
        """Whether the rule is certain enough to be listed with the others."""
        return not self.reason

    @classmethod
    def published_name(cls) -> str:
        """The title of the rule, or else its name, with a remark if its constants are unverified."""
        return f"{cls.title or cls.name}{', constants unverified' if cls.reason else ''}"

    def describe(self) -> str:
        """Name, reference, mark and any reason for doubt in one line, for metadata."""
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
    """Decorator that registers a rule by its name and sets its reference, mark and title."""

    def add(rule: type[Rule]) -> type[Rule]:
        rule.name, rule.reference, rule.mark, rule.title = name, reference, mark, title
        return registry.register(name, place)(rule)

    return add


def look_up(registry: Registry[type[Rule]], name: object, parameter: str) -> type[Rule]:
    """The rule with this name, in any case, with or without the year, or with this abbreviation.

    For an unknown name a ValueError lists all rules; ``parameter`` is the name of the argument.
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
    """The name in lower case, without spaces, underscores and hyphens."""
    return re.sub(r"[\s_-]", "", str(name).lower())
