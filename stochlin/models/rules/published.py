"""Name, reference and mark of a published formula, and the search by name."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TypeVar

from stochlin.messages import brief
from stochlin.registry import LAST, Registry


@dataclass(frozen=True, kw_only=True)
class Published:
    """A published formula, by name."""

    name: str
    reference: str
    mark: str = ""
    title: str = ""  # published name, authors and year
    reason: str = ""  # why the rule is too uncertain to be listed with the others, if it is

    def published_name(self) -> str:
        """The title of the rule, or its name, with a remark if its constants are unverified."""
        return f"{self.title or self.name}{', constants unverified' if self.reason else ''}"

    def describe(self) -> str:
        """Name, reference, mark and any reason for doubt in one line, for metadata."""
        return (
            f"{self.name}: {self.reference} [{'; '.join(filter(None, (self.mark, self.reason)))}]"
        )


Rule = TypeVar("Rule", bound=Published)


def publish(registry: Registry[Rule], rule: Rule, place: int = LAST) -> None:
    """Make a rule known by its name; lists show a lower ``place`` first."""
    registry.register(rule.name, place)(rule)


def look_up(registry: Registry[Rule], name: object, parameter: str) -> Rule:
    """The rule with this name, in any case, with or without the year.

    For an unknown name, or one that several rules have without the year, a ValueError lists what is
    allowed; ``parameter`` is the name of the argument.
    """
    wanted = _plain(name)
    exact = [rule for key, rule in registry.items() if _plain(key) == wanted]
    fitting = exact or [
        rule for key, rule in registry.items() if _plain(key).rstrip("0123456789") == wanted
    ]
    if len(fitting) == 1:
        return fitting[0]
    allowed = ", ".join([rule.name for rule in fitting] or registry)
    raise ValueError(
        f"{parameter} = {brief(name)} is not a known {registry.kind}; allowed: {allowed}"
    )


def _plain(name: object) -> str:
    """The name in lower case, without spaces, underscores and hyphens."""
    return re.sub(r"[\s_-]", "", str(name).lower())
