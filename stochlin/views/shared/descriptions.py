"""What the attributes of a dataset and a case say of their models, for captions and pages."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stochlin.models.grounds.named import ground_names
from stochlin.views.shared.words import rule_label

if TYPE_CHECKING:
    from stochlin.analyses.cases.reading.case import Case

ROLES = {
    "first": "building 1",
    "second": "building 2",
    "ground": "ground",
    "envelope": "envelope",
    "envelope_model": "envelope",
    "contact": "contact",
    "gap": "gap",
    "record": "record",
}
ERRORS_OF_FIT = re.compile(r", have this spectrum in the mean with errors of .*?\(largest\)")


def roles_in_words(attrs: Mapping[Any, Any], *roles: str) -> list[str]:
    """A line for each of these roles that the attributes of a dataset describe; all if none is named."""
    return [f"{ROLES[r]}: {attrs[r].removeprefix(f'{r} ')}" for r in roles or ROLES if r in attrs]


def site_in_words(case: Case) -> str:
    """The ground of a case: the name or spectrum that it is given by, and its model."""
    parts = [part.name for part in getattr(case.site.ground, "grounds", (case.site.ground,))]
    model = f"{' and '.join(dict.fromkeys(parts))} ground"
    if len(parts) > 1:
        model = f"{len(parts)} {model}s in parallel"
    if case.site.spectrum is not None:
        code = case.site.spectrum.attrs.get("code")
        return f"{rule_label(code) if code else case.site.name} spectrum, {model}"
    if case.site.name == "fitted":
        return f"{model}, fitted to a record"
    return f"{case.site.name}, {model}" if case.site.name in ground_names() else model


def source_in_words(case: Case) -> str:
    """The source of the ground of a case; empty if it has none.

    The errors of a fit over all periods are left out: a case has those in the band of its buildings.
    """
    return ERRORS_OF_FIT.sub("", case.site.ground.source)
