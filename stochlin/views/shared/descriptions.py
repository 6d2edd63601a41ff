"""Models as datasets name them, ``Bilinear(period=1, mass=2e6)``, in words and units."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from stochlin.messages import hyphenated
from stochlin.models.buildings import ModalBuilding, ShearBuilding
from stochlin.models.contacts.base import CONTACTS
from stochlin.models.envelopes.base import ENVELOPES
from stochlin.models.grounds import ParallelGround
from stochlin.models.grounds.base import GROUNDS
from stochlin.models.grounds.named import ground_names
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.parameters import Model
from stochlin.models.structures import LAWS, Gap
from stochlin.views.shared.words import rounded, rule_label, shown_unit

if TYPE_CHECKING:
    from stochlin.analyses.cases.case import Case

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
CALL = re.compile(r"(\w+)\((.*)\)", re.DOTALL)
NUMBER = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:e[-+]?\d+)?(?![\w.])")
OF_ONE = re.compile(r"_(?=[12]$)")
UNCERTAIN = re.compile(r"([-\d.e+]+(?: to [-\d.e+]+)?)(?: \+- (.*))?")  # two ends, or median and spread
SEVERAL = re.compile(r"\(([^()]*)\)")
WITHIN = re.compile(r"\b[A-Z]\w*\(\w+=(?:[^()]|\([^()]*\))*\)")  # a model in a text
ERRORS_OF_FIT = re.compile(r", have this spectrum in the mean with errors of .*?\(largest\)")
COUNT = re.compile(r"^(\d+) of ")
SHOWN = {
    "ModalBuilding": "building by its modes",
    "ShearBuilding": "shear building",
    "ParallelGround": "filters in parallel",
    "WhiteNoise": "white noise",
}
OVER = re.compile(r"\[(?:(\d+) times )?(.*) over (.*)\]")


def roles_in_words(attrs: Mapping[Any, Any], *roles: str) -> list[str]:
    """A line for each of these roles that the attributes of a dataset describe; all if none is named."""
    shown = roles or tuple(ROLES)
    return [f"{ROLES[role]}: {in_words(attrs[role], role)}" for role in shown if role in attrs]


def in_words(described: str, role: str = "") -> str:
    """The text of ``Model.describe`` for a reader, without the name of the role; others unchanged."""
    call = CALL.fullmatch(described)
    if call is None:
        return described
    name, arguments = call.groups()
    kind = _kinds().get(name)
    parts = [
        _bracketed(part) if WITHIN.match(part) else _parameter(kind, role, *part.partition("=")[::2])
        for part in _parts(arguments)
    ]
    shown = SHOWN.get(name, hyphenated(name))
    return ", ".join(filter(None, ["" if name.lower() == role else shown, *parts]))


def _bracketed(text: str, role: str = "") -> str:
    """A text with the models in it in words."""
    return WITHIN.sub(lambda found: f"({in_words(found[0], role)})", text)


def site_in_words(case: Case) -> str:
    """The ground of a case: the name or spectrum that it is given by, and its model."""
    parts = [part.name for part in getattr(case.ground, "grounds", (case.ground,))]
    model = f"{' and '.join(dict.fromkeys(parts))} ground"
    if len(parts) > 1:
        model = f"{len(parts)} {model}s in parallel"
    if case.spectrum is not None:
        code = case.spectrum.attrs.get("code")
        return f"{rule_label(code) if code else case.site} spectrum, {model}"
    if case.fitted:
        return f"{model}, fitted to a record"
    return f"{case.site}, {model}" if case.site in ground_names() else model


def source_in_words(case: Case) -> str:
    """The source of the ground of a case, the envelope in words; empty if it has none.

    The errors of a fit over all periods are left out: a case has those in the band of its buildings.
    """
    source = ERRORS_OF_FIT.sub("", case.ground.source)
    return WITHIN.sub(lambda found: f"envelope ({in_words(found[0])})", source)


def _parameter(kind: type[Model] | None, role: str, name: str, value: str) -> str:
    """``mass 2000 t``; empty of a zero that says that there is nothing."""
    field = getattr(kind, "__dataclass_fields__", {}).get(name)
    units = field.metadata.get("units", "1") if field else "1"
    colon = ":" if OF_ONE.search(name) else ""
    words = "" if name == role else f"{OF_ONE.sub(' of building ', name).replace('_', ' ')}{colon} "
    if WITHIN.search(value):
        return words + COUNT.sub(r"\1 times ", _bracketed(value, name))
    if NUMBER.fullmatch(value):
        absent = float(value) == 0 and (not field or field.default == 0)
        return "" if absent else words + _measured(value, units)
    if over := OVER.fullmatch(value):
        count, numbers, dimensions = over.groups()
        every = f"{count} times " if count else ""
        places = re.sub(r"\b(?:yielding )?(?:storey|floor|mode)\b", r"the \g<0>s", dimensions)
        return f"{words}{every}{_measured(numbers, units)} over {places}"
    if uncertain := UNCERTAIN.fullmatch(value):
        spread = f" ± {uncertain[2]}" if uncertain[2] else ""
        return f"{words}{_measured(uncertain[1], units)}{spread}"
    if several := SEVERAL.fullmatch(value):
        return _ends(name, words, several[1].rstrip(",").split(", "))
    return f"{words}{value}".strip()


def _ends(name: str, words: str, each: list[str]) -> str:
    """Where a link is: between which floors, of which buildings or inside which."""
    if name == "structures" and len(set(each)) == 1:
        return f"inside building {each[0]}"
    ends = ["the ground" if (name, end) == ("floors", "0") else end for end in each]
    return f"{words.replace('structure', 'building')}{' and '.join(ends)}"


def _measured(text: str, units: str) -> str:
    """The numbers of a text in the unit that is shown, and that unit."""
    numbers = [abs(float(number)) for number in NUMBER.findall(text)]
    unit, scale = shown_unit(units, max(numbers, default=np.inf))
    return NUMBER.sub(lambda number: rounded(scale * float(number[0])), text) + unit


def _parts(given: str) -> Iterator[str]:
    """The parts between the commas outside of brackets."""
    depth, begin = 0, 0
    for place, letter in enumerate(given):
        depth += (letter in "([") - (letter in ")]")
        if letter == "," and depth == 0:
            yield given[begin:place].strip()
            begin = place + 1
    if given[begin:].strip():
        yield given[begin:].strip()


@cache
def _kinds() -> dict[str, type[Model]]:
    """Every kind of model by its name."""
    named = (kind for registry in (LAWS, GROUNDS, ENVELOPES, CONTACTS) for kind in registry.values())
    others = ParallelGround, ModalBuilding, ShearBuilding, Link, Measure, Gap
    return {kind.__name__: kind for kind in (*named, *others)}
