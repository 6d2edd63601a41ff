"""What a user describes can be sent to another process, compared and used as a key."""

import dataclasses
import inspect
import pickle
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import sympy
from cases import example_case
from uploads import open_case

import stochlin as sl
from stochlin.models.contacts.base import CONTACTS
from stochlin.models.envelopes import ENVELOPES
from stochlin.models.grounds import GROUNDS
from stochlin.models.rules.codes import CODE_RULES
from stochlin.models.rules.effective_properties import EFFECTIVE_RULES
from stochlin.models.rules.peak_factors import PEAK_FACTORS
from stochlin.models.structures import LAWS
from stochlin.views.figures.settings import ChartSettings

pytestmark = pytest.mark.invariant

V, Z = sympy.symbols("v z")
REGISTRIES = (CONTACTS, ENVELOPES, GROUNDS, LAWS)
RULES = (CODE_RULES, EFFECTIVE_RULES, PEAK_FACTORS)
# What the parameters of a class do not tell by their ranges.
GIVEN: dict[str, dict[str, Any]] = {
    "AminAng": {"strong_end": 9.0},
    "ShinozukaSato": {"fast": 2.0},
    "Uncertain": {"median": 1.0, "spread": 0.2},
    "HazardCurve": {"intensities": [1.0, 2.0], "frequencies": [0.01, 0.002]},
    "Hysteretic": {"law": V - abs(V) * Z, "hardening": 0.1, "reduction_factor": 4},
    "Measure": {"added_damping_1": 0.1, "link": [sl.Link(damping_constant=1e5), sl.Link(1e6)]},
    "ParallelGround": {"grounds": [sl.KanaiTajimi(0.4, 0.6), sl.KanaiTajimi(1.0, 0.3)]},
    "ModalBuilding": {
        "periods": [0.5],
        "shapes": [[1.0]],
        "masses": [1e5],
        "heights": [3.0],
        "damping": 0.05,
    },
    "ShearBuilding": {"masses": [1e5], "stiffnesses": [1e8], "heights": [3.0], "damping": 0.05},
}
UNHASHABLE = {"Case", "ModalBuilding", "ShearBuilding"}  # they hold arrays and mappings
OTHERS = {
    "Case": open_case({"case.toml": example_case().encode()})[0],
    "ChartSettings": ChartSettings(),
    **{name: rule for registry in RULES for name, rule in registry.items()},
}


def described() -> Iterator[type]:
    """Every public class, and every one that is found by name."""
    public = (getattr(sl, name) for name in sl.__all__)
    registered = (kind for registry in REGISTRIES for kind in registry.values())
    return iter({one for one in (*public, *registered) if inspect.isclass(one)})


def made(kind: type) -> Any:
    """One of this class, with numbers inside the ranges."""
    given = dict(GIVEN.get(kind.__name__, {}))
    about = {field.name: field.metadata for field in dataclasses.fields(kind)}
    for name, one in inspect.signature(kind).parameters.items():
        if name not in given and (one.default is one.empty or name == "restitution"):
            given[name] = about[name]["allowed"].middle if "allowed" in about.get(name, ()) else 0.5
    return kind(**given)


KINDS = sorted(described(), key=lambda kind: (kind.__module__, kind.__name__))
THINGS = [pytest.param(lambda kind=kind: made(kind), id=kind.__name__) for kind in KINDS]
THINGS += [pytest.param(lambda thing=thing: thing, id=name) for name, thing in OTHERS.items()]


@pytest.mark.parametrize("make", THINGS)
def test_a_copy_is_the_same(make: Callable[[], Any]) -> None:
    thing = make()
    other = pickle.loads(pickle.dumps(thing))
    assert other == thing
    assert type(other) is type(thing)
    if type(thing).__name__ not in UNHASHABLE:
        assert hash(other) == hash(thing)


def test_a_law_that_was_sent_away_gives_the_same_numbers() -> None:
    friction = made(sl.Hysteretic)
    sent = pickle.loads(pickle.dumps(friction))
    ground = sl.KanaiTajimi(1.0, 0.3)
    for one in (friction, sent):
        one.step()
    assert sl.linearize(sent, ground).equals(sl.linearize(friction, ground))
    assert pickle.loads(pickle.dumps(friction)) == friction  # after its compiled parts were used
